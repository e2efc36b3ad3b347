//! Equation 1: the estimator with fractional M and N.

use core::ops::{Add, Mul};

use crate::{Budget, Float, Reservoir, Source, Target, Uniform};

/// Resampled importance sampling.
///
/// ```text
/// I = 1/N sum_i  f(Y_i) W_i,     W_i = 1/g(Y_i) * 1/M sum_j g(X_ij) / p(X_ij)                    (Talbot, Cline and Egbert 2005, equation 1)
/// ```
///
/// **Symbols.** `f`: the integrand, of any type that can be added and scaled; `X_ij`: candidates of density `p` (of a
/// [`Source`]); `g`: the [`Target`]; `Y_i`: the candidate selected of `X_i1 .. X_iM` in proportion to `g/p`; `M`, `N`: the
/// [`Budget`], both rounded at random to integers, `N` once and `M` for each sample.
///
/// **Unbiased** if `f(x) != 0` implies `g(x) > 0` and `p(x) > 0`. With `M = 1` it is importance sampling, bit for bit: the
/// target is then never asked, so that only `p > 0` matters.
///
/// **Numbers** are drawn in this order: one to round `N`; for each sample one to round `M`, then for each candidate what the
/// source takes and one to select. Integers are not rounded, and with `M = 1` and where the source draws nothing, nothing is selected.
///
/// **Bad input.** As [`Reservoir`]'s; with `M = 1`, too, a candidate whose density is zero or NaN adds nothing.
///
/// **Cost.** `N (M T_X + T_Y)`, with `T_X` for drawing a candidate and evaluating `g`, `T_Y` for evaluating `f`.
///
/// **Source.** Talbot, Cline and Egbert 2005, section 4.
///
/// # Example
/// ```
/// use ris::{Budget, Ris, from_fn};
///
/// // The integral of (x, x^2) over [0, 2] is (2, 8/3). The target is x.
/// let uniform_source = from_fn(|u: &mut dyn FnMut() -> f64| (2.0 * u(), 0.5), |_: &f64| 0.5);
/// let ris = Ris::new(Budget::new(4.5, 1000.0));
/// let mut state = 1_u64;
/// let mut uniform = || {
///     state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407); // Knuth's
///     (state >> 11) as f64 / (1_u64 << 53) as f64
/// };
/// let mut sum = [0.0; 2];
/// ris.for_each(&uniform_source, &|x: &f64| *x, &mut uniform, |&x, weight| {
///     sum[0] += x * weight;
///     sum[1] += x * x * weight;
/// });
/// assert!((sum[0] - 2.0).abs() < 0.1 && (sum[1] - 8.0 / 3.0).abs() < 0.2, "{sum:?}");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ris {
    budget: Budget,
}

impl Ris {
    /// With this budget.
    pub const fn new(budget: Budget) -> Self {
        Self { budget }
    }

    /// Its budget.
    pub const fn budget(&self) -> Budget {
        self.budget
    }

    /// Calls `add` with each sample and its weight `W / N`: the estimate is the sum of `f(Y) * weight`.
    ///
    /// This is [`estimate`](Self::estimate) for integrands that bring their own arithmetic.
    #[inline]
    pub fn for_each<X, F: Float>(
        &self,
        source: &impl Source<X, F>,
        target: &impl Target<X, F>,
        uniform: &mut impl Uniform<F>,
        mut add: impl FnMut(&X, F),
    ) {
        let samples = Budget::round(self.budget.samples(), uniform);
        let part = F::ONE / F::from_f64(f64::from(samples));
        for _ in 0..samples {
            let candidates = Budget::round(self.budget.candidates(), uniform);
            if candidates == 1 {
                if let Some(proposal) = source.propose(uniform) {
                    let inverse_density = (F::ONE / proposal.density).weight_or_zero();
                    if inverse_density > F::ZERO {
                        add(&proposal.sample, inverse_density * part);
                    }
                }
                continue;
            }
            if let Some(selected) = Reservoir::draw(candidates, source, target, uniform).selected {
                add(&selected.sample, selected.contribution_weight * part);
            }
        }
    }

    /// An estimate of the integral of `f`.
    #[inline]
    pub fn estimate<X, F: Float, V>(
        &self,
        source: &impl Source<X, F>,
        target: &impl Target<X, F>,
        uniform: &mut impl Uniform<F>,
        mut f: impl FnMut(&X) -> V,
    ) -> V
    where
        V: Default + Add<Output = V> + Mul<F, Output = V>,
    {
        let mut sum = V::default();
        self.for_each(source, target, uniform, |x, weight| sum = core::mem::take(&mut sum) + f(x) * weight);
        sum
    }
}
