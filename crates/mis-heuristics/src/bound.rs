//! Bounds on the variance of the classical heuristics.

use crate::math::sqrt;

/// A heuristic whose variance is bounded, for [`variance_bound`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Bounded {
    /// The balance heuristic: `c = 1`.
    Balance,
    /// The power heuristic with beta = 2: `c = (1 + sqrt(l)) / 2`.
    Square,
    /// The maximum heuristic: `c = l`.
    Maximum,
    /// The cutoff heuristic with this `alpha`: `c = 1 + alpha (l - 1)`.
    Cutoff(f64),
}

impl Bounded {
    /// The factor `c` of the bound for `l` techniques. (One technique needs no heuristic: `c = 1`.)
    pub fn factor(self, techniques: usize) -> f64 {
        let techniques = techniques.max(1) as f64;
        match self {
            Self::Balance => 1.0,
            Self::Square => 0.5 * (1.0 + sqrt(techniques)),
            Self::Maximum => techniques,
            Self::Cutoff(alpha) => 1.0 + alpha * (techniques - 1.0),
        }
    }
}

/// Kollig and Keller's equation 5: how much variance a heuristic has at most, compared to the best one.
///
/// ```text
/// sigma^2(eta) <= c sigma^2(eta_opt) + 1/n E(eta)^2
/// ```
///
/// **Symbols.** `sigma^2(eta_opt)`: variance of the estimator with any other **non-negative** weights, the best
/// included; `E`: the integral;
/// `n`: samples of each technique; `l`: number of techniques; `c`: [`Bounded::factor`]. The print has `E` where only
/// `E^2` has the right dimension.
///
/// **Assumptions.** All techniques take `n` samples. Weights that may be negative
/// ([`OptimalWeights`](crate::OptimalWeights)) can do better than the bound allows.
///
/// **Cost.** None to speak of.
///
/// **Source.** Kollig and Keller 2004, equation 5; E. Veach, PhD thesis 1997, theorems 9.2 and 9.3, from which the factors of the cutoff
/// and maximum heuristics are.
///
/// # Example
/// ```
/// use mis_heuristics::{Bounded, variance_bound};
/// assert_eq!(variance_bound(Bounded::Balance, 2, 0.5, 3.0, 1), 0.5 + 9.0);
/// assert_eq!(variance_bound(Bounded::Square, 9, 0.5, 3.0, 10), 2.0 * 0.5 + 0.9);
/// ```
pub fn variance_bound(heuristic: Bounded, techniques: usize, optimal_variance: f64, mean: f64, samples: u32) -> f64 {
    heuristic.factor(techniques) * optimal_variance + mean * mean / f64::from(samples)
}

/// The sharper form of [`variance_bound`], for sample counts that differ.
///
/// ```text
/// sigma^2(eta) <= c sigma^2(eta_opt) + (1 / min_i n_i - 1 / sum_i n_i) E(eta)^2
/// ```
///
/// **Source.** E. Veach, PhD thesis 1997, theorems 9.2 and 9.3. A count of zero (or none at all) bounds nothing:
/// infinity.
///
/// # Example
/// ```
/// use mis_heuristics::{Bounded, variance_bound_with_counts};
/// assert_eq!(variance_bound_with_counts(Bounded::Balance, 0.5, 2.0, &[1, 3]), 0.5 + 0.75 * 4.0);
/// ```
pub fn variance_bound_with_counts(heuristic: Bounded, optimal_variance: f64, mean: f64, counts: &[u32]) -> f64 {
    let least = counts.iter().copied().min().unwrap_or(0);
    if least == 0 {
        return f64::INFINITY;
    }
    let total: f64 = counts.iter().map(|&count| f64::from(count)).sum();
    heuristic.factor(counts.len()) * optimal_variance + (1.0 / f64::from(least) - 1.0 / total) * mean * mean
}
