//! What resampling returns: a sample, and the weight that makes estimates with it unbiased.

use core::ops::Mul;

use crate::Float;

/// A selected sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Selected<X, F = f32> {
    /// The sample `Y`.
    pub sample: X,
    /// `g(Y)`, of the target it was selected for.
    pub score: F,
    /// The unbiased contribution weight `W`: `E[W | Y = y]` is one over the density of `Y`.
    pub contribution_weight: F,
}

/// The outcome of resampling.
///
/// ```text
/// W = 1/g(Y) * 1/M sum_j g(X_j)/p(X_j),        E[f(Y) W] = integral of f
/// ```
///
/// **Symbols.** `Y`: the selected sample; `g`: the target; `p`: the density of the candidates `X_j`; `M`: their number, kept
/// as the *confidence* for later combinations.
///
/// There may be no sample: if all candidates had weight zero, or there were none. Estimates are then zero.
///
/// It is a sample with a weight, and no estimate by itself: what is to be estimated has to be said.
///
/// ```
/// use ris::{Proposal, Reservoir};
/// let picked = Reservoir::stream([Proposal { sample: 0.5, density: 2.0 }], &|x: &f64| *x, &mut || 0.5);
/// let radiance: f64 = 0.25 + picked.estimate(|x| x * x);
/// assert_eq!(radiance, 0.375);
/// ```
///
/// ```compile_fail,E0277
/// use ris::{Proposal, Reservoir};
/// let picked = Reservoir::stream([Proposal { sample: 0.5, density: 2.0 }], &|x: &f64| *x, &mut || 0.5);
/// let radiance: f64 = 0.25 + picked;
/// ```
///
/// A `Resampled` is itself a candidate for the next resampling, with `W` in place of `1/p`:
/// [`Reservoir::merge`](crate::Reservoir::merge), [`Pairwise`](crate::Pairwise).
///
/// **Source.** Talbot, Cline and Egbert 2005, equation 1; Lin, Kettunen, Bitterli, Pantaleoni, Yuksel, Wyman 2022 (*Generalized resampled importance
/// sampling*), section 4, for the name of `W`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resampled<X, F = f32> {
    /// The sample that was selected, if any.
    pub selected: Option<Selected<X, F>>,
    /// The number of candidates that it stands for.
    pub confidence: F,
}

impl<X, F: Float> Resampled<X, F> {
    /// No sample, of no candidates.
    pub const EMPTY: Self = Self { selected: None, confidence: F::ZERO };

    /// The sample `Y`, if any.
    #[inline]
    pub fn sample(&self) -> Option<&X> {
        self.selected.as_ref().map(|selected| &selected.sample)
    }

    /// `W`; zero if there is no sample.
    #[inline]
    pub fn contribution_weight(&self) -> F {
        self.selected.as_ref().map_or(F::ZERO, |selected| selected.contribution_weight)
    }

    /// `f(Y) W`, an estimate of the integral of `f`; `V::default()` (zero) if there is no sample, and `f` is not asked.
    #[inline]
    pub fn estimate<V: Default + Mul<F, Output = V>>(&self, f: impl FnOnce(&X) -> V) -> V {
        match &self.selected {
            Some(selected) => f(&selected.sample) * selected.contribution_weight,
            None => V::default(),
        }
    }

    /// The same with at most this confidence: how much of its history later combinations believe. Unbiased with any
    /// bound that does not depend on the sample; a bound that is negative or NaN is zero.
    #[inline]
    #[must_use]
    pub fn with_confidence_at_most(self, bound: F) -> Self {
        Self { confidence: self.confidence.at_most(if bound > F::ZERO { bound } else { F::ZERO }), ..self }
    }

    /// Drops the sample unless it is kept by what the target left out, such as visibility; the confidence stays. The target is
    /// from here on `g` times that indicator, and whoever weighs this sample against others has to count it in.
    #[inline]
    #[must_use]
    pub fn kept_if(self, keep: impl FnOnce(&X) -> bool) -> Self {
        Self { selected: self.selected.filter(|selected| keep(&selected.sample)), ..self }
    }
}
