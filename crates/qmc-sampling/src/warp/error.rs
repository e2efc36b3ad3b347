//! What can be wrong with a table of weights.
use core::fmt;

/// Why a table of weights was refused.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum TableError {
    /// There are no weights.
    Empty,
    /// There are more weights than uniform numbers of this precision can tell apart.
    TooMany {
        /// How many there are.
        len: usize,
        /// How many there may be.
        limit: usize,
    },
    /// A weight is negative, infinite or NaN.
    InvalidWeight {
        /// Where it stands.
        index: usize,
        /// What it is.
        weight: f64,
    },
    /// All the weights are zero, or their sum overflows.
    InvalidSum(f64),
    /// The number of weights is not the product of the sides.
    WrongSize {
        /// How many there are.
        len: usize,
        /// How many there should be.
        expected: usize,
    },
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => write!(f, "no weights"),
            Self::TooMany { len, limit } => write!(f, "{len} weights, of at most {limit}"),
            Self::InvalidWeight { index, weight } => {
                write!(f, "weight {index} is {weight}, neither zero nor positive and finite")
            }
            Self::InvalidSum(sum) => write!(f, "the sum of the weights is {sum}, not positive and finite"),
            Self::WrongSize { len, expected } => write!(f, "{len} weights instead of {expected}"),
        }
    }
}

impl core::error::Error for TableError {}

/// The sum of the weights.
pub(crate) fn checked_sum<F: crate::Real>(weights: &[F]) -> Result<f64, TableError> {
    if weights.is_empty() {
        return Err(TableError::Empty);
    }
    let mut sum = 0.0;
    for (index, weight) in weights.iter().map(|w| w.to_f64()).enumerate() {
        if !(weight >= 0.0 && weight.is_finite()) {
            return Err(TableError::InvalidWeight { index, weight });
        }
        sum += weight;
    }
    Ok(sum)
}
