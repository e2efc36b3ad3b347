//! Interleaved sampling.
use crate::Sequence;
use crate::sequences::SequenceError;

/// Interleaved sampling: a tile of `columns` times `rows` pixels, repeated over the image, gives each pixel one of
/// `columns * rows` sub-patterns.
///
/// Neighbouring pixels use different points, so aliasing becomes noise, which a filter of the size of the tile removes; pixels
/// of the same sub-pattern use the same points, so that data per point (virtual point lights) are shared, coherently.
///
/// A sub-pattern takes a contiguous block of the sequence. Taking every `n`-th point instead would, for sequences in a base
/// that divides the size of the tile, put all the points of a sub-pattern into one interval of the first dimension.
///
/// Source: Keller and Heidrich, "Interleaved sampling" (2001).
///
/// ```
/// use qmc_sampling::{Interleaved, Sequence, sobol::Sobol};
/// # fn main() -> Result<(), qmc_sampling::sequences::SequenceError> {
/// let tile = Interleaved::new(4, 4)?;
/// let pattern = tile.pattern([101, 42]);
/// assert_eq!(tile.cell(pattern), [1, 2]);
/// // Point 5 of 64 of that sub-pattern:
/// let x = tile.sample(&Sobol::default(), pattern, 64, 5, 0);
/// assert_eq!(x, Sobol::default().sample(u64::from(pattern) * 64 + 5, 0));
/// # Ok(()) }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Unchecked"))]
pub struct Interleaved {
    columns: u32,
    rows: u32,
}

#[cfg(feature = "serde")]
read_through!(Interleaved { columns: u32, rows: u32 } => Self::new(columns, rows), SequenceError);

impl Interleaved {
    /// A tile of `columns` times `rows` pixels.
    ///
    /// # Errors
    /// If a side is zero or there are 2^32 pixels and more.
    pub fn new(columns: u32, rows: u32) -> Result<Self, SequenceError> {
        match columns.checked_mul(rows) {
            None => Err(SequenceError::ImageTooLarge { width: columns, height: rows }),
            Some(0) => Err(SequenceError::NoPoints),
            Some(_) => Ok(Self { columns, rows }),
        }
    }

    /// The number of sub-patterns.
    #[must_use]
    pub fn patterns(&self) -> u32 {
        self.columns * self.rows
    }

    /// The sides of the tile.
    #[must_use]
    pub fn sides(&self) -> [u32; 2] {
        [self.columns, self.rows]
    }

    /// The sub-pattern of a pixel (column, row).
    #[inline]
    #[must_use]
    pub fn pattern(&self, pixel: [u32; 2]) -> u32 {
        pixel[0] % self.columns + self.columns * (pixel[1] % self.rows)
    }

    /// The pixel of the tile that has a sub-pattern.
    #[inline]
    #[must_use]
    pub fn cell(&self, pattern: u32) -> [u32; 2] {
        [pattern % self.columns, pattern / self.columns % self.rows]
    }

    /// The pixels of an image of `width` times `height` that have a sub-pattern.
    pub fn pixels(&self, pattern: u32, width: u32, height: u32) -> impl Iterator<Item = [u32; 2]> + use<> {
        let [x, y] = self.cell(pattern);
        let [columns, rows] = self.sides().map(|side| side as usize);
        (y..height).step_by(rows).flat_map(move |y| (x..width).step_by(columns).map(move |x| [x, y]))
    }

    /// The index in the sequence of point `i` of a sub-pattern of `points` points.
    #[inline]
    #[must_use]
    pub fn index(&self, pattern: u32, points: u64, i: u64) -> u64 {
        debug_assert!(i < points);
        u64::from(pattern) * points + i
    }

    /// The sub-pattern, and the point in it, that an index of the sequence belongs to; none beyond the last sub-pattern.
    #[inline]
    #[must_use]
    pub fn locate(&self, index: u64, points: u64) -> Option<(u32, u64)> {
        let pattern = index.checked_div(points)?;
        (pattern < u64::from(self.patterns())).then(|| (pattern as u32, index % points))
    }

    /// Coordinate `dimension` of point `i` of a sub-pattern of `points` points of any sequence.
    #[inline]
    #[must_use]
    pub fn sample(&self, sequence: &impl Sequence, pattern: u32, points: u64, i: u64, dimension: u32) -> f64 {
        sequence.sample(self.index(pattern, points, i), dimension)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;

    #[test]
    fn patterns_and_pixels_are_inverse() {
        let tile = Interleaved::new(3, 2).unwrap();
        let mut hit = vec![0; 100];
        for pattern in 0..tile.patterns() {
            assert_eq!(tile.pattern(tile.cell(pattern)), pattern);
            for [x, y] in tile.pixels(pattern, 10, 10) {
                assert_eq!(tile.pattern([x, y]), pattern);
                hit[(x + 10 * y) as usize] += 1;
            }
            assert_eq!(tile.locate(tile.index(pattern, 7, 6), 7), Some((pattern, 6)));
        }
        assert_eq!(hit, vec![1; 100]);
        assert_eq!((tile.locate(42, 7), tile.locate(1, 0)), (None, None));
        assert!(Interleaved::new(0, 1).is_err() && Interleaved::new(1 << 20, 1 << 20).is_err());
    }

    /// The sub-patterns together are the first points of the sequence, and each of them alone is a net.
    #[test]
    fn sub_patterns_are_nets_and_their_union_is_the_sequence() {
        let tile = Interleaved::new(4, 2).unwrap();
        let sobol = crate::sobol::Sobol::default();
        let mut all = [false; 128];
        for pattern in 0..8 {
            let mut net = [false; 16];
            for i in 0..16 {
                let x = tile.sample(&sobol, pattern, 16, i, 0);
                let y = tile.sample(&sobol, pattern, 16, i, 1);
                net[(4.0 * x) as usize + 4 * (4.0 * y) as usize] = true;
                all[(128.0 * x) as usize] = true;
            }
            assert!(net.iter().all(|&h| h));
        }
        assert!(all.iter().all(|&h| h));
    }
}
