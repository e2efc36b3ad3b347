//! Importance sampling.

use core::ops::{Add, Mul};

use crate::{Budget, Float, Source, Uniform};

/// Importance sampling: `1/N sum_i f(X_i) / p(X_i)`.
///
/// **Symbols.** `f`: the integrand; `X_i`: samples of density `p`; `N`: their number, real, rounded at random.
///
/// **Unbiased** if `f != 0` implies `p > 0`. **Variance** `(e3 - e1) / N`, see [`VarianceModel`](crate::VarianceModel).
/// **Cost** `N (T_X + T_Y)`. **Bad input**: densities that are zero, negative, infinite or NaN add nothing.
///
/// ```
/// use ris::{baselines::ImportanceSampling, from_fn};
/// let source = from_fn(|u: &mut dyn FnMut() -> f64| (2.0 * u(), 0.5), |_: &f64| 0.5);
/// // The middle of the interval, times its length.
/// assert_eq!(ImportanceSampling { samples: 1.0 }.estimate(&source, &mut || 0.5, |x: &f64| x * x), 2.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImportanceSampling {
    /// `N`.
    pub samples: f64,
}

impl ImportanceSampling {
    /// An estimate of the integral of `f`.
    pub fn estimate<X, F: Float, V>(
        &self,
        source: &impl Source<X, F>,
        uniform: &mut impl Uniform<F>,
        f: impl Fn(&X) -> V,
    ) -> V
    where
        V: Default + Add<Output = V> + Mul<F, Output = V>,
    {
        let samples = Budget::round(self.samples, uniform);
        let part = F::ONE / F::from_f64(f64::from(samples));
        (0..samples).fold(V::default(), |sum, _| match source.propose(uniform) {
            Some(proposal) => match (F::ONE / proposal.density).weight_or_zero() {
                inverse_density if inverse_density > F::ZERO => sum + f(&proposal.sample) * (inverse_density * part),
                _ => sum,
            },
            None => sum,
        })
    }
}
