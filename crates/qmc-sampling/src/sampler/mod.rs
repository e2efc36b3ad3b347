//! What a path consumes.
mod from_sequence;
mod global_halton;
mod global_sobol;
mod groups;
mod independent;
mod lattice;
#[cfg(feature = "openqmc")]
mod open_qmc;
mod owen_sobol;
mod z_order;
mod z_sobol;

pub use from_sequence::{FromSequence, SequenceSampler};
pub use global_halton::{GlobalHalton, GlobalHaltonSampler};
pub use global_sobol::{GlobalSobol, GlobalSobolSampler};
pub use independent::{Independent, IndependentSampler};
pub use lattice::{PaddedLattice, PaddedLatticeSampler};
#[cfg(feature = "openqmc")]
pub use open_qmc::{OpenQmc, OpenQmcSampler};
/// The crate whose sampler kinds [`OpenQmc`] takes.
#[cfg(feature = "openqmc")]
pub use openqmc;
pub use owen_sobol::{OwenSobol, OwenSobolSampler};
pub use z_sobol::{ZSobol, ZSobolSampler};

/// What one path consumes. All numbers lie in `[0, 1)`, never 1.
///
/// Small and passed by value; cloning it replays the numbers. No sampler is `Copy`, so that two uses of the same numbers
/// have to be asked for; independent ones come from [`fork`](Sampler::fork):
///
/// ```
/// use qmc_sampling::{OwenSobol, Sampler, SamplerFamily};
/// fn light(mut numbers: impl Sampler) -> [f32; 2] { numbers.next_2d() }
/// fn bsdf(mut numbers: impl Sampler) -> [f32; 2] { numbers.next_2d() }
///
/// let numbers = OwenSobol::new(7).sampler(0, 0);
/// assert_ne!(light(numbers.fork(0)), bsdf(numbers.fork(1)));
/// ```
///
/// ```compile_fail,E0382
/// use qmc_sampling::{OwenSobol, Sampler, SamplerFamily};
/// fn light(mut numbers: impl Sampler) -> [f32; 2] { numbers.next_2d() }
/// fn bsdf(mut numbers: impl Sampler) -> [f32; 2] { numbers.next_2d() }
///
/// let numbers = OwenSobol::new(7).sampler(0, 0);
/// assert_ne!(light(numbers), bsdf(numbers));
/// ```
///
/// # Laws
/// - Two samplers made alike hand out the same numbers.
/// - [`fork`](Sampler::fork) depends on what the sampler is and on `domain`, not on how many numbers were taken from it.
///
/// Not dyn compatible: samplers are cloned, so that paths may fork. To choose at run time, implement it for an enum of
/// the choices.
pub trait Sampler: Clone {
    /// The next number.
    fn next_1d(&mut self) -> f32;

    /// The next two numbers, stratified together where the sampler can.
    fn next_2d(&mut self) -> [f32; 2];

    /// A decorrelated sub-stream: one per bounce, per light, per lens.
    ///
    /// Streams of different domains, and the stream they were forked from, are independent; the same domain of the same
    /// sampler gives the same stream again.
    #[must_use]
    fn fork(&self, domain: u32) -> Self;
}

/// Splitting of paths: one path goes on as several. Every sampler of this crate can.
pub trait Split: Sampler {
    /// Child number `child` of `children`, in a domain of its own.
    ///
    /// The children of one sampler are stratified against each other and against those of the samplers with neighbouring
    /// indices, where the sampler can: give each as many children, a power of two.
    #[must_use]
    fn split(&self, domain: u32, children: u32, child: u32) -> Self;
}

/// Hands out the sampler of path number `index` (0, 1, ..) of stream `stream` (a pixel, a light-path stream, ..).
/// Shared between threads by reference.
///
/// # Laws
/// - The samplers of one stream are stratified against each other over consecutive indices, where the family can.
/// - The samplers of different streams are independent, unless the family says how they are related.
/// - A family that is made for an image of `width` times `height` pixels takes stream `y * width + x` for the pixel in
///   column `x` and row `y`. The first pair of numbers is the place in the pixel, from `[0, 0]` to below `[1, 1]`. Any other
///   stream (light paths, say) belongs to no pixel, and is a randomisation of its own.
///
/// Dyn compatible: `&dyn SamplerFamily<Sampler = S>`.
pub trait SamplerFamily: Sync {
    /// What it hands out.
    type Sampler: Sampler;

    /// The sampler of path `index` of stream `stream`.
    fn sampler(&self, stream: u64, index: u64) -> Self::Sampler;
}

// Its docs say so.
const _: Option<&dyn SamplerFamily<Sampler = IndependentSampler>> = None;

/// Shuffles an index such that aligned blocks of powers of two stay together: Owen scrambling of the integer.
///
/// Only the low 32 bits move; the others choose how.
#[inline]
fn shuffle(index: u64, key: u64) -> u64 {
    let high = index >> 32;
    let key = if high == 0 { key } else { crate::hash::combine(key, high) };
    (high << 32) | u64::from(crate::scramble::owen_hash_u32(index as u32, (key >> 32) as u32))
}

/// Four random numbers of a well mixed key.
#[inline]
fn seeds(key: u64) -> [u32; 4] {
    // Odd numbers without structure, from the digits of square roots of primes, as in SHA-512.
    const MULTIPLIERS: [u64; 4] =
        [0x6a09_e667_f3bc_c909, 0xbb67_ae85_84ca_a73b, 0x3c6e_f372_fe94_f82b, 0xa54f_f53a_5f1d_36f1];
    MULTIPLIERS.map(|m| (key.wrapping_mul(m) >> 32) as u32)
}

/// Column and row of a stream, if it is a pixel of an image of this size.
#[inline]
fn pixel_of(stream: u64, [width, height]: [u32; 2]) -> Option<[u32; 2]> {
    let (x, y) = match u32::try_from(stream) {
        // Small numbers are divided faster.
        Ok(short) => (short % width, u64::from(short / width)),
        Err(_) => ((stream % u64::from(width)) as u32, stream / u64::from(width)),
    };
    (y < u64::from(height)).then_some([x, y as u32])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequences::Halton;
    use std::vec::Vec;

    /// Calls the test with every family, each for an image of 64 x 64 pixels and 64 paths.
    macro_rules! with_every_family {
        ($test:ident) => {
            $test("independent", &Independent::new(1));
            $test("owen-sobol", &OwenSobol::new(1));
            $test("global sobol", &GlobalSobol::new(64, 64, 1).unwrap());
            $test("global halton", &GlobalHalton::new(64, 64, 1).unwrap());
            $test("z-sobol", &ZSobol::new(64, 64, 64, 1).unwrap());
            $test("lattice", &PaddedLattice::new(1));
            $test("from sequence", &FromSequence::new(Halton::default(), 1));
        };
    }

    fn keeps_the_laws<F: SamplerFamily>(name: &str, family: &F) {
        for stream in [0, 1, 63, 64, 4095] {
            for index in [0, 1, 63] {
                let sampler = family.sampler(stream, index);
                let take = |mut sampler: F::Sampler, n| -> Vec<f32> { (0..n).map(|_| sampler.next_1d()).collect() };
                let numbers = take(sampler.clone(), 3000);
                assert!(numbers.iter().all(|x| (0.0..1.0).contains(x)), "{name}");
                assert_eq!(numbers, take(family.sampler(stream, index), 3000), "{name}");
                let fork = take(sampler.fork(3), 20);
                let mut used = sampler.clone();
                for _ in 0..9 {
                    let pair = used.next_2d();
                    assert!(pair.iter().all(|x| (0.0..1.0).contains(x)), "{name}");
                    used.next_1d();
                }
                assert_eq!(fork, take(used.fork(3), 20), "{name}: a fork depends on what was taken");
                assert_ne!(fork, numbers[..20], "{name}");
                assert_ne!(fork, take(sampler.fork(4), 20), "{name}");
                assert_ne!(fork, take(sampler.fork(3).fork(3), 20), "{name}");
            }
        }
    }

    #[test]
    fn every_family_keeps_the_laws() {
        with_every_family!(keeps_the_laws);
    }

    /// Means, and correlations between dimensions, forks and streams, over all pixels and paths: a coarse net for mistakes.
    fn is_uncorrelated<F: SamplerFamily>(name: &str, family: &F) {
        let mut sums = [0.0; 6];
        let n = 64 * 64 * 64;
        for i in 0..n {
            let mut sampler = family.sampler(i / 64, i % 64);
            let mut neighbour = family.sampler((i / 64) ^ 1, i % 64);
            let mut fork = sampler.fork(1);
            let centred = |x: f32| f64::from(x) - 0.5;
            let [x, y] = sampler.next_2d().map(centred);
            let z = centred(sampler.next_1d());
            for (sum, value) in sums.iter_mut().zip([
                x,
                12.0 * x * y,
                12.0 * x * z,
                12.0 * x * centred(fork.next_1d()),
                12.0 * z * centred(fork.next_1d()),
                12.0 * z * {
                    neighbour.next_2d();
                    centred(neighbour.next_1d())
                },
            ]) {
                *sum += value / n as f64;
            }
        }
        // Independent ones would have a standard deviation of 0.002; neighbouring pixels share structure on purpose.
        for (k, sum) in sums.iter().enumerate() {
            let bound = if k == 5 && name.starts_with("global") { 1.0 } else { 0.012 };
            assert!(sum.abs() < bound, "{name}: correlation {k} is {sum}");
        }
    }

    #[test]
    fn no_family_is_correlated_with_itself() {
        with_every_family!(is_uncorrelated);
    }

    fn is_small<F: SamplerFamily>(name: &str, _: &F) {
        let sequence = if name == "from sequence" { size_of::<Halton>() } else { 0 };
        assert!(size_of::<F::Sampler>() <= 32 + sequence, "{name} {}", size_of::<F::Sampler>());
    }

    #[test]
    fn samplers_are_small() {
        with_every_family!(is_small);
    }

    /// The children of the first paths of a pixel, four each: one in each of 64 cells, for all of these and for those of
    /// single paths; `columns` of 1 asks for the first coordinate only.
    fn splits_well<F: SamplerFamily<Sampler: Split>>(name: &str, family: &F, columns: usize) {
        for stream in [3, 77, 1 << 40] {
            for domain in [0, 5] {
                for (paths, children) in [(16, 4), (1, 64), (64, 1)] {
                    let mut hit = [false; 64];
                    for i in 0..64_u32 {
                        let path = family.sampler(stream, u64::from(i / children));
                        let [x, y] = path.split(domain, children, i % children).next_2d();
                        let rows = 64 / columns;
                        hit[(columns as f32 * y) as usize + columns * (rows as f32 * x) as usize] = true;
                    }
                    assert!(hit.iter().all(|&h| h), "{name}: {paths} paths, {children} children, domain {domain}");
                }
            }
        }
    }

    #[test]
    fn children_of_all_the_paths_are_stratified_together() {
        let lattice = FromSequence::new(crate::sequences::Lattice::default(), 1);
        for columns in [1, 8] {
            splits_well("owen-sobol", &OwenSobol::new(8), columns);
            splits_well("global sobol", &GlobalSobol::new(64, 64, 1).unwrap(), columns);
            splits_well("z-sobol", &ZSobol::new(64, 64, 64, 1).unwrap(), columns);
        }
        splits_well("global halton", &GlobalHalton::new(64, 64, 1).unwrap(), 1);
        splits_well("lattice", &PaddedLattice::new(1), 1);
        splits_well("from sequence", &lattice, 1);
    }

    /// Children are no copies: not of each other, nor of the fork of the same domain, nor of those of other numbers of children.
    #[test]
    fn children_are_all_different() {
        fn check<F: SamplerFamily<Sampler: Split>>(name: &str, family: &F) {
            let path = family.sampler(70, 2);
            let splits = (0..4).flat_map(|child| [4, 8].map(|children| path.split(1, children, child).next_2d()));
            let mut all: Vec<[u32; 2]> = splits.map(|pair| pair.map(f32::to_bits)).collect();
            all.push(path.fork(1).next_2d().map(f32::to_bits));
            all.push(path.clone().next_2d().map(f32::to_bits));
            all.sort_unstable();
            all.dedup();
            assert_eq!(all.len(), 10, "{name}");
            let mut used = path.clone();
            used.next_1d();
            assert_eq!(used.split(3, 4, 2).next_2d(), path.split(3, 4, 2).next_2d(), "{name}");
        }
        with_every_family!(check);
    }

    #[test]
    fn shuffling_is_a_permutation_of_every_aligned_block() {
        for start in [0, 64, 1 << 32, 1 << 40] {
            let mut block: Vec<u64> = (start..start + 64).map(|i| shuffle(i, 0x1234_5678_9abc_def0)).collect();
            block.sort_unstable();
            assert!(block[0].is_multiple_of(64) && block[0] >> 32 == start >> 32);
            assert!(block.windows(2).all(|w| w[1] == w[0] + 1));
        }
    }
}
