//! The Z-order curve, and shuffling along it.
use super::seeds;
use crate::hash::combine;
use crate::scramble::laine_karras;

/// The place of column `x` and row `y` on the Z-order curve: their bits in turns, those of `x` lower.
#[inline]
pub(super) fn z_order(x: u32, y: u32) -> u64 {
    spread(x) | (spread(y) << 1)
}

/// Moves bit `i` to bit `2 i`.
#[inline]
fn spread(x: u32) -> u64 {
    let mut x = u64::from(x);
    for (shift, mask) in [
        (16, 0x0000_ffff_0000_ffff),
        (8, 0x00ff_00ff_00ff_00ff),
        (4, 0x0f0f_0f0f_0f0f_0f0f),
        (2, 0x3333_3333_3333_3333),
        (1, 0x5555_5555_5555_5555),
    ] {
        x = (x | (x << shift)) & mask;
    }
    x
}

/// Permutes the digits in base 4 of a number of `bits` bits, each by one of all 24 permutations, which is hashed from the digits
/// above it. Takes and returns the number with its bits reversed, so that the highest one is bit 0; a single bit that is left
/// over at the end is flipped or not. Bits from `bits` on are rubbish.
///
/// All digits at once. Any permutation of four things is an affine map of two bits over GF(2), and exactly one of these: one of
/// three rotations `(h, l) -> (h, l)`, `(l, h + l)` or `(h + l, h)` of the higher and the lower bit, then a flip of the
/// higher bit, then a flip of the lower one that depends on the higher one. The flips of all digits are one hash of Laine and
/// Karras, in which each bit depends on the bits before it; so are the choices of the rotations, which have the
/// probabilities 6, 5 and 5 sixteenths.
#[inline]
pub(super) fn permute_base_4(reversed: u64, bits: u32, key: u64) -> u64 {
    let low = permute_word(reversed as u32, bits.min(32), seeds(key));
    if bits <= 32 {
        return u64::from(low);
    }
    let key = combine(key, u64::from(reversed as u32));
    let high = permute_word((reversed >> 32) as u32, bits - 32, seeds(key));
    u64::from(low) | (u64::from(high) << 32)
}

/// The higher bits of all digits.
const HIGHER: u32 = 0x5555_5555;

#[inline]
fn permute_word(reversed: u32, bits: u32, seeds: [u32; 4]) -> u32 {
    // Rotate whole digits.
    let whole = ((1_u64 << (bits & !1)) - 1) as u32 & HIGHER;
    let [once, twice] = rotations(reversed, [seeds[0], seeds[1]]).map(|digits| digits & whole);
    let kept = HIGHER & !(once | twice);
    let (higher, lower) = (reversed, reversed >> 1);
    let sum = higher ^ lower;
    let rotated_higher = (higher & kept) | (lower & once) | (sum & twice);
    let rotated_lower = (lower & kept) | (sum & once) | (higher & twice);
    // Flip.
    laine_karras(rotated_higher | (rotated_lower << 1), seeds[2])
}

/// Which digits to rotate once and twice, at the places of their higher bits.
#[inline]
fn rotations(reversed: u32, seeds: [u32; 2]) -> [u32; 2] {
    // Two random bits for each digit, which know nothing of it but all about those above.
    let random = |seed: u32| {
        let flips = laine_karras(reversed, seed) ^ reversed;
        (flips, (flips << 1) | (seed >> 31))
    };
    // Of their four values, the last one asks for two more bits; of those, the last one means no rotation.
    let ((a, b), (c, d)) = (random(seeds[0]), random(seeds[1]));
    let again = a & b;
    [(!a & b) | (again & !c & d), (a & !b) | (again & c & !d)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::mix64;
    use std::collections::BTreeMap;
    use std::vec::Vec;

    /// The permuted digits of a number, from the highest one.
    fn permuted(number: u64, bits: u32, key: u64) -> u64 {
        permute_base_4(number.reverse_bits() >> (64 - bits), bits, key).reverse_bits() >> (64 - bits)
    }

    /// In the plainest way: digit by digit, each with hashes of the digits above alone.
    fn plain(number: u64, bits: u32, key: u64) -> u64 {
        assert!(bits <= 32);
        let seeds = seeds(key);
        let mut result = 0;
        let mut rotated_above = 0;
        for digit in 0..bits.div_ceil(2) {
            let at = |shift: i64| if shift >= 0 { (number >> shift) & 1 } else { 0 };
            let (high, low) =
                (at(i64::from(bits) - 1 - 2 * i64::from(digit)), at(i64::from(bits) - 2 - 2 * i64::from(digit)));
            let above = (number.reverse_bits() >> (64 - bits)) as u32 & ((1_u64 << (2 * digit)) - 1) as u32;
            let random = |seed: u32| {
                let flips = laine_karras(above, seed) ^ above;
                let second = if digit == 0 { seed >> 31 } else { (flips >> (2 * digit - 1)) & 1 };
                ((flips >> (2 * digit)) & 1, second)
            };
            let whole = 2 * digit + 2 <= bits;
            let turns = match (random(seeds[0]), random(seeds[1])) {
                _ if !whole => 0,
                ((0, 1), _) | ((1, 1), (0, 1)) => 1,
                ((1, 0), _) | ((1, 1), (1, 0)) => 2,
                _ => 0,
            };
            let (h, l) = [(high, low), (low, high ^ low), (high ^ low, high)][turns];
            let mut flip = |bit: u64, place: u32| {
                let flipped = (laine_karras(rotated_above, seeds[2]) >> place) & 1;
                rotated_above |= (bit as u32) << place;
                bit ^ u64::from(flipped)
            };
            result = (result << 1) | flip(h, 2 * digit);
            if whole {
                result = (result << 1) | flip(l, 2 * digit + 1);
            }
        }
        result
    }

    #[test]
    fn all_at_once_is_digit_by_digit() {
        for bits in [1, 2, 3, 8, 15, 31, 32] {
            for i in 0..300 {
                let (number, key) = (mix64(i) >> (64 - bits), mix64(i + 1000));
                assert_eq!(permuted(number, bits, key), plain(number, bits, key), "{bits} bits of {number:x}");
            }
        }
    }

    /// Numbers that agree in their first digits still do, and no two become the same.
    #[test]
    fn permutes_every_aligned_block() {
        for bits in [2, 5, 10, 34, 40, 63] {
            for key in [0, 1, mix64(5)] {
                let depth = bits.min(10);
                let start = (mix64(key) >> (64 - bits)) & !((1 << depth) - 1);
                let mut block: Vec<u64> = (start..start + (1 << depth)).map(|i| permuted(i, bits, key)).collect();
                // Digits of block numbers: pairs from the top of the number.
                let mut shift = bits % 2;
                while shift <= depth {
                    for group in block.chunks(1 << shift) {
                        assert!(group.iter().all(|x| x >> shift == group[0] >> shift), "{bits} bits, {shift}");
                    }
                    shift += 2;
                }
                block.sort_unstable();
                block.dedup();
                assert_eq!(block.len(), 1 << depth);
            }
        }
    }

    /// Wherever a digit is, all 24 permutations occur, as often as the rotations say.
    #[test]
    fn all_permutations_occur() {
        let trials = 24_000;
        for (bits, digit) in [(2, 0), (8, 1), (8, 3), (32, 15), (40, 16), (40, 19)] {
            let mut counts = BTreeMap::new();
            for key in 0..trials {
                let shift = bits - 2 - 2 * digit;
                let prefix = (mix64(key) >> (64 - bits)) & !((4 << shift) - 1);
                let permutation: [u64; 4] = core::array::from_fn(|d| {
                    (permuted(prefix | ((d as u64) << shift), bits, mix64(!key)) >> shift) & 3
                });
                *counts.entry(permutation).or_insert(0) += 1;
            }
            assert_eq!(counts.len(), 24, "digit {digit} of {bits} bits: {counts:?}");
            for (permutation, count) in counts {
                // Eight permutations for each rotation; six standard deviations.
                let [low, high] = [5.0 / 16.0, 6.0 / 16.0].map(|p| p / 8.0 * trials as f64);
                let count = f64::from(count);
                let fits = low - 6.0 * low.sqrt() < count && count < high + 6.0 * high.sqrt();
                assert!(fits, "digit {digit} of {bits} bits: {permutation:?} {count} times");
            }
        }
    }

    #[test]
    fn the_curve_is_a_z() {
        let places = [(0, 0), (1, 0), (0, 1), (1, 1), (2, 0), (u32::MAX, u32::MAX)].map(|(x, y)| z_order(x, y));
        assert_eq!(places, [0, 1, 2, 3, 4, u64::MAX]);
    }
}
