//! Cranley-Patterson rotation.
use crate::Real;
use crate::float::f64_from_bits;
use crate::hash::combine;
use crate::sequence::Sequence;

/// Any sequence, shifted by a random vector modulo one.
///
/// `x' = {x + shift_d}`: unbiased over the seed whatever the sequence. It keeps lattices, but breaks the elementary intervals
/// of nets (each may have a point too many or too few), so scramble those instead.
/// Source: Cranley and Patterson, "Randomization of number theoretic methods for multiple integration" (1976).
///
/// ```
/// use qmc_sampling::{Sequence, sequences::{CranleyPatterson, Halton}};
/// let shifted = CranleyPatterson::new(Halton::default(), 5);
/// let difference = |i| (shifted.sample(i, 1) - Halton::default().sample(i, 1)).rem_euclid(1.0);
/// assert!((difference(3) - difference(8)).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CranleyPatterson<S> {
    sequence: S,
    seed: u64,
}

impl<S: Sequence> CranleyPatterson<S> {
    /// `sequence` shifted by the vector of `seed`.
    #[must_use]
    pub const fn new(sequence: S, seed: u64) -> Self {
        Self { sequence, seed }
    }
}

impl<S: Sequence> Sequence for CranleyPatterson<S> {
    fn dimensions(&self) -> u32 {
        self.sequence.dimensions()
    }

    #[inline]
    fn sample(&self, index: u64, dimension: u32) -> f64 {
        let x = self.sequence.sample(index, dimension) + f64_from_bits(combine(self.seed, u64::from(dimension)));
        (if x >= 1.0 { x - 1.0 } else { x }).clamp_unit()
    }
}
