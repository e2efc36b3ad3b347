//! Which slots a query has to look at.

use core::convert::Infallible;
use core::ops::{ControlFlow, Range};

use super::HashGrid;
use super::cells::{CellBounds, Layout};
use crate::ball::Ball;
use crate::closest::Closest;
use crate::index::RangeIndex;
use crate::neighbour::Neighbour;

/// Ranges of slots kept on the stack. More rows than that (half of that, if hashed) need the heap.
const FEW_RANGES: usize = 32;

/// Ranges of slots.
pub(super) struct Ranges {
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

    /// The ranges.
    #[inline(always)]
    pub(super) fn iter(&self) -> impl Iterator<Item = Range<usize>> + Clone + '_ {
        let all = if self.many.is_empty() { &self.few[..] } else { &self.many };
        all[..self.len].iter().map(|&(start, end)| start as usize..end as usize)
    }

    /// Number of slots, once ranges are disjoint.
    #[inline(always)]
    pub(super) fn count(&self) -> usize {
        self.iter().map(|slots| slots.len()).sum()
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
    pub(super) fn ranges(&self, (lower, upper): ([f32; 3], [f32; 3])) -> Ranges {
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

    /// Disjoint ranges of slots, in ascending order, that hold all points in the ball.
    #[inline(always)]
    pub(super) fn ranges_of(&self, ball: &Ball) -> Ranges {
        if ball.is_everything() { self.everything() } else { self.ranges(ball.bounds()) }
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
            Some(ball) => self.points.scan(&ball, self.ranges_of(&ball).iter(), f),
            None => ControlFlow::Continue(()),
        }
    }

    /// Looks within growing radii, until there are enough points or no larger radius.
    fn k_nearest(&self, center: [f32; 3], k: usize, max_radius: f32, out: &mut Vec<Neighbour>) {
        out.clear();
        let Some(largest) = Ball::new(center, max_radius) else { return };
        if k == 0 || self.is_empty() {
            return;
        }
        let mut radius = self.first_radius(&largest, k);
        loop {
            let smaller = Ball::new(center, radius).filter(|ball| ball.radius_squared < largest.radius_squared);
            let mut ball = smaller.unwrap_or(largest);
            let ranges = self.ranges_of(&ball);
            // If it comes to testing all points anyway, it is for the last time.
            if ranges.count() == self.len() {
                ball = largest;
            }
            let mut closest = Closest::new(k, ball.radius_squared, out);
            let ControlFlow::Continue(()) = self.points.scan(&ball, ranges.iter(), |id, distance_squared| {
                closest.push(Neighbour::new(id as u32, distance_squared));
                ControlFlow::<Infallible>::Continue(())
            });
            // Points that were not found are farther away than those that were.
            if closest.len() >= k || ball.radius_squared == largest.radius_squared {
                return closest.finish();
            }
            radius *= growth(closest.len(), k);
        }
    }
}

impl HashGrid {
    /// A radius that holds somewhat more than `k` points, if they lie on a surface and about as densely as in the cells around the centre.
    ///
    /// The box of three cells meets about `12 c^2` of a surface, for cells of size `c` and any inclination; a ball `pi r^2`.
    #[inline(always)]
    fn first_radius(&self, largest: &Ball, k: usize) -> f32 {
        let size = self.scale.size;
        let around = self.ranges((largest.center.map(|x| x - size), largest.center.map(|x| x + size))).count();
        let wanted = k as f32 + 2.0 * (k as f32).sqrt();
        let radius = size * (wanted * 12.0 / (core::f32::consts::PI * around as f32)).sqrt();
        // No points at all give infinity.
        radius.min(2.0 * size)
    }
}

/// How much larger the next radius is, again as for a surface.
#[inline(always)]
fn growth(found: usize, k: usize) -> f32 {
    (1.2 * (k as f32 / found as f32).sqrt()).min(2.0)
}
