//! Streaming resampling in constant memory.

use crate::resampled::{Resampled, Selected};
use crate::stream::{Chosen, Stream, candidate_weight, contribution_weight};
use crate::{Float, OneNumber, Proposal, Source, Target, Uniform};

/// A reservoir: candidates pass through, one stays, and the estimate is unbiased.
///
/// ```text
/// w_j = g(X_j) / p(X_j),    P(Y = X_j) = w_j / sum_k w_k,    W = 1/g(Y) * 1/M sum_j w_j
/// ```
///
/// **Symbols.** `X_j`: candidates, independent of each other or not, each with density `p`; `g`: the target; `M`: the number of
/// candidates, those of weight zero included; `Y`: the one that stays; `W`: its unbiased contribution weight.
///
/// **Unbiased**: `E[f(Y) W]` is the integral of `f` wherever `f != 0` implies `g > 0` and `p > 0`. With `M = 1` it is
/// importance sampling: `W` is `1/p`, bit for bit.
///
/// **Cost.** One evaluation of `g` and `p` per candidate, two multiplications, an addition, comparisons (2 to 3 ns, number
/// included); memory for one sample.
///
/// **Bad input.** Scores and weights that are zero, negative, infinite or NaN count as zero: the candidate counts among the `M`
/// and is never selected. With no positive weight there is no sample and the estimate is zero. A sum of weights, or a
/// contribution weight, beyond the largest number stays there (the estimate is then too small); weights below the smallest one
/// are zero. Where `u` is not below one, or NaN, the sample that is there stays.
///
/// **Precision.** With `f32` the count stops at `2^24` candidates, and a `u` of 24 bits selects a candidate of share `s` with a
/// relative error of up to `2^-24 / s`: take `f64` for streams of tens of thousands.
///
/// **Source.** Talbot, Cline and Egbert 2005, section 3 and equation 1; Chao 1982 for the selection; Bitterli, Wyman, Pharr, Shirley, Lefohn, Jarosz
/// 2020 (*Spatiotemporal reservoir resampling*) for its use in rendering.
///
/// # Example
/// ```
/// use ris::{Proposal, Reservoir};
///
/// // The integral of x^2 over [0, 1] is 1/3. Candidates are uniform, the target x is cheap.
/// let mut state = 1_u64;
/// let mut uniform = || {
///     state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407); // Knuth's
///     (state >> 11) as f64 / (1_u64 << 53) as f64
/// };
/// let mut sum = 0.0;
/// for _ in 0..10_000 {
///     let candidates: Vec<_> = (0..8).map(|_| Proposal { sample: uniform(), density: 1.0 }).collect();
///     let picked = Reservoir::stream(candidates, &|x: &f64| *x, &mut uniform);
///     sum += picked.estimate(|x| x * x);
/// }
/// assert!((sum / 10_000.0 - 1.0 / 3.0).abs() < 0.01);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reservoir<X, F = f32> {
    stream: Stream<X, F>,
    candidates: F,
}

impl<X, F: Float> Default for Reservoir<X, F> {
    fn default() -> Self {
        Self::new()
    }
}

impl<X, F: Float> Reservoir<X, F> {
    /// An empty one.
    #[inline]
    pub const fn new() -> Self {
        Self { stream: Stream::EMPTY, candidates: F::ZERO }
    }

    /// Offers a candidate with its score `g(x)` and one over its density; returns whether it took the place of the one
    /// before. `u` is uniform in `[0, 1)`.
    #[inline]
    pub fn update(&mut self, sample: X, score: F, inverse_density: F, u: F) -> bool {
        self.update_with(score, inverse_density, u, || sample)
    }

    /// [`update`](Self::update) that makes the sample only if it is selected.
    #[inline]
    pub fn update_with(&mut self, score: F, inverse_density: F, u: F, sample: impl FnOnce() -> X) -> bool {
        self.candidates += F::ONE;
        self.stream.offer(candidate_weight(score, inverse_density), u, || Chosen {
            sample: sample(),
            score,
            inverse_density,
        })
    }

    /// Counts a candidate of weight zero: one whose drawing failed, or whose score is known to be zero.
    #[inline]
    pub fn skip(&mut self) {
        self.candidates += F::ONE;
    }

    /// Number of candidates so far.
    #[inline]
    pub fn candidates(&self) -> F {
        self.candidates
    }

    /// Sum of weights so far.
    #[inline]
    pub fn weight_sum(&self) -> F {
        self.stream.weight_sum
    }

    /// Takes over the candidates of a reservoir **for the same target**, as when a stream was split among threads:
    /// the result is distributed as if all had come in one stream.
    #[inline]
    pub fn absorb(&mut self, other: Self, u: F) {
        self.candidates += other.candidates;
        if let Some(chosen) = other.stream.chosen {
            self.stream.offer(other.stream.weight_sum, u, || chosen);
        }
    }

    /// Takes in what another resampling selected, perhaps for another target: the score is evaluated anew, for the
    /// receiver's `target`.
    ///
    /// ```text
    /// w = g(Y_i) W_i M_i,    M <- M + M_i
    /// ```
    ///
    /// **Unbiased** if all that is merged could be generated wherever `f != 0`, that is, if every giver's target is positive
    /// there. Where that may fail (another surface, another hemisphere) it is biased; then combine by [`Pairwise`](crate::Pairwise).
    ///
    /// **Source.** Bitterli et al. 2020, algorithm 4.
    ///
    /// ```
    /// use ris::{Proposal, Reservoir};
    /// let theirs = Reservoir::stream([Proposal { sample: 0.5, density: 1.0 }], &|x: &f64| 1.0 - x, &mut || 0.5);
    /// let mut mine = Reservoir::new();
    /// mine.merge(theirs, &|x: &f64| x * x, 0.5);
    /// assert_eq!(mine.finish().selected.map(|y| y.score), Some(0.25));
    /// ```
    ///
    /// Without the receiver's target there is no merging; the neighbour's score would be another target's:
    ///
    /// ```compile_fail,E0061
    /// use ris::{Proposal, Reservoir};
    /// let theirs = Reservoir::stream([Proposal { sample: 0.5, density: 1.0 }], &|x: &f64| 1.0 - x, &mut || 0.5);
    /// let mut mine = Reservoir::new();
    /// mine.merge(theirs, 0.5);
    /// ```
    #[inline]
    pub fn merge(&mut self, other: Resampled<X, F>, target: &impl Target<X, F>, u: F) {
        let confidence = other.confidence.weight_or_zero();
        self.candidates += confidence;
        if let Some(Selected { sample, contribution_weight, .. }) = other.selected {
            let score = target.score(&sample);
            let weight = candidate_weight(score, contribution_weight) * confidence;
            self.stream.offer(weight, u, || Chosen { sample, score, inverse_density: contribution_weight });
        }
    }

    /// The selected sample with its unbiased contribution weight.
    #[inline]
    pub fn finish(self) -> Resampled<X, F> {
        let (sum, candidates) = (self.stream.weight_sum, self.candidates);
        let selected = self.stream.chosen.map(|Chosen { sample, score, inverse_density }| {
            // A single candidate is importance sampling, without the detour by way of the target and its rounding. Confidences
            // that add up to one may be several candidates: their sum of weights is another one.
            let single = candidates == F::ONE && sum == score * inverse_density;
            let contribution_weight =
                if single { inverse_density } else { contribution_weight(sum, candidates, score) };
            Selected { sample, score, contribution_weight }
        });
        Resampled { selected, confidence: candidates }
    }

    /// Resamples `count` candidates of a source. Each takes the numbers of its drawing first, and then one that selects.
    #[inline]
    pub fn draw(
        count: u32,
        source: &impl Source<X, F>,
        target: &impl Target<X, F>,
        uniform: &mut impl Uniform<F>,
    ) -> Resampled<X, F> {
        let mut reservoir = Self::new();
        for _ in 0..count {
            match source.propose(uniform) {
                Some(Proposal { sample, density }) => {
                    let score = target.score(&sample);
                    reservoir.update(sample, score, F::ONE / density, uniform.next_uniform());
                }
                None => reservoir.skip(),
            }
        }
        reservoir.finish()
    }

    /// Resamples a stream of candidates with a number for each.
    #[inline]
    pub fn stream(
        candidates: impl IntoIterator<Item = Proposal<X, F>>,
        target: &impl Target<X, F>,
        uniform: &mut impl Uniform<F>,
    ) -> Resampled<X, F> {
        let mut reservoir = Self::new();
        for Proposal { sample, density } in candidates {
            let score = target.score(&sample);
            reservoir.update(sample, score, F::ONE / density, uniform.next_uniform());
        }
        reservoir.finish()
    }

    /// Resamples a stream of candidates with **one** number `u` in `[0, 1)`, see [`OneNumber`].
    #[inline]
    pub fn stream_with_one_number(
        candidates: impl IntoIterator<Item = Proposal<X, F>>,
        target: &impl Target<X, F>,
        u: F,
    ) -> Resampled<X, F> {
        let mut reservoir = Self::new();
        let mut number = OneNumber::new(u);
        for Proposal { sample, density } in candidates {
            let score = target.score(&sample);
            reservoir.update_by(sample, score, F::ONE / density, &mut number);
        }
        reservoir.finish()
    }

    /// [`update`](Self::update), decided by what is left of a number.
    #[inline]
    pub fn update_by(&mut self, sample: X, score: F, inverse_density: F, number: &mut OneNumber) -> bool {
        let weight = candidate_weight(score, inverse_density);
        if weight == F::ZERO {
            self.skip();
            return false;
        }
        let share = weight.to_f64() / (self.stream.weight_sum + weight).at_most(F::MAX).to_f64();
        let chosen = number.accept(share);
        // Zero takes any positive weight, one none: rounding must not decide otherwise.
        self.update(sample, score, inverse_density, if chosen { F::ZERO } else { F::ONE })
    }
}
