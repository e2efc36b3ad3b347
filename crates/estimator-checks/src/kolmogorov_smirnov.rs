//! Kolmogorov-Smirnov tests: one sample against a distribution function, and two samples.

use crate::distributions::kolmogorov_upper;
use crate::outcome::Outcome;
use crate::suite::Check;
use crate::verdict::{Undecided, Violation};

const ONE: &str = "Kolmogorov-Smirnov";
const TWO: &str = "two-sample Kolmogorov-Smirnov";

/// One-sample Kolmogorov-Smirnov test of numbers against a continuous distribution function.
///
/// ```text
/// D = sup_x |F_n(x) - F(x)|,     p = Q(sqrt(n) D),     Q(l) = 2 sum_{k>=1} (-1)^(k-1) exp(-2 k^2 l^2)
/// ```
///
/// - `F_n`: the empirical distribution function of the `n` samples,
/// - `F`: the claimed one, `cdf`.
///
/// Assumes independent samples and a continuous `F`; for a discrete one the test is conservative. The tail of `Q` is the
/// bound of Dvoretzky, Kiefer and Wolfowitz with Massart's constant, which holds for every `n`: the rate of false
/// rejections stays below the level, however small that is. The cost is a sort.
///
/// NaN or infinite samples, and a `cdf` that is NaN, outside of `[0, 1]` or decreasing are violations; an empty slice is
/// undecided.
///
/// Sources: Kolmogorov (1933); Massart, "The tight constant in the Dvoretzky-Kiefer-Wolfowitz inequality", Ann. Probab.
/// 18 (1990).
///
/// ```
/// use estimator_checks::{Check, kolmogorov_smirnov};
///
/// let check = Check::new("free paths", 1e-6)?;
/// let mut uniforms = check.uniforms();
/// let distances: Vec<f64> = (0..10_000).map(|_| -(1.0 - uniforms.next_f64()).ln()).collect();
/// kolmogorov_smirnov(check, &distances, |t| 1.0 - (-t).exp()).expect_pass();
/// # Ok::<(), estimator_checks::SuiteError>(())
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn kolmogorov_smirnov(check: Check, samples: &[f64], cdf: impl Fn(f64) -> f64) -> Outcome {
    let sorted = match sorted(samples) {
        Ok(sorted) => sorted,
        Err(violation) => return Outcome::violation(check, ONE, violation),
    };
    if sorted.is_empty() {
        return Outcome::undecided(check, ONE, Undecided::TooFew { what: "samples", count: 0, needed: 1 });
    }
    let n = sorted.len() as f64;
    let (mut distance, mut previous) = (0.0_f64, 0.0);
    for (i, &x) in sorted.iter().enumerate() {
        let f = cdf(x);
        if !(0.0..=1.0).contains(&f) || f < previous - 1e-12 {
            let counterexample = format!("F({x}) = {f} after {previous}");
            let law = "a distribution function rises from 0 to 1";
            return Outcome::violation(check, ONE, Violation::Law { law, counterexample });
        }
        previous = f;
        distance = distance.max(f - i as f64 / n).max((i + 1) as f64 / n - f);
    }
    Outcome::decide(check, format!("{ONE}, n = {n}"), distance, kolmogorov_upper(n.sqrt() * distance))
}

/// Two-sample Kolmogorov-Smirnov test: do two sets of numbers have the same distribution?
///
/// ```text
/// D = sup_x |F_n(x) - G_m(x)|,     p = Q(sqrt(n m / (n + m)) D)
/// ```
///
/// Assumes that all samples are independent; ties make it conservative. The p-value is that of
/// [`kolmogorov_smirnov`], asymptotic in `n` and `m`. The cost is two sorts. NaN and infinite samples are violations; an
/// empty slice is undecided.
///
/// Source: Smirnov (1939).
///
/// ```
/// use estimator_checks::{Check, kolmogorov_smirnov_two_sample};
///
/// let check = Check::new("inversion against rejection", 1e-6)?;
/// let mut uniforms = check.uniforms();
/// let root: Vec<f64> = (0..5000).map(|_| uniforms.next_f64().sqrt()).collect();
/// let largest: Vec<f64> = (0..5000).map(|_| uniforms.next_f64().max(uniforms.next_f64())).collect();
/// kolmogorov_smirnov_two_sample(check, &root, &largest).expect_pass();
/// # Ok::<(), estimator_checks::SuiteError>(())
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn kolmogorov_smirnov_two_sample(check: Check, a: &[f64], b: &[f64]) -> Outcome {
    let (a, b) = match (sorted(a), sorted(b)) {
        (Ok(a), Ok(b)) => (a, b),
        (Err(violation), _) | (_, Err(violation)) => return Outcome::violation(check, TWO, violation),
    };
    if a.is_empty() || b.is_empty() {
        return Outcome::undecided(check, TWO, Undecided::TooFew { what: "samples", count: 0, needed: 1 });
    }
    let (n, m) = (a.len() as f64, b.len() as f64);
    let (mut i, mut j, mut distance) = (0, 0, 0.0_f64);
    while i < a.len() && j < b.len() {
        // Step over all samples that equal the next value, so that ties do not count.
        let x = a[i].min(b[j]);
        i += a[i..].partition_point(|&y| y <= x);
        j += b[j..].partition_point(|&y| y <= x);
        distance = distance.max((i as f64 / n - j as f64 / m).abs());
    }
    let p_value = kolmogorov_upper((n * m / (n + m)).sqrt() * distance);
    Outcome::decide(check, format!("{TWO}, n = {n}, m = {m}"), distance, p_value)
}

fn sorted(samples: &[f64]) -> Result<Vec<f64>, Violation> {
    if let Some(i) = samples.iter().position(|x| !x.is_finite()) {
        return Err(Violation::NotFinite { what: "sample", at: format!("index {i}") });
    }
    let mut sorted = samples.to_vec();
    sorted.sort_by(f64::total_cmp);
    Ok(sorted)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Uniforms;

    fn check(name: &str) -> Check {
        Check::new(name, 1e-8).unwrap()
    }

    fn numbers(name: &str, n: usize) -> Vec<f64> {
        let mut uniforms = Uniforms::named(name);
        (0..n).map(|_| uniforms.next_f64()).collect()
    }

    #[test]
    fn distances_by_hand() {
        let outcome = kolmogorov_smirnov(check("one"), &[0.5], |x| x);
        assert_eq!(outcome.statistic, 0.5);
        let outcome = kolmogorov_smirnov_two_sample(check("two"), &[1.0, 2.0, 2.0, 3.0], &[2.0, 4.0]);
        assert_eq!(outcome.statistic, 0.5);
        assert_eq!(kolmogorov_smirnov_two_sample(check("ties"), &[1.0; 9], &[1.0; 4]).statistic, 0.0);
    }

    #[test]
    fn planted_bugs() {
        let u = numbers("planted", 100_000);
        kolmogorov_smirnov(check("uniform"), &u, |x| x).expect_pass();
        kolmogorov_smirnov(check("power 1.05"), &u, |x| x.powf(1.05)).expect_reject();
        let squeezed: Vec<f64> = numbers("other", 100_000).iter().map(|x| 0.98 * x).collect();
        kolmogorov_smirnov_two_sample(check("2 % narrower"), &u, &squeezed).expect_reject();
    }

    #[test]
    fn edges() {
        assert!(
            kolmogorov_smirnov(check("nan"), &[0.1, f64::NAN], |x| x).expect_reject().to_string().contains("index 1")
        );
        kolmogorov_smirnov(check("cdf above one"), &[0.1, 0.9], |x| 2.0 * x).expect_reject();
        kolmogorov_smirnov(check("falling"), &[0.1, 0.9], |x| 1.0 - x).expect_reject();
        kolmogorov_smirnov(check("nan cdf"), &[0.1, 0.9], |_| f64::NAN).expect_reject();
        kolmogorov_smirnov_two_sample(check("inf"), &[0.1], &[f64::INFINITY]).expect_reject();
        for empty in
            [kolmogorov_smirnov(check("e"), &[], |x| x), kolmogorov_smirnov_two_sample(check("e"), &[], &[1.0])]
        {
            assert!(!empty.passed() && !empty.rejected());
        }
    }

    #[test]
    fn p_values_are_uniform_under_the_null() {
        let one: Vec<f64> =
            (0..300).map(|i| kolmogorov_smirnov(check("p"), &numbers(&format!("a{i}"), 2000), |x| x).p_value).collect();
        kolmogorov_smirnov(check("KS p-values"), &one, |p| p).expect_pass();
        let two: Vec<f64> = (0..300)
            .map(|i| {
                let (a, b) = (numbers(&format!("b{i}"), 2000), numbers(&format!("c{i}"), 3000));
                kolmogorov_smirnov_two_sample(check("p"), &a, &b).p_value
            })
            .collect();
        kolmogorov_smirnov(check("two-sample KS p-values"), &two, |p| p).expect_pass();
    }
}
