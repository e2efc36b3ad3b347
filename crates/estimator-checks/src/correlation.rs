//! Tests for correlation, which would invalidate the error bars of everything else.

use crate::distributions::student_two_sided;
use crate::outcome::Outcome;
use crate::suite::Check;
use crate::verdict::{Undecided, Violation};

const METHOD: &str = "Pearson correlation";

/// Tests that two quantities are uncorrelated.
///
/// ```text
/// t = r sqrt((n - 2) / (1 - r^2)),     two-sided, n - 2 degrees of freedom
/// ```
///
/// - `r`: the sample correlation coefficient of the `n` pairs.
///
/// Assumes that the pairs are independent of each other; exact for normal quantities, asymptotic for others. Detects
/// linear dependence only. The cost is linear. Non-finite values are violations; fewer than three pairs, or a quantity
/// without variance, are undecided.
///
/// Source: Fisher, Biometrika 10 (1915).
///
/// ```
/// use estimator_checks::{Check, uncorrelated};
///
/// let check = Check::new("dimensions 0 and 1", 1e-6)?;
/// let mut uniforms = check.uniforms();
/// let pairs: Vec<[f64; 2]> = (0..5000).map(|_| uniforms.array()).collect();
/// uncorrelated(check, &pairs).expect_pass();
/// # Ok::<(), estimator_checks::SuiteError>(())
/// ```
pub fn uncorrelated(check: Check, pairs: &[[f64; 2]]) -> Outcome {
    if let Some(i) = pairs.iter().position(|pair| !(pair[0].is_finite() && pair[1].is_finite())) {
        return Outcome::violation(check, METHOD, Violation::NotFinite { what: "a value", at: format!("pair {i}") });
    }
    let n = pairs.len();
    if n < 3 {
        return Outcome::undecided(check, METHOD, Undecided::TooFew { what: "pairs", count: n, needed: 3 });
    }
    let mean = |axis: usize| pairs.iter().map(|pair| pair[axis]).sum::<f64>() / n as f64;
    let (mean_x, mean_y) = (mean(0), mean(1));
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for [x, y] in pairs {
        let (x, y) = (x - mean_x, y - mean_y);
        xx += x * x;
        xy += x * y;
        yy += y * y;
    }
    if xx == 0.0 || yy == 0.0 {
        return Outcome::undecided(check, METHOD, Undecided::Argument("a quantity has no variance".into()));
    }
    let r = (xy / (xx.sqrt() * yy.sqrt())).clamp(-1.0, 1.0);
    let dof = (n - 2) as f64;
    let p_value = student_two_sided(r * (dof / (1.0 - r * r)).sqrt(), dof);
    Outcome::decide(check, format!("{METHOD}, {dof} dof"), r, p_value)
}

/// Tests that neighbours in a series are uncorrelated.
///
/// [`uncorrelated`] on the disjoint pairs `(x_0, x_1), (x_2, x_3), ..`, which are independent if the series is. Run it on
/// samples before a t-test believes them.
///
/// ```
/// use estimator_checks::{Check, Uniforms, serially_uncorrelated};
///
/// let mut uniforms = Uniforms::named("series");
/// let mut series: Vec<f64> = (0..5000).map(|_| uniforms.next_f64()).collect();
/// serially_uncorrelated(Check::new("independent", 1e-6)?, &series).expect_pass();
/// for i in 1..series.len() {
///     series[i] = 0.8 * series[i] + 0.2 * series[i - 1];
/// }
/// serially_uncorrelated(Check::new("smoothed", 1e-6)?, &series).expect_reject();
/// # Ok::<(), estimator_checks::SuiteError>(())
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn serially_uncorrelated(check: Check, series: &[f64]) -> Outcome {
    let (pairs, _) = series.as_chunks::<2>();
    uncorrelated(check, pairs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kolmogorov_smirnov::kolmogorov_smirnov;
    use crate::seed::Uniforms;

    fn check(name: &str) -> Check {
        Check::new(name, 1e-8).unwrap()
    }

    #[test]
    fn p_values_are_uniform_under_the_null() {
        let mut uniforms = Uniforms::named("correlation null");
        let p_values: Vec<f64> = (0..300)
            .map(|_| {
                let pairs: Vec<[f64; 2]> = (0..100).map(|_| uniforms.array()).collect();
                uncorrelated(check("p"), &pairs).p_value
            })
            .collect();
        kolmogorov_smirnov(check("correlation p-values"), &p_values, |p| p).expect_pass();
    }

    #[test]
    fn planted_bug_correlated_dimensions() {
        let mut uniforms = Uniforms::named("correlated");
        let mut pairs: Vec<[f64; 2]> = (0..20_000).map(|_| uniforms.array()).collect();
        uncorrelated(check("independent"), &pairs).expect_pass();
        pairs.iter_mut().for_each(|pair| pair[1] = 0.95 * pair[1] + 0.05 * pair[0]);
        uncorrelated(check("5 % leak"), &pairs).expect_reject();
        let same: Vec<[f64; 2]> = pairs.iter().map(|pair| [pair[0]; 2]).collect();
        uncorrelated(check("same dimension twice"), &same).expect_reject();
    }

    #[test]
    fn edges() {
        uncorrelated(check("nan"), &[[0.0, f64::NAN]; 5]).expect_reject();
        for outcome in [uncorrelated(check("none"), &[]), uncorrelated(check("constant"), &[[1.0, 2.0]; 9])] {
            assert!(!outcome.passed() && !outcome.rejected());
        }
    }
}
