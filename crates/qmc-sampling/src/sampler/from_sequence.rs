//! Any sequence as a sampler.
use super::groups::{DrawGroup, Groups};
use super::{Sampler, SamplerFamily, Split, shuffle};
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
        SequenceSampler(Groups::new(Point { sequence: self.sequence, pattern, index }))
    }
}

/// The sampler of [`FromSequence`]: the sequence and 24 bytes.
#[derive(Clone, Debug, PartialEq)]
pub struct SequenceSampler<S>(Groups<Point<S>, [f32; 1]>);

/// One point of one shifted sequence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Point<S> {
    sequence: S,
    pattern: u64,
    index: u64,
}

impl<S: Sequence> Point<S> {
    #[inline]
    fn fork(&self, domain: u32) -> Self {
        let pattern = combine(!self.pattern, u64::from(domain));
        Self { pattern, index: shuffle(self.index, mix64(!pattern)), ..*self }
    }

    #[inline]
    fn coordinate(&self, dimension: u32) -> f32 {
        let shift = f64_from_bits(combine(self.pattern, u64::from(dimension)));
        let x = self.sequence.sample(self.index, dimension) + shift;
        truncate_to_f32(if x >= 1.0 { x - 1.0 } else { x })
    }
}

impl<S: Sequence> DrawGroup<[f32; 1]> for Point<S> {
    #[inline]
    fn draw(&self, dimension: u32, numbers: &mut [f32; 1]) {
        let dimensions = self.sequence.dimensions();
        *numbers = [if dimension < dimensions {
            self.coordinate(dimension)
        } else {
            // The sequence again, as often as needed: in forks of domains counted down from the last one.
            self.fork(!(dimension / dimensions - 1)).coordinate(dimension % dimensions)
        }];
    }
}

impl<S: Sequence> Sampler for SequenceSampler<S> {
    #[inline]
    fn next_1d(&mut self) -> f32 {
        self.0.next_1d()
    }

    #[inline]
    fn next_2d(&mut self) -> [f32; 2] {
        self.0.next_2d()
    }

    #[inline]
    fn fork(&self, domain: u32) -> Self {
        Self(Groups::new(self.0.stream.fork(domain)))
    }
}

impl<S: Sequence> Split for SequenceSampler<S> {
    #[inline]
    fn split(&self, domain: u32, children: u32, child: u32) -> Self {
        let point = &self.0.stream;
        let index = point.index.wrapping_mul(u64::from(children)).wrapping_add(u64::from(child));
        let pattern = combine(point.pattern, u64::from(children));
        Self(Groups::new(Point { pattern, index, ..*point }.fork(domain)))
    }
}
