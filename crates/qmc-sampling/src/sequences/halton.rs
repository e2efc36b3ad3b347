//! The Halton sequence and the Hammersley set.
use super::{DigitScramble, PRIMES, SequenceError, prime, radical_inverse};
use crate::Real;
use crate::sequence::Sequence;

/// The Halton sequence: in dimension `d` the radical inverse in the prime number `d`.
///
/// Any number of points is a good number. In higher dimensions neighbouring ones are correlated unless the digits are
/// permuted; scrambling by Owen removes that and speeds up convergence.
///
/// Cost: one integer division per digit, and one hash per digit if randomised.
/// Source: Halton (1960); Owen, "A randomized Halton algorithm in R" (2017).
///
/// ```
/// use qmc_sampling::{Sequence, sequences::{DigitScramble, Halton}};
/// let halton = Halton::default();
/// assert_eq!([halton.sample(4, 0), halton.sample(4, 1)], [0.125, 4.0 / 9.0]);
/// assert!(Halton::new(DigitScramble::Owen(1)).sample(1 << 40, 1023) < 1.0);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Halton {
    scramble: DigitScramble,
}

impl Halton {
    /// The sequence with digits randomised in this way.
    #[must_use]
    pub const fn new(scramble: DigitScramble) -> Self {
        Self { scramble }
    }
}

impl Sequence for Halton {
    fn dimensions(&self) -> u32 {
        PRIMES
    }

    /// # Panics
    /// If `dimension` is 1024 or more.
    #[inline]
    fn sample(&self, index: u64, dimension: u32) -> f64 {
        self.scramble.radical_inverse(prime(dimension), index, dimension)
    }
}

/// The Hammersley set of `n` points: `i / n` in the first dimension, the Halton sequence in the others.
///
/// Indices of `n` and more repeat the first dimension. Source: Hammersley (1960).
///
/// ```
/// use qmc_sampling::{Sequence, sequences::Hammersley};
/// # fn main() -> Result<(), qmc_sampling::sequences::SequenceError> {
/// assert_eq!(Hammersley::new(4)?.sample_2d(3), [0.75, 0.75]);
/// # Ok(()) }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Unchecked"))]
pub struct Hammersley {
    points: u64,
}

#[cfg(feature = "serde")]
read_through!(Hammersley { points: u64 } => Self::new(points), SequenceError);

impl Hammersley {
    /// The set of `points` points.
    ///
    /// # Errors
    /// If there are none.
    pub fn new(points: u64) -> Result<Self, SequenceError> {
        if points == 0 { Err(SequenceError::NoPoints) } else { Ok(Self { points }) }
    }
}

impl Sequence for Hammersley {
    fn dimensions(&self) -> u32 {
        PRIMES + 1
    }

    /// # Panics
    /// If `dimension` is 1025 or more.
    #[inline]
    fn sample(&self, index: u64, dimension: u32) -> f64 {
        match dimension {
            0 => ((index % self.points) as f64 / self.points as f64).clamp_unit(),
            d => radical_inverse(prime(d - 1), index),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Halton (1960): the first points in bases 2, 3 and 5.
    #[test]
    fn first_points() {
        let halton = Halton::default();
        let expected = [
            [0.0, 0.0, 0.0],
            [0.5, 1.0 / 3.0, 0.2],
            [0.25, 2.0 / 3.0, 0.4],
            [0.75, 1.0 / 9.0, 0.6],
            [0.125, 4.0 / 9.0, 0.8],
            [0.625, 7.0 / 9.0, 0.04],
        ];
        for (i, point) in expected.iter().enumerate() {
            assert_eq!([0, 1, 2].map(|d| halton.sample(i as u64, d)), *point);
        }
        assert_eq!(Hammersley::new(0), Err(SequenceError::NoPoints));
    }

    #[test]
    fn scrambled_dimensions_differ_and_repeat() {
        for scramble in [DigitScramble::Permuted(5), DigitScramble::Owen(5)] {
            let halton = Halton::new(scramble);
            for d in 0..20 {
                assert_eq!(halton.sample(77, d), halton.sample(77, d));
                assert_ne!(halton.sample(77, d), Halton::default().sample(77, d));
            }
        }
    }
}
