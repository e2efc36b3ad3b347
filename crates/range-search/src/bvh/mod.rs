//! A bounding volume hierarchy over blocks of points.

mod build;

use core::convert::Infallible;
use core::ops::{ControlFlow, Range};

use crate::ball::{Ball, distance_squared};
use crate::closest::Closest;
use crate::error::BuildError;
use crate::index::RangeIndex;
use crate::lanes::{Lanes, WIDTH};
use crate::neighbour::Neighbour;

/// Nodes above each other at most: each leaves one waiting.
const MAX_DEPTH: usize = 64;

/// Nodes that wait at most while near points are looked for.
const FRONTIER: usize = 64;

/// A box, and what is in it.
#[derive(Clone, Copy, Debug)]
struct Node {
    min: [f32; 3],
    max: [f32; 3],
    /// The first of two nodes, or the first block.
    first: u32,
    /// Number of blocks; zero if there are nodes.
    blocks: u32,
}

impl Node {
    /// Squared distance of the nearest point of the box. Rounding is monotone, so that it is at most that of any point in the box.
    #[inline(always)]
    fn distance_squared(&self, center: [f32; 3]) -> f32 {
        let [x, y, z] = [0, 1, 2].map(|axis| center[axis].max(self.min[axis]).min(self.max[axis]));
        distance_squared([x, y, z], center)
    }
}

/// A bounding volume hierarchy, built by the crate [obvhs](https://crates.io/crates/obvhs) over blocks of eight points. Needs the feature
/// `obvhs`.
///
/// Points are halved along the longest axis until they are blocks, whose boxes obvhs builds a binary hierarchy over. Blocks in one place
/// are one leaf. Where too many boxes share a centre, which takes obvhs quadratic time, or its hierarchy gets too deep, the hierarchy is
/// the balanced one over the blocks as they lie.
///
/// Knows no cell size, as [`KdTree`](crate::KdTree); stops early, and needs less memory.
///
/// Order of visits: the hierarchy's, a function of the input. Cost: building sorts, `n log n`; a query visits the nodes that meet the
/// ball; one for the nearest points looks for a ball first. Memory: 16 bytes per point, and about 8 for the nodes.
///
/// Source: D. Meister and J. Bittner, *Parallel Locally-Ordered Clustering for Bounding Volume Hierarchy Construction* (2018).
///
/// ```
/// use range_search::{Bvh, RangeIndex};
/// let bvh = Bvh::build(&[[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [1000.0, 0.0, 0.0]], |p| *p)?;
/// assert_eq!(bvh.count_within([0.5, 0.0, 0.0], 0.5), 2);
/// assert_eq!(bvh.nearest([600.0, 0.0, 0.0]).map(|neighbour| neighbour.id()), Some(2));
/// # Ok::<(), range_search::BuildError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Bvh {
    /// The first is the root; none, if there are no points.
    nodes: Vec<Node>,
    points: Lanes,
    skipped: usize,
}

impl Bvh {
    /// A hierarchy over points anywhere in a payload.
    ///
    /// # Errors
    /// If there are more points than ids.
    pub fn build<P>(points: &[P], position: impl Fn(&P) -> [f32; 3]) -> Result<Self, BuildError> {
        build::build(points, position)
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        self.points.bytes() + size_of::<Node>() * self.nodes.capacity()
    }

    /// The slots of a leaf.
    #[inline(always)]
    fn slots(&self, leaf: &Node) -> Range<usize> {
        let first = leaf.first as usize * WIDTH;
        first..(first + leaf.blocks as usize * WIDTH).min(self.points.len())
    }
}

/// The leaves whose boxes meet a ball.
struct Leaves<'a> {
    bvh: &'a Bvh,
    ball: Ball,
    waiting: [u32; MAX_DEPTH + 1],
    len: usize,
}

impl Iterator for Leaves<'_> {
    type Item = Range<usize>;

    #[inline(always)]
    fn next(&mut self) -> Option<Range<usize>> {
        while self.len > 0 {
            self.len -= 1;
            let node = &self.bvh.nodes[self.waiting[self.len] as usize];
            if node.distance_squared(self.ball.center) > self.ball.radius_squared {
                continue;
            }
            if node.blocks > 0 {
                return Some(self.bvh.slots(node));
            }
            self.waiting[self.len] = node.first + 1;
            self.waiting[self.len + 1] = node.first;
            self.len += 2;
        }
        None
    }
}

impl RangeIndex for Bvh {
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
        let Some(ball) = Ball::new(center, radius) else { return ControlFlow::Continue(()) };
        self.points.scan(&ball, self.leaves(ball), f)
    }

    /// Some points near the centre give a radius that holds the nearest ones; all within it are tested together.
    fn k_nearest(&self, center: [f32; 3], k: usize, max_radius: f32, out: &mut Vec<Neighbour>) {
        out.clear();
        let Some(ball) = Ball::new(center, max_radius) else { return };
        if k == 0 {
            return;
        }
        let radius_squared = self.bound_of_nearest(center, k, out).min(ball.radius_squared);
        let ball = Ball { radius_squared, ..ball };
        let mut closest = Closest::new(k, ball.radius_squared, out);
        let ControlFlow::Continue(()) = self.points.scan(&ball, self.leaves(ball), |id, distance_squared| {
            closest.push(Neighbour::new(id as u32, distance_squared));
            ControlFlow::<Infallible>::Continue(())
        });
        closest.finish();
    }
}

impl Bvh {
    #[inline(always)]
    fn leaves(&self, ball: Ball) -> Leaves<'_> {
        Leaves { bvh: self, ball, waiting: [0; MAX_DEPTH + 1], len: self.nodes.len().min(1) }
    }

    /// A squared radius that holds the `k > 0` nearest points: that of the `k`-th nearest among `2 k` points of the leaves
    /// whose boxes are nearest. Infinite if there are fewer than `k`.
    #[inline(always)]
    fn bound_of_nearest(&self, center: [f32; 3], k: usize, found: &mut Vec<Neighbour>) -> f32 {
        let enough = k.saturating_mul(2).max(WIDTH);
        let mut frontier = Frontier::new();
        if !self.nodes.is_empty() {
            frontier.insert(Neighbour::new(0, 0.0));
        }
        while found.len() < enough
            && let Some(nearest) = frontier.pop()
        {
            let node = &self.nodes[nearest.id()];
            if node.blocks > 0 {
                let slots = self.slots(node).take(enough - found.len());
                found.extend(slots.map(|slot| {
                    Neighbour::new(self.points.id(slot), distance_squared(self.points.position(slot), center))
                }));
            } else {
                for child in [node.first, node.first + 1] {
                    frontier.insert(Neighbour::new(child, self.nodes[child as usize].distance_squared(center)));
                }
            }
        }
        if found.len() < k { f32::INFINITY } else { found.select_nth_unstable(k - 1).1.distance_squared() }
    }
}

/// Nodes that wait, the nearest one last. If there are too many the farthest are forgotten.
struct Frontier {
    nodes: [Neighbour; FRONTIER],
    len: usize,
}

impl Frontier {
    fn new() -> Self {
        Self { nodes: [Neighbour::new(0, 0.0); FRONTIER], len: 0 }
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<Neighbour> {
        self.len = self.len.checked_sub(1)?;
        Some(self.nodes[self.len])
    }

    #[inline(always)]
    fn insert(&mut self, node: Neighbour) {
        if self.len == FRONTIER {
            self.nodes.copy_within(1.., 0);
            self.len -= 1;
        }
        let mut place = self.len;
        while place > 0 && self.nodes[place - 1] < node {
            self.nodes[place] = self.nodes[place - 1];
            place -= 1;
        }
        self.nodes[place] = node;
        self.len += 1;
    }
}
