//! Which slots a query has to look at.

use core::ops::ControlFlow;

use super::HashGrid;
use super::cells::{CellBounds, Layout};
use crate::ball::Ball;
use crate::closest::Closest;
use crate::index::RangeIndex;
use crate::neighbor::Neighbor;

/// Ranges of slots kept on the stack. More rows than that (half of that, if hashed) need the heap.
const FEW_RANGES: usize = 32;

/// Ranges of slots.
struct Ranges {
    few: [(u32, u32); FEW_RANGES],
    many: Vec<(u32, u32)>,
    len: usize,
}

impl Ranges {
    /// Room for so many.
    #[inline(always)]
    fn new(most: usize) -> Self {
        let many = if most > FEW_RANGES { vec![(0, 0); most] } else { Vec::new() };
        Self { few: [(0, 0); FEW_RANGES], many, len: 0 }
    }

    #[inline(always)]
    fn all(&mut self) -> &mut [(u32, u32)] {
        if self.many.is_empty() { &mut self.few } else { &mut self.many }
    }

    /// Adds a range, if it is not empty: without a branch, which would have to wait for memory.
    #[inline(always)]
    fn push(&mut self, start: u32, end: u32) {
        let len = self.len;
        self.all()[len] = (start, end);
        self.len = len + usize::from(start < end);
    }

    /// Sorts ranges and makes them disjoint.
    fn unite(&mut self) {
        let len = self.len;
        let ranges = &mut self.all()[..len];
        ranges.sort_unstable();
        let mut done = 0;
        for (start, end) in ranges {
            *start = done.max(*start);
            *end = (*start).max(*end);
            done = *end;
        }
    }
}

impl HashGrid {
    /// Disjoint ranges of slots, in ascending order, that hold all points of the cells in a box.
    #[inline(always)]
    fn ranges(&self, (lower, upper): ([f32; 3], [f32; 3])) -> Ranges {
        let query = CellBounds { min: self.scale.cell(lower), max: self.scale.cell(upper) };
        let Some(query) = self.bounds.intersect(&query) else { return Ranges::new(0) };
        if query == self.bounds || query.rows() > self.points.len() as u64 {
            return self.everything();
        }
        match self.layout {
            Layout::Dense { .. } => self.dense_ranges(&query),
            Layout::Hashed { mask } => self.hashed_ranges(&query, mask),
        }
    }

    fn everything(&self) -> Ranges {
        let mut ranges = Ranges::new(1);
        ranges.push(0, self.points.len() as u32);
        ranges
    }

    #[inline(always)]
    fn dense_ranges(&self, query: &CellBounds) -> Ranges {
        let mut ranges = Ranges::new(query.rows() as usize);
        let first = (query.min[0] - self.bounds.min[0]) as usize;
        let columns = query.extent(0) as usize;
        for z in query.range(2) {
            for y in query.range(1) {
                let first = self.layout.row(&self.bounds, y, z) as usize + first;
                ranges.push(self.starts[first], self.starts[first + columns]);
            }
        }
        ranges
    }

    /// Rows overlap where different cells share a bucket: their union is what has to be visited.
    #[inline(never)]
    fn hashed_ranges(&self, query: &CellBounds, mask: u32) -> Ranges {
        let buckets = mask as usize + 1;
        let columns = query.extent(0) as usize;
        if columns >= buckets {
            return self.everything();
        }
        let mut ranges = Ranges::new(2 * query.rows() as usize);
        for z in query.range(2) {
            for y in query.range(1) {
                let first = self.layout.bucket(&self.bounds, [query.min[0], y, z]) as usize;
                ranges.push(self.starts[first], self.starts[(first + columns).min(buckets)]);
                // The rest of a row that reaches over the last bucket.
                ranges.push(0, self.starts[(first + columns).saturating_sub(buckets)]);
            }
        }
        ranges.unite();
        ranges
    }

    /// Calls `f` with id and squared distance of the points in the ball.
    #[inline(always)]
    fn scan<B>(&self, ball: &Ball, f: impl FnMut(usize, f32) -> ControlFlow<B>) -> ControlFlow<B> {
        let mut ranges = if ball.is_everything() { self.everything() } else { self.ranges(ball.bounds()) };
        let len = ranges.len;
        self.points.scan(ball, ranges.all()[..len].iter().map(|&(start, end)| start as usize..end as usize), f)
    }
}

impl RangeIndex for HashGrid {
    fn len(&self) -> usize {
        self.points.len()
    }

    fn skipped(&self) -> usize {
        self.skipped
    }

    #[inline]
    fn try_for_each_within<B>(
        &self,
        center: [f32; 3],
        radius: f32,
        f: impl FnMut(usize, f32) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        match Ball::new(center, radius) {
            Some(ball) => self.scan(&ball, f),
            None => ControlFlow::Continue(()),
        }
    }

    /// Looks within growing radii, until there are enough points or no larger radius.
    fn k_nearest(&self, center: [f32; 3], k: usize, max_radius: f32, out: &mut Vec<Neighbor>) {
        out.clear();
        if k == 0 || self.points.len() == 0 || Ball::new(center, max_radius).is_none() {
            return;
        }
        let mut radius = self.first_radius(center, k).min(max_radius);
        loop {
            let mut closest = Closest::new(k, radius * radius, out);
            self.for_each_within(center, radius, |id, distance_squared| {
                closest.push(Neighbor::new(id as u32, distance_squared));
            });
            // Points that were not found are farther away than those that were.
            if closest.len() >= k.min(self.points.len()) || radius >= max_radius {
                return closest.finish();
            }
            radius = grown(radius, closest.len(), k).min(max_radius);
        }
    }
}

impl HashGrid {
    /// A radius that may hold `k` points.
    fn first_radius(&self, _center: [f32; 3], _k: usize) -> f32 {
        self.scale.size
    }
}

/// The next radius to try.
fn grown(radius: f32, _found: usize, _k: usize) -> f32 {
    2.0 * radius
}
