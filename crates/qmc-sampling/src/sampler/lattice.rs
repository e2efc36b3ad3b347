//! Rank-1 lattices, padded.
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
        PaddedLatticeSampler { pattern: combine(combine(0, self.seed), stream), index, dimension: 0 }
    }
}

/// The sampler of [`PaddedLattice`], 24 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PaddedLatticeSampler {
    pattern: u64,
    index: u64,
    dimension: u32,
}

impl Sampler for PaddedLatticeSampler {
    #[inline]
    fn next_1d(&mut self) -> f32 {
        if self.dimension as usize == KUO_VECTOR.len() {
            *self = self.fork(u32::MAX);
        }
        let shift = combine(self.pattern, u64::from(self.dimension));
        let z = u64::from(KUO_VECTOR[self.dimension as usize]);
        self.dimension += 1;
        f32_from_bits((self.index.reverse_bits().wrapping_mul(z).wrapping_add(shift) >> 32) as u32)
    }

    #[inline]
    fn next_2d(&mut self) -> [f32; 2] {
        [self.next_1d(), self.next_1d()]
    }

    #[inline]
    fn fork(&self, domain: u32) -> Self {
        let pattern = combine(!self.pattern, u64::from(domain));
        Self { pattern, index: shuffle(self.index, mix64(!pattern)), dimension: 0 }
    }
}

impl Split for PaddedLatticeSampler {
    #[inline]
    fn split(&self, domain: u32, children: u32, child: u32) -> Self {
        let index = self.index.wrapping_mul(u64::from(children)).wrapping_add(u64::from(child));
        Self { index, ..*self }.fork(domain)
    }
}
