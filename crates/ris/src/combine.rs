//! Generalised resampling: combining what others selected, for other targets, without bias.

use crate::resampled::Selected;
use crate::several_sources::{finish, share};
use crate::stream::{Chosen, Stream, candidate_weight};
use crate::{Float, Resampled, Target};

/// Combines resampled samples with resampling weights that the caller gives.
///
/// ```text
/// w_i = m_i(Y_i) g(Y_i) W_i,     P(Y = Y_i) = w_i / sum_j w_j,     W = 1/g(Y) * sum_j w_j
/// ```
///
/// **Symbols.** `Y_i`, `W_i`: the sample and contribution weight of input `i`; `g`: the receiver's target; `m_i`: weights that
/// sum to one over all inputs that could have selected `Y_i`.
///
/// **Unbiased** if the `W_i` are, and for each `x` with `f(x) != 0` the weights `m_i(x)` of the inputs whose target is positive
/// at `x` sum to one. The inputs may depend on each other.
///
/// **Source.** Lin et al. 2022, equations 21 and 22. [`Pairwise`] chooses the weights; [`balance`] is the costlier choice.
#[derive(Clone, Copy, Debug)]
pub struct Combination<X, F = f32> {
    stream: Stream<X, F>,
    confidence: F,
}

impl<X, F: Float> Default for Combination<X, F> {
    fn default() -> Self {
        Self::new()
    }
}

impl<X, F: Float> Combination<X, F> {
    /// An empty one.
    pub const fn new() -> Self {
        Self { stream: Stream::EMPTY, confidence: F::ZERO }
    }

    /// Adds an input with the receiver's score `g(Y_i)` and its weight `m_i(Y_i)`. If the sample was moved here by a shift
    /// mapping, `input.contribution_weight` has to be multiplied by its Jacobian determinant before.
    #[inline]
    pub fn add(&mut self, input: Resampled<X, F>, score: F, resampling_weight: F, u: F) {
        self.confidence += input.confidence.weight_or_zero();
        if let Some(Selected { sample, contribution_weight, .. }) = input.selected {
            let weight = candidate_weight(score, contribution_weight) * resampling_weight;
            self.stream.offer(weight, u, || Chosen { sample, score, inverse_density: contribution_weight });
        }
    }

    /// The outcome.
    #[inline]
    pub fn finish(self) -> Resampled<X, F> {
        finish(self.stream, self.confidence)
    }
}

/// Pairwise weights: each neighbour is weighed against the receiver's own ("canonical") sample alone, in `O(N)`.
///
/// ```text
/// m_i(y) = c_i/C *      C' g_i(y) / (c_c g_c(y) + C' g_i(y))                        for neighbours i
/// m_c(y) = c_c/C + sum_i  c_i/C * c_c g_c(y) / (c_c g_c(y) + C' g_i(y))             for the canonical sample
/// ```
///
/// **Symbols.** `g_c`, `g_i`: targets of receiver and neighbour; `c_c`, `c_i`: their confidences (numbers of candidates);
/// `C' = sum_i c_i`, `C = c_c + C'`. At any `y` the weights sum to one, and `m_i(y)` is zero where `g_i(y)` is: what a
/// neighbour cannot select is not counted for it. The term `c_c/C` is the *defensive* one: the receiver's own sample keeps
/// at least its share.
///
/// **Unbiased** for any neighbours, if
/// - their choice and all confidences do not depend on the samples, the receiver's confidence is positive, and the neighbours'
///   sum up to what [`new`](Self::new) was told,
/// - the receiver alone would be unbiased: `f != 0` implies `g_c > 0` and a positive density of its candidates,
/// - a neighbour's target is the one that it really selected by, times whatever dropped samples since
///   ([`Resampled::kept_if`]), and zero where its candidates have density zero: what it claims to be able to select it can.
///
/// **Cost.** Per neighbour the receiver's target at its sample, and its target at the receiver's sample: `2 N` scores against
/// `N^2` of [`balance`].
///
/// **Source.** Bitterli 2022 (*Correlations and reuse for fast and accurate physically based light transport*), section 9.1.3;
/// Lin et al. 2022, equation 38, for the defensive form.
///
/// # Example
/// ```
/// use ris::{Pairwise, Proposal, Reservoir};
/// let here = |x: &f64| *x;
/// let there = |x: &f64| 1.0 - x;
/// let mut state = 1_u64;
/// let mut uniform = || {
///     state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407); // Knuth's
///     (state >> 11) as f64 / (1_u64 << 53) as f64
/// };
/// let draw = |uniform: &mut dyn FnMut() -> f64| [uniform(), uniform()].map(|x| Proposal { sample: x, density: 1.0 });
/// let mine = Reservoir::stream(draw(&mut uniform), &here, &mut uniform);
/// let theirs = Reservoir::stream(draw(&mut uniform), &there, &mut uniform);
///
/// let mut pairwise = Pairwise::new(mine, theirs.confidence);
/// pairwise.add(theirs, &here, &there, uniform());
/// let picked = pairwise.finish(uniform());
/// assert_eq!(picked.confidence, 4.0);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Pairwise<X, F = f32> {
    combination: Combination<X, F>,
    canonical: Resampled<X, F>,
    /// `c_c / C + ..`, growing with each neighbour.
    canonical_weight: F,
    /// `c_c / C'`.
    odds: F,
    /// `C`.
    total: F,
}

impl<X, F: Float> Pairwise<X, F> {
    /// For the receiver's own sample, and neighbours whose confidences will sum to `neighbours`.
    #[inline]
    pub fn new(canonical: Resampled<X, F>, neighbours: F) -> Self {
        let neighbours = neighbours.weight_or_zero();
        let canonical = Resampled { confidence: canonical.confidence.weight_or_zero(), ..canonical };
        let total = canonical.confidence + neighbours;
        let canonical_weight = if total > F::ZERO { canonical.confidence / total } else { F::ONE };
        let odds = if neighbours > F::ZERO { canonical.confidence / neighbours } else { F::ZERO };
        Self { combination: Combination::new(), canonical, canonical_weight, odds, total }
    }

    /// The part of the pair's weight that is the neighbour's, at a sample with these scores.
    #[inline]
    fn neighbour_part(&self, canonical_score: F, neighbour_score: F, ratio: F) -> F {
        let (neighbour, canonical) = (neighbour_score.weight_or_zero(), canonical_score.weight_or_zero());
        let ratio = ratio.weight_or_zero();
        let odds = if ratio > F::ZERO { (self.odds / ratio).at_most(F::MAX) } else { self.odds };
        // Where neither could select the sample any split does; it is never asked for then.
        if neighbour == F::ZERO {
            F::ZERO
        } else if canonical == F::ZERO || odds == F::ZERO {
            F::ONE
        } else {
            // The quotient of scores may overflow, and rightly gives zero then; their products with confidences must not.
            F::ONE / (F::ONE + canonical / neighbour * odds)
        }
    }

    /// Adds a neighbour: `target` is the receiver's, `neighbour_target` the one that the neighbour selected by.
    #[inline]
    pub fn add(
        &mut self,
        neighbour: Resampled<X, F>,
        target: &impl Target<X, F>,
        neighbour_target: &impl Target<X, F>,
        u: F,
    ) {
        self.add_normalised(neighbour, target, neighbour_target, F::ONE, u);
    }

    /// [`add`](Self::add) with weights for normalised targets: `ratio` is an estimate of the integral of the receiver's target over that of the
    /// neighbour's.
    ///
    /// ```text
    /// g_i -> g_i * ratio,    ratio ~ (integral of g_c) / (integral of g_i)
    /// ```
    /// Samples are distributed as the *normalised* target, so a neighbour that sees much more light would otherwise be trusted with what it
    /// hardly ever selects: fireflies, more of them with each round.
    ///
    /// **Unbiased** with any ratio that does not depend on the samples that are combined, such as one from other random numbers. What is no positive
    /// number counts as one.
    #[inline]
    pub fn add_normalised(
        &mut self,
        neighbour: Resampled<X, F>,
        target: &impl Target<X, F>,
        neighbour_target: &impl Target<X, F>,
        ratio: F,
        u: F,
    ) {
        if neighbour.confidence.weight_or_zero() == F::ZERO {
            return;
        }
        let share = neighbour.confidence / self.total;
        if let Some(own) = &self.canonical.selected {
            let part = self.neighbour_part(own.score, neighbour_target.score(&own.sample), ratio);
            self.canonical_weight += share * (F::ONE - part);
        }
        let (score, weight) = match &neighbour.selected {
            Some(theirs) => {
                let score = target.score(&theirs.sample);
                (score, share * self.neighbour_part(score, theirs.score, ratio))
            }
            None => (F::ZERO, F::ZERO),
        };
        self.combination.add(neighbour, score, weight, u);
    }

    /// Adds the receiver's own sample, and returns the outcome.
    #[inline]
    pub fn finish(mut self, u: F) -> Resampled<X, F> {
        let score = self.canonical.selected.as_ref().map_or(F::ZERO, |own| own.score);
        self.combination.add(self.canonical, score, self.canonical_weight, u);
        self.combination.finish()
    }
}

/// The balance heuristic over all inputs, `m_i(y) = c_i g_i(y) / sum_j c_j g_j(y)`, at a sample with these scores.
///
/// The oracle of [`Pairwise`]: mostly, but not always, less variance, and quadratic cost, for each sample has to be scored by
/// every input's target. An input that does not exist has weight zero. **Source.** Lin et al. 2022, equation 36.
///
/// ```
/// let weights = [0, 1].map(|i| ris::balance(i, &[2.0, 1.0], &[0.5, 3.0]));
/// assert_eq!(weights, [0.25, 0.75]);
/// ```
pub fn balance<F: Float>(input: usize, confidences: &[F], scores: &[F]) -> F {
    // Scaled, so that no product overflows.
    let largest = scores.iter().map(|score| score.weight_or_zero()).fold(F::ZERO, |a, b| if b > a { b } else { a });
    share(input, || confidences.iter().zip(scores).map(|(&c, &g)| c * (g.weight_or_zero() / largest)))
}
