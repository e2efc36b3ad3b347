//! Candidates from several distributions, a fixed number from each: the multi-sample model.

use crate::resampled::Selected;
use crate::stream::{Chosen, Stream, candidate_weight, contribution_weight};
use crate::{Float, Resampled, Target, Uniform};

/// A set of `K` source distributions over the same space.
///
/// # Laws
/// Those of [`Source`](crate::Source) for each; and wherever the integrand is not zero, at least one source that is given
/// candidates has a positive density.
///
/// Not dyn compatible, because `propose` is generic: to choose at run time, implement it for an enum of the choices.
pub trait Sources<X, F, const K: usize> {
    /// Draws a candidate from source number `source`.
    fn propose(&self, source: usize, uniform: &mut impl Uniform<F>) -> Option<X>;

    /// The densities with which each of the sources would have drawn `x`, in one common measure.
    fn densities(&self, x: &X) -> [F; K];
}

/// Weights over sources: a multiple importance sampling heuristic.
///
/// Closures `|source, densities: &[F]| -> F` are weights, so any heuristic of `mis-heuristics` is
/// `|k, n_p: &[f32]| Power::TWO.weight(k, &n_p)`.
///
/// # Laws
/// The weights of all sources sum to one wherever any density is positive; a source of density zero has weight zero. The
/// densities are `n_k p_k`, counts included.
///
/// Dyn compatible: `&dyn Weights<F>`.
pub trait Weights<F> {
    /// The weight of source number `source`.
    fn weight(&self, source: usize, densities: &[F]) -> F;
}

// Its docs say so.
const _: Option<&dyn Weights<f64>> = None;

impl<F, W: Fn(usize, &[F]) -> F> Weights<F> for W {
    #[inline(always)]
    fn weight(&self, source: usize, densities: &[F]) -> F {
        self(source, densities)
    }
}

/// The balance heuristic: `n_k p_k / sum_i n_i p_i`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BalanceWeights;

impl<F: Float> Weights<F> for BalanceWeights {
    #[inline]
    fn weight(&self, source: usize, densities: &[F]) -> F {
        share(source, || densities.iter().copied())
    }
}

/// The share of one term in a sum, where what is not positive and finite is zero; zero if there is no such term. Sums beyond
/// the largest number are no obstacle.
pub(crate) fn share<F: Float, I: Iterator<Item = F>>(index: usize, terms: impl Fn() -> I) -> F {
    let terms = || terms().map(Float::weight_or_zero);
    let largest = terms().fold(F::ZERO, |largest, term| if term > largest { term } else { largest });
    let own = terms().nth(index).unwrap_or(F::ZERO);
    if own > F::ZERO { own / largest / terms().map(|term| term / largest).sum::<F>() } else { F::ZERO }
}

/// Resamples candidates of which `counts[k]` come from source `k`.
///
/// ```text
/// w_kj = m_k(X_kj) g(X_kj) / (n_k p_k(X_kj)),     P(Y = X_kj) = w_kj / sum w,     W = 1/g(Y) * sum w
/// ```
///
/// **Symbols.** `n_k`: number of candidates from source `k`; `p_k`: its density; `m_k`: the weights of `heuristic`, which sum
/// to one over the sources; `g`: the target. With the balance heuristic `w = g / sum_i n_i p_i` whatever the source.
///
/// **Unbiased** if wherever `f != 0` the target is positive and so is `n_k p_k` of some source.
///
/// **Cost.** All densities at each candidate. The confidence of the result is the number of candidates.
///
/// **Source.** Talbot 2005, section 4.3; Lin et al. 2022, equation 20.
///
/// ```
/// use ris::{BalanceWeights, Sources, Uniform, resample_sources};
///
/// /// Uniform on [0, 1], and with density 2x.
/// struct Two;
/// impl Sources<f64, f64, 2> for Two {
///     fn propose(&self, source: usize, uniform: &mut impl Uniform<f64>) -> Option<f64> {
///         let u = uniform.next_uniform();
///         Some(if source == 0 { u } else { u.sqrt() })
///     }
///     fn densities(&self, x: &f64) -> [f64; 2] { [1.0, 2.0 * x] }
/// }
/// let mut state = 1_u64;
/// let mut uniform = || {
///     state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407); // Knuth's
///     (state >> 11) as f64 / (1_u64 << 53) as f64
/// };
/// let picked = resample_sources(&Two, [3, 2], &BalanceWeights, &|x: &f64| x * x, &mut uniform);
/// assert!(picked.contribution_weight() > 0.0);
/// ```
pub fn resample_sources<X, F: Float, const K: usize>(
    sources: &impl Sources<X, F, K>,
    counts: [u32; K],
    heuristic: &impl Weights<F>,
    target: &impl Target<X, F>,
    uniform: &mut impl Uniform<F>,
) -> Resampled<X, F> {
    let counts_f = counts.map(|count| F::from_f64(f64::from(count)));
    let mut stream = Stream::EMPTY;
    for (source, &count) in counts.iter().enumerate() {
        for _ in 0..count {
            let Some(sample) = sources.propose(source, uniform) else { continue };
            let densities = sources.densities(&sample);
            let scaled: [F; K] = core::array::from_fn(|k| counts_f[k] * densities[k]);
            let score = target.score(&sample);
            let inverse_density = heuristic.weight(source, &scaled) / scaled[source];
            let u = uniform.next_uniform();
            stream.offer(candidate_weight(score, inverse_density), u, || Chosen { sample, score, inverse_density });
        }
    }
    let confidence = counts_f.iter().copied().sum();
    finish(stream, confidence)
}

/// The outcome of a stream whose weights sum to an estimate of the target's integral.
pub(crate) fn finish<X, F: Float>(stream: Stream<X, F>, confidence: F) -> Resampled<X, F> {
    let sum = stream.weight_sum;
    let selected = stream.chosen.map(|Chosen { sample, score, .. }| {
        let contribution_weight = contribution_weight(sum, F::ONE, score);
        Selected { sample, score, contribution_weight }
    });
    Resampled { selected, confidence }
}
