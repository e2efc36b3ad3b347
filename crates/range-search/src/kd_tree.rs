//! The k-d tree of the crate kiddo, made to answer by the rule that all indices share.

use core::num::NonZero;
use core::ops::ControlFlow;

use kiddo::{ImmutableKdTree, SquaredEuclidean};

use crate::ball::{Ball, distance_squared, is_finite};
use crate::closest::Closest;
use crate::error::{BuildError, check_count};
use crate::index::RangeIndex;
use crate::neighbour::Neighbour;

/// Squares of the distances between coordinates up to this do not overflow.
const LARGE: f32 = 1e18;

/// A k-d tree: the immutable one of the crate [kiddo](https://crates.io/crates/kiddo). Needs the feature `kiddo`.
///
/// Knows no cell size, and so suits points whose density varies by orders of magnitude. kiddo is asked for slightly more than the ball,
/// which the shared rule then cuts down, so that rounding in its traversal loses nothing. It has no way to stop early: after a break it
/// goes on, but `f` is not called again. Where squares of coordinates overflow (above 1e18), all points are tested.
///
/// The nearest are found in two passes, since kiddo chooses freely among points at the same distance: one for the distance of the last
/// of them, one for all up to there.
///
/// Order of visits: the tree's, a function of the input. Cost: building sorts, `n log n`; a query visits the leaves that meet the
/// ball, `log n` for few neighbours. Memory: about 20 bytes per point.
///
/// Source: J. L. Bentley, *Multidimensional binary search trees used for associative searching* (1975).
///
/// ```
/// use range_search::{KdTree, RangeIndex};
/// let tree = KdTree::build(&[[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [1000.0, 0.0, 0.0]], |p| *p)?;
/// assert_eq!(tree.count_within([0.5, 0.0, 0.0], 0.5), 2);
/// assert_eq!(tree.nearest([600.0, 0.0, 0.0]).map(|neighbour| neighbour.id()), Some(2));
/// # Ok::<(), range_search::BuildError>(())
/// ```
pub struct KdTree {
    /// Nothing, if there are no points.
    tree: Option<ImmutableKdTree<f32, 3>>,
    len: usize,
    skipped: usize,
    /// All coordinates are small enough for squares.
    is_small: bool,
}

impl KdTree {
    /// A tree over points anywhere in a payload.
    ///
    /// # Errors
    /// If there are more points than ids.
    pub fn build<P>(points: &[P], position: impl Fn(&P) -> [f32; 3]) -> Result<Self, BuildError> {
        check_count(points.len())?;
        let entries: Vec<(u32, [f32; 3])> =
            (0..).zip(points.iter().map(position)).filter(|(_, point)| is_finite(*point)).collect();
        let tree = match entries.is_empty() {
            true => None,
            false => {
                Some(ImmutableKdTree::new_from_entries(&entries).map_err(|_| BuildError::TooManyPoints(points.len()))?)
            }
        };
        let is_small = entries.iter().all(|(_, point)| is_small(*point));
        Ok(Self { tree, len: entries.len(), skipped: points.len() - entries.len(), is_small })
    }

    /// Calls `f` with all points whose squared distance may be up to a bound.
    #[inline]
    fn for_each_near(&self, center: [f32; 3], bound: f32, mut f: impl FnMut(u32, [f32; 3])) {
        let Some(tree) = &self.tree else { return };
        if bound.is_finite() && self.is_small && is_small(center) {
            let query = tree.query(&center).within::<SquaredEuclidean<f32>>(bound);
            query.unsorted().with_points().visit(|found| f(found.item, found.point));
        } else {
            tree.iter().for_each(|(id, point)| f(id, point));
        }
    }

    /// A squared radius that holds the `k > 0` nearest points.
    fn bound_of_nearest(&self, center: [f32; 3], k: usize) -> f32 {
        let (Some(tree), Some(count)) = (&self.tree, NonZero::new(k)) else { return 0.0 };
        if k >= self.len || !self.is_small || !is_small(center) {
            return f32::INFINITY;
        }
        let nearest = tree.query(&center).nearest_n::<SquaredEuclidean<f32>>(count).execute();
        if nearest.len() < k { f32::INFINITY } else { nearest.iter().map(|found| found.distance).fold(0.0, f32::max) }
    }
}

fn is_small(point: [f32; 3]) -> bool {
    point.iter().all(|x| x.abs() <= LARGE)
}

/// More than enough for the rounding of a sum of squares.
fn enlarged(distance_squared: f32) -> f32 {
    distance_squared * (1.0 + 1e-5) + 1e-43
}

impl RangeIndex for KdTree {
    fn len(&self) -> usize {
        self.len
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
        let mut flow = ControlFlow::Continue(());
        self.for_each_near(center, enlarged(ball.reach * ball.reach), |id, point| {
            let distance_squared = distance_squared(point, center);
            if distance_squared <= ball.radius_squared && flow.is_continue() {
                flow = f(id as usize, distance_squared);
            }
        });
        flow
    }

    fn k_nearest(&self, center: [f32; 3], k: usize, max_radius: f32, out: &mut Vec<Neighbour>) {
        out.clear();
        let Some(ball) = Ball::new(center, max_radius) else { return };
        if k == 0 {
            return;
        }
        let bound = self.bound_of_nearest(center, k).min(ball.reach * ball.reach);
        let mut closest = Closest::new(k, ball.radius_squared, out);
        self.for_each_near(center, enlarged(bound), |id, point| {
            closest.push(Neighbour::new(id, distance_squared(point, center)));
        });
        closest.finish();
    }
}
