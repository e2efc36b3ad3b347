//! Independent random points by random access.
use crate::float::f64_from_bits;
use crate::hash::combine;
use crate::sequence::Sequence;

/// Independent uniform points: a hash of seed, index and dimension.
///
/// The baseline: variance falls as `n^-1`. For numbers in a row [`Independent`](crate::Independent) is faster.
///
/// ```
/// use qmc_sampling::{Sequence, sequences::Random};
/// assert_ne!(Random::new(1).sample(0, 0), Random::new(1).sample(0, 1));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Random {
    seed: u64,
}

impl Random {
    /// The points of a seed.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self { seed }
    }
}

impl Sequence for Random {
    fn dimensions(&self) -> u32 {
        u32::MAX
    }

    #[inline]
    fn sample(&self, index: u64, dimension: u32) -> f64 {
        f64_from_bits(combine(combine(combine(0, self.seed), index), u64::from(dimension)))
    }
}
