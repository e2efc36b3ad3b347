//! Jittered grids.
use super::{SequenceError, permute};
use crate::Real;
use crate::float::f64_from_bits;
use crate::hash::combine;
use crate::sequence::Sequence;

/// A regular grid of cells with one point in each, in the middle or anywhere; pair by pair of dimensions.
///
/// The first pair of dimensions runs through the cells in rows; further pairs in random orders. Indices of
/// `columns * rows` and more begin another grid, with other random numbers.
///
/// Variance: `n^-2` on smooth integrands of two dimensions if jittered. Source: Mitchell (1996) for the analysis.
///
/// ```
/// use qmc_sampling::{Sequence, sequences::Stratified};
/// # fn main() -> Result<(), qmc_sampling::sequences::SequenceError> {
/// assert_eq!(Stratified::regular(2, 2)?.sample_2d(1), [0.75, 0.25]);
/// let [x, y] = Stratified::jittered(2, 2, 9)?.sample_2d(1);
/// assert!((0.5..1.0).contains(&x) && (0.0..0.5).contains(&y));
/// # Ok(()) }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Stratified {
    grid: Grid,
    jitter: bool,
    seed: u64,
}

impl Stratified {
    /// Points in the middle of their cells.
    ///
    /// # Errors
    /// If a side is zero or there are 2^32 cells and more.
    pub fn regular(columns: u32, rows: u32) -> Result<Self, SequenceError> {
        Ok(Self { grid: Grid::new(columns, rows)?, jitter: false, seed: 0 })
    }

    /// Points uniform in their cells.
    ///
    /// # Errors
    /// If a side is zero or there are 2^32 cells and more.
    pub fn jittered(columns: u32, rows: u32, seed: u64) -> Result<Self, SequenceError> {
        Ok(Self { grid: Grid::new(columns, rows)?, jitter: true, seed })
    }
}

impl Sequence for Stratified {
    fn dimensions(&self) -> u32 {
        u32::MAX
    }

    fn sample(&self, index: u64, dimension: u32) -> f64 {
        let (cell, key) = self.grid.cell(index, dimension / 2, self.seed);
        let [column, row] = [cell % self.grid.columns, cell / self.grid.columns];
        let within =
            if self.jitter { f64_from_bits(combine(key, 2 * u64::from(cell) + u64::from(dimension % 2))) } else { 0.5 };
        let (place, side) =
            if dimension.is_multiple_of(2) { (column, self.grid.columns) } else { (row, self.grid.rows) };
        ((f64::from(place) + within) / f64::from(side)).clamp_unit()
    }
}

/// Correlated multi-jittered points: stratified as a grid and, in each coordinate alone, into `columns * rows` intervals;
/// pair by pair of dimensions.
///
/// Indices of `columns * rows` and more begin another set. Variance: `n^-3` in one-dimensional projections, `n^-2` else.
/// Source: Kensler, "Correlated multi-jittered sampling" (2013).
///
/// ```
/// use qmc_sampling::{Sequence, sequences::MultiJittered};
/// # fn main() -> Result<(), qmc_sampling::sequences::SequenceError> {
/// let points = MultiJittered::new(4, 4, 1)?;
/// let mut columns = [0; 16];
/// (0..16).for_each(|i| columns[(16.0 * points.sample(i, 0)) as usize] += 1);
/// assert_eq!(columns, [1; 16]);
/// # Ok(()) }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MultiJittered {
    grid: Grid,
    seed: u64,
}

impl MultiJittered {
    /// The set on a grid of cells.
    ///
    /// # Errors
    /// If a side is zero or there are 2^32 cells and more.
    pub fn new(columns: u32, rows: u32, seed: u64) -> Result<Self, SequenceError> {
        Ok(Self { grid: Grid::new(columns, rows)?, seed })
    }
}

impl Sequence for MultiJittered {
    fn dimensions(&self) -> u32 {
        u32::MAX
    }

    fn sample(&self, index: u64, dimension: u32) -> f64 {
        let Grid { columns, rows } = self.grid;
        let (cell, key) = self.grid.cell(index, dimension / 2, self.seed);
        let [column, row] = [cell % columns, cell / columns];
        let jitter = f64_from_bits(combine(key, 2 * u64::from(cell) + u64::from(dimension % 2)));
        let [m, n] = [f64::from(columns), f64::from(rows)];
        // Listing 5: the sub-column is a permutation of the row, the sub-row one of the column.
        let x = if dimension.is_multiple_of(2) {
            let sub = f64::from(permute(row, rows, key as u32));
            (f64::from(column) + (sub + jitter) / n) / m
        } else {
            let sub = f64::from(permute(column, columns, (key >> 32) as u32));
            (f64::from(row) + (sub + jitter) / m) / n
        };
        x.clamp_unit()
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Unchecked"))]
struct Grid {
    columns: u32,
    rows: u32,
}

#[cfg(feature = "serde")]
read_through!(Grid { columns: u32, rows: u32 } => Self::new(columns, rows), SequenceError);

impl Grid {
    fn new(columns: u32, rows: u32) -> Result<Self, SequenceError> {
        match columns.checked_mul(rows) {
            None => Err(SequenceError::ImageTooLarge { width: columns, height: rows }),
            Some(0) => Err(SequenceError::NoPoints),
            Some(_) => Ok(Self { columns, rows }),
        }
    }

    /// The cell of a point in a pair of dimensions, and the random number of the grid it belongs to.
    fn cell(self, index: u64, pair: u32, seed: u64) -> (u32, u64) {
        let cells = self.columns * self.rows;
        let key = combine(combine(seed, u64::from(pair)), index / u64::from(cells));
        let i = (index % u64::from(cells)) as u32;
        (if pair == 0 { i } else { permute(i, cells, combine(key, 1) as u32) }, key)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;

    #[test]
    fn every_pair_is_stratified_in_every_set() {
        let (columns, rows) = (5, 3);
        for pair in [0, 1, 9] {
            for start in [0, 15, 15 << 40] {
                let jittered = Stratified::jittered(columns, rows, 4).unwrap();
                let multi = MultiJittered::new(columns, rows, 4).unwrap();
                let mut hit = vec![[0; 4]; 15];
                for i in start..start + 15 {
                    let cell = |x: f64, y: f64| (x * 5.0) as usize + 5 * (y * 3.0) as usize;
                    hit[cell(jittered.sample(i, 2 * pair), jittered.sample(i, 2 * pair + 1))][0] += 1;
                    let [x, y] = [multi.sample(i, 2 * pair), multi.sample(i, 2 * pair + 1)];
                    hit[cell(x, y)][1] += 1;
                    hit[(15.0 * x) as usize][2] += 1;
                    hit[(15.0 * y) as usize][3] += 1;
                }
                assert_eq!(hit, vec![[1; 4]; 15]);
            }
        }
    }

    #[test]
    fn refuses_empty_and_huge_grids() {
        assert_eq!(Stratified::regular(0, 3), Err(SequenceError::NoPoints));
        assert!(MultiJittered::new(1 << 16, 1 << 16, 0).is_err());
    }
}
