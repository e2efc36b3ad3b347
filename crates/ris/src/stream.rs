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

/// The weight of a candidate: zero unless score and product are positive and finite. Two negative numbers make no weight.
#[inline(always)]
pub(crate) fn candidate_weight<F: Float>(score: F, inverse_density: F) -> F {
    if score > F::ZERO { (score * inverse_density).weight_or_zero() } else { F::ZERO }
}

/// `sum / (candidates * score)`, finite for any weights: neither the product of large numbers nor the quotient by small ones
/// may overflow.
#[inline(always)]
pub(crate) fn contribution_weight<F: Float>(sum: F, candidates: F, score: F) -> F {
    (sum / candidates / score).at_most(F::MAX)
}

impl<X, F: Float> Stream<X, F> {
    pub(crate) const EMPTY: Self = Self { chosen: None, weight_sum: F::ZERO };

    /// Offers a sample of this weight; whether it was chosen. `u` lies in `[0, 1)`.
    #[inline(always)]
    pub(crate) fn offer(&mut self, weight: F, u: F, make: impl FnOnce() -> Chosen<X, F>) -> bool {
        let weight = weight.weight_or_zero();
        // Sums beyond the largest number stay there.
        self.weight_sum = (self.weight_sum + weight).at_most(F::MAX);
        // The second condition makes the first positive weight certain: subnormal numbers round u * w to w, and generators
        // of f32 are known to return 1.
        let chosen = weight > F::ZERO && (u * self.weight_sum < weight || self.weight_sum == weight);
        if chosen {
            self.chosen = Some(make());
        }
        chosen
    }
}
