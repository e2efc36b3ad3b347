//! Inversion of tabulated cumulative distribution functions, in one and two dimensions.

use alloc::vec::Vec;

use crate::{PrefixSums, Proposal, Source, Uniform};

/// Why a table is none.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum TabulatedError {
    /// No cells.
    Empty,
    /// An end of the domain is not finite, or they are in the wrong order.
    Domain(f64, f64),
    /// No cell has a positive and finite value.
    NoWeight,
}

impl core::fmt::Display for TabulatedError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Empty => write!(f, "a table needs at least one cell"),
            Self::Domain(low, high) => write!(f, "[{low}, {high}] is no interval"),
            Self::NoWeight => write!(f, "no cell of the table is positive and finite"),
        }
    }
}

impl core::error::Error for TabulatedError {}

fn check(cells: usize, [low, high]: [f64; 2]) -> Result<(), TabulatedError> {
    if cells == 0 {
        return Err(TabulatedError::Empty);
    }
    if !(low < high && low.is_finite() && high.is_finite()) {
        return Err(TabulatedError::Domain(low, high));
    }
    Ok(())
}

/// The middle of cell `i` of `n` on an interval.
fn middle([low, high]: [f64; 2], i: usize, n: usize) -> f64 {
    low + (high - low) * (i as f64 + 0.5) / n as f64
}

/// A density on an interval, constant in equal cells, in proportion to a function at their middles.
///
/// `sample(u)` is monotonic in `u`: the inverse of the cumulative distribution function. Exact as a [`Source`]; as an approximation of the
/// function only as good as the table.
///
/// ```
/// use ris::baselines::Tabulated1d;
/// let table = Tabulated1d::new(|x| x, [0.0, 2.0], 2)?;
/// assert_eq!(table.pdf(0.3), 0.25);
/// assert_eq!(table.sample(0.25), 1.0);
/// # Ok::<(), ris::baselines::TabulatedError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Tabulated1d {
    domain: [f64; 2],
    sums: PrefixSums,
}

impl Tabulated1d {
    /// Tabulates `g` in `cells` cells. Values that are not positive and finite are zero.
    ///
    /// # Errors
    /// No cells, an interval that is none, or no positive value.
    pub fn new(g: impl Fn(f64) -> f64, domain: [f64; 2], cells: usize) -> Result<Self, TabulatedError> {
        check(cells, domain)?;
        let sums = PrefixSums::new((0..cells).map(|i| g(middle(domain, i, cells))));
        if sums.total() > 0.0 { Ok(Self { domain, sums }) } else { Err(TabulatedError::NoWeight) }
    }

    /// The probability density at `x`; zero outside of the interval.
    pub fn pdf(&self, x: f64) -> f64 {
        let ([low, high], cells) = (self.domain, self.sums.len());
        if !(x >= low && x <= high) {
            return 0.0;
        }
        let cell = ((x - low) / (high - low) * cells as f64) as usize;
        self.sums.probability(cell.min(cells - 1)) * cells as f64 / (high - low)
    }

    /// The point with `u` in `[0, 1)` of the probability below it.
    pub fn sample(&self, u: f64) -> f64 {
        self.sample_with_pdf(u).0
    }

    /// The point and its density, that of the cell which was selected: rounding may move the point to the edge of the next
    /// one, where the density may be zero.
    fn sample_with_pdf(&self, u: f64) -> (f64, f64) {
        let ([low, high], cells) = (self.domain, self.sums.len() as f64);
        let (cell, rest) = self.sums.select_with_rest(u).unwrap_or((0, 0.0));
        (low + (high - low) * (cell as f64 + rest) / cells, self.sums.probability(cell) * cells / (high - low))
    }
}

impl Source<f64, f64> for Tabulated1d {
    fn propose(&self, uniform: &mut impl Uniform<f64>) -> Option<Proposal<f64, f64>> {
        let (sample, density) = self.sample_with_pdf(uniform.next_uniform());
        Some(Proposal { sample, density })
    }
    fn density(&self, x: &f64) -> f64 {
        self.pdf(*x)
    }
}

/// A density on a rectangle, constant in equal cells: a row by its marginal, a column by the row's conditional distribution.
///
/// ```
/// use ris::baselines::Tabulated2d;
/// let table = Tabulated2d::new(|[x, y]| x * y, [[0.0, 2.0], [0.0, 2.0]], [2, 2])?;
/// assert_eq!(table.pdf([0.5, 0.5]), 1.0 / 16.0);
/// assert_eq!(table.pdf([1.5, 1.5]), 9.0 / 16.0);
/// # Ok::<(), ris::baselines::TabulatedError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Tabulated2d {
    rows: Vec<Tabulated1d>,
    marginal: PrefixSums,
    domain: [f64; 2],
}

impl Tabulated2d {
    /// Tabulates `g` over `domain = [x interval, y interval]` in `cells = [columns, rows]`. Values that are not positive and finite are
    /// zero.
    ///
    /// # Errors
    /// No cells, an interval that is none, or no positive value.
    pub fn new(g: impl Fn([f64; 2]) -> f64, domain: [[f64; 2]; 2], cells: [usize; 2]) -> Result<Self, TabulatedError> {
        let ([x, y], [columns, rows]) = (domain, cells);
        check(columns, x)?;
        check(rows, y)?;
        let row = |j: usize| PrefixSums::new((0..columns).map(|i| g([middle(x, i, columns), middle(y, j, rows)])));
        let rows: Vec<_> = (0..rows).map(|j| Tabulated1d { domain: x, sums: row(j) }).collect();
        let marginal = PrefixSums::new(rows.iter().map(|row| row.sums.total()));
        if marginal.total() > 0.0 { Ok(Self { rows, marginal, domain: y }) } else { Err(TabulatedError::NoWeight) }
    }

    /// The probability density at a point; zero outside of the rectangle.
    pub fn pdf(&self, [x, y]: [f64; 2]) -> f64 {
        let ([low, high], rows) = (self.domain, self.rows.len());
        if !(y >= low && y <= high) {
            return 0.0;
        }
        let row = (((y - low) / (high - low) * rows as f64) as usize).min(rows - 1);
        self.marginal.probability(row) * rows as f64 / (high - low) * self.rows[row].pdf(x)
    }

    /// The point for two numbers in `[0, 1)`: the second chooses the row.
    pub fn sample(&self, numbers: [f64; 2]) -> [f64; 2] {
        self.sample_with_pdf(numbers).0
    }

    fn sample_with_pdf(&self, [u, v]: [f64; 2]) -> ([f64; 2], f64) {
        let ([low, high], rows) = (self.domain, self.rows.len() as f64);
        let (row, rest) = self.marginal.select_with_rest(v).unwrap_or((0, 0.0));
        let (x, pdf) = self.rows[row].sample_with_pdf(u);
        (
            [x, low + (high - low) * (row as f64 + rest) / rows],
            self.marginal.probability(row) * rows / (high - low) * pdf,
        )
    }
}

impl Source<[f64; 2], f64> for Tabulated2d {
    fn propose(&self, uniform: &mut impl Uniform<f64>) -> Option<Proposal<[f64; 2], f64>> {
        let (sample, density) = self.sample_with_pdf([uniform.next_uniform(), uniform.next_uniform()]);
        Some(Proposal { sample, density })
    }
    fn density(&self, x: &[f64; 2]) -> f64 {
        self.pdf(*x)
    }
}
