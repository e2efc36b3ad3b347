//! How evenly points are spread.
//!
//! Points are slices of rows, `points[i * dimensions + d]`, in `[0, 1)`. Empty sets and points that do not fill the last row
//! are refused.
mod discrepancy;
mod net;
mod periodogram;
mod star;

pub use discrepancy::{centred_l2, l2_star, mixture, wrap_around_l2};
pub use net::{digital_net_t, is_net, net_t};
pub use periodogram::Periodogram;
pub use star::{star_bounds, star_exact};

use core::fmt;

/// Why a set of points could not be measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeasureError {
    /// No points, no dimensions, or a last row that is not full.
    Shape {
        /// How many numbers there are.
        len: usize,
        /// How many make a point.
        dimensions: usize,
    },
    /// A coordinate outside of `[0, 1)`, or NaN.
    Outside {
        /// Where it stands.
        index: usize,
    },
    /// The number of points is no power of the base, or the base is below two.
    NotAPower {
        /// How many points there are.
        points: usize,
        /// The base.
        base: u32,
    },
    /// It would take too long: more than about 10^10 steps.
    TooExpensive,
}

impl fmt::Display for MeasureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Shape { len, dimensions } => {
                write!(f, "{len} numbers make no set of points in {dimensions} dimensions")
            }
            Self::Outside { index } => write!(f, "number {index} is not in [0, 1)"),
            Self::NotAPower { points, base } => write!(f, "{points} points are no power of {base}"),
            Self::TooExpensive => write!(f, "this measure would take too long on that many points and dimensions"),
        }
    }
}

impl core::error::Error for MeasureError {}

/// The number of points, if they are well-formed.
fn check(points: &[f64], dimensions: usize) -> Result<usize, MeasureError> {
    if points.is_empty() || dimensions == 0 || !points.len().is_multiple_of(dimensions) {
        return Err(MeasureError::Shape { len: points.len(), dimensions });
    }
    match points.iter().position(|x| !(0.0..1.0).contains(x)) {
        Some(index) => Err(MeasureError::Outside { index }),
        None => Ok(points.len() / dimensions),
    }
}

#[cfg(test)]
pub(crate) mod testing {
    use crate::Sequence;
    use std::vec::Vec;

    pub(crate) fn points(sequence: impl Sequence, n: u64, dimensions: u32) -> Vec<f64> {
        (0..n).flat_map(|i| (0..dimensions).map(move |d| sequence.sample(i, d))).collect()
    }
}
