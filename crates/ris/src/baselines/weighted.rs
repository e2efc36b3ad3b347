//! Weighted importance sampling.

use core::ops::{Add, Mul};

use crate::stream::candidate_weight;
use crate::{Budget, Float, Source, Target, Uniform};

/// Weighted importance sampling: a ratio of two estimates from the same samples.
///
/// ```text
/// I = (integral of g) * sum_i f(X_i)/p(X_i) / sum_i g(X_i)/p(X_i)
/// ```
///
/// **Symbols.** `f`: the integrand; `g`: a target whose integral is known; `X_i`: samples of density `p`; `N`: their number.
///
/// **Biased**, of order `1/N`; **consistent**. If all samples have target zero, the estimate is zero. Densities that are zero,
/// negative, infinite or NaN add nothing.
///
/// **Source.** Bekaert, Sbert, Willems 2000 (*Weighted importance sampling techniques for Monte Carlo radiosity*).
///
/// ```
/// use ris::{baselines::WeightedImportanceSampling, from_fn};
/// let source = from_fn(|u: &mut dyn FnMut() -> f64| (u(), 1.0), |_: &f64| 1.0);
/// let weighted = WeightedImportanceSampling { samples: 10.0, target_integral: 0.5 };
/// // With f proportional to g the ratio has no variance at all.
/// let mut k = 0;
/// let mut uniform = || { k += 1; (f64::from(k) * 0.618).fract() };
/// let estimate = weighted.estimate(&source, &|x: &f64| *x, &mut uniform, |x| 3.0 * x);
/// assert!((estimate - 1.5_f64).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightedImportanceSampling<F = f32> {
    /// `N`, real, rounded at random.
    pub samples: f64,
    /// The integral of the target.
    pub target_integral: F,
}

impl<F: Float> WeightedImportanceSampling<F> {
    /// An estimate of the integral of `f`.
    pub fn estimate<X, V>(
        &self,
        source: &impl Source<X, F>,
        target: &impl Target<X, F>,
        uniform: &mut impl Uniform<F>,
        f: impl Fn(&X) -> V,
    ) -> V
    where
        V: Default + Add<Output = V> + Mul<F, Output = V>,
    {
        let samples = Budget::round(self.samples, uniform);
        let mut weights = F::ZERO;
        let sum = (0..samples).fold(V::default(), |sum, _| match source.propose(uniform) {
            Some(proposal) => {
                let inverse_density = (F::ONE / proposal.density).weight_or_zero();
                if inverse_density == F::ZERO {
                    return sum;
                }
                weights += candidate_weight(target.score(&proposal.sample), inverse_density);
                sum + f(&proposal.sample) * inverse_density
            }
            None => sum,
        });
        if weights > F::ZERO { sum * (self.target_integral / weights).at_most(F::MAX) } else { V::default() }
    }
}
