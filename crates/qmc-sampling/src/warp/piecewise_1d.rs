//! Piecewise constant densities on the unit interval.
use super::TableError;
use super::error::checked_sum;
use crate::Real;
use alloc::vec::Vec;

/// A density on `[0, 1)` that is constant on each of `n` cells of equal length.
///
/// `pdf(x) = n w_i / sum_j w_j` for `x` in cell `i`, up to the rounding described next.
///
/// The cumulative distribution is rounded to the grid of the uniform numbers (multiples of `2^-24`, or `2^-53` for `f64`),
/// so that every cell with a positive weight has at least one of them, and [`pdf`](Self::pdf) is what is really sampled:
/// no cell that matters is ever missed, however bright the others, and weighting by the inverse density is unbiased.
///
/// Sampling is by inversion, so stratification survives. Cost: a guide table lookup and on average one or two comparisons.
/// Source: Chen and Asau, "On generating random variates from an empirical distribution" (1974) for the guide table.
///
/// ```
/// use qmc_sampling::warp::PiecewiseConstant1d;
/// # fn main() -> Result<(), qmc_sampling::warp::TableError> {
/// let table = PiecewiseConstant1d::new(&[1.0_f32, 0.0, 3.0])?;
/// let (x, pdf, cell) = table.sample(0.5);
/// assert_eq!(cell, 2);
/// assert!((pdf - 3.0 * 0.75).abs() < 1e-6 && (table.invert(x) - 0.5).abs() < 1e-6);
/// # Ok(()) }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PiecewiseConstant1d<F = f32> {
    /// `n + 1` values from 0 to 1.
    cdf: Vec<F>,
    /// For each of some buckets of equal length, the first cell that it touches; one more at the end.
    guide: Vec<u32>,
}

/// The largest number of cells. Beyond, single precision could not tell them apart.
pub(super) const LIMIT: usize = 1 << 20;

impl<F: Real> PiecewiseConstant1d<F> {
    /// The density proportional to `weights`.
    ///
    /// # Errors
    /// No weights or more than 2^20; a weight that is negative, infinite or NaN; all weights zero.
    pub fn new(weights: &[F]) -> Result<Self, TableError> {
        let sum = check(weights)?;
        let cdf = cumulative(weights.iter().map(|w| w.to_f64()), sum);
        let guide = guide(&cdf);
        Ok(Self { cdf, guide })
    }

    /// The same from weights in double precision.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub(super) fn from_f64(weights: &[f64]) -> Result<Self, TableError> {
        let sum = check(weights)?;
        let cdf = cumulative(weights.iter().copied(), sum);
        let guide = guide(&cdf);
        Ok(Self { cdf, guide })
    }

    /// The number of cells.
    #[inline]
    #[must_use]
    pub fn len(&self) -> usize {
        self.cdf.len() - 1
    }

    /// Never: a table has at least one cell.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        false
    }

    /// A point, its density with respect to length and its cell. Numbers outside of `[0, 1)` are clamped, NaN is 0.
    #[inline]
    #[must_use]
    pub fn sample(&self, u: F) -> (F, F, usize) {
        sample_row(&self.cdf, &self.guide, u)
    }

    /// A cell, its probability, and what remains of the number: uniform in `[0, 1)`, to be used again.
    ///
    /// As [`AliasTable::sample`](super::AliasTable::sample), but monotone, so that stratification survives.
    #[inline]
    #[must_use]
    pub fn choose(&self, u: F) -> (usize, F, F) {
        let u = u.clamp_unit();
        if self.cdf.len() == 2 {
            return (0, F::ONE, u);
        }
        let cell = cell_at(&self.cdf, &self.guide, u);
        let start = self.cdf[cell];
        let probability = self.cdf[cell + 1] - start;
        (cell, probability, ((u - start) / probability).clamp_unit())
    }

    /// The density at `x` with respect to length; zero outside of `[0, 1)`.
    #[inline]
    #[must_use]
    pub fn pdf(&self, x: F) -> F {
        if x >= F::ZERO && x < F::ONE { pdf_row(&self.cdf, cell_of(x, self.len())) } else { F::ZERO }
    }

    /// The probability of a cell.
    ///
    /// # Panics
    /// If there is no such cell.
    #[inline]
    #[must_use]
    pub fn probability(&self, cell: usize) -> F {
        self.cdf[cell + 1] - self.cdf[cell]
    }

    /// The number that [`sample`](Self::sample) maps to `x`.
    #[inline]
    #[must_use]
    pub fn invert(&self, x: F) -> F {
        invert_row(&self.cdf, x)
    }
}

/// The sum of weights that make a density.
fn check<F: Real>(weights: &[F]) -> Result<f64, TableError> {
    let sum = checked_sum(weights)?;
    if weights.len() > LIMIT {
        return Err(TableError::TooMany { len: weights.len(), limit: LIMIT });
    }
    if !(sum > 0.0 && sum.is_finite()) {
        return Err(TableError::InvalidSum(sum));
    }
    Ok(sum)
}

/// The cumulative distribution of weights, on the grid of the uniform numbers, each positive weight at least one step.
pub(super) fn cumulative<F: Real>(weights: impl Iterator<Item = f64> + Clone, sum: f64) -> Vec<F> {
    let steps = 1_u64 << F::MANTISSA_BITS;
    let scale = steps as f64 / sum;
    // Steps to keep for the positive weights to come.
    let mut pending = weights.clone().filter(|&w| w > 0.0).count() as u64;
    let mut position = 0_u64;
    let mut total = 0.0;
    let mut cdf = Vec::with_capacity(weights.size_hint().0 + 1);
    cdf.push(F::ZERO);
    for weight in weights {
        if weight > 0.0 {
            total += weight;
            pending -= 1;
            let wanted = (total * scale + 0.5) as u64;
            position = if pending == 0 { steps } else { wanted.clamp(position + 1, steps - pending) };
        }
        cdf.push(F::of(position as f64 / steps as f64));
    }
    cdf
}

/// The guide table of a cumulative distribution: a bucket for every four cells.
pub(super) fn guide<F: Real>(cdf: &[F]) -> Vec<u32> {
    let buckets = buckets(cdf.len() - 1);
    let mut cell = 0;
    let mut guide = Vec::with_capacity(buckets + 1);
    for bucket in 0..buckets {
        let start = F::of(bucket as f64 / buckets as f64);
        while cdf[cell + 1] <= start {
            cell += 1;
        }
        guide.push(cell as u32);
    }
    guide.push(cdf.len() as u32 - 2);
    guide
}

/// The number of buckets of a guide table: a power of two, so that finding one is exact.
#[inline]
pub(super) fn buckets(cells: usize) -> usize {
    (cells / 4).max(1).next_power_of_two()
}

/// The last cell that starts at or before `u`, which lies in `[0, 1)`.
#[inline]
fn cell_at<F: Real>(cdf: &[F], guide: &[u32], u: F) -> usize {
    let bucket = (u * F::of_usize(guide.len() - 1)).to_usize();
    let (first, last) = (guide[bucket] as usize, guide[bucket + 1] as usize);
    first + cdf[first + 1..=last].partition_point(|&end| end <= u)
}

#[inline]
pub(super) fn sample_row<F: Real>(cdf: &[F], guide: &[u32], u: F) -> (F, F, usize) {
    let u = u.clamp_unit();
    let cells = cdf.len() - 1;
    let cell = cell_at(cdf, guide, u);
    // Place the point within it.
    let probability = cdf[cell + 1] - cdf[cell];
    let x = place(cell, (u - cdf[cell]) / probability, cells);
    (x, probability * F::of_usize(cells), cell)
}

#[inline]
pub(super) fn pdf_row<F: Real>(cdf: &[F], cell: usize) -> F {
    (cdf[cell + 1] - cdf[cell]) * F::of_usize(cdf.len() - 1)
}

#[inline]
pub(super) fn invert_row<F: Real>(cdf: &[F], x: F) -> F {
    let x = x.clamp_unit();
    let cells = cdf.len() - 1;
    let cell = cell_of(x, cells);
    let within = (x * F::of_usize(cells) - F::of_usize(cell)).clamp_unit();
    (cdf[cell] + within * (cdf[cell + 1] - cdf[cell])).clamp_unit()
}

/// The cell of `x` in `[0, 1)`.
#[inline]
pub(super) fn cell_of<F: Real>(x: F, cells: usize) -> usize {
    (x * F::of_usize(cells)).to_usize().min(cells - 1)
}

/// The point at the fraction `within` of a cell, such that [`cell_of`] finds the cell again.
#[inline]
fn place<F: Real>(cell: usize, within: F, cells: usize) -> F {
    let n = F::of_usize(cells);
    let mut x = ((F::of_usize(cell) + within.clamp_unit()) / n).clamp_unit();
    // Rounding may lead across a border.
    let found = cell_of(x, cells);
    if found > cell {
        x = x * (F::ONE - F::EPSILON);
    } else if found < cell {
        x = (x * (F::ONE + F::EPSILON)).clamp_unit();
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_remains_of_a_choice_is_uniform_and_agrees_with_sampling() {
        let table = PiecewiseConstant1d::new(&[1.0_f32, 0.0, 3.0, 0.5]).unwrap();
        for k in 0..=4096 {
            let u = (k as f32 / 4096.0).min(1.0 - f32::EPSILON * 0.5);
            let (cell, probability, rest) = table.choose(u);
            let (x, _, sampled) = table.sample(u);
            assert_eq!((cell, probability), (sampled, table.probability(cell)));
            assert!((0.0..1.0).contains(&rest));
            assert!((x * 4.0 - cell as f32 - rest).abs() < 1e-5);
        }
        assert_eq!(table.choose(f32::NAN).0, 0);
    }
    use std::vec;

    fn tables() -> Vec<Vec<f32>> {
        let mut hash = 1_u32;
        let mut random = move || {
            hash = hash.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            (hash >> 8) as f32 / 16_777_216.0
        };
        let mut spiky: Vec<f32> = (0..1000).map(|_| random()).collect();
        spiky[517] = 1e9;
        vec![
            vec![1.0],
            vec![0.0, 0.0, 2.0, 0.0],
            vec![1.0, 2.0, 3.0],
            vec![1e-30, 1e30, 1e-30],
            (0..777).map(|_| (random() - 0.3).max(0.0)).collect(),
            spiky,
        ]
    }

    #[test]
    fn samples_lie_in_cells_of_positive_weight_and_invert() {
        for weights in tables() {
            let table = PiecewiseConstant1d::new(&weights).unwrap();
            for i in 0..10_000 {
                let u = if i == 0 { f32::ONE_MINUS_EPSILON } else { i as f32 / 10_001.0 };
                let (x, pdf, cell) = table.sample(u);
                assert!(weights[cell] > 0.0 && (0.0..1.0).contains(&x));
                assert_eq!(pdf, table.pdf(x), "{u} {x} {cell}");
                let slack = 1e-6 * f32::max(1.0, pdf);
                assert!((table.invert(x) - u).abs() <= slack, "{u} {x} {}", table.invert(x));
            }
            assert_eq!(table.sample(0.0).2, weights.iter().position(|&w| w > 0.0).unwrap());
            assert_eq!(table.sample(1.0).2, weights.iter().rposition(|&w| w > 0.0).unwrap());
            assert_eq!(table.sample(f32::NAN), table.sample(0.0));
        }
    }

    /// Counting all the 2^24 numbers is exact: the density is what is sampled, and no positive cell is missed.
    #[test]
    fn density_is_exactly_what_is_sampled() {
        let weights = &tables()[5];
        let table = PiecewiseConstant1d::new(weights).unwrap();
        let mut counts = vec![0_u32; weights.len()];
        for i in 0..1_u32 << 24 {
            counts[table.sample(crate::f32_from_bits(i << 8)).2] += 1;
        }
        for (cell, &count) in counts.iter().enumerate() {
            assert!(count > 0);
            assert_eq!(count as f32 / 16_777_216.0, table.probability(cell));
        }
    }

    #[test]
    fn density_is_proportional_to_the_weights() {
        let table = PiecewiseConstant1d::new(&[1.0_f64, 2.0, 5.0]).unwrap();
        for (cell, weight) in [1.0, 2.0, 5.0].into_iter().enumerate() {
            assert!((table.probability(cell) - weight / 8.0).abs() < 1e-15);
        }
        assert_eq!((table.pdf(-0.1), table.pdf(1.0), table.pdf(f64::NAN)), (0.0, 0.0, 0.0));
    }

    #[test]
    fn refuses_what_is_no_density() {
        let refused = |weights: &[f32]| PiecewiseConstant1d::new(weights).unwrap_err();
        assert_eq!(refused(&[]), TableError::Empty);
        assert_eq!(refused(&[0.0, 0.0]), TableError::InvalidSum(0.0));
        assert_eq!(refused(&[1.0, -1.0]), TableError::InvalidWeight { index: 1, weight: -1.0 });
        assert!(matches!(refused(&[f32::NAN]), TableError::InvalidWeight { .. }));
        assert!(matches!(refused(&[f32::INFINITY]), TableError::InvalidWeight { .. }));
        assert!(matches!(refused(&vec![1.0; LIMIT + 1]), TableError::TooMany { .. }));
    }
}
