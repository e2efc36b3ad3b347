//! Means over independent randomisations, for estimators whose samples depend on each other.

use crate::mean::{Truth, mean_is};
use crate::moments::Moments;
use crate::outcome::Outcome;
use crate::suite::Check;

/// Tests that an estimator is unbiased, by the mean of its results over independent randomisations.
///
/// ```text
/// t = (mean_r I_r - truth) / sqrt(variance_r(I_r) / R),     two-sided, R - 1 degrees of freedom
/// ```
///
/// - `I_r`: the result of `estimate(seed_r)`, one whole estimate: of a quasi-Monte Carlo rule with its own scramble or
///   shift, of a Markov chain, of a stratified or adaptive estimator,
/// - `R`: the number of `replicates`.
///
/// The points of such an estimator are correlated, so that the t-test of [`mean_is`] over *them* is wrong; its results
/// over seeds are independent. Their distribution need not be normal: choose 32 replicates or more. Fewer than two are
/// undecided, NaN is a violation. Cost: `R` estimates.
///
/// Source: Owen, "Randomly permuted (t,m,s)-nets and (t,s)-sequences" (1995), for the practice.
///
/// ```
/// use estimator_checks::{Check, Uniforms, randomised_mean_is};
///
/// // A lattice with a random shift.
/// let lattice = |seed: u64| {
///     let shift = Uniforms::new(seed).next_f64();
///     (0..64).map(|i| (f64::from(i) / 64.0 + shift).fract().powi(2)).sum::<f64>() / 64.0
/// };
/// randomised_mean_is(Check::new("shifted lattice", 1e-6)?, 200, 1.0 / 3.0, lattice).expect_pass();
/// // Without the shift, the left end of each stratum is biased.
/// let unshifted = |_| lattice(0) * 0.0 + (0..64).map(|i| (f64::from(i) / 64.0).powi(2)).sum::<f64>() / 64.0;
/// randomised_mean_is(Check::new("plain lattice", 1e-6)?, 200, 1.0 / 3.0, unshifted).expect_reject();
/// # Ok::<(), estimator_checks::SuiteError>(())
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn randomised_mean_is(
    check: Check,
    replicates: usize,
    truth: impl Into<Truth>,
    mut estimate: impl FnMut(u64) -> f64,
) -> Outcome {
    let mut seeds = check.uniforms();
    let moments: Moments = (0..replicates).map(|_| estimate(seeds.next_u64())).collect();
    mean_is(check, &moments, truth)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kolmogorov_smirnov::kolmogorov_smirnov;
    use crate::seed::Uniforms;

    fn check(name: &str) -> Check {
        Check::new(name, 1e-8).unwrap()
    }

    /// Jittered strata.
    fn stratified(seed: u64) -> f64 {
        let mut uniforms = Uniforms::new(seed);
        (0..16).map(|i| ((f64::from(i) + uniforms.next_f64()) / 16.0).exp()).sum::<f64>() / 16.0
    }

    #[test]
    fn unbiased_over_randomisations() {
        let truth = 1.0_f64.exp() - 1.0;
        randomised_mean_is(check("strata"), 1000, truth, stratified).expect_pass();
        randomised_mean_is(check("0.2 % off"), 1000, truth, |seed| 1.002 * stratified(seed)).expect_reject();
    }

    #[test]
    fn planted_bug_correlated_replicates() {
        // All replicates share one randomisation: the estimate has no variance and misses the truth.
        let truth = 1.0_f64.exp() - 1.0;
        randomised_mean_is(check("shared"), 100, truth, |_| stratified(1)).expect_reject();
    }

    #[test]
    fn p_values_are_uniform_under_the_null() {
        let truth = 1.0_f64.exp() - 1.0;
        let p_values: Vec<f64> =
            (0..300).map(|i| randomised_mean_is(check(&format!("null {i}")), 50, truth, stratified).p_value).collect();
        kolmogorov_smirnov(check("replicate p-values"), &p_values, |p| p).expect_pass();
    }

    #[test]
    fn edges() {
        randomised_mean_is(check("nan"), 10, 1.0, |_| f64::NAN).expect_reject();
        let none = randomised_mean_is(check("none"), 1, 1.0, |_| 1.0);
        assert!(!none.passed() && !none.rejected());
    }
}
