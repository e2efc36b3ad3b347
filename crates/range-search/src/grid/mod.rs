//! A grid of cells, whose points lie together.

mod build;
mod cells;
mod query;
mod self_query;

use crate::error::BuildError;
use crate::lanes::Lanes;
use cells::{CellBounds, Layout, Scale};
pub use self_query::{Neighbourhood, QueryRadius, SelfQuery};

/// A grid of cubic cells over all of space; the points of a cell lie together, in the order of their ids.
///
/// Built by counting sort. Cells are numbered densely, row by row, if their bounding box has at most four for a point;
/// otherwise rows are hashed. Different cells may then share a bucket, but queries visit the union of the buckets and test
/// every point in it: nothing is found twice, nothing missed.
///
/// The cell size is a matter of speed alone. Queries are fastest with a radius of about the cell size; a smaller radius needs no
/// new grid, and a larger one costs its cells. If a query's box has more rows of cells than there are points, it tests all points.
///
/// Order of visits: ascending *slots*, which are positions in the grid's own order ([`order`](Self::order)): by cells, and by
/// ids within. Callers that keep their payloads in this order ([`reorder`](Self::reorder)) read them almost one after the other.
///
/// Cost: building is linear, one sort into buckets. A query tests the points in the cells that its box meets. Memory:
/// 16 bytes per point, and 4 for each bucket, of which there are at most four per point.
///
/// Source: counting sort into cells as in S. Green, *Particle Simulation using CUDA* (2010); hashed cells after M. Teschner et al.,
/// *Optimized Spatial Hashing for Collision Detection of Deformable Objects* (VMV 2003).
///
/// ```
/// use range_search::{HashGrid, RangeIndex};
/// struct Photon { position: [f32; 3], flux: f32 }
/// let photons = [[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [2.0, 0.0, 0.0]].map(|position| Photon { position, flux: 0.25 });
/// let grid = HashGrid::build(&photons, |photon| photon.position, 1.0)?;
///
/// let mut flux = 0.0;
/// grid.for_each_within([0.1, 0.0, 0.0], 1.0, |id, _distance_squared| flux += photons[id].flux);
/// assert_eq!(flux, 0.5);
/// assert_eq!(grid.nearest([1.9, 0.0, 0.0]).map(|neighbour| neighbour.id()), Some(2));
/// # Ok::<(), range_search::BuildError>(())
/// ```
#[derive(Clone, Debug)]
pub struct HashGrid {
    /// In the order of slots.
    points: Lanes,
    /// Where the slots of each bucket start, and where those of the last one end.
    starts: Vec<u32>,
    scale: Scale,
    /// Of the cells with points.
    bounds: CellBounds,
    layout: Layout,
    skipped: usize,
}

impl HashGrid {
    /// A grid over points anywhere in a payload. `position` is called more than once for a point and has to give the same each time;
    /// if it does not, neither do queries.
    ///
    /// # Errors
    /// If the cell size is not positive and finite, or there are more points than ids.
    pub fn build<P>(points: &[P], position: impl Fn(&P) -> [f32; 3], cell_size: f32) -> Result<Self, BuildError> {
        build::build(points, position, cell_size)
    }

    /// The same grid, built on all threads of rayon's pool.
    ///
    /// # Errors
    /// As [`build`](Self::build).
    #[cfg(feature = "rayon")]
    pub fn par_build<P: Sync>(
        points: &[P],
        position: impl Fn(&P) -> [f32; 3] + Sync,
        cell_size: f32,
    ) -> Result<Self, BuildError> {
        build::par_build(points, position, cell_size)
    }

    /// Edge length of the cells.
    pub fn cell_size(&self) -> f32 {
        self.scale.size
    }

    /// The ids in the order of slots.
    pub fn order(&self) -> impl ExactSizeIterator<Item = usize> + '_ {
        (0..self.points.len()).map(|slot| self.points.id(slot) as usize)
    }

    /// The id of the point in a slot.
    ///
    /// # Panics
    /// If there is no such slot.
    #[inline]
    pub fn id(&self, slot: usize) -> usize {
        assert!(slot < self.points.len(), "slot {slot} of {}", self.points.len());
        self.points.id(slot) as usize
    }

    /// The position of the point in a slot.
    ///
    /// # Panics
    /// If there is no such slot.
    pub fn position(&self, slot: usize) -> [f32; 3] {
        assert!(slot < self.points.len(), "slot {slot} of {}", self.points.len());
        self.points.position(slot)
    }

    /// Payloads in the order of slots: what belongs to `payloads[id]` comes to the slot of that id.
    ///
    /// # Panics
    /// If there are fewer payloads than there were points.
    pub fn reorder<T: Clone>(&self, payloads: &[T]) -> Vec<T> {
        self.order().map(|id| payloads[id].clone()).collect()
    }

    /// The grid over reordered payloads, whose ids are slots: what building it again over them would give, bit for bit.
    /// Nothing is skipped any more.
    ///
    /// ```
    /// use range_search::{HashGrid, RangeIndex};
    /// let points = [[2.0_f32, 0.0, 0.0], [0.0, 0.0, 0.0], [0.5, 0.0, 0.0]];
    /// let grid = HashGrid::build(&points, |p| *p, 1.0)?;
    /// let sorted = grid.reorder(&points);
    /// let grid = grid.renumbered();
    /// grid.for_each_within([0.0; 3], 1.0, |slot, d2| assert_eq!(range_search::distance_squared(sorted[slot], [0.0; 3]), d2));
    /// # Ok::<(), range_search::BuildError>(())
    /// ```
    ///
    /// The grid of the old numbers is gone, so that these cannot be taken for slots:
    ///
    /// ```compile_fail,E0382
    /// use range_search::{HashGrid, RangeIndex};
    /// let points = [[2.0_f32, 0.0, 0.0], [0.0, 0.0, 0.0], [0.5, 0.0, 0.0]];
    /// let grid = HashGrid::build(&points, |p| *p, 1.0)?;
    /// let sorted = grid.reorder(&points);
    /// let renumbered = grid.renumbered();
    /// grid.for_each_within([0.0; 3], 1.0, |slot, d2| assert_eq!(range_search::distance_squared(sorted[slot], [0.0; 3]), d2));
    /// # Ok::<(), range_search::BuildError>(())
    /// ```
    #[must_use]
    pub fn renumbered(mut self) -> Self {
        self.points.number();
        Self { skipped: 0, ..self }
    }

    /// Undoes [`reorder`](Self::reorder): what is in a slot goes to `out[id]`. Ids of points that were skipped keep what they have.
    ///
    /// # Panics
    /// If `out` is shorter than the input was.
    pub fn restore<T: Clone>(&self, slots: &[T], out: &mut [T]) {
        for (id, value) in self.order().zip(slots) {
            out[id] = value.clone();
        }
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        self.points.bytes() + size_of::<u32>() * self.starts.capacity()
    }
}
