//! Random access point sequences.

/// A deterministic sequence of points in the unit cube, of which any coordinate of any point can be asked for alone.
///
/// # Laws
/// - `sample(i, d)` depends on `self`, `i` and `d` only and lies in `[0, 1)`.
/// - `sample_f32(i, d)` is `sample(i, d)` rounded towards zero, never 1.
/// - `dimension` is below [`dimensions`](Sequence::dimensions); beyond, an implementation panics or says what it does.
///
/// Not dyn compatible: sequences are copied.
pub trait Sequence: Copy {
    /// The number of dimensions there are; `u32::MAX` where there is no end.
    fn dimensions(&self) -> u32;

    /// Coordinate `dimension` of point `index`, in `[0, 1)`.
    fn sample(&self, index: u64, dimension: u32) -> f64;

    /// The same coordinate in single precision, in `[0, 1)`.
    #[inline]
    fn sample_f32(&self, index: u64, dimension: u32) -> f32 {
        truncate_to_f32(self.sample(index, dimension))
    }

    /// The first two coordinates of point `index`.
    #[inline]
    fn sample_2d(&self, index: u64) -> [f64; 2] {
        [self.sample(index, 0), self.sample(index, 1)]
    }
}

/// Rounds a number in `[0, 1)` down to a multiple of `2^-24`, so that it stays below 1.
#[inline]
pub(crate) fn truncate_to_f32(x: f64) -> f32 {
    ((x * 16_777_216.0) as u32) as f32 * (1.0 / 16_777_216.0)
}
