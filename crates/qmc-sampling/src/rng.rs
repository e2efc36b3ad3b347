//! To and from the generators of the `rand` crates.
use crate::float::f32_from_bits;
use crate::hash::combine;
use crate::sampler::{Sampler, Split};
use rand_core::{Infallible, Rng, SeedableRng, TryRng};

/// A sampler as a random number generator, for code that asks for one.
///
/// Words are made of one-dimensional numbers: 24 bits of a number, filled up by 8 bits of the next, and so on; so the leading
/// bits of each word are stratified as the sampler is. Code that takes a varying number of words per sample loses the
/// stratification (rejection, for example), and a generator that is used for long is no more than hashed points: not for
/// anything secret.
///
/// ```
/// use qmc_sampling::{OwenSobol, SamplerFamily, SamplerRng};
/// use rand::RngExt;
/// let mut rng = SamplerRng(OwenSobol::new(1).sampler(2, 3));
/// assert!((0..6).contains(&rng.random_range(0..6)));
/// ```
#[derive(Clone, Debug)]
pub struct SamplerRng<S>(pub S);

impl<S: Sampler> TryRng for SamplerRng<S> {
    type Error = Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        let high = (self.0.next_1d() * 16_777_216.0) as u32;
        let low = (self.0.next_1d() * 256.0) as u32;
        Ok((high << 8) | low)
    }

    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        let high = u64::from(self.try_next_u32()?);
        Ok((high << 32) | u64::from(self.try_next_u32()?))
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        for chunk in bytes.chunks_mut(4) {
            let word = self.try_next_u32()?.to_le_bytes();
            chunk.copy_from_slice(&word[..chunk.len()]);
        }
        Ok(())
    }
}

/// A random number generator as a sampler.
///
/// Forks are generators seeded by a hash of the key and the domain.
///
/// ```
/// use qmc_sampling::{RngSampler, Sampler};
/// let mut sampler = RngSampler::<rand_pcg::Pcg64>::new(42);
/// assert!(sampler.next_1d() < 1.0 && sampler.fork(1).next_1d() < 1.0);
/// ```
#[derive(Clone, Debug)]
pub struct RngSampler<R> {
    rng: R,
    key: u64,
}

impl<R: Rng + SeedableRng + Clone> RngSampler<R> {
    /// The sampler of a key.
    #[must_use]
    pub fn new(key: u64) -> Self {
        Self { rng: R::seed_from_u64(key), key }
    }

    /// A sampler whose key is the next word of a generator.
    #[must_use]
    pub fn from_rng(rng: &mut impl Rng) -> Self {
        Self::new(rng.next_u64())
    }
}

impl<R: Rng + SeedableRng + Clone> Sampler for RngSampler<R> {
    fn next_1d(&mut self) -> f32 {
        f32_from_bits(self.rng.next_u32())
    }

    fn next_2d(&mut self) -> [f32; 2] {
        [self.next_1d(), self.next_1d()]
    }

    fn fork(&self, domain: u32) -> Self {
        Self::new(combine(self.key, u64::from(domain)))
    }
}

impl<R: Rng + SeedableRng + Clone> Split for RngSampler<R> {
    fn split(&self, domain: u32, children: u32, child: u32) -> Self {
        Self::new(combine(combine(combine(self.key, u64::from(domain)), u64::from(children)), u64::from(child)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Independent, OwenSobol, SamplerFamily};

    #[test]
    fn words_are_stratified_as_the_sampler_is() {
        let mut hit = [false; 16];
        for i in 0..16 {
            hit[(SamplerRng(OwenSobol::new(1).sampler(0, i)).next_u32() >> 28) as usize] = true;
        }
        assert!(hit.iter().all(|&h| h));
        let mut bytes = [0; 7];
        SamplerRng(Independent::new(1).sampler(0, 0)).fill_bytes(&mut bytes);
        assert_ne!(bytes, [0; 7]);
    }

    #[test]
    fn forks_do_not_depend_on_what_was_taken() {
        let mut sampler = RngSampler::<rand_pcg::Pcg32>::from_rng(&mut rand_pcg::Pcg32::new(1, 2));
        let expected = sampler.fork(3).next_2d();
        sampler.next_2d();
        assert_eq!(sampler.fork(3).next_2d(), expected);
        assert_ne!(sampler.fork(4).next_2d(), expected);
    }
}
