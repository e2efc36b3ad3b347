//! Projection maps: photons only where caustic generators are.

use std::f64::consts::{PI, TAU};

use crate::sphere::below_one;
use crate::vector::normalise;

/// A cell of a grid on the unit square.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    column: u32,
    row: u32,
    columns: u32,
    rows: u32,
}

impl Cell {
    /// The point of the unit square at a place of the cell: `[0, 0]` is its corner of least coordinates.
    #[must_use]
    pub fn at(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        [(f64::from(self.column) + u) / f64::from(self.columns), (f64::from(self.row) + v) / f64::from(self.rows)]
    }

    /// Half the angle of a cone around the cell's centre that holds all its directions under
    /// [`sphere_direction`](crate::sphere_direction).
    ///
    /// With at least two columns no point is farther from the centre than the corners: for equal `z` the angle grows
    /// with the difference of azimuths, and along a meridian at most 90 degrees off its cosine is concave.
    fn half_angle(&self) -> f64 {
        if self.columns < 2 {
            return PI;
        }
        let z = |v: f64| 1.0 - 2.0 * self.at([0.5, v])[1];
        let radius = |z: f64| (1.0 - z * z).max(0.0).sqrt();
        let (centre, turn) = (z(0.5), (0.5 * TAU / f64::from(self.columns)).cos());
        let angle = |z: f64| (centre * z + radius(centre) * radius(z) * turn).clamp(-1.0, 1.0).acos();
        angle(z(0.0)).max(angle(z(1.0)))
    }
}

/// Why there is no such projection map.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProjectionError {
    /// No cell, or too many to count.
    #[error("a projection map of {columns} x {rows} cells: both are at least 1, their product below 2^31")]
    Resolution {
        /// Columns.
        columns: u32,
        /// Rows.
        rows: u32,
    },
    /// A cone without axis or angle.
    #[error("cone {0} has no direction, or its half angle is not in [0, pi]")]
    Cone(usize),
}

/// Which parts of a light's emission meet caustic generators, so that photons for **direct** caustics are shot
/// nowhere else.
///
/// ```text
/// integral over [0,1)^2 of g(u) du  =  s E g(U),     U uniform in the marked cells,  s = marked / all cells
/// ```
///
/// **Symbols.** `u`: the two random numbers that the light's own sampling turns into a direction; `g`: what the
/// photons of such a path contribute, zero outside of the marked cells. `s`: [`share`](Self::share). Being a map of
/// the random numbers, it goes with any light; multiply the flux by `s`.
///
/// **Assumptions.** `g = 0` outside of the marked cells: unmarked cells hit no caustic generator first. **Unbiased**
/// then for caustics of light that comes directly from the light (`L S+ D`), biased otherwise: marks have to be
/// conservative, as those of [`for_cones`](Self::for_cones) around bounding spheres are. Caustics of indirect light
/// are out of reach of this method; [`MapPartition`](crate::MapPartition) has them all. If other paths fill the
/// caustic map as well, they must leave out what this one makes: photons of first emission in a marked cell
/// ([`contains`](Self::contains)) with specular bounces only.
///
/// **Cost.** One multiplication per sample; four bytes per marked cell, one bit per cell.
///
/// **Source.** H. W. Jensen and N. J. Christensen, "Photon maps in bidirectional Monte Carlo ray tracing of complex
/// objects", Computers & Graphics 19(2), 1995. Keller and Wald 2000 compares with it in section 2.2.
///
/// # Example
/// ```
/// use photon_map::{ProjectionMap, sphere_direction};
/// // A point light that emits 10 W into all directions, a glass sphere above it that it sees under 2 x 0.2 rad.
/// let projection = ProjectionMap::for_cones(64, 64, &[([0.0, 0.0, 2.0], 0.2)])?;
/// let u = projection.sample([0.3, 0.8]).ok_or("no generator")?;
/// let (direction, flux) = (sphere_direction(u), 10.0 * projection.share());
/// assert!(direction[2] > 0.9 && flux < 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ProjectionMap {
    columns: u32,
    rows: u32,
    marked: Vec<u32>,
    bits: Vec<u64>,
}

impl ProjectionMap {
    /// Asks for each cell whether light that is emitted there may meet a caustic generator.
    ///
    /// # Errors
    /// [`ProjectionError::Resolution`] if a side has no cell, or there are `2^31` cells or more.
    pub fn new(columns: u32, rows: u32, mut marks: impl FnMut(Cell) -> bool) -> Result<Self, ProjectionError> {
        let cells = u64::from(columns) * u64::from(rows);
        if cells == 0 || cells >= 1 << 31 {
            return Err(ProjectionError::Resolution { columns, rows });
        }
        let mut map = Self { columns, rows, marked: Vec::new(), bits: vec![0; cells.div_ceil(64) as usize] };
        for index in 0..cells as u32 {
            if marks(Cell { column: index % columns, row: index / columns, columns, rows }) {
                map.marked.push(index);
                map.bits[index as usize / 64] |= 1 << (index % 64);
            }
        }
        Ok(map)
    }

    /// Marks the cells that meet cones (axis, half angle in radians), for lights that use
    /// [`sphere_direction`](crate::sphere_direction).
    ///
    /// A sphere of radius `R` at distance `d` is a cone of half angle `asin(R / d)`; within it, of `pi`.
    ///
    /// # Errors
    /// [`ProjectionError`] for a resolution as in [`new`](Self::new), an axis of no direction, or an angle outside of
    /// `[0, pi]`.
    pub fn for_cones(columns: u32, rows: u32, cones: &[([f32; 3], f32)]) -> Result<Self, ProjectionError> {
        // Round-off of axes and centres in f32.
        const MARGIN: f64 = 1e-5;
        let axis = |(index, &(axis, half_angle)): (usize, &([f32; 3], f32))| match normalise(axis) {
            Some(axis) if (0.0..=std::f32::consts::PI).contains(&half_angle) => Ok((axis, f64::from(half_angle))),
            _ => Err(ProjectionError::Cone(index)),
        };
        let cones = cones.iter().enumerate().map(axis).collect::<Result<Vec<_>, _>>()?;
        Self::new(columns, rows, |cell| {
            let (centre, reach) =
                (crate::sphere_direction(cell.at([0.5, 0.5])).map(f64::from), cell.half_angle() + MARGIN);
            cones.iter().any(|(axis, half_angle)| {
                let cosine: f64 = centre.iter().zip(axis).map(|(a, &b)| a * f64::from(b)).sum();
                cosine.clamp(-1.0, 1.0).acos() <= half_angle + reach
            })
        })
    }

    /// The share of the unit square that is marked: what the flux is to be multiplied by.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.marked.len() as f64 / (f64::from(self.columns) * f64::from(self.rows))
    }

    /// A point in the marked cells, uniformly; `None` if no cell is marked.
    ///
    /// The first number chooses the cell and the place in it, so low-discrepancy points stay stratified along one axis.
    /// Numbers outside of `[0, 1)` count as the nearest in it, NaN as zero.
    #[must_use]
    pub fn sample(&self, [u, v]: [f64; 2]) -> Option<[f64; 2]> {
        let scaled = u * self.marked.len() as f64;
        let chosen = (scaled as usize).min(self.marked.len().checked_sub(1)?);
        let index = self.marked[chosen];
        // Adding the place in the cell may round up to the next cell, which need not be marked.
        let place = |cell: u32, within: f64, cells: u32| {
            let place = (f64::from(cell) + below_one(within)) / f64::from(cells);
            if place * f64::from(cells) < f64::from(cell) + 1.0 { place } else { place * (1.0 - f64::EPSILON) }
        };
        let column = place(index % self.columns, scaled - chosen as f64, self.columns);
        Some([column, place(index / self.columns, v, self.rows)])
    }

    /// Whether a point of the unit square lies in a marked cell; no, if it lies outside of the square.
    #[must_use]
    pub fn contains(&self, [u, v]: [f64; 2]) -> bool {
        if !((0.0..1.0).contains(&u) && (0.0..1.0).contains(&v)) {
            return false;
        }
        let (column, row) = ((u * f64::from(self.columns)) as u32, (v * f64::from(self.rows)) as u32);
        let index = row.min(self.rows - 1) * self.columns + column.min(self.columns - 1);
        self.bits[index as usize / 64] >> (index % 64) & 1 == 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A regular grid of numbers integrates a function that is constant in cells exactly.
    #[test]
    fn restricted_emission_integrates_what_lies_in_the_marked_cells() {
        let marks = |cell: Cell| (cell.column * 7 + cell.row * 3).is_multiple_of(4);
        let map = ProjectionMap::new(8, 6, marks).unwrap();
        let value =
            |u: [f64; 2]| if map.contains(u) { (u[0] * 8.0).floor() + 10.0 * (u[1] * 6.0).floor() } else { 0.0 };
        let grid = |columns: u32, rows: u32| {
            let cell = move |i: u32| Cell { column: i % columns, row: i / columns, columns, rows }.at([0.5, 0.5]);
            (0..columns * rows).map(cell)
        };
        let all = grid(8, 6).map(value).sum::<f64>() / 48.0;
        let marked = map.marked.len() as u32;
        let sampled = grid(marked, 6).map(|u| value(map.sample(u).unwrap())).sum::<f64>() / f64::from(marked * 6);
        assert!((map.share() * sampled - all).abs() < 1e-12);
        assert!(grid(97, 31).all(|u| map.contains(map.sample(u).unwrap())));
    }

    #[test]
    fn cones_are_marked_conservatively() {
        let mut uniforms = estimator_checks::Uniforms::named("cones");
        for (columns, rows) in [(1, 3), (2, 2), (3, 1), (16, 8), (40, 64)] {
            for half_angle in [0.0, 0.1, 0.7, 2.0] {
                let axis = crate::sphere_direction(uniforms.array());
                let map = ProjectionMap::for_cones(columns, rows, &[(axis, half_angle)]).unwrap();
                for _ in 0..2000 {
                    let square = uniforms.array();
                    let direction = crate::sphere_direction(square);
                    let cosine: f32 = direction.iter().zip(axis).map(|(a, b)| a * b).sum();
                    assert!(cosine < half_angle.cos() || map.contains(square), "{columns} x {rows}, {half_angle}");
                }
                assert!(map.contains(crate::sphere_square(axis).unwrap()));
            }
        }
        let fine = ProjectionMap::for_cones(64, 64, &[([1.0, 0.0, 0.0], 0.2)]).unwrap();
        let exact = 0.5 * (1.0 - 0.2_f64.cos());
        assert!(fine.share() > exact && fine.share() < 2.5 * exact, "{} {exact}", fine.share());
    }

    #[test]
    fn nonsense_is_answered_as_documented() {
        assert!(matches!(ProjectionMap::new(0, 4, |_| true), Err(ProjectionError::Resolution { .. })));
        assert!(matches!(ProjectionMap::new(1 << 16, 1 << 15, |_| true), Err(ProjectionError::Resolution { .. })));
        for cone in [([0.0; 3], 0.1), ([1.0, 0.0, 0.0], f32::NAN), ([1.0, 0.0, 0.0], 4.0)] {
            assert_eq!(ProjectionMap::for_cones(2, 2, &[cone]), Err(ProjectionError::Cone(0)));
        }
        let none = ProjectionMap::for_cones(8, 8, &[]).unwrap();
        assert_eq!((none.sample([0.5, 0.5]), none.share()), (None, 0.0));
        let all = ProjectionMap::new(2, 2, |_| true).unwrap();
        assert!(!all.contains([f64::NAN, 0.5]) && !all.contains([1.0, 0.5]) && all.contains([0.99, 0.0]));
        assert_eq!(all.share(), 1.0);
        assert_eq!(all.sample([f64::NAN, -1.0]), Some([0.0, 0.0]));
        assert!(all.sample([2.0, 2.0]).is_some_and(|u| all.contains(u)));
    }
}
