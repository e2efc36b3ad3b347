//! Seeds from names, and the uniform numbers that feed the closures under test.

use rand_pcg::Pcg64;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// The largest `f32` below one: uniform numbers never exceed it, so that they stay below one as `f32`.
const BELOW_ONE: f64 = 1.0 - 1.0 / (1u64 << 24) as f64;

/// Hashes a name to a seed; the same on every machine and in every release.
///
/// ```text
/// FNV-1a:  h <- (h xor byte) * 0x100000001b3,   h_0 = 0xcbf29ce484222325
/// ```
///
/// followed by the SplitMix64 finaliser, because FNV leaves the high bits of short names similar.
/// The cost is one multiplication per byte.
///
/// Sources: Fowler, Noll, Vo (1991), the 64-bit constants; Steele, Lea, Flood, "Fast splittable pseudorandom number
/// generators" (2014), mix64variant13.
///
/// ```
/// assert_eq!(estimator_checks::seed("cosine hemisphere"), estimator_checks::seed("cosine hemisphere"));
/// assert_ne!(estimator_checks::seed("a"), estimator_checks::seed("b"));
/// ```
pub const fn seed(name: &str) -> u64 {
    let bytes = name.as_bytes();
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut i = 0;
    while i < bytes.len() {
        hash = (hash ^ bytes[i] as u64).wrapping_mul(0x0000_0100_0000_01b3);
        i += 1;
    }
    mix(hash)
}

/// The SplitMix64 finaliser: a bijection of the 64-bit integers.
pub(crate) const fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// The generator that belongs to a name: PCG XSL RR 128/64, seeded with [`seed`].
///
/// It implements the traits of `rand` 0.10, for code under test that takes such a generator.
///
/// ```
/// use rand_pcg::rand_core::Rng;
/// assert_eq!(estimator_checks::rng("reservoir").next_u64(), estimator_checks::rng("reservoir").next_u64());
/// ```
pub fn rng(name: &str) -> Pcg64 {
    Pcg64::seed_from_u64(seed(name))
}

/// A stream of uniform numbers in `[0, 1)`.
///
/// The numbers are at most `1 - 2^-24`, the largest `f32` below one: converted to `f32` they are still below one, and
/// code under test that relies on it is not blamed for a rounding of ours.
///
/// ```
/// let mut uniforms = estimator_checks::Uniforms::new(7);
/// let [x, y] = uniforms.array();
/// assert!((0.0..1.0).contains(&x) && (0.0..1.0).contains(&y));
/// ```
#[derive(Clone, Debug)]
pub struct Uniforms(Pcg64);

impl Uniforms {
    /// The stream of a seed.
    pub fn new(seed: u64) -> Self {
        Self(Pcg64::seed_from_u64(seed))
    }

    /// The stream of a name, see [`seed`].
    pub fn named(name: &str) -> Self {
        Self(rng(name))
    }

    /// The next number.
    pub fn next_f64(&mut self) -> f64 {
        ((self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64).min(BELOW_ONE)
    }

    /// The next number, as `f32` below one.
    pub fn next_f32(&mut self) -> f32 {
        self.next_f64() as f32
    }

    /// The next `N` numbers.
    pub fn array<const N: usize>(&mut self) -> [f64; N] {
        std::array::from_fn(|_| self.next_f64())
    }

    /// The next 64 random bits, to seed something else.
    pub fn next_u64(&mut self) -> u64 {
        self.0.next_u64()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_never_change() {
        // Published FNV-1a test vectors, before the finaliser; a change of these moves every seed of every suite.
        assert_eq!(seed(""), mix(0xcbf2_9ce4_8422_2325));
        assert_eq!(seed("a"), mix(0xaf63_dc4c_8601_ec8c));
        assert_eq!(seed("foobar"), mix(0x8594_4171_f739_67e8));
    }

    #[test]
    fn uniforms_stay_below_one_as_f32() {
        assert!((BELOW_ONE as f32) < 1.0);
        let mut uniforms = Uniforms::new(1);
        assert!((0..10_000).map(|_| uniforms.next_f32()).all(|u| (0.0..1.0).contains(&u)));
    }
}
