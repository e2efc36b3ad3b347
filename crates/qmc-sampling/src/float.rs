//! Integers to floats in `[0, 1)`.

/// The 24 leading bits of `bits` as a float in `[0, 1)`: a multiple of `2^-24`, never 1.
///
/// The lower bits are cut off, not rounded, so that elementary intervals survive the conversion.
///
/// ```
/// use qmc_sampling::f32_from_bits;
/// assert_eq!(f32_from_bits(0), 0.0);
/// assert_eq!(f32_from_bits(0x8000_00ff), 0.5);
/// assert_eq!(f32_from_bits(u32::MAX), 1.0 - 0.5 * f32::EPSILON);
/// ```
#[inline]
#[must_use]
pub const fn f32_from_bits(bits: u32) -> f32 {
    // Below 2^24 the signed conversion is exact, and it is the one that SSE2 has.
    ((bits >> 8) as i32) as f32 * (1.0 / 16_777_216.0)
}

/// The 53 leading bits of `bits` as a float in `[0, 1)`: a multiple of `2^-53`, never 1.
///
/// ```
/// use qmc_sampling::f64_from_bits;
/// assert_eq!(f64_from_bits(1 << 63), 0.5);
/// assert!(f64_from_bits(u64::MAX) < 1.0);
/// ```
#[inline]
#[must_use]
pub const fn f64_from_bits(bits: u64) -> f64 {
    ((bits >> 11) as i64) as f64 * (1.0 / 9_007_199_254_740_992.0)
}
