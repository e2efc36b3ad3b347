//! Samplers of `qmc-sampling` that are chosen on the command line.

use clap::ValueEnum;
use qmc_sampling::sampler::{
    GlobalHalton, GlobalHaltonSampler, GlobalSobol, GlobalSobolSampler, PaddedLattice, PaddedLatticeSampler, ZSobol,
    ZSobolSampler,
};
#[cfg(feature = "openqmc")]
use qmc_sampling::sampler::{
    OpenQmc, OpenQmcSampler,
    openqmc::{
        lattice::LatticeImpl, latticebn::LatticeBnImpl, pmj::PmjImpl, pmjbn::PmjBnImpl, sobol::SobolImpl,
        sobolbn::SobolBnImpl,
    },
};
use qmc_sampling::sequences::SequenceError;
use qmc_sampling::{Independent, IndependentSampler, OwenSobol, OwenSobolSampler, Sampler, SamplerFamily};

use crate::values::name_of;

/// A sampler of `qmc-sampling` by name.
///
/// The first two numbers of a path are its place in its pixel, which the reconstruction filter turns into an offset from
/// the pixel's centre. That holds for sequences through the whole image too: there the leading digits of the first two
/// dimensions choose the pixel, and the digits below are the place in it, uniform in the unit square. With the box filter
/// a sample thus lies exactly where the sequence puts it; wider filters stretch the pixel, and leave its mean as it is.
///
/// Light paths belong to no pixel. They are one stream, whose samplers continue with their number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, ValueEnum)]
#[non_exhaustive]
pub enum SamplerName {
    /// Independent random numbers (PCG).
    Independent,
    /// Owen-scrambled Sobol points per pixel, padded four dimensions at a time.
    #[default]
    Sobol,
    /// One Owen-scrambled Sobol sequence through the whole image.
    GlobalSobol,
    /// One Owen-scrambled Halton sequence through the whole image.
    GlobalHalton,
    /// Blue-noise error: Owen-scrambled Sobol points along the Z-order curve of the image.
    ZSobol,
    /// Rank-1 lattices per pixel, shifted at random.
    Lattice,
    /// OpenQMC's progressive multi-jittered points.
    #[cfg(feature = "openqmc")]
    OpenqmcPmj,
    /// The same with blue-noise error.
    #[cfg(feature = "openqmc")]
    OpenqmcPmjBn,
    /// OpenQMC's Owen-scrambled Sobol points.
    #[cfg(feature = "openqmc")]
    OpenqmcSobol,
    /// The same with blue-noise error.
    #[cfg(feature = "openqmc")]
    OpenqmcSobolBn,
    /// OpenQMC's lattice.
    #[cfg(feature = "openqmc")]
    OpenqmcLattice,
    /// The same with blue-noise error.
    #[cfg(feature = "openqmc")]
    OpenqmcLatticeBn,
}

impl SamplerName {
    /// All of them.
    pub fn all() -> &'static [Self] {
        Self::value_variants()
    }

    /// Its name on the command line.
    pub fn name(self) -> String {
        name_of(self)
    }
}

macro_rules! any_sampler {
    ($($(#[$feature:meta])? $variant:ident($family:ty, $sampler:ty),)*) => {
        /// A family of samplers that is known at run time only: one branch for each number that is taken.
        #[derive(Debug)]
        pub enum AnyFamily {
            $(
                #[doc = concat!("See [`SamplerName::", stringify!($variant), "`].")]
                $(#[$feature])?
                $variant($family),
            )*
        }

        /// A sampler of [`AnyFamily`].
        #[derive(Clone, Debug)]
        pub enum AnySampler {
            $(
                #[doc = concat!("See [`SamplerName::", stringify!($variant), "`].")]
                $(#[$feature])?
                $variant($sampler),
            )*
        }

        impl SamplerFamily for AnyFamily {
            type Sampler = AnySampler;

            fn sampler(&self, stream: u64, index: u64) -> AnySampler {
                match self {
                    $($(#[$feature])? Self::$variant(family) => AnySampler::$variant(family.sampler(stream, index)),)*
                }
            }
        }

        // Not inlined: each would be all samplers over again.
        impl Sampler for AnySampler {
            #[inline(never)]
            fn next_1d(&mut self) -> f32 {
                match self {
                    $($(#[$feature])? Self::$variant(sampler) => sampler.next_1d(),)*
                }
            }

            #[inline(never)]
            fn next_2d(&mut self) -> [f32; 2] {
                match self {
                    $($(#[$feature])? Self::$variant(sampler) => sampler.next_2d(),)*
                }
            }

            fn fork(&self, domain: u32) -> Self {
                match self {
                    $($(#[$feature])? Self::$variant(sampler) => Self::$variant(sampler.fork(domain)),)*
                }
            }
        }
    };
}

any_sampler! {
    Independent(Independent, IndependentSampler),
    Sobol(OwenSobol, OwenSobolSampler),
    GlobalSobol(Box<GlobalSobol>, GlobalSobolSampler),
    GlobalHalton(Box<GlobalHalton>, GlobalHaltonSampler),
    ZSobol(ZSobol, ZSobolSampler),
    Lattice(PaddedLattice, PaddedLatticeSampler),
    #[cfg(feature = "openqmc")] OpenqmcPmj(OpenQmc<PmjImpl>, OpenQmcSampler<PmjImpl>),
    #[cfg(feature = "openqmc")] OpenqmcPmjBn(OpenQmc<PmjBnImpl>, OpenQmcSampler<PmjBnImpl>),
    #[cfg(feature = "openqmc")] OpenqmcSobol(OpenQmc<SobolImpl>, OpenQmcSampler<SobolImpl>),
    #[cfg(feature = "openqmc")] OpenqmcSobolBn(OpenQmc<SobolBnImpl>, OpenQmcSampler<SobolBnImpl>),
    #[cfg(feature = "openqmc")] OpenqmcLattice(OpenQmc<LatticeImpl>, OpenQmcSampler<LatticeImpl>),
    #[cfg(feature = "openqmc")] OpenqmcLatticeBn(OpenQmc<LatticeBnImpl>, OpenQmcSampler<LatticeBnImpl>),
}

impl AnyFamily {
    /// The family for an image of `width` times `height` pixels, with about so many `paths` through each pixel; one of
    /// 2^64 randomisations (2^30 of OpenQMC's).
    ///
    /// # Errors
    /// If the image is too large for a sequence through all of it.
    pub fn new(name: SamplerName, [width, height]: [u32; 2], paths: u32, seed: u64) -> Result<Self, SequenceError> {
        Ok(match name {
            SamplerName::Independent => Self::Independent(Independent::new(seed)),
            SamplerName::Sobol => Self::Sobol(OwenSobol::new(seed)),
            SamplerName::GlobalSobol => Self::GlobalSobol(Box::new(GlobalSobol::new(width, height, seed)?)),
            SamplerName::GlobalHalton => Self::GlobalHalton(Box::new(GlobalHalton::new(width, height, seed)?)),
            SamplerName::ZSobol => Self::ZSobol(ZSobol::new(width, height, paths, seed)?),
            SamplerName::Lattice => Self::Lattice(PaddedLattice::new(seed)),
            #[cfg(feature = "openqmc")]
            SamplerName::OpenqmcPmj => Self::OpenqmcPmj(OpenQmc::new(width, seed)),
            #[cfg(feature = "openqmc")]
            SamplerName::OpenqmcPmjBn => Self::OpenqmcPmjBn(OpenQmc::new(width, seed)),
            #[cfg(feature = "openqmc")]
            SamplerName::OpenqmcSobol => Self::OpenqmcSobol(OpenQmc::new(width, seed)),
            #[cfg(feature = "openqmc")]
            SamplerName::OpenqmcSobolBn => Self::OpenqmcSobolBn(OpenQmc::new(width, seed)),
            #[cfg(feature = "openqmc")]
            SamplerName::OpenqmcLattice => Self::OpenqmcLattice(OpenQmc::new(width, seed)),
            #[cfg(feature = "openqmc")]
            SamplerName::OpenqmcLatticeBn => Self::OpenqmcLatticeBn(OpenQmc::new(width, seed)),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The stream of a pixel, and one of light paths.
    const STREAMS: [u64; 2] = [7 * 20 + 11, 1 << 40];

    #[test]
    fn every_name_is_its_sampler_and_places_paths_in_the_pixel() {
        let mut seen = Vec::new();
        for &name in SamplerName::all() {
            let family = AnyFamily::new(name, [20, 10], 64, 3).unwrap();
            for stream in STREAMS {
                // A pixel's own points, stratified: the means over 64 of them are near one half.
                let mut sum = [0.0; 2];
                for index in 0..64 {
                    let place = family.sampler(stream, index).next_2d();
                    assert!(place.iter().all(|u| (0.0..1.0).contains(u)), "{name:?}: {place:?}");
                    (0..2).for_each(|k| sum[k] += f64::from(place[k]) / 64.0);
                }
                let bound = if name == SamplerName::Independent { 0.2 } else { 0.02 };
                assert!(sum.iter().all(|mean| (mean - 0.5).abs() < bound), "{name:?}, stream {stream}: {sum:?}");
            }
            seen.push(STREAMS.map(|stream| family.sampler(stream, 5).next_2d().map(f32::to_bits)));
        }
        // No two samplers, and no two streams, are the same.
        let mut all = seen.concat();
        let count = all.len();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), count);
    }

    #[test]
    fn the_two_that_the_renderer_knows_are_the_same_here() {
        let any = |name| AnyFamily::new(name, [20, 10], 64, 3).unwrap().sampler(5, 6).next_2d();
        assert_eq!(any(SamplerName::Independent), Independent::new(3).sampler(5, 6).next_2d());
        assert_eq!(any(SamplerName::Sobol), OwenSobol::new(3).sampler(5, 6).next_2d());
    }

    #[test]
    fn images_beyond_a_sequence_are_refused() {
        let error = AnyFamily::new(SamplerName::GlobalSobol, [65_537, 1], 1, 0).unwrap_err();
        assert_eq!(error.to_string(), "65537 x 1 pixels are too many for the sequence");
        assert!(AnyFamily::new(SamplerName::ZSobol, [0, 1], 1, 0).is_err());
    }
}
