//! Piecewise constant densities on the unit square.
use super::TableError;
use super::error::checked_sum;
use super::piecewise_1d::{PiecewiseConstant1d, buckets, cell_of, cumulative, guide, invert_row, pdf_row, sample_row};
use crate::Real;
use alloc::vec::Vec;

/// A density on the unit square that is constant on each cell of a grid: an environment map, a luminance image.
///
/// `pdf(x, y) = width height w_ij / sum w`, sampled as a row by the sums of rows, then a column within it. The rounding
/// of [`PiecewiseConstant1d`] applies to both: the density is exactly what is sampled.
///
/// Cost: two guide table lookups, two short searches; 5 bytes per cell in single precision.
///
/// ```
/// use qmc_sampling::warp::PiecewiseConstant2d;
/// # fn main() -> Result<(), qmc_sampling::warp::TableError> {
/// let image = [0.0_f32, 1.0, 0.0, /* next row */ 0.0, 1.0, 2.0];
/// let table = PiecewiseConstant2d::new(&image, 3, 2)?;
/// let (point, pdf, [column, row]) = table.sample([0.9, 0.9]);
/// assert_eq!([column, row], [2, 1]);
/// assert!((pdf - 6.0 * 0.5).abs() < 1e-5 && table.pdf(point) == pdf);
/// # Ok(()) }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PiecewiseConstant2d<F = f32> {
    width: usize,
    rows: PiecewiseConstant1d<F>,
    /// `width + 1` values per row.
    cdf: Vec<F>,
    /// `buckets(width) + 1` values per row.
    guide: Vec<u32>,
}

impl<F: Real> PiecewiseConstant2d<F> {
    /// The density proportional to `weights`, row by row, `width` of them in each of `height` rows.
    ///
    /// # Errors
    /// `weights.len() != width * height`; a side that is zero or more than 2^20; a weight that is negative, infinite or
    /// NaN; all weights zero.
    pub fn new(weights: &[F], width: usize, height: usize) -> Result<Self, TableError> {
        let expected = width.saturating_mul(height);
        if weights.len() != expected {
            return Err(TableError::WrongSize { len: weights.len(), expected });
        }
        let total = checked_sum(weights)?;
        let limit = super::piecewise_1d::LIMIT;
        if width > limit {
            return Err(TableError::TooMany { len: width, limit });
        }
        if !(total > 0.0 && total.is_finite()) {
            return Err(TableError::InvalidSum(total));
        }
        let mut sums = Vec::with_capacity(height);
        let mut cdf = Vec::with_capacity((width + 1) * height);
        let mut guides = Vec::with_capacity((buckets(width) + 1) * height);
        for row in weights.chunks_exact(width) {
            let sum: f64 = row.iter().map(|w| w.to_f64()).sum();
            // Relative to the total: sums of large weights may not fit the narrower float.
            sums.push(sum / total);
            if sum > 0.0 {
                cdf.extend(cumulative::<F>(row.iter().map(|w| w.to_f64()), sum));
            } else {
                // Never sampled: density zero everywhere.
                cdf.extend(core::iter::repeat_n(F::ZERO, width + 1));
            }
            let start = cdf.len() - width - 1;
            if sum > 0.0 {
                guides.extend(guide(&cdf[start..]));
            } else {
                guides.extend(core::iter::repeat_n(0, buckets(width) + 1));
            }
        }
        Ok(Self { width, rows: PiecewiseConstant1d::from_f64(&sums)?, cdf, guide: guides })
    }

    /// The number of columns.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// The number of rows.
    #[must_use]
    pub fn height(&self) -> usize {
        self.rows.len()
    }

    /// A point, its density with respect to area (on the unit square) and its cell as column and row. Numbers outside of
    /// `[0, 1)` are clamped, NaN is 0.
    #[inline]
    #[must_use]
    pub fn sample(&self, u: [F; 2]) -> ([F; 2], F, [usize; 2]) {
        let (y, pdf_y, row) = self.rows.sample(u[1]);
        let stride = buckets(self.width) + 1;
        let (x, pdf_x, column) = sample_row(self.row(row), &self.guide[stride * row..][..stride], u[0]);
        ([x, y], pdf_x * pdf_y, [column, row])
    }

    /// The density at `point` with respect to area; zero outside of the square.
    #[inline]
    #[must_use]
    pub fn pdf(&self, point: [F; 2]) -> F {
        let [x, y] = point;
        if x >= F::ZERO && x < F::ONE && y >= F::ZERO && y < F::ONE {
            self.pdf_cell([cell_of(x, self.width), cell_of(y, self.height())])
        } else {
            F::ZERO
        }
    }

    /// The density in a cell (column, row) with respect to area.
    ///
    /// # Panics
    /// If there is no such cell.
    #[inline]
    #[must_use]
    pub fn pdf_cell(&self, cell: [usize; 2]) -> F {
        let [column, row] = cell;
        pdf_row(self.row(row), column) * self.rows.probability(row) * F::of_usize(self.height())
    }

    /// The point of the square that [`sample`](Self::sample) maps to `point`.
    #[inline]
    #[must_use]
    pub fn invert(&self, point: [F; 2]) -> [F; 2] {
        let row = cell_of(point[1].clamp_unit(), self.height());
        [invert_row(self.row(row), point[0]), self.rows.invert(point[1])]
    }

    #[inline]
    fn row(&self, row: usize) -> &[F] {
        &self.cdf[(self.width + 1) * row..][..self.width + 1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warp::testing::square;

    fn image(width: usize, height: usize) -> Vec<f32> {
        (0..width * height)
            .map(|i| {
                let (x, y) = (i % width, i / width);
                let dark = y == 3 || (x * 7 + y * 13) % 5 == 0;
                if dark { 0.0 } else { 0.01 + (x * y) as f32 + if (x, y) == (17, 9) { 1e6 } else { 0.0 } }
            })
            .collect()
    }

    #[test]
    fn samples_invert_and_have_the_density() {
        for (width, height) in [(1, 1), (1, 7), (31, 12), (200, 100)] {
            let mut weights = image(width, height);
            weights[0] = 1.0;
            let table = PiecewiseConstant2d::new(&weights, width, height).unwrap();
            for u in square::<f32>() {
                let (point, pdf, cell) = table.sample(u);
                assert!(weights[cell[0] + width * cell[1]] > 0.0);
                assert!(point.iter().all(|x| (0.0..1.0).contains(x)));
                assert!((table.pdf(point) - pdf).abs() <= 1e-6 * pdf, "{u:?} {point:?}");
                let inverse = table.invert(point);
                for k in 0..2 {
                    assert!((inverse[k] - u[k]).abs() < 1e-2, "{u:?} {inverse:?}");
                }
                let (again, _, same) = table.sample(inverse);
                assert_eq!(same[1], cell[1]);
                assert!((again[0] - point[0]).abs() < 2.0 / width as f32);
            }
            let mean: f64 = (0..width * height).map(|i| f64::from(table.pdf_cell([i % width, i / width]))).sum::<f64>()
                / (width * height) as f64;
            assert!((mean - 1.0).abs() < 1e-5, "{mean}");
        }
    }

    #[test]
    fn large_maps_are_robust() {
        let (width, height) = (2048, 1024);
        let mut weights: Vec<f32> = (0..width * height).map(|i| ((i * 31) % 17) as f32 * 0.1).collect();
        weights[123_456] = 1e7;
        let table = PiecewiseConstant2d::new(&weights, width, height).unwrap();
        for u in square::<f32>() {
            let (_, pdf, [column, row]) = table.sample(u);
            assert!(pdf > 0.0 && weights[column + width * row] > 0.0);
        }
    }

    #[test]
    fn refuses_what_is_no_density() {
        let refused = |weights: &[f32], w, h| PiecewiseConstant2d::new(weights, w, h).unwrap_err();
        assert_eq!(refused(&[1.0; 3], 2, 2), TableError::WrongSize { len: 3, expected: 4 });
        assert_eq!(refused(&[], 0, 2), TableError::Empty);
        assert_eq!(refused(&[0.0; 4], 2, 2), TableError::InvalidSum(0.0));
        assert!(matches!(refused(&[1.0, f32::NAN], 2, 1), TableError::InvalidWeight { index: 1, .. }));
    }
}
