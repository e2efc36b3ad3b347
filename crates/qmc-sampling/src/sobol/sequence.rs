//! The Sobol sequence, plain and randomised.
use super::{DIMENSIONS, sobol_bits, sobol_bits_u32};
use crate::float::{f32_from_bits, f64_from_bits};
use crate::hash::combine;
use crate::scramble::{nested_uniform, owen_hash_u32, owen_hash_u64};
use crate::sequence::Sequence;

/// How the digits of a digital sequence are randomised.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Randomisation {
    /// Not at all.
    #[default]
    None,
    /// One random number per dimension is added digit by digit (exclusive or). Cheap; the error falls as for the plain
    /// sequence.
    DigitShift(u64),
    /// Owen scrambling by hashing (Laine and Karras 2011): the error falls faster on smooth integrands.
    Owen(u64),
    /// Owen scrambling digit by digit, exactly: slow, the oracle of [`Owen`](Self::Owen).
    NestedUniform(u64),
}

/// The Sobol sequence with the direction numbers of Joe and Kuo: 1024 dimensions, 2^52 points.
///
/// `x_d = scramble_d(C_d i)` over GF(2). The first two dimensions are a (0,2)-sequence; in any dimension each aligned block
/// of 2^m indices has one point in each interval of length 2^-m. Point 0 of the plain sequence is the origin. Indices of
/// 2^52 and more repeat the sequence.
///
/// Cost: plain and hashed, in single precision and the first 256 dimensions: eight table lookups; else a loop over the bits
/// of the index.
///
/// ```
/// use qmc_sampling::{Sequence, sobol::{Randomisation, Sobol}};
/// let plain = Sobol::new(Randomisation::None);
/// assert_eq!([plain.sample(3, 0), plain.sample(3, 1)], [0.75, 0.25]);
/// let scrambled = Sobol::new(Randomisation::Owen(1));
/// assert!(scrambled.sample(1 << 51, 1023) < 1.0);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sobol {
    randomisation: Randomisation,
}

impl Sobol {
    /// The sequence with this randomisation.
    #[must_use]
    pub const fn new(randomisation: Randomisation) -> Self {
        Self { randomisation }
    }

    /// The randomised coordinate as a binary fraction, first digit in the highest bit.
    ///
    /// # Panics
    /// If `dimension` is 1024 or more.
    #[inline]
    #[must_use]
    pub fn bits(&self, index: u64, dimension: u32) -> u64 {
        self.randomisation.apply(sobol_bits(index, dimension), dimension)
    }

    /// The 32 leading bits of [`bits`](Self::bits), faster.
    #[inline]
    fn bits_u32(&self, index: u64, dimension: u32) -> u32 {
        match self.randomisation {
            Randomisation::None => sobol_bits_u32(index, dimension),
            Randomisation::DigitShift(seed) => sobol_bits_u32(index, dimension) ^ (key(seed, dimension) >> 32) as u32,
            Randomisation::Owen(seed) => {
                owen_hash_u32(sobol_bits_u32(index, dimension), (key(seed, dimension) >> 32) as u32)
            }
            Randomisation::NestedUniform(_) => (self.bits(index, dimension) >> 32) as u32,
        }
    }
}

impl Randomisation {
    /// Randomises the digits of a coordinate; each dimension has its own random numbers.
    #[inline]
    #[must_use]
    pub fn apply(self, bits: u64, dimension: u32) -> u64 {
        match self {
            Self::None => bits,
            Self::DigitShift(seed) => bits ^ key(seed, dimension),
            Self::Owen(seed) => owen_hash_u64(bits, key(seed, dimension)),
            Self::NestedUniform(seed) => nested_uniform(bits, key(seed, dimension), 64),
        }
    }
}

/// The random number of a dimension.
#[inline]
const fn key(seed: u64, dimension: u32) -> u64 {
    combine(seed, dimension as u64)
}

impl Sequence for Sobol {
    #[inline]
    fn dimensions(&self) -> u32 {
        DIMENSIONS
    }

    #[inline]
    fn sample(&self, index: u64, dimension: u32) -> f64 {
        f64_from_bits(self.bits(index, dimension))
    }

    #[inline]
    fn sample_f32(&self, index: u64, dimension: u32) -> f32 {
        f32_from_bits(self.bits_u32(index, dimension))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::truncate_to_f32;

    #[test]
    fn single_precision_is_double_truncated() {
        for randomisation in
            [Randomisation::None, Randomisation::DigitShift(3), Randomisation::Owen(3), Randomisation::NestedUniform(3)]
        {
            let sobol = Sobol::new(randomisation);
            for i in 0..100 {
                let index = i * i * i * 7_777_777;
                for dimension in [0, 1, 2, 100, 1000] {
                    assert_eq!(sobol.sample_f32(index, dimension), truncate_to_f32(sobol.sample(index, dimension)));
                }
            }
        }
    }

    #[test]
    fn two_to_the_52_points_and_no_more() {
        let sobol = Sobol::default();
        assert_eq!(sobol.sample(1 << 51, 0), 0.5_f64.powi(52));
        assert_eq!(sobol.sample((1 << 52) + 3, 0), sobol.sample(3, 0));
    }
}
