//! The samplers of OpenQMC.
use super::{Sampler, SamplerFamily, Split};
use openqmc::SamplerImpl;

/// The samplers of OpenQMC, in its Rust port `openqmc-rs`: Sobol, lattice and progressive multi-jittered points, each with a
/// blue-noise variant for images.
///
/// The stream is the pixel, `y * width + x`; the index is at most 2^16, beyond which OpenQMC repeats values. The seed takes the
/// place of its frame number. Each group of four dimensions is a domain.
///
/// ```
/// use qmc_sampling::{Sampler, SamplerFamily, sampler::OpenQmc};
/// let family = OpenQmc::<openqmc::sobolbn::SobolBnImpl>::new(640, 7);
/// assert!(family.sampler(640 * 3 + 5, 0).next_2d()[0] < 1.0);
/// ```
#[derive(Debug)]
pub struct OpenQmc<I> {
    width: u32,
    frame: i32,
    kind: core::marker::PhantomData<fn() -> I>,
}

impl<I> OpenQmc<I> {
    /// The samplers for an image of this width. A width of zero is taken as one; of the seed, 31 bits count.
    #[must_use]
    pub fn new(width: u32, seed: u64) -> Self {
        Self { width: width.max(1), frame: (seed & 0x7fff_ffff) as i32, kind: core::marker::PhantomData }
    }
}

impl<I: SamplerImpl> SamplerFamily for OpenQmc<I> {
    type Sampler = OpenQmcSampler<I>;

    #[inline]
    fn sampler(&self, stream: u64, index: u64) -> OpenQmcSampler<I> {
        let [x, y] = [stream % u64::from(self.width), stream / u64::from(self.width)].map(|c| (c & 0x7fff_ffff) as i32);
        let root = openqmc::Sampler::<I>::new(x, y, self.frame, (index & 0x7fff_ffff) as i32);
        OpenQmcSampler { root, dimension: 0, group: [0.0; 4] }
    }
}

/// The sampler of [`OpenQmc`].
#[derive(Clone, Copy, Debug)]
pub struct OpenQmcSampler<I: SamplerImpl> {
    root: openqmc::Sampler<I>,
    dimension: u32,
    group: [f32; 4],
}

impl<I: SamplerImpl> OpenQmcSampler<I> {
    #[inline]
    fn refill(&mut self) {
        // Domains of forks are even, those of groups odd.
        self.group = self.root.new_domain((self.dimension / 2 + 1) as i32).draw_sample_f32::<4>();
    }
}

impl<I: SamplerImpl> Sampler for OpenQmcSampler<I> {
    #[inline]
    fn next_1d(&mut self) -> f32 {
        if self.dimension.is_multiple_of(4) {
            self.refill();
        }
        let x = self.group[(self.dimension % 4) as usize];
        self.dimension = self.dimension.wrapping_add(1);
        x
    }

    #[inline]
    fn next_2d(&mut self) -> [f32; 2] {
        self.dimension = self.dimension.wrapping_add(self.dimension % 2);
        if self.dimension.is_multiple_of(4) {
            self.refill();
        }
        let first = (self.dimension % 4) as usize;
        self.dimension = self.dimension.wrapping_add(2);
        [self.group[first], self.group[first + 1]]
    }

    #[inline]
    fn fork(&self, domain: u32) -> Self {
        Self { root: self.root.new_domain(domain.wrapping_mul(2) as i32), dimension: 0, group: [0.0; 4] }
    }
}

impl<I: SamplerImpl> Split for OpenQmcSampler<I> {
    #[inline]
    fn split(&self, domain: u32, children: u32, child: u32) -> Self {
        let root = self.root.new_domain_split(domain.wrapping_mul(2) as i32, children.max(1) as i32, child as i32);
        Self { root, dimension: 0, group: [0.0; 4] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_openqmc_and_small() {
        let mut sampler = OpenQmc::<openqmc::sobol::SobolImpl>::new(10, 3).sampler(42, 5);
        let theirs = openqmc::SobolSampler::new(2, 4, 3, 5).new_domain(1).draw_sample_f32::<4>();
        assert_eq!([0; 4].map(|_| sampler.next_1d()), theirs);
        assert_ne!(sampler.fork(0).next_2d(), sampler.fork(1).next_2d());
        assert!(size_of::<OpenQmcSampler<openqmc::sobol::SobolImpl>>() <= 32);
    }
}
