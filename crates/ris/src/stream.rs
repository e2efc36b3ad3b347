//! The selection itself: weights come one by one, one sample stays.

use crate::Float;

/// A sample in the course of selection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Chosen<X, F> {
    pub(crate) sample: X,
    pub(crate) score: F,
    /// `1/p`, or the contribution weight with which it came.
    pub(crate) inverse_density: F,
}

/// Weighted reservoir sampling with a reservoir of one (Chao 1982): after `k` weights sample `j` is the chosen one with
/// probability `w_j / (w_1 + .. + w_k)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stream<X, F> {
    pub(crate) chosen: Option<Chosen<X, F>>,
    pub(crate) weight_sum: F,
}

impl<X, F: Float> Stream<X, F> {
    pub(crate) const EMPTY: Self = Self { chosen: None, weight_sum: F::ZERO };

    /// Offers a sample of this weight; whether it was chosen. `u` lies in `[0, 1)`.
    #[inline(always)]
    pub(crate) fn offer(&mut self, weight: F, u: F, make: impl FnOnce() -> Chosen<X, F>) -> bool {
        let weight = weight.weight_or_zero();
        // Sums beyond the largest number stay there.
        self.weight_sum = (self.weight_sum + weight).at_most(F::MAX);
        // u < 1 makes the first positive weight certain, also in rounding: weight_sum is then the weight itself.
        let chosen = u * self.weight_sum < weight;
        if chosen {
            self.chosen = Some(make());
        }
        chosen
    }
}
