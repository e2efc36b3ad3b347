//! Tests of means: z, Student's t and Welch's t.

use crate::distributions::{normal_two_sided, student_two_sided};
use crate::moments::Moments;
use crate::outcome::Outcome;
use crate::suite::Check;
use crate::verdict::{Undecided, Violation};

/// Round-off of an accumulated mean, relative to its size, that is never held against an estimator.
const ROUND_OFF: f64 = 64.0 * f64::EPSILON;

/// A true value, and how far it may be off: the error of a quadrature, or the round-off of an `f32` renderer.
///
/// ```
/// use estimator_checks::Truth;
/// assert_eq!(Truth::from(0.5), Truth { value: 0.5, error: 0.0 });
/// assert_eq!(Truth::relative(2.0, 1e-3).error, 2e-3);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth {
    /// The value.
    pub value: f64,
    /// A bound of its absolute error.
    pub error: f64,
}

impl Truth {
    /// A value known to a relative error.
    pub fn relative(value: f64, relative_error: f64) -> Self {
        Self { value, error: value.abs() * relative_error }
    }
}

impl From<f64> for Truth {
    fn from(value: f64) -> Self {
        Self { value, error: 0.0 }
    }
}

/// A difference of means in units of its standard error, beyond what is allowed.
pub(crate) fn studentise(difference: f64, allowance: f64, variance: f64) -> f64 {
    let excess = (difference.abs() - allowance).max(0.0).copysign(difference);
    // Without variance, any difference is infinitely significant, and none is not.
    if excess == 0.0 { 0.0 } else { excess / variance.sqrt() }
}

/// Student's t statistic of a mean against a truth, its degrees of freedom and p-value.
pub(crate) fn one_sample(moments: &Moments, truth: Truth) -> (f64, f64, f64) {
    let size = moments.mean().abs().max(truth.value.abs());
    let t = studentise(moments.mean() - truth.value, truth.error + ROUND_OFF * size, moments.variance_of_mean());
    let dof = moments.count() as f64 - 1.0;
    (t, dof, student_two_sided(t, dof))
}

/// Welch's t statistic of two means, its degrees of freedom and p-value.
pub(crate) fn two_sample(a: &Moments, b: &Moments, allowance: f64) -> (f64, f64, f64) {
    let size = a.mean().abs().max(b.mean().abs());
    let (va, vb) = (a.variance_of_mean(), b.variance_of_mean());
    let t = studentise(a.mean() - b.mean(), allowance + ROUND_OFF * size, va + vb);
    let (na, nb) = (a.count() as f64 - 1.0, b.count() as f64 - 1.0);
    // Shares instead of squares of variances, which could underflow.
    let share = va / (va + vb);
    let dof = if share.is_nan() { na + nb } else { 1.0 / (share * share / na + (1.0 - share) * (1.0 - share) / nb) };
    (t, dof, student_two_sided(t, dof))
}

/// What forbids to test a mean.
pub(crate) fn unusable(moments: &Moments) -> Option<Result<Violation, Undecided>> {
    if moments.count() < 2 {
        return Some(Err(Undecided::TooFew { what: "samples", count: moments.count() as usize, needed: 2 }));
    }
    let finite = moments.mean().is_finite() && moments.variance().is_finite();
    (!finite).then(|| {
        let at = format!("mean {}, variance {}", moments.mean(), moments.variance());
        Ok(Violation::NotFinite { what: "a sample", at })
    })
}

fn refuse(check: Check, method: &str, reason: Result<Violation, Undecided>) -> Outcome {
    match reason {
        Ok(violation) => Outcome::violation(check, method, violation),
        Err(reason) => Outcome::undecided(check, method, reason),
    }
}

fn show(moments: &Moments) -> String {
    format!("{:.8e} +- {:.1e} (n = {})", moments.mean(), moments.variance_of_mean().sqrt(), moments.count())
}

/// Student's t-test that the mean of independent samples is the truth.
///
/// ```text
/// t = (mean - truth) / sqrt(variance / n),     two-sided, n - 1 degrees of freedom
/// ```
///
/// `|mean - truth|` is first reduced by the error of the [`Truth`] and by the round-off of the accumulation.
///
/// Assumes independent samples (for quasi-Monte Carlo: one number per randomisation, see
/// [`randomised_mean_is`](crate::randomised_mean_is)) of finite variance, and enough of them that the mean is nearly
/// normal. Skewed samples, as of importance sampling with rare large weights, need more: at a level of 1e-8 the
/// distribution of the mean matters out to 6 standard errors.
///
/// A sample that is NaN or infinite is a violation; fewer than two samples are undecided. Samples without variance are
/// rejected exactly if they differ from the truth.
///
/// Source: Student, "The probable error of a mean", Biometrika 6 (1908).
///
/// ```
/// use estimator_checks::{Check, Moments, mean_is};
///
/// let mut uniforms = estimator_checks::Uniforms::named("integral of x^2");
/// let squares: Moments = (0..100_000).map(|_| uniforms.next_f64().powi(2)).collect();
/// mean_is(Check::new("one third", 1e-6)?, &squares, 1.0 / 3.0).expect_pass();
/// mean_is(Check::new("2 % off", 1e-6)?, &squares, 0.34).expect_reject();
/// # Ok::<(), estimator_checks::SuiteError>(())
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn mean_is(check: Check, moments: &Moments, truth: impl Into<Truth>) -> Outcome {
    const METHOD: &str = "Student's t";
    let truth = truth.into();
    if let Some(reason) = unusable(moments) {
        return refuse(check, METHOD, reason);
    }
    let (t, dof, p_value) = one_sample(moments, truth);
    Outcome::decide(check, format!("{METHOD}, {dof} dof"), t, p_value).with_detail(format!(
        "mean {}, truth {:.8e} +- {:.1e}",
        show(moments),
        truth.value,
        truth.error
    ))
}

/// z-test that the mean of independent samples of known variance is the truth.
///
/// ```text
/// z = (mean - truth) / sqrt(sigma^2 / n),     two-sided, normal
/// ```
///
/// As [`mean_is`], but with the variance `sigma^2` of a single sample given: for indicator functions, and where the
/// sample variance itself is unreliable. A single sample suffices. A variance that is negative or NaN is undecided.
///
/// ```
/// use estimator_checks::{Check, Moments, mean_is_known_variance};
///
/// let mut uniforms = estimator_checks::Uniforms::named("roulette");
/// let survivors: Moments = (0..10_000).map(|_| f64::from(uniforms.next_f64() < 0.2)).collect();
/// mean_is_known_variance(Check::new("one in five", 1e-6)?, &survivors, 0.2, 0.2 * 0.8).expect_pass();
/// # Ok::<(), estimator_checks::SuiteError>(())
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn mean_is_known_variance(check: Check, moments: &Moments, truth: impl Into<Truth>, variance: f64) -> Outcome {
    const METHOD: &str = "z";
    let truth = truth.into();
    if moments.count() == 0 {
        return Outcome::undecided(check, METHOD, Undecided::TooFew { what: "samples", count: 0, needed: 1 });
    }
    if !(variance >= 0.0 && variance.is_finite()) {
        return Outcome::undecided(check, METHOD, Undecided::Argument(format!("{variance} is no variance")));
    }
    if !moments.mean().is_finite() {
        let at = format!("mean {}", moments.mean());
        return Outcome::violation(check, METHOD, Violation::NotFinite { what: "a sample", at });
    }
    let size = moments.mean().abs().max(truth.value.abs());
    let allowance = truth.error + ROUND_OFF * size;
    let z = studentise(moments.mean() - truth.value, allowance, variance / moments.count() as f64);
    Outcome::decide(check, METHOD, z, normal_two_sided(z)).with_detail(format!(
        "mean {:.8e}, truth {:.8e} +- {:.1e}",
        moments.mean(),
        truth.value,
        truth.error
    ))
}

/// Welch's t-test that two estimators have the same mean, whatever their variances.
///
/// ```text
/// t = (mean_a - mean_b) / sqrt(v_a + v_b),     v = variance / n
/// dof = (v_a + v_b)^2 / (v_a^2 / (n_a - 1) + v_b^2 / (n_b - 1))
/// ```
///
/// Assumes independent samples of finite variance, as [`mean_is`]; invalid data are treated as there.
///
/// Source: Welch, "The generalization of 'Student's' problem when several different population variances are involved",
/// Biometrika 34 (1947).
///
/// ```
/// use estimator_checks::{Check, Moments, same_mean};
///
/// let check = Check::new("stratified against plain", 1e-6)?;
/// let mut uniforms = check.uniforms();
/// let plain: Moments = (0..4000).map(|_| uniforms.next_f64().exp()).collect();
/// let stratified: Moments = (0..2000)
///     .map(|_| 0.5 * ((0.5 * uniforms.next_f64()).exp() + (0.5 + 0.5 * uniforms.next_f64()).exp()))
///     .collect();
/// same_mean(check, &plain, &stratified).expect_pass();
/// # Ok::<(), estimator_checks::SuiteError>(())
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn same_mean(check: Check, a: &Moments, b: &Moments) -> Outcome {
    same_mean_within(check, a, b, 0.0)
}

/// As [`same_mean`], but for means that may differ by `allowance`, such as the round-off of `f32` or a known bias.
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn same_mean_within(check: Check, a: &Moments, b: &Moments, allowance: f64) -> Outcome {
    const METHOD: &str = "Welch's t";
    if let Some(reason) = unusable(a).or_else(|| unusable(b)) {
        return refuse(check, METHOD, reason);
    }
    let (t, dof, p_value) = two_sample(a, b, allowance);
    Outcome::decide(check, format!("{METHOD}, {dof:.1} dof"), t, p_value).with_detail(format!(
        "means {} and {}",
        show(a),
        show(b)
    ))
}

/// Tests that the variance of estimator `a` is `ratio` times that of `b`.
///
/// ```text
/// E[s_a^2 - ratio * s_b^2] = 0     <=>     sigma_a^2 = ratio * sigma_b^2
/// ```
///
/// `a` and `b` are unbiased sample variances of independent batches of the two estimators, of any size; the difference
/// of their means is tested with [`same_mean`], which needs no assumption on the distribution of the samples (an F-test
/// would need normal ones). Offer at least 32 batches of many samples. Fewer than two are undecided.
///
/// ```
/// use estimator_checks::{Check, Moments, variance_ratio_is};
///
/// let check = Check::new("the mean of four has a quarter of the variance", 1e-6)?;
/// let mut uniforms = check.uniforms();
/// let mut batches = |of: usize| -> Vec<f64> {
///     let mut mean = || (0..of).map(|_| uniforms.next_f64()).sum::<f64>() / of as f64;
///     (0..64).map(|_| (0..50).map(|_| mean()).collect::<Moments>().variance()).collect()
/// };
/// let (four, one) = (batches(4), batches(1));
/// variance_ratio_is(check, &four, &one, 0.25).expect_pass();
/// variance_ratio_is(Check::new("half", 1e-6)?, &four, &one, 0.5).expect_reject();
/// # Ok::<(), estimator_checks::SuiteError>(())
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn variance_ratio_is(check: Check, a: &[f64], b: &[f64], ratio: f64) -> Outcome {
    let a: Moments = a.iter().copied().collect();
    let b: Moments = b.iter().copied().collect();
    same_mean(check, &a, &b.scaled(ratio)).with_detail(format!(
        "variances {} and {}, ratio {ratio}",
        show(&a),
        show(&b)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kolmogorov_smirnov::kolmogorov_smirnov;
    use crate::seed::Uniforms;

    fn check(name: &str) -> Check {
        Check::new(name, 1e-8).unwrap()
    }

    fn draw(uniforms: &mut Uniforms, n: usize, f: impl Fn(f64) -> f64) -> Moments {
        (0..n).map(|_| f(uniforms.next_f64())).collect()
    }

    #[test]
    fn statistics_by_hand() {
        let a: Moments = [1.0, 2.0, 3.0, 4.0].into_iter().collect();
        let outcome = mean_is(check("t"), &a, 2.0);
        assert!((outcome.statistic - 0.5 / (5.0_f64 / 12.0).sqrt()).abs() < 1e-12);
        // scipy.stats.ttest_1samp([1, 2, 3, 4], 2.0).pvalue
        assert!((outcome.p_value - 0.495_025_3).abs() < 1e-6, "{}", outcome.p_value);
        let b: Moments = [2.0, 4.0, 6.0].into_iter().collect();
        let (t, dof, _) = two_sample(&a, &b, 0.0);
        let (va, vb) = (5.0 / 12.0_f64, 4.0 / 3.0);
        assert!((t + 1.5 / (va + vb).sqrt()).abs() < 1e-12);
        assert!((dof - (va + vb) * (va + vb) / (va * va / 3.0 + vb * vb / 2.0)).abs() < 1e-12);
    }

    #[test]
    fn p_values_are_uniform_under_the_null() {
        let mut uniforms = Uniforms::named("t null");
        let (mut t, mut welch) = (Vec::new(), Vec::new());
        for _ in 0..400 {
            let (a, b) = (draw(&mut uniforms, 60, |u| u), draw(&mut uniforms, 90, |u| 2.0 * u - 0.5));
            t.push(mean_is(check("t"), &a, 0.5).p_value);
            welch.push(same_mean(check("w"), &a, &b).p_value);
        }
        kolmogorov_smirnov(check("t p-values"), &t, |p| p).expect_pass();
        kolmogorov_smirnov(check("Welch p-values"), &welch, |p| p).expect_pass();
    }

    #[test]
    fn planted_bug_biased_mean() {
        let mut uniforms = Uniforms::named("biased");
        let good = draw(&mut uniforms, 100_000, |u| u);
        let biased = draw(&mut uniforms, 100_000, |u| 1.02 * u);
        mean_is(check("good"), &good, 0.5).expect_pass();
        mean_is(check("biased"), &biased, 0.5).expect_reject();
        mean_is(check("biased, allowed"), &biased, Truth::relative(0.5, 0.03)).expect_pass();
        same_mean(check("biased pair"), &good, &biased).expect_reject();
        same_mean_within(check("biased pair, allowed"), &good, &biased, 0.02).expect_pass();
        mean_is_known_variance(check("z"), &good, 0.5, 1.0 / 12.0).expect_pass();
        mean_is_known_variance(check("z, biased"), &biased, 0.5, 1.0 / 12.0).expect_reject();
    }

    #[test]
    fn planted_bug_variance_ratio() {
        let mut uniforms = Uniforms::named("variances");
        let mut batch =
            |width: f64| -> Vec<f64> { (0..64).map(|_| draw(&mut uniforms, 100, |u| width * u).variance()).collect() };
        let (wide, narrow) = (batch(2.0), batch(1.0));
        variance_ratio_is(check("four"), &wide, &narrow, 4.0).expect_pass();
        variance_ratio_is(check("two"), &wide, &narrow, 2.0).expect_reject();
    }

    #[test]
    fn without_variance() {
        let tenth: Moments = std::iter::repeat_n(0.1, 1000).collect();
        mean_is(check("furnace"), &tenth, 0.1).expect_pass();
        mean_is(check("furnace, off"), &tenth, 0.100001).expect_reject();
        same_mean(check("both"), &tenth, &tenth).expect_pass();
        same_mean(check("both, off"), &tenth, &tenth.scaled(1.001)).expect_reject();
    }

    #[test]
    fn edges() {
        let nan: Moments = [1.0, f64::NAN, 2.0].into_iter().collect();
        let one: Moments = [1.0].into_iter().collect();
        mean_is(check("nan"), &nan, 1.0).expect_reject();
        same_mean(check("nan"), &nan, &nan).expect_reject();
        mean_is_known_variance(check("nan"), &nan, 1.0, 1.0).expect_reject();
        for outcome in [
            mean_is(check("one"), &one, 1.0),
            same_mean(check("none"), &one, &Moments::new()),
            mean_is_known_variance(check("none"), &Moments::new(), 1.0, 1.0),
            mean_is_known_variance(check("variance"), &one, 1.0, f64::NAN),
        ] {
            assert!(!outcome.passed() && !outcome.rejected(), "{outcome}");
        }
    }
}
