//! Any sequence as a sampler.
use super::{Sampler, SamplerFamily, shuffle};
use crate::Sequence;
use crate::float::f64_from_bits;
use crate::hash::{combine, mix64};
use crate::sequence::truncate_to_f32;

/// Any [`Sequence`] as a family of samplers: each stream gets the sequence shifted by a random vector of its own
/// (Cranley-Patterson rotation).
///
/// Forks, and dimensions beyond those of the sequence, restart at dimension 0 with other shifts and the index shuffled
/// within aligned blocks of powers of two.
///
/// ```
/// use qmc_sampling::{Sampler, SamplerFamily, sampler::FromSequence, sequences::Halton};
/// let family = FromSequence::new(Halton::default(), 7);
/// assert!(family.sampler(0, 0).next_1d() < 1.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FromSequence<S> {
    sequence: S,
    seed: u64,
}

impl<S: Sequence> FromSequence<S> {
    /// The family of a sequence and a seed.
    #[must_use]
    pub const fn new(sequence: S, seed: u64) -> Self {
        Self { sequence, seed }
    }
}

impl<S: Sequence + Sync> SamplerFamily for FromSequence<S> {
    type Sampler = SequenceSampler<S>;

    #[inline]
    fn sampler(&self, stream: u64, index: u64) -> SequenceSampler<S> {
        let pattern = combine(combine(0, self.seed), stream);
        SequenceSampler { sequence: self.sequence, pattern, index, dimension: 0 }
    }
}

/// The sampler of [`FromSequence`]: the sequence and 24 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SequenceSampler<S> {
    sequence: S,
    pattern: u64,
    index: u64,
    dimension: u32,
}

impl<S: Sequence> Sampler for SequenceSampler<S> {
    #[inline]
    fn next_1d(&mut self) -> f32 {
        if self.dimension >= self.sequence.dimensions() {
            *self = self.fork(u32::MAX);
        }
        let shift = f64_from_bits(combine(self.pattern, u64::from(self.dimension)));
        let x = self.sequence.sample(self.index, self.dimension) + shift;
        self.dimension += 1;
        truncate_to_f32(if x >= 1.0 { x - 1.0 } else { x })
    }

    #[inline]
    fn next_2d(&mut self) -> [f32; 2] {
        [self.next_1d(), self.next_1d()]
    }

    #[inline]
    fn fork(&self, domain: u32) -> Self {
        let pattern = combine(!self.pattern, u64::from(domain));
        Self { pattern, index: shuffle(self.index, mix64(!pattern)), dimension: 0, ..*self }
    }
}
