//! Independent uniform numbers.
use super::{Sampler, SamplerFamily, Split};
use crate::float::f32_from_bits;
use crate::hash::combine;

/// Independent uniform numbers: the baseline of all other samplers.
///
/// The generator is PCG32 (XSH-RR) of O'Neill, "PCG: A family of simple fast space-efficient statistically good algorithms
/// for random number generation" (2014). Each path has its own state and its own increment, hashed from the seed, the stream
/// and the index, so that making a sampler costs a few multiplications.
///
/// Cost: as bare `rand_pcg`. Error of a mean: the standard deviation over the root of the number of samples.
///
/// ```
/// use qmc_sampling::{Independent, Sampler, SamplerFamily};
/// let family = Independent::new(7);
/// let mut path = family.sampler(3, 0);
/// let x = path.next_1d();
/// assert!((0.0..1.0).contains(&x));
/// assert_eq!(x, family.sampler(3, 0).next_1d());
/// assert_ne!(x, family.sampler(3, 1).next_1d());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Independent {
    seed: u64,
}

impl Independent {
    /// The family of a seed. Any seed is as good as any other.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self { seed }
    }
}

impl SamplerFamily for Independent {
    type Sampler = IndependentSampler;

    #[inline]
    fn sampler(&self, stream: u64, index: u64) -> IndependentSampler {
        IndependentSampler::from_key(combine(combine(combine(0, self.seed), stream), index))
    }
}

/// The sampler of [`Independent`], 16 bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IndependentSampler {
    state: u64,
    /// Odd; also what the sampler is, whatever was taken from it.
    increment: u64,
}

impl IndependentSampler {
    const MULTIPLIER: u64 = 6_364_136_223_846_793_005;

    /// The generator of a well mixed key.
    #[inline]
    fn from_key(key: u64) -> Self {
        let mut sampler = Self { state: key, increment: key.wrapping_mul(0xd134_2543_de82_ef95) | 1 };
        sampler.state = combine(sampler.state, sampler.increment);
        sampler
    }

    /// 32 uniform bits.
    #[inline]
    pub fn next_u32(&mut self) -> u32 {
        let old = self.state;
        self.state = old.wrapping_mul(Self::MULTIPLIER).wrapping_add(self.increment);
        let folded = (((old >> 18) ^ old) >> 27) as u32;
        folded.rotate_right((old >> 59) as u32)
    }
}

impl Sampler for IndependentSampler {
    #[inline]
    fn next_1d(&mut self) -> f32 {
        f32_from_bits(self.next_u32())
    }

    #[inline]
    fn next_2d(&mut self) -> [f32; 2] {
        [self.next_1d(), self.next_1d()]
    }

    #[inline]
    fn fork(&self, domain: u32) -> Self {
        Self::from_key(combine(self.increment, u64::from(domain)))
    }
}

impl Split for IndependentSampler {
    #[inline]
    fn split(&self, domain: u32, children: u32, child: u32) -> Self {
        let key = combine(combine(self.increment, u64::from(domain)), u64::from(children));
        Self::from_key(combine(key, u64::from(child)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;

    #[test]
    fn is_pcg32() {
        let mut theirs = rand_pcg::Pcg32::new(42, 54);
        let increment = (54 << 1) | 1;
        // Their constructor advances once after adding the increment.
        let state = 42_u64.wrapping_add(increment).wrapping_mul(IndependentSampler::MULTIPLIER).wrapping_add(increment);
        let mut ours = IndependentSampler { state, increment };
        // The first value of the demonstration program of the reference implementation.
        assert_eq!(ours.clone().next_u32(), 0xa15c_02b7);
        for _ in 0..1000 {
            assert_eq!(ours.next_u32(), theirs.next_u32());
        }
    }

    #[test]
    fn forks_ignore_what_was_taken() {
        let mut sampler = Independent::new(1).sampler(2, 3);
        let fork = sampler.fork(9);
        sampler.next_2d();
        assert_eq!(fork, sampler.fork(9));
        assert_ne!(fork, sampler.fork(8));
        assert_eq!(size_of::<IndependentSampler>(), 16);
    }
}
