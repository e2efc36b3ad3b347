//! Which cell a coordinate falls in, and which bucket a cell falls in.

use core::ops::RangeInclusive;

/// Buckets are laid out densely if there are at most so many for a point.
const DENSE_BUCKETS_PER_POINT: u64 = 4;
/// However few points there are, so many buckets are no burden.
const FEW_BUCKETS: u64 = 64;

/// A cell's coordinates. Far out they saturate: the outermost cells reach to infinity.
pub(crate) type Cell = [i32; 3];

/// Maps points to cells, monotonically along each axis: that is all that queries rely on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale {
    pub(crate) size: f32,
    inverse: f32,
}

impl Scale {
    pub(crate) fn new(size: f32) -> Self {
        Self { size, inverse: 1.0 / size }
    }

    /// `floor(x / size)`, saturating. The origin of cells is zero, so that a point far out costs the others no precision.
    #[inline(always)]
    pub(crate) fn coordinate(self, x: f32) -> i32 {
        // Casts saturate and truncate. NaN, which only 0 times infinity gives, becomes 0.
        let scaled = x * self.inverse;
        let truncated = scaled as i32;
        truncated.saturating_sub(i32::from(truncated as f32 > scaled))
    }

    #[inline(always)]
    pub(crate) fn cell(self, point: [f32; 3]) -> Cell {
        point.map(|x| self.coordinate(x))
    }
}

/// Bounds of cells, both ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CellBounds {
    pub(crate) min: Cell,
    pub(crate) max: Cell,
}

impl CellBounds {
    /// What is common; nothing if there is nothing.
    #[inline(always)]
    pub(crate) fn intersect(&self, other: &Self) -> Option<Self> {
        let [x, y, z] = [0, 1, 2].map(|axis| self.min[axis].max(other.min[axis]));
        let [u, v, w] = [0, 1, 2].map(|axis| self.max[axis].min(other.max[axis]));
        (x <= u && y <= v && z <= w).then_some(Self { min: [x, y, z], max: [u, v, w] })
    }

    #[inline(always)]
    pub(crate) fn range(&self, axis: usize) -> RangeInclusive<i32> {
        self.min[axis]..=self.max[axis]
    }

    /// Cells along an axis, up to `2^32`.
    #[inline(always)]
    pub(crate) fn extent(&self, axis: usize) -> u64 {
        (i64::from(self.max[axis]) - i64::from(self.min[axis]) + 1).max(0) as u64
    }

    /// Rows of cells along the first axis.
    #[inline(always)]
    pub(crate) fn rows(&self) -> u64 {
        self.extent(1).saturating_mul(self.extent(2))
    }
}

/// Maps rows of cells to buckets. The cells of a row have consecutive buckets, so that a row of a query is one range of slots.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Layout {
    /// Each cell has a bucket of its own: row by row, layer by layer.
    Dense {
        /// Buckets from row to row.
        row: u32,
        /// Buckets from layer to layer.
        layer: u32,
    },
    /// Rows begin at a hash of their coordinates, and continue from the last bucket to the first.
    Hashed {
        /// Number of buckets, a power of two, less one.
        mask: u32,
    },
}

impl Layout {
    /// A layout for cells within bounds, and its number of buckets.
    pub(crate) fn new(bounds: &CellBounds, points: usize) -> (Self, usize) {
        let points = points as u64;
        if points == 0 {
            return (Self::Hashed { mask: 0 }, 1);
        }
        let dense = bounds.extent(0).saturating_mul(bounds.rows());
        let limit = (DENSE_BUCKETS_PER_POINT * points).clamp(FEW_BUCKETS, 1 << 31);
        if dense <= limit {
            let row = bounds.extent(0) as u32;
            return (Self::Dense { row, layer: row * bounds.extent(1) as u32 }, dense as usize);
        }
        let buckets = points.next_power_of_two().clamp(FEW_BUCKETS, 1 << 31);
        (Self::Hashed { mask: (buckets - 1) as u32 }, buckets as usize)
    }

    /// The bucket of the first cell (of the bounds) in a row.
    #[inline(always)]
    pub(crate) fn row(&self, bounds: &CellBounds, y: i32, z: i32) -> u32 {
        let (y, z) = (y.wrapping_sub(bounds.min[1]) as u32, z.wrapping_sub(bounds.min[2]) as u32);
        match *self {
            Self::Dense { row, layer } => y * row + z * layer,
            Self::Hashed { mask } => hash(y, z) & mask,
        }
    }

    /// The bucket of a cell within the bounds.
    #[inline(always)]
    pub(crate) fn bucket(&self, bounds: &CellBounds, [x, y, z]: Cell) -> u32 {
        let bucket = self.row(bounds, y, z).wrapping_add(x.wrapping_sub(bounds.min[0]) as u32);
        match *self {
            Self::Dense { .. } => bucket,
            Self::Hashed { mask } => bucket & mask,
        }
    }
}

/// Mixes two coordinates (multiplication and shifts as in the finaliser of MurmurHash3, Appleby 2011).
#[inline(always)]
fn hash(y: u32, z: u32) -> u32 {
    let mut h = u64::from(y) | (u64::from(z) << 32);
    h = (h ^ (h >> 33)).wrapping_mul(0xff51_afd7_ed55_8ccd);
    h = (h ^ (h >> 33)).wrapping_mul(0xc4ce_b9fe_1a85_ec53);
    (h >> 32) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_floors_and_saturate() {
        let scale = Scale::new(0.5);
        let cases = [(0.0, 0), (-0.0, 0), (0.49, 0), (0.5, 1), (-0.01, -1), (-0.5, -1), (-0.51, -2)];
        for (x, cell) in cases {
            assert_eq!(scale.coordinate(x), cell, "{x}");
        }
        assert_eq!(scale.coordinate(f32::MAX), i32::MAX);
        assert_eq!(scale.coordinate(f32::MIN), i32::MIN);
        assert_eq!(Scale::new(1e-45).cell([0.0, 1e-45, -1e-45]), [0, i32::MAX, i32::MIN]);
    }

    #[test]
    fn coordinates_are_monotone_across_borders_and_saturation() {
        for size in [1e-3, 0.1, 0.7, 1.0, 3.0e4] {
            let scale = Scale::new(size);
            for start in [0.0_f32, 1.0, 123.4, 1e7, 2.0e6, -5.0, -2.147e6] {
                let mut x = start;
                for _ in 0..2000 {
                    let next = x.next_up();
                    assert!(scale.coordinate(x) <= scale.coordinate(next), "{size}: {x} {next}");
                    x = next;
                }
            }
        }
    }

    #[test]
    fn dense_layouts_give_each_cell_its_own_bucket() {
        let bounds = CellBounds { min: [-1, 2, -3], max: [2, 4, -2] };
        let (layout, buckets) = Layout::new(&bounds, 24);
        let mut seen = vec![false; buckets];
        for z in bounds.range(2) {
            for y in bounds.range(1) {
                for x in bounds.range(0) {
                    assert!(!core::mem::replace(&mut seen[layout.bucket(&bounds, [x, y, z]) as usize], true));
                }
            }
        }
        assert!(seen.into_iter().all(|seen| seen));
    }
}
