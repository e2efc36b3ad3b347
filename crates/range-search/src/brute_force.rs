//! Tests every point: the oracle of the other indices.

use core::ops::ControlFlow;

use crate::ball::{Ball, is_finite};
use crate::closest::Closest;
use crate::error::{BuildError, check_count};
use crate::index::RangeIndex;
use crate::lanes::Lanes;
use crate::neighbour::Neighbour;

/// Tests every point. The oracle of all other indices, and the fastest up to about a hundred points.
///
/// Order of visits: ascending ids. Cost of a query: linear in the number of points. Memory: 16 bytes per point.
///
/// ```
/// use range_search::{BruteForce, RangeIndex};
/// let index = BruteForce::build(&[[0.0_f32, 0.0, 0.0], [3.0, 4.0, 0.0], [f32::NAN, 0.0, 0.0]], |p| *p)?;
/// assert_eq!(index.within([0.0, 0.0, 0.0], 5.0).len(), 2); // the boundary belongs to it
/// assert_eq!((index.len(), index.skipped()), (2, 1));
/// # Ok::<(), range_search::BuildError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct BruteForce {
    points: Lanes,
    skipped: usize,
}

impl BruteForce {
    /// An index of points anywhere in a payload.
    ///
    /// # Errors
    /// If there are more points than ids.
    pub fn build<P>(points: &[P], position: impl Fn(&P) -> [f32; 3]) -> Result<Self, BuildError> {
        check_count(points.len())?;
        let kept: Vec<(u32, [f32; 3])> =
            (0..).zip(points.iter().map(position)).filter(|(_, point)| is_finite(*point)).collect();
        Ok(Self { points: Lanes::from_points(&kept), skipped: points.len() - kept.len() })
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        self.points.bytes()
    }
}

impl RangeIndex for BruteForce {
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
        self.points.scan(&ball, core::iter::once(0..self.len()), f)
    }

    fn k_nearest(&self, center: [f32; 3], k: usize, max_radius: f32, out: &mut Vec<Neighbour>) {
        out.clear();
        if k == 0 {
            return;
        }
        let mut closest = Closest::new(k, max_radius * max_radius, out);
        self.for_each_within(center, max_radius, |id, distance_squared| {
            closest.push(Neighbour::new(id as u32, distance_squared));
        });
        closest.finish();
    }
}
