//! Integer hashes: seeds from small structured numbers.

/// Stafford's variant 13 of the murmur finaliser (the output function of SplitMix64): a bijection on 64 bits.
#[inline]
pub(crate) const fn mix64(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// Folds `value` into the running hash `state`. Two different values give two different states.
#[inline]
pub(crate) const fn combine(state: u64, value: u64) -> u64 {
    mix64(state ^ value.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_values_spread() {
        let mut seen: std::vec::Vec<u64> = (0..1000).map(|v| combine(combine(0, v / 10), v % 10)).collect();
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen.len(), 1000);
        let flips = (combine(0, 0) ^ combine(0, 1)).count_ones();
        assert!((12..52).contains(&flips), "{flips}");
    }
}
