//! Owen scrambling by hashing.
//!
//! Nested uniform scrambling (Owen 1995) flips each binary digit of a coordinate by a random bit that depends on all the
//! digits before it. On the bit-reversed number that is any hash in which a bit depends on lower bits only: multiplications
//! by odd numbers, additions and multiply-xors have that property.

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn permutes_every_elementary_interval() {
        for seed in [0, 0x9e37_79b9, 0xdead_beef, u32::MAX] {
            for depth in 1..=10 {
                let mut hit = std::vec![false; 1 << depth];
                for i in 0..1_u32 << depth {
                    hit[(owen_hash_u32(i << (32 - depth), seed) >> (32 - depth)) as usize] = true;
                }
                assert!(hit.into_iter().all(|h| h), "seed {seed:x} depth {depth}");
            }
        }
    }
}
