//! All points of a grid asked for their neighbours.

use super::HashGrid;
use crate::ball::Ball;
use crate::lanes::Candidates;

/// Slots that one thread works on at a time.
#[cfg(feature = "rayon")]
const CHUNK: usize = 1 << 12;
/// Queries of a cell that share their candidates, at most.
const MOST_QUERIES: usize = 64;

/// How far the points of a grid look for neighbours: all as far (`f32`), or each as far as a closure says of its slot.
///
/// Where the radius is negative or NaN nothing is looked for.
///
/// Dyn compatible: `&dyn QueryRadius`.
pub trait QueryRadius {
    /// Radius of the point in a slot. Asked more than once for a point; the answer has to be the same.
    fn at(&self, slot: usize) -> f32;
}

// Its docs say so.
const _: Option<&dyn QueryRadius> = None;

impl QueryRadius for f32 {
    #[inline(always)]
    fn at(&self, _: usize) -> f32 {
        *self
    }
}

impl<F: Fn(usize) -> f32> QueryRadius for F {
    #[inline(always)]
    fn at(&self, slot: usize) -> f32 {
        self(slot)
    }
}

/// The neighbours of every point of a grid: data are queries.
///
/// The queries of a cell share their candidates, which are copied together once; each query then tests them in one go. Results are as
/// if [`for_each_within`](crate::RangeIndex::for_each_within) were asked at each point: same neighbours, same order, same squared
/// distances. A point is its own neighbour.
///
/// Queries are made in the order of slots. Cost: linear in the number of points for a given number of neighbours. Memory: that of the
/// candidates of a cell.
///
/// ```
/// use range_search::HashGrid;
/// let heights = [1.0_f32, 3.0, 10.0];
/// let grid = HashGrid::build(&[[0.0_f32, 0.0, 0.0], [0.5, 0.0, 0.0], [9.0, 0.0, 0.0]], |p| *p, 1.0)?;
/// let mut means = [0.0; 3];
/// grid.self_query(1.0).for_each(|neighbourhood| {
///     let sum: f32 = neighbourhood.iter().map(|(id, _distance_squared)| heights[id]).sum();
///     means[neighbourhood.id()] = sum / neighbourhood.len() as f32;
/// });
/// assert_eq!(means, [2.0, 2.0, 10.0]);
/// # Ok::<(), range_search::BuildError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct SelfQuery<'a, R = f32> {
    grid: &'a HashGrid,
    radius: R,
}

/// A point and its neighbours.
#[derive(Clone, Copy, Debug)]
pub struct Neighbourhood<'a> {
    grid: &'a HashGrid,
    slot: usize,
    position: [f32; 3],
    slots: &'a [u32],
    distances_squared: &'a [f32],
}

impl<'a> Neighbourhood<'a> {
    /// The point, as a position in the input.
    #[inline]
    pub fn id(&self) -> usize {
        self.grid.points.id(self.slot) as usize
    }

    /// The point, as a position in the grid's order.
    #[inline]
    pub fn slot(&self) -> usize {
        self.slot
    }

    /// Where the point is.
    #[inline]
    pub fn position(&self) -> [f32; 3] {
        self.position
    }

    /// Number of neighbours, the point itself among them. Zero if the radius is negative or NaN.
    #[inline]
    pub fn len(&self) -> usize {
        self.slots.len()
    }

    /// Whether there are no neighbours, not even the point itself.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.slots.is_empty()
    }

    /// The neighbours as positions in the grid's order, ascending: for payloads that were [reordered](HashGrid::reorder).
    #[inline]
    pub fn slots(&self) -> &'a [u32] {
        self.slots
    }

    /// Squared distances of the neighbours, in the same order.
    #[inline]
    pub fn distances_squared(&self) -> &'a [f32] {
        self.distances_squared
    }

    /// Ids and squared distances of the neighbours, in the same order.
    #[inline]
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (usize, f32)> + 'a {
        let grid = self.grid;
        let id = move |&slot: &u32| grid.points.id(slot as usize) as usize;
        self.slots.iter().map(id).zip(self.distances_squared.iter().copied())
    }
}

impl HashGrid {
    /// The neighbours of all points within a radius, which need not be the cell size, nor the same for all points. For other radii see the
    /// table of [`RangeIndex`](crate::RangeIndex): where nothing is found, neighbourhoods are empty.
    ///
    /// ```
    /// use range_search::HashGrid;
    /// let grid = HashGrid::build(&[[0.0_f32, 0.0, 0.0], [0.5, 0.0, 0.0], [0.9, 0.0, 0.0]], |p| *p, 1.0)?;
    /// let radii = [1.0, 0.45, -1.0];
    /// let counts = grid.self_query(|slot| radii[grid.id(slot)]).map(|neighbourhood| neighbourhood.len());
    /// assert_eq!(counts, [3, 2, 0]);
    /// # Ok::<(), range_search::BuildError>(())
    /// ```
    pub fn self_query<R: QueryRadius>(&self, radius: R) -> SelfQuery<'_, R> {
        SelfQuery { grid: self, radius }
    }
}

impl<R: QueryRadius> SelfQuery<'_, R> {
    /// Calls `f` with the neighbourhood of each point, in the order of slots.
    pub fn for_each(&self, mut f: impl FnMut(Neighbourhood<'_>)) {
        self.visit(0..self.grid.points.len(), &mut f);
    }

    /// Calls `f` with the neighbourhoods of the points in a range of slots, in their order: for loops over parts of the grid.
    ///
    /// # Panics
    /// If there are no such slots.
    pub fn for_each_in(&self, slots: core::ops::Range<usize>, mut f: impl FnMut(Neighbourhood<'_>)) {
        assert!(slots.end <= self.grid.points.len(), "slots {slots:?} of {}", self.grid.points.len());
        self.visit(slots, &mut f);
    }

    /// What `f` makes of each neighbourhood, in the order of slots; [`HashGrid::restore`] brings it into the order of the input.
    pub fn map<T>(&self, mut f: impl FnMut(Neighbourhood<'_>) -> T) -> Vec<T> {
        let mut results = Vec::with_capacity(self.grid.points.len());
        self.for_each(|neighbourhood| results.push(f(neighbourhood)));
        results
    }

    /// As [`for_each`](Self::for_each), on all threads of rayon's pool: the same neighbourhoods, in any order.
    #[cfg(feature = "rayon")]
    pub fn par_for_each(&self, f: impl Fn(Neighbourhood<'_>) + Sync)
    where
        R: Sync,
    {
        use rayon::prelude::*;
        self.chunks().for_each(|slots| self.visit(slots, &mut &f));
    }

    /// As [`map`](Self::map), on all threads of rayon's pool: the same result.
    #[cfg(feature = "rayon")]
    pub fn par_map<T: Send>(&self, f: impl Fn(Neighbourhood<'_>) -> T + Sync) -> Vec<T>
    where
        R: Sync,
    {
        use rayon::prelude::*;
        let results: Vec<Vec<T>> = self
            .chunks()
            .map(|slots| {
                let mut results = Vec::with_capacity(slots.len());
                self.visit(slots, &mut |neighbourhood| results.push(f(neighbourhood)));
                results
            })
            .collect();
        results.into_iter().flatten().collect()
    }

    #[cfg(feature = "rayon")]
    fn chunks(&self) -> impl rayon::iter::IndexedParallelIterator<Item = core::ops::Range<usize>> + use<R> {
        use rayon::prelude::*;
        let len = self.grid.points.len();
        (0..len.div_ceil(CHUNK)).into_par_iter().map(move |chunk| chunk * CHUNK..((chunk + 1) * CHUNK).min(len))
    }

    /// Neighbourhoods of the points in a range of slots.
    fn visit(&self, slots: core::ops::Range<usize>, f: &mut impl FnMut(Neighbourhood<'_>)) {
        let grid = self.grid;
        let mut candidates = Candidates::default();
        let mut start = slots.start;
        while start < slots.end {
            // Take the points of one cell.
            let first = grid.points.position(start);
            let cell = grid.scale.cell(first);
            let (mut min, mut max) = (first, first);
            let mut radius = self.radius.at(start);
            let mut end = start + 1;
            while end < slots.end.min(start + MOST_QUERIES) {
                let position = grid.points.position(end);
                if grid.scale.cell(position) != cell {
                    break;
                }
                for axis in 0..3 {
                    min[axis] = min[axis].min(position[axis]);
                    max[axis] = max[axis].max(position[axis]);
                }
                // The other one if one is NaN.
                radius = radius.max(self.radius.at(end));
                end += 1;
            }
            // Gather what may be near any of them, as far as the one looks that looks farthest.
            if let (Some(lower), Some(upper)) = (Ball::new(min, radius), Ball::new(max, radius)) {
                let ranges = if lower.is_everything() {
                    grid.ranges_of(&lower)
                } else {
                    grid.ranges((lower.bounds().0, upper.bounds().1))
                };
                candidates.gather(&grid.points, ranges.iter());
            }
            // Test it for each of them.
            for slot in start..end {
                let position = grid.points.position(slot);
                let (slots, distances_squared) = match Ball::new(position, self.radius.at(slot)) {
                    Some(ball) => candidates.find(&ball),
                    None => (&[][..], &[][..]),
                };
                f(Neighbourhood { grid, slot, position, slots, distances_squared });
            }
            start = end;
        }
    }
}
