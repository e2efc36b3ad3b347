//! Rates of convergence: the slope of a log-log regression.

use crate::distributions::{student_two_sided, student_upper};
use crate::mean::{Truth, studentise};
use crate::outcome::Outcome;
use crate::suite::Check;
use crate::verdict::Undecided;

const METHOD: &str = "slope of log y over log x";

/// Round-off of a slope that is never held against a claim.
const ROUND_OFF: f64 = 1e-10;

/// A straight line through points in double-logarithmic coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LogLogFit {
    /// The exponent `b` of `y = e^a x^b`.
    pub slope: f64,
    /// The intercept `a`.
    pub intercept: f64,
    /// The standard error of the slope.
    pub slope_error: f64,
    /// The number of points less two.
    pub degrees_of_freedom: f64,
}

/// Fits `ln y = a + b ln x` by least squares.
///
/// ```text
/// b = S_xy / S_xx,     se(b)^2 = sum (ln y - a - b ln x)^2 / ((k - 2) S_xx)
/// ```
///
/// The standard error assumes independent errors of `ln y` of equal variance, as when every variance estimate comes from
/// equally many replicates. `None` for fewer than three points, coordinates that are not positive and finite, or equal
/// abscissae.
///
/// ```
/// let fit = estimator_checks::log_log_fit(&[(1.0, 8.0), (2.0, 2.0), (4.0, 0.5)]).ok_or("no fit")?;
/// assert!((fit.slope + 2.0).abs() < 1e-12);
/// # Ok::<(), &str>(())
/// ```
pub fn log_log_fit(points: &[(f64, f64)]) -> Option<LogLogFit> {
    let valid = |x: f64| x > 0.0 && x.is_finite();
    if points.len() < 3 || !points.iter().all(|&(x, y)| valid(x) && valid(y)) {
        return None;
    }
    let k = points.len() as f64;
    let logs: Vec<(f64, f64)> = points.iter().map(|&(x, y)| (x.ln(), y.ln())).collect();
    let (mean_x, mean_y) = logs.iter().fold((0.0, 0.0), |(a, b), (x, y)| (a + x / k, b + y / k));
    let s_xx: f64 = logs.iter().map(|(x, _)| (x - mean_x).powi(2)).sum();
    let s_xy: f64 = logs.iter().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    if s_xx <= 0.0 {
        return None;
    }
    let slope = s_xy / s_xx;
    let intercept = mean_y - slope * mean_x;
    let residual: f64 = logs.iter().map(|(x, y)| (y - intercept - slope * x).powi(2)).sum();
    let degrees_of_freedom = k - 2.0;
    Some(LogLogFit {
        slope,
        intercept,
        slope_error: (residual / (degrees_of_freedom * s_xx)).sqrt(),
        degrees_of_freedom,
    })
}

/// Tests that a power law has the claimed exponent: two-sided t-test on the slope of [`log_log_fit`].
///
/// The points are typically (number of samples, variance over replicates), with claims of -1 for Monte Carlo, -2 for
/// stratification in one dimension, -3 for a scrambled net. Let no two points share samples. Points that cannot be
/// fitted leave the check undecided.
///
/// ```
/// use estimator_checks::{Check, Moments, slope_is};
///
/// let check = Check::new("Monte Carlo", 1e-6)?;
/// let mut uniforms = check.uniforms();
/// let mut variance = |n: usize| {
///     let mut mean = || (0..n).map(|_| uniforms.next_f64()).sum::<f64>() / n as f64;
///     (0..100).map(|_| mean()).collect::<Moments>().variance()
/// };
/// let points: Vec<_> = (0..9).map(|k| (f64::from(1 << k), variance(1 << k))).collect();
/// slope_is(check, &points, -1.0).expect_pass();
/// slope_is(Check::new("not a net", 1e-6)?, &points, -3.0).expect_reject();
/// # Ok::<(), estimator_checks::SuiteError>(())
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn slope_is(check: Check, points: &[(f64, f64)], claimed: impl Into<Truth>) -> Outcome {
    let claimed = claimed.into();
    decide(check, points, claimed, student_two_sided)
}

/// Tests that something falls at least as fast as claimed: one-sided, rejects if the slope is significantly larger.
///
/// Otherwise as [`slope_is`].
///
/// ```
/// use estimator_checks::{Check, slope_at_most};
///
/// let points = [(1.0, 1.0), (2.0, 0.26), (4.0, 0.06), (8.0, 0.016), (16.0, 0.004)];
/// slope_at_most(Check::new("at least 1/n", 1e-3)?, &points, -1.0).expect_pass();
/// slope_at_most(Check::new("at least 1/n^3", 1e-3)?, &points, -3.0).expect_reject();
/// # Ok::<(), estimator_checks::SuiteError>(())
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn slope_at_most(check: Check, points: &[(f64, f64)], claimed: f64) -> Outcome {
    decide(check, points, claimed.into(), student_upper)
}

fn decide(check: Check, points: &[(f64, f64)], claimed: Truth, tail: impl Fn(f64, f64) -> f64) -> Outcome {
    let Some(fit) = log_log_fit(points) else {
        let reason = Undecided::Argument("a fit needs three or more points with positive coordinates".into());
        return Outcome::undecided(check, METHOD, reason);
    };
    let t = studentise(fit.slope - claimed.value, claimed.error + ROUND_OFF, fit.slope_error * fit.slope_error);
    Outcome::decide(check, format!("{METHOD}, {} dof", fit.degrees_of_freedom), t, tail(t, fit.degrees_of_freedom))
        .with_detail(format!("slope {:.4} +- {:.4}, claimed {}", fit.slope, fit.slope_error, claimed.value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kolmogorov_smirnov::kolmogorov_smirnov;
    use crate::moments::Moments;
    use crate::seed::Uniforms;

    fn check(name: &str) -> Check {
        Check::new(name, 1e-6).unwrap()
    }

    fn points(uniforms: &mut Uniforms, stratified: bool) -> Vec<(f64, f64)> {
        let mut mean = |n: usize| {
            let x = |i: usize, u: f64| if stratified { (i as f64 + u) / n as f64 } else { u };
            (0..n).map(|i| x(i, uniforms.next_f64())).sum::<f64>() / n as f64
        };
        (0..8).map(|k| (f64::from(1 << k), (0..60).map(|_| mean(1 << k)).collect::<Moments>().variance())).collect()
    }

    #[test]
    fn planted_bug_stratification_lost() {
        let mut uniforms = Uniforms::named("strata");
        let (strata, plain) = (points(&mut uniforms, true), points(&mut uniforms, false));
        slope_is(check("strata"), &strata, -3.0).expect_pass();
        slope_at_most(check("strata"), &strata, -2.0).expect_pass();
        slope_is(check("lost"), &plain, -3.0).expect_reject();
        slope_at_most(check("lost"), &plain, -2.0).expect_reject();
    }

    #[test]
    fn p_values_are_uniform_under_the_null() {
        let mut uniforms = Uniforms::named("slopes");
        let p_values: Vec<f64> =
            (0..200).map(|_| slope_is(check("p"), &points(&mut uniforms, false), -1.0).p_value).collect();
        kolmogorov_smirnov(check("slope p-values"), &p_values, |p| p).expect_pass();
    }

    #[test]
    fn edges() {
        let line = [(1.0, 1.0), (2.0, 0.5), (4.0, 0.25)];
        slope_is(check("exact"), &line, -1.0).expect_pass();
        slope_is(check("exact, off"), &line, -1.01).expect_reject();
        for bad in [&[(1.0, 1.0), (2.0, 0.0), (3.0, 1.0)][..], &[(1.0, f64::NAN); 3], &[(1.0, 2.0); 4], &[]] {
            let outcome = slope_is(check("bad"), bad, -1.0);
            assert!(!outcome.passed() && !outcome.rejected());
        }
    }
}
