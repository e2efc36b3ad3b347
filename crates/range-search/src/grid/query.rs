//! Which slots a query has to look at.

use core::ops::{ControlFlow, Range};

use super::HashGrid;
use super::cells::{CellBounds, Layout};
use crate::ball::Ball;
use crate::closest::Closest;
use crate::index::RangeIndex;
use crate::neighbor::Neighbor;

/// Ranges of slots of a hashed query kept on the stack. More rows than half of that need the heap.
const FEW_RANGES: usize = 64;

impl HashGrid {
    /// Calls `f` with disjoint ranges of slots, in ascending order, that hold all points of the cells in a box.
    #[inline(always)]
    pub(super) fn for_each_range<B>(
        &self,
        (lower, upper): ([f32; 3], [f32; 3]),
        mut f: impl FnMut(Range<usize>) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        let query = CellBounds { min: self.scale.cell(lower), max: self.scale.cell(upper) };
        let Some(query) = self.bounds.intersect(&query) else { return ControlFlow::Continue(()) };
        if query == self.bounds || query.rows() > self.ids.len() as u64 {
            return f(0..self.ids.len());
        }
        match self.layout {
            Layout::Dense { .. } => {
                let (first, last) = (self.column(query.min[0]), self.column(query.max[0]) + 1);
                for z in query.range(2) {
                    for y in query.range(1) {
                        let row = self.layout.row(&self.bounds, y, z) as usize;
                        let slots = self.starts[row + first] as usize..self.starts[row + last] as usize;
                        if !slots.is_empty() {
                            f(slots)?;
                        }
                    }
                }
                ControlFlow::Continue(())
            }
            Layout::Hashed { mask } => self.for_each_hashed_range(&query, mask, &mut f),
        }
    }

    /// Number of a cell in its row.
    #[inline(always)]
    fn column(&self, x: i32) -> usize {
        x.wrapping_sub(self.bounds.min[0]) as u32 as usize
    }

    /// Rows overlap where different cells share a bucket: their union is what has to be visited.
    #[inline(never)]
    fn for_each_hashed_range<B>(
        &self,
        query: &CellBounds,
        mask: u32,
        f: &mut impl FnMut(Range<usize>) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        let buckets = mask as usize + 1;
        let columns = query.extent(0) as usize;
        if columns >= buckets {
            return f(0..self.ids.len());
        }
        let (mut on_stack, mut on_heap) = ([(0, 0); FEW_RANGES], Vec::new());
        let most = 2 * query.rows() as usize;
        let ranges: &mut [(u32, u32)] = if most <= FEW_RANGES {
            &mut on_stack
        } else {
            on_heap.resize(most, (0, 0));
            &mut on_heap
        };
        let mut count = 0;
        let mut add = |first: usize, last: usize| {
            let (start, end) = (self.starts[first], self.starts[last]);
            if start < end {
                ranges[count] = (start, end);
                count += 1;
            }
        };
        for z in query.range(2) {
            for y in query.range(1) {
                let first = self.layout.bucket(&self.bounds, [query.min[0], y, z]) as usize;
                add(first, (first + columns).min(buckets));
                // The rest of a row that reaches over the last bucket.
                add(0, (first + columns).saturating_sub(buckets));
            }
        }
        let ranges = &mut ranges[..count];
        ranges.sort_unstable();
        let mut done = 0;
        for &mut (start, end) in ranges {
            if end > done {
                f(start.max(done) as usize..end as usize)?;
                done = end;
            }
        }
        ControlFlow::Continue(())
    }

    /// Calls `f` with slot and squared distance of the points in the ball.
    #[inline(always)]
    fn scan<B>(&self, ball: &Ball, mut f: impl FnMut(usize, f32) -> ControlFlow<B>) -> ControlFlow<B> {
        if ball.is_everything() {
            return self.points.scan(0..self.ids.len(), ball, f);
        }
        self.for_each_range(ball.bounds(), |slots| self.points.scan(slots, ball, &mut f))
    }
}

impl RangeIndex for HashGrid {
    fn len(&self) -> usize {
        self.ids.len()
    }

    fn skipped(&self) -> usize {
        self.skipped
    }

    #[inline]
    fn try_for_each_within<B>(
        &self,
        center: [f32; 3],
        radius: f32,
        mut f: impl FnMut(usize, f32) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        let Some(ball) = Ball::new(center, radius) else { return ControlFlow::Continue(()) };
        self.scan(&ball, |slot, distance_squared| f(self.ids[slot] as usize, distance_squared))
    }

    /// Looks within growing radii, until there are enough points or no larger radius.
    fn k_nearest(&self, center: [f32; 3], k: usize, max_radius: f32, out: &mut Vec<Neighbor>) {
        out.clear();
        if k == 0 || self.ids.is_empty() || Ball::new(center, max_radius).is_none() {
            return;
        }
        let mut radius = self.first_radius(center, k).min(max_radius);
        loop {
            let mut closest = Closest::new(k, radius * radius, out);
            self.for_each_within(center, radius, |id, distance_squared| {
                closest.push(Neighbor::new(id as u32, distance_squared));
            });
            // Points that were not found are farther away than those that were.
            if closest.len() >= k.min(self.ids.len()) || radius >= max_radius {
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
