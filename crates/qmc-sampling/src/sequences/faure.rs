//! The Faure sequence.
use super::primes::prime_from;
use super::{DigitScramble, PRIMES, SequenceError, prime};
use crate::sequence::Sequence;

/// The Faure sequence: a (0,s)-sequence in a prime base of at least `s`.
///
/// The digits of coordinate `j` are `P^j d` modulo the base, with `P` the matrix of binomials: the coefficients of the digit
/// polynomial shifted by `j`. Each aligned block of `b^m` points has exactly one point in every elementary interval of volume
/// `b^-m`, which no base below `s` allows.
///
/// Cost: quadratic in the number of digits of the index. Source: Faure (1982).
///
/// ```
/// use qmc_sampling::{Sequence, sequences::Faure};
/// # fn main() -> Result<(), qmc_sampling::sequences::SequenceError> {
/// let faure = Faure::new(3)?;
/// assert_eq!(faure.base(), 3);
/// let ninths = [0, 1, 2].map(|d| (9.0 * faure.sample(4, d)).round());
/// assert_eq!(ninths, [4.0, 7.0, 1.0]);
/// # Ok(()) }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Unchecked"))]
pub struct Faure {
    base: u32,
    dimensions: u32,
    scramble: DigitScramble,
}

#[cfg(feature = "serde")]
read_through!(Faure { dimensions: u32, scramble: DigitScramble } => Ok(Self::new(dimensions)?.scrambled(scramble)), SequenceError);

impl Faure {
    /// The plain sequence of this many dimensions, in the smallest prime base that has them.
    ///
    /// # Errors
    /// If there are no dimensions or more than 8161.
    pub fn new(dimensions: u32) -> Result<Self, SequenceError> {
        let limit = prime(PRIMES - 1);
        let refused = SequenceError::Dimensions { asked: dimensions, limit };
        let base = prime_from(dimensions).filter(|_| dimensions > 0).ok_or(refused)?;
        Ok(Self { base, dimensions, scramble: DigitScramble::None })
    }

    /// The same with randomised digits.
    #[must_use]
    pub fn scrambled(self, scramble: DigitScramble) -> Self {
        Self { scramble, ..self }
    }

    /// The base: blocks of its powers are nets.
    #[must_use]
    pub fn base(&self) -> u32 {
        self.base
    }
}

impl Sequence for Faure {
    fn dimensions(&self) -> u32 {
        self.dimensions
    }

    /// Dimensions beyond [`dimensions`](Sequence::dimensions) repeat the others.
    fn sample(&self, index: u64, dimension: u32) -> f64 {
        // Split the index into digits.
        let mut digits = [0_u32; 64];
        let (mut count, mut rest) = (0, index);
        while rest > 0 {
            digits[count] = (rest % u64::from(self.base)) as u32;
            rest /= u64::from(self.base);
            count += 1;
        }
        // Shift the polynomial with these coefficients.
        let shift = u64::from(dimension % self.base);
        for start in 0..count.saturating_sub(1) {
            for k in (start..count - 1).rev() {
                let sum = u64::from(digits[k]) + shift * u64::from(digits[k + 1]);
                digits[k] = (sum % u64::from(self.base)) as u32;
            }
        }
        // Mirror its digits at the decimal point.
        let mut digits = digits.iter();
        self.scramble.mirror(self.base, dimension, 53, || digits.next().copied().unwrap_or(0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;

    /// Fox (1986), Algorithm 647: in base 3 the points after the origin.
    #[test]
    fn first_points_in_base_three() {
        let faure = Faure::new(3).unwrap();
        let ninths = |i| [0, 1, 2].map(|d| (faure.sample(i, d) * 9.0).round() as u32);
        let expected =
            [[0, 0, 0], [3, 3, 3], [6, 6, 6], [1, 4, 7], [4, 7, 1], [7, 1, 4], [2, 8, 5], [5, 2, 8], [8, 5, 2]];
        for (i, point) in expected.into_iter().enumerate() {
            assert_eq!(ninths(i as u64), point, "point {i}");
        }
    }

    #[test]
    fn blocks_are_nets_without_defect() {
        let faure = Faure::new(3).unwrap();
        for scramble in [DigitScramble::None, DigitScramble::Owen(2)] {
            let faure = faure.scrambled(scramble);
            for block in [0_u64, 5] {
                for [a, b] in [[4, 0], [1, 3], [2, 2], [0, 4]].map(|[a, b]: [u32; 2]| [3_u64.pow(a), 3_u64.pow(b)]) {
                    let mut hit = vec![false; 81];
                    for i in 81 * block..81 * (block + 1) {
                        let cell = |d, n: u64| (faure.sample(i, d) * n as f64 + 1e-9) as u64;
                        hit[(cell(1, a) + a * cell(2, b)) as usize] = true;
                    }
                    assert!(hit.into_iter().all(|h| h), "{a} x {b}");
                }
            }
        }
    }

    #[test]
    fn ends() {
        let faure = Faure::new(2).unwrap();
        assert!(faure.sample(u64::MAX, 1) < 1.0);
        assert!(Faure::new(0).is_err() && Faure::new(8162).is_err() && Faure::new(8161).is_ok());
    }
}
