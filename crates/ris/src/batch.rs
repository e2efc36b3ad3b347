//! Resampling of candidates that are all in memory.

use alloc::vec::Vec;

use crate::resampled::{Resampled, Selected};
use crate::select::{AliasTable, PrefixSums, Select};
use crate::stream::{candidate_weight, contribution_weight};
use crate::{Float, Proposal, Target};

/// A set of candidates with a table to select from them: one sample, or as many as one likes.
///
/// ```text
/// P(Y = X_j) = w_j / sum_k w_k,    w_j = g(X_j) / p(X_j),    W = 1/g(Y) * 1/M sum_j w_j
/// ```
///
/// The same estimator as [`Reservoir`](crate::Reservoir), for when one of these matters: several samples from the same
/// candidates; **one** number selects, monotonically in the order of the candidates, so that stratification of the
/// candidates and of the number is kept; a selection that can be repeated.
///
/// **Unbiased** as the reservoir; the samples of one batch depend on each other by their candidates, which costs variance
/// against fresh candidates but no bias.
///
/// **Cost.** Memory for `M` candidates. [`PrefixSums`]: `log2 M` comparisons per sample; [`AliasTable`]: constant.
///
/// **Bad input** is treated as by the reservoir.
///
/// **Source.** Talbot, Cline and Egbert 2005, section 3; Rubin 1987; the comb of stratified selection is systematic resampling (Kitagawa 1996).
///
/// ```
/// use ris::{Batch, PrefixSums, Proposal};
/// let candidates = [0.1, 0.5, 0.9].map(|x| Proposal { sample: x, density: 1.0 });
/// let batch = Batch::<_, f64, PrefixSums>::new(candidates, &|x: &f64| *x);
/// assert_eq!(batch.select(0.0).sample(), Some(&&0.1));
/// assert_eq!(batch.select(0.5).sample(), Some(&&0.9));
/// // Three samples, evenly spread over the weights.
/// let picked: Vec<f64> = batch.select_stratified(3, 0.5).filter_map(|y| y.sample().map(|x| **x)).collect();
/// assert_eq!(picked, [0.5, 0.9, 0.9]);
/// ```
#[derive(Clone, Debug)]
pub struct Batch<X, F = f32, T = PrefixSums> {
    candidates: Vec<Selected<X, F>>,
    table: T,
}

/// A selection table that can be built of weights.
///
/// Not dyn compatible: it is a constructor.
pub trait Table<F>: Select<F> {
    /// Builds it.
    fn build(weights: impl IntoIterator<Item = F>) -> Self;
}

impl<F: Float> Table<F> for PrefixSums {
    fn build(weights: impl IntoIterator<Item = F>) -> Self {
        Self::new(weights)
    }
}

impl<F: Float> Table<F> for AliasTable {
    fn build(weights: impl IntoIterator<Item = F>) -> Self {
        Self::new(weights)
    }
}

impl<X, F: Float, T: Table<F>> Batch<X, F, T> {
    /// Of these candidates, for this target.
    pub fn new(candidates: impl IntoIterator<Item = Proposal<X, F>>, target: &impl Target<X, F>) -> Self {
        let score = |Proposal { sample, density }| {
            let score = target.score(&sample);
            Selected { sample, score, contribution_weight: F::ONE / density }
        };
        let candidates: Vec<_> = candidates.into_iter().map(score).collect();
        let table = T::build(candidates.iter().map(|x| candidate_weight(x.score, x.contribution_weight)));
        Self { candidates, table }
    }

    /// Number of candidates `M`.
    pub fn len(&self) -> usize {
        self.candidates.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.candidates.is_empty()
    }

    /// Sum of the weights.
    pub fn weight_sum(&self) -> F {
        self.table.sum()
    }

    /// The sample that `u` in `[0, 1)` selects.
    pub fn select(&self, u: F) -> Resampled<&X, F> {
        let confidence = F::from_f64(self.len() as f64);
        let selected = self.table.select(u).map(|index| {
            let Selected { sample, score, contribution_weight: inverse_density } = &self.candidates[index];
            let contribution_weight = if self.len() == 1 {
                *inverse_density
            } else {
                contribution_weight(self.table.sum(), confidence, *score)
            };
            Selected { sample, score: *score, contribution_weight }
        });
        Resampled { selected, confidence }
    }

    /// `count` samples from one number: `select((u + k) / count)` for `k` from 0. Each has the distribution of
    /// [`select`](Self::select), so their mean is unbiased.
    pub fn select_stratified(&self, count: usize, u: F) -> impl Iterator<Item = Resampled<&X, F>> {
        let step = 1.0 / count as f64;
        (0..count).map(move |k| self.select(F::from_f64((u.to_f64() + k as f64) * step)))
    }
}
