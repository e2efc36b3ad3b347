//! The interface of all indices.

use core::convert::Infallible;
use core::ops::ControlFlow;

use crate::neighbour::Neighbour;

/// Finds points within a radius, and the nearest ones. Points are named by their positions in the slice that the index was
/// built from: ids. Payloads stay with the caller.
///
/// # What is found
/// Point `p` is within radius `r` of `c` if [`distance_squared(p, c)`](crate::distance_squared) `<= r * r` in `f32`. All indices
/// compute both sides identically, so they agree bit for bit.
///
/// | input | answer |
/// |---|---|
/// | a point with a coordinate that is NaN or infinite | is kept out when the index is built, and counted by [`skipped`](Self::skipped) |
/// | a centre with such a coordinate | nothing is found |
/// | radius NaN or negative | nothing is found |
/// | radius 0 | points whose squared distance is zero: those in the centre, and those closer than 3e-23, where squares underflow |
/// | radius infinite, or above 1.8e19, where its square overflows | all points are found, some perhaps at squared distance infinity |
/// | coincident points | each is found |
/// | `k = 0` | nothing is found |
/// | `k` larger than the number of points | all points are found, up to the radius |
/// | no points | nothing is found |
///
/// # Laws
/// 1. [`try_for_each_within`](Self::try_for_each_within) visits each point within the radius once, no other point, with its
///    squared distance, and stops when told to.
/// 2. The order of visits depends on nothing but index and query. Each index documents it; indices differ.
/// 3. [`k_nearest`](Self::k_nearest) finds the first `k` of these points in the order of [`Neighbour`]: by squared distance, then by id.
///
/// [`check_index`](crate::check::check_index) tests them on anybody's implementation.
///
/// Not dyn compatible, because `try_for_each_within` is generic: to choose at run time, implement it for an enum of the
/// choices.
pub trait RangeIndex {
    /// Number of points that can be found. At most `u32::MAX`.
    fn len(&self) -> usize;

    /// Number of points of the input that were kept out, since a coordinate is not finite.
    fn skipped(&self) -> usize;

    /// Calls `f` with id and squared distance of every point within the radius, until it breaks.
    fn try_for_each_within<B>(
        &self,
        center: [f32; 3],
        radius: f32,
        f: impl FnMut(usize, f32) -> ControlFlow<B>,
    ) -> ControlFlow<B>;

    /// The `k` nearest points within the radius, nearest first, equal distances by id. Replaces what is in `out`, whose
    /// memory is used again.
    fn k_nearest(&self, center: [f32; 3], k: usize, max_radius: f32, out: &mut Vec<Neighbour>);

    /// Whether there is nothing to be found.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Calls `f` with id and squared distance of every point within the radius.
    #[inline]
    fn for_each_within(&self, center: [f32; 3], radius: f32, mut f: impl FnMut(usize, f32)) {
        let ControlFlow::Continue(()) = self.try_for_each_within(center, radius, |id, distance_squared| {
            f(id, distance_squared);
            ControlFlow::<Infallible>::Continue(())
        });
    }

    /// All points within the radius, nearest first, equal distances by id.
    fn within(&self, center: [f32; 3], radius: f32) -> Vec<Neighbour> {
        let mut found = Vec::new();
        self.for_each_within(center, radius, |id, distance_squared| {
            found.push(Neighbour::new(id as u32, distance_squared));
        });
        found.sort_unstable();
        found
    }

    /// The number of points within the radius.
    fn count_within(&self, center: [f32; 3], radius: f32) -> usize {
        let mut count = 0;
        self.for_each_within(center, radius, |_, _| count += 1);
        count
    }

    /// Whether any point is within the radius.
    fn any_within(&self, center: [f32; 3], radius: f32) -> bool {
        self.try_for_each_within(center, radius, |_, _| ControlFlow::Break(())).is_break()
    }

    /// The nearest point, the one with the smallest id if several are.
    fn nearest(&self, center: [f32; 3]) -> Option<Neighbour> {
        let mut found = Vec::with_capacity(1);
        self.k_nearest(center, 1, f32::INFINITY, &mut found);
        found.first().copied()
    }
}

impl<I: RangeIndex> RangeIndex for &I {
    fn len(&self) -> usize {
        (**self).len()
    }

    fn skipped(&self) -> usize {
        (**self).skipped()
    }

    fn try_for_each_within<B>(
        &self,
        center: [f32; 3],
        radius: f32,
        f: impl FnMut(usize, f32) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        (**self).try_for_each_within(center, radius, f)
    }

    fn k_nearest(&self, center: [f32; 3], k: usize, max_radius: f32, out: &mut Vec<Neighbour>) {
        (**self).k_nearest(center, k, max_radius, out);
    }
}
