//! Owen scrambling, exact and by hashing.
//!
//! Nested uniform scrambling (Owen, "Randomly permuted (t,m,s)-nets and (t,s)-sequences", 1995) flips each binary digit of a
//! coordinate by a random bit that depends on all the digits before it. On the bit-reversed number that is any hash in which
//! a bit depends on lower bits only: multiplications by odd numbers, additions and multiply-xors have that property.
use crate::hash::{combine, mix64};

/// The hash of Laine and Karras (2011) with the constants of Vegdahl, "Building a better LK hash" (2021).
///
/// Bit `k` of the result is bit `k` of `reversed`, flipped depending on the bits below `k` and on `seed`: an Owen scramble
/// of a number whose bits are reversed. `seed` must be well mixed already.
///
/// ```
/// use qmc_sampling::scramble::laine_karras;
/// let (a, b) = (laine_karras(0b0101, 0x9e37_79b9), laine_karras(0b1101, 0x9e37_79b9));
/// assert_eq!((a ^ b) & 0b1111, 0b1000); // the three low bits agree, the fourth one differs
/// ```
#[inline]
#[must_use]
pub const fn laine_karras(mut reversed: u32, seed: u32) -> u32 {
    reversed ^= reversed.wrapping_mul(0x3d20_adea);
    reversed = reversed.wrapping_add(seed);
    reversed = reversed.wrapping_mul((seed >> 16) | 1);
    reversed ^= reversed.wrapping_mul(0x0552_6c56);
    reversed ^= reversed.wrapping_mul(0x53a2_2864);
    reversed
}

/// The Owen scramble of a 32-digit binary fraction, by hashing. `seed` must be well mixed already.
#[inline]
#[must_use]
pub const fn owen_hash_u32(fraction: u32, seed: u32) -> u32 {
    laine_karras(fraction.reverse_bits(), seed).reverse_bits()
}

/// The Owen scramble of a 64-digit binary fraction, by hashing. `seed` must be well mixed already.
///
/// The leading 32 digits are those of [`owen_hash_u32`] with the high half of the seed; the others are scrambled with a seed
/// that depends on the leading ones.
#[inline]
#[must_use]
pub const fn owen_hash_u64(fraction: u64, seed: u64) -> u64 {
    let leading = (fraction >> 32) as u32;
    let rest_seed = combine(seed, leading as u64) as u32;
    let (leading, rest) = (owen_hash_u32(leading, (seed >> 32) as u32), owen_hash_u32(fraction as u32, rest_seed));
    ((leading as u64) << 32) | rest as u64
}

/// The Owen scramble of the first `digits` digits of a 64-digit binary fraction, digit by digit: each is flipped by a bit
/// hashed from all the digits before it and the seed. Further digits become random.
///
/// Slow and exact: the oracle of the hashed scrambles.
///
/// ```
/// use qmc_sampling::scramble::nested_uniform;
/// let (a, b) = (nested_uniform(0b01 << 62, 7, 64), nested_uniform(0b00 << 62, 7, 64));
/// assert_eq!(a >> 63, b >> 63); // the same first digit stays the same one
/// assert_ne!(a >> 62, b >> 62);
/// ```
#[must_use]
pub const fn nested_uniform(fraction: u64, seed: u64, digits: u32) -> u64 {
    let mut scrambled = fraction;
    let mut k = 0;
    while k < digits && k < 64 {
        // the digits before, with a marker of how many
        let prefix = if k == 0 { 1 } else { (fraction >> (64 - k)) | (1 << k) };
        scrambled ^= (combine(seed, prefix) >> 63) << (63 - k);
        k += 1;
    }
    if digits < 64 {
        let kept = if digits == 0 { 0 } else { fraction >> (64 - digits) };
        let random = mix64(combine(seed ^ 0x5851_f42d_4c95_7f2d, kept)) >> digits;
        scrambled = ((scrambled >> (63 - digits)) >> 1 << (63 - digits)) << 1 | random;
    }
    scrambled
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each scramble permutes the intervals of every length, and the intervals within an interval.
    #[test]
    fn permutes_every_elementary_interval() {
        let scrambles: [fn(u64, u64) -> u64; 3] = [
            |x, seed| u64::from(owen_hash_u32((x >> 32) as u32, seed as u32)) << 32,
            owen_hash_u64,
            |x, seed| nested_uniform(x, seed, 52),
        ];
        for scramble in scrambles {
            for seed in [0, 0x9e37_79b9_dead_beef, u64::MAX] {
                for depth in 1..=10 {
                    let mut hit = std::vec![false; 1 << depth];
                    for i in 0..1_u64 << depth {
                        let scrambled = scramble(i << (64 - depth), seed) >> (64 - depth);
                        hit[scrambled as usize] = true;
                        // the parent interval does not depend on the last digit
                        let sibling = scramble((i ^ 1) << (64 - depth), seed) >> (64 - depth);
                        assert_eq!(scrambled ^ sibling, 1);
                    }
                    assert!(hit.into_iter().all(|h| h), "seed {seed:x} depth {depth}");
                }
            }
        }
    }

    #[test]
    fn digits_below_32_are_nested_too() {
        let x = 0x0123_4567_89ab_cdef;
        for digit in 0..64 {
            for scramble in [owen_hash_u64, |x, seed| nested_uniform(x, seed, 64)] {
                let difference = scramble(x, 12345) ^ scramble(x ^ (1 << (63 - digit)), 12345);
                assert_eq!(difference.leading_zeros(), digit);
            }
        }
    }

    /// Given the digits before, a flip is as likely as not: over seeds, each digit of each node.
    #[test]
    fn flips_are_even() {
        let n = 4096;
        for scramble in [owen_hash_u64, |x, seed| nested_uniform(x, seed, 64)] {
            for digit in [0, 1, 2, 5, 20, 31, 32, 33, 50] {
                for x in [0, 0x0123_4567_89ab_cdef, u64::MAX] {
                    let ones = (0..n).filter(|&s| (scramble(x, mix64(s)) ^ x) >> (63 - digit) & 1 == 1).count();
                    // six standard deviations
                    assert!((ones as f64 - 2048.0).abs() < 6.0 * 32.0, "digit {digit} of {x:x}: {ones}");
                }
            }
        }
    }
}
