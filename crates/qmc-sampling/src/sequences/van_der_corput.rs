//! The van der Corput sequence.
use super::{DigitScramble, SequenceError};
use crate::sequence::Sequence;

/// The van der Corput sequence in any base: the radical inverse of the index.
///
/// `x_i = sum_k d_k b^(-k-1)`. Each block of `b^k` indices has one point in each interval of length `b^-k`.
/// One dimension; others repeat it with other random digits, or alike if there are none.
/// Source: van der Corput (1935).
///
/// ```
/// use qmc_sampling::{Sequence, sequences::VanDerCorput};
/// # fn main() -> Result<(), qmc_sampling::sequences::SequenceError> {
/// assert_eq!(VanDerCorput::new(10)?.sample(123, 0), 0.321);
/// # Ok(()) }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Unchecked"))]
pub struct VanDerCorput {
    base: u32,
    scramble: DigitScramble,
}

#[cfg(feature = "serde")]
read_through!(VanDerCorput { base: u32, scramble: DigitScramble } => Ok(Self::new(base)?.scrambled(scramble)), SequenceError);

impl VanDerCorput {
    /// The plain sequence in this base.
    ///
    /// # Errors
    /// If the base is below two.
    pub fn new(base: u32) -> Result<Self, SequenceError> {
        if base < 2 {
            return Err(SequenceError::BaseTooSmall(base));
        }
        Ok(Self { base, scramble: DigitScramble::None })
    }

    /// The same with randomised digits.
    #[must_use]
    pub fn scrambled(self, scramble: DigitScramble) -> Self {
        Self { scramble, ..self }
    }
}

impl Sequence for VanDerCorput {
    fn dimensions(&self) -> u32 {
        1
    }

    #[inline]
    fn sample(&self, index: u64, dimension: u32) -> f64 {
        self.scramble.radical_inverse(self.base, index, dimension)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_points() {
        let points = |base, n: u64| -> std::vec::Vec<f64> {
            (0..n).map(|i| VanDerCorput::new(base).unwrap().sample(i, 0)).collect()
        };
        assert_eq!(points(2, 8), [0.0, 0.5, 0.25, 0.75, 0.125, 0.625, 0.375, 0.875]);
        assert_eq!(points(3, 6), [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0 / 9.0, 4.0 / 9.0, 7.0 / 9.0]);
        assert_eq!(VanDerCorput::new(1), Err(SequenceError::BaseTooSmall(1)));
    }
}
