//! Rank-1 lattices, padded.
use super::groups::{DrawGroup, Groups};
use super::{Sampler, SamplerFamily, Split, shuffle};
use crate::float::f32_from_bits;
use crate::hash::{combine, mix64};
use crate::sequences::KUO_VECTOR;

/// An extensible rank-1 lattice per stream, shifted at random.
///
/// Dimension `d` of path `i` is `{phi_2(i) z_d + shift}`; after 128 dimensions it starts again with a shuffled index.
/// Fast, and good on smooth integrands; the generating vector is made for up to 2^20 paths.
///
/// ```
/// use qmc_sampling::{Sampler, SamplerFamily, sampler::PaddedLattice};
/// assert!(PaddedLattice::new(3).sampler(0, 0).next_1d() < 1.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PaddedLattice {
    seed: u64,
}

impl PaddedLattice {
    /// The family of a seed: one randomisation.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self { seed }
    }
}

impl SamplerFamily for PaddedLattice {
    type Sampler = PaddedLatticeSampler;

    #[inline]
    fn sampler(&self, stream: u64, index: u64) -> PaddedLatticeSampler {
        PaddedLatticeSampler::new(combine(combine(0, self.seed), stream), index)
    }
}

/// The sampler of [`PaddedLattice`], 24 bytes.
#[derive(Clone, Debug, PartialEq)]
pub struct PaddedLatticeSampler(Groups<Point, [f32; 1]>);

/// One point of one pattern.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Point {
    pattern: u64,
    index: u64,
}

impl Point {
    #[inline]
    fn fork(&self, domain: u32) -> Self {
        let pattern = combine(!self.pattern, u64::from(domain));
        Self { pattern, index: shuffle(self.index, mix64(!pattern)) }
    }

    #[inline]
    fn coordinate(&self, dimension: usize) -> f32 {
        let shift = combine(self.pattern, dimension as u64);
        let z = u64::from(KUO_VECTOR[dimension]);
        f32_from_bits((self.index.reverse_bits().wrapping_mul(z).wrapping_add(shift) >> 32) as u32)
    }
}

impl DrawGroup<[f32; 1]> for Point {
    #[inline]
    fn draw(&self, dimension: u32, numbers: &mut [f32; 1]) {
        let length = KUO_VECTOR.len() as u32;
        *numbers = [if dimension < length {
            self.coordinate(dimension as usize)
        } else {
            // The vector again, as often as needed: in forks of domains counted down from the last one.
            self.fork(!(dimension / length - 1)).coordinate((dimension % length) as usize)
        }];
    }
}

impl PaddedLatticeSampler {
    #[inline]
    const fn new(pattern: u64, index: u64) -> Self {
        Self(Groups::new(Point { pattern, index }))
    }
}

impl Sampler for PaddedLatticeSampler {
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

impl Split for PaddedLatticeSampler {
    #[inline]
    fn split(&self, domain: u32, children: u32, child: u32) -> Self {
        let Point { pattern, index } = self.0.stream;
        let index = index.wrapping_mul(u64::from(children)).wrapping_add(u64::from(child));
        let pattern = combine(pattern, u64::from(children));
        Self(Groups::new(Point { pattern, index }.fork(domain)))
    }
}
