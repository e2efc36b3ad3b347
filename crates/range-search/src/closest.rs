//! Collects the nearest of many neighbours.

use crate::neighbour::Neighbour;

/// Keeps the `k` nearest neighbours it is shown, in a vector of the caller's.
///
/// They are collected unsorted up to a multiple of `k`, then all but the nearest `k` are dropped by quickselect, which is
/// linear; a heap would have to be mended for each. The bound shrinks whenever some are dropped.
pub(crate) struct Closest<'a> {
    k: usize,
    /// Neighbours collected before some are dropped.
    full: usize,
    /// Neighbours after this one are not wanted.
    last: Neighbour,
    found: &'a mut Vec<Neighbour>,
}

impl<'a> Closest<'a> {
    /// For the nearest `k > 0` up to a squared radius.
    pub(crate) fn new(k: usize, radius_squared: f32, found: &'a mut Vec<Neighbour>) -> Self {
        found.clear();
        let full = k.saturating_mul(2).max(64);
        Self { k, full, last: Neighbour::new(u32::MAX, radius_squared), found }
    }

    #[inline(always)]
    pub(crate) fn push(&mut self, neighbour: Neighbour) {
        if neighbour <= self.last {
            self.found.push(neighbour);
            if self.found.len() >= self.full {
                self.shrink();
            }
        }
    }

    /// Neighbours that were not dropped.
    #[inline(always)]
    pub(crate) fn len(&self) -> usize {
        self.found.len()
    }

    /// Drops all but the nearest `k`.
    pub(crate) fn shrink(&mut self) {
        if self.found.len() > self.k {
            let (_, last, _) = self.found.select_nth_unstable(self.k - 1);
            self.last = *last;
            self.found.truncate(self.k);
        }
    }

    /// Leaves the nearest `k`, sorted.
    pub(crate) fn finish(self) {
        self.found.sort_unstable();
        self.found.truncate(self.k);
    }
}
