//! The samplers of OpenQMC.
use super::groups::{DrawGroup, Groups};
use super::{Sampler, SamplerFamily, Split};
use crate::hash::combine;
use openqmc::SamplerImpl;

/// The samplers of OpenQMC, in its Rust port `openqmc-rs`: Sobol, lattice and progressive multi-jittered points, each with a
/// blue-noise variant for images.
///
/// The stream is the pixel, `y * width + x`; pixels 256 columns or rows apart share their points. Paths are stratified in
/// blocks of 2^16, independent of each other. A hash of the seed takes the place of the frame number, cut to
/// 30 bits; streams from 2^32 on, which no image has, are told apart in the same way. Each group of four
/// dimensions is a domain.
///
/// ```
/// use qmc_sampling::{Sampler, SamplerFamily, sampler::OpenQmc};
/// let family = OpenQmc::<openqmc::sobolbn::SobolBnImpl>::new(640, 7);
/// assert!(family.sampler(640 * 3 + 5, 0).next_2d()[0] < 1.0);
/// ```
#[derive(Debug)]
pub struct OpenQmc<I> {
    width: u32,
    seed: u64,
    kind: core::marker::PhantomData<fn() -> I>,
}

impl<I> OpenQmc<I> {
    /// The samplers for an image of this width. A width of zero is taken as one.
    #[must_use]
    pub fn new(width: u32, seed: u64) -> Self {
        Self { width: width.max(1), seed, kind: core::marker::PhantomData }
    }
}

impl<I: SamplerImpl> SamplerFamily for OpenQmc<I> {
    type Sampler = OpenQmcSampler<I>;

    #[inline]
    fn sampler(&self, stream: u64, index: u64) -> OpenQmcSampler<I> {
        let [x, y] = [stream % u64::from(self.width), stream / u64::from(self.width)].map(|c| (c & 0x7fff_ffff) as i32);
        // OpenQMC adds the number of the block of 2^16 paths to the frame: leave room, and tell blocks apart ourselves.
        let key = combine(combine(combine(0, self.seed), stream >> 32), index >> 16);
        let root = openqmc::Sampler::<I>::new(x, y, (key >> 34) as i32, (index & 0xffff) as i32);
        OpenQmcSampler(Groups::new(Root(root)))
    }
}

/// The sampler of [`OpenQmc`]: 32 bytes at most, 64 with blue noise, of which it refers to the tables.
#[derive(Clone, Debug)]
pub struct OpenQmcSampler<I: SamplerImpl>(Groups<Root<I>, [f32; 4]>);

/// What the domains of groups and forks are derived from.
#[derive(Clone, Copy, Debug)]
struct Root<I: SamplerImpl>(openqmc::Sampler<I>);

impl<I: SamplerImpl> DrawGroup<[f32; 4]> for Root<I> {
    #[inline]
    fn draw(&self, group: u32, numbers: &mut [f32; 4]) {
        // Domains of forks are even, those of groups odd.
        *numbers = self.0.new_domain((2 * group + 1) as i32).draw_sample_f32::<4>();
    }
}

impl<I: SamplerImpl> Sampler for OpenQmcSampler<I> {
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
        Self(Groups::new(Root(self.0.stream.0.new_domain(domain.wrapping_mul(2) as i32))))
    }
}

impl<I: SamplerImpl> Split for OpenQmcSampler<I> {
    #[inline]
    fn split(&self, domain: u32, children: u32, child: u32) -> Self {
        let (key, size) = (domain.wrapping_mul(2) as i32, children.max(1) as i32);
        Self(Groups::new(Root(self.0.stream.0.new_domain_split(key, size, child as i32))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Longer than OpenQMC's own indices, and for light paths.
    #[test]
    fn blocks_of_paths_streams_and_seeds_differ() {
        let first = |seed, stream, index| {
            OpenQmc::<openqmc::sobol::SobolImpl>::new(10, seed).sampler(stream, index).next_2d().map(f32::to_bits)
        };
        let places = [(0, 0), (0, 1 << 16), (0, 1 << 31), (0, 1 << 40), (1 << 40, 0), (1 << 41, 0)];
        let mut all: std::vec::Vec<_> =
            [3, 4].iter().flat_map(|&seed| places.map(|(stream, index)| first(seed, stream, index))).collect();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 2 * places.len());
    }

    #[test]
    fn is_openqmc_and_small() {
        let mut sampler = OpenQmc::<openqmc::sobol::SobolImpl>::new(10, 3).sampler(42, 5);
        let frame = (combine(combine(combine(0, 3), 0), 0) >> 34) as i32;
        let theirs = openqmc::SobolSampler::new(2, 4, frame, 5).new_domain(1).draw_sample_f32::<4>();
        assert_eq!([0; 4].map(|_| sampler.next_1d()), theirs);
        assert_ne!(sampler.fork(0).next_2d(), sampler.fork(1).next_2d());
        assert!(size_of::<OpenQmcSampler<openqmc::sobol::SobolImpl>>() <= 32);
        assert!(size_of::<OpenQmcSampler<openqmc::sobolbn::SobolBnImpl>>() <= 64);
    }
}
