//! A weighted average.

use crate::{Contribution, Kernel, Similarity};

/// What weighs a neighbour.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rule<'a, S, K> {
    pub(super) similarity: &'a S,
    pub(super) kernel: &'a K,
}

/// An average, and the number of contributions in it.
pub(super) type Counted<C> = (C, u32);

/// The sums of equation 1 at one vertex.
pub(super) struct Mean<C: Contribution> {
    sum: C::Sum,
    weights: f64,
    count: u32,
}

impl<C: Contribution> Mean<C> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self { sum: C::NOTHING, weights: 0.0, count: 0 }
    }

    /// Adds a contribution unless its weight is zero, or no weight at all.
    #[inline(always)]
    pub(super) fn add(&mut self, weight: f32, contribution: C) {
        if is_weight(weight) {
            contribution.add(weight, &mut self.sum);
            self.weights += f64::from(weight);
            self.count += 1;
        }
    }

    #[inline(always)]
    pub(super) fn finish(self) -> Option<Counted<C>> {
        (self.count > 0).then(|| (C::mean(&self.sum, self.weights), self.count))
    }
}

impl<S, K: Kernel> Rule<'_, S, K> {
    /// The weight of a neighbour. The centre itself counts whatever its weight is.
    #[inline(always)]
    pub(super) fn weight<V>(&self, center: &S::Features, other: &S::Features, t_squared: f32, is_center: bool) -> f32
    where
        S: Similarity<V>,
    {
        let weight = self.kernel.weight(t_squared) * self.similarity.weight(center, other);
        if is_center && !is_weight(weight) { 1.0 } else { weight }
    }
}

/// Positive and finite; NaN is neither.
#[inline(always)]
fn is_weight(weight: f32) -> bool {
    weight > 0.0 && weight < f32::INFINITY
}

/// `1 / r^2` for `t^2 = d^2 / r^2`; zero if nothing but the centre can be in the ball.
#[inline(always)]
pub(super) fn over_squared(radius: f32) -> f32 {
    let inverse = 1.0 / (radius * radius);
    if inverse.is_finite() { inverse } else { 0.0 }
}
