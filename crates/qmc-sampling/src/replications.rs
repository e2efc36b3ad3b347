//! Error bars by independent replications.

/// The mean of independent replications of an estimator, with its error.
///
/// The points of a low-discrepancy set are not independent, so their scatter says nothing about the error of their mean.
/// Independent randomisations are: the estimator is run with `R` seeds, and the standard error of the mean of the results is
/// `s / sqrt(R)`. Source: Owen, "Monte Carlo theory, methods and examples", chapter 17.
///
/// ```
/// use qmc_sampling::{Replications, Sequence, sobol::{Randomisation, Sobol}};
/// // The integral of x y over the unit square, with 64 points, 16 times.
/// let result = Replications::run(16, 7, |seed| {
///     let sobol = Sobol::new(Randomisation::Owen(seed));
///     (0..64).map(|i| sobol.sample(i, 0) * sobol.sample(i, 1)).sum::<f64>() / 64.0
/// });
/// let [low, high] = result.confidence_interval(0.9999);
/// assert!(low < 0.25 && 0.25 < high && result.standard_error() < 1e-3);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Unchecked"))]
pub struct Replications {
    count: u64,
    mean: f64,
    /// Sum of squared differences from the mean.
    squares: f64,
}

#[cfg(feature = "serde")]
read_through!(Replications { count: u64, mean: f64, squares: f64 } => {
    // More than can ever be counted would overflow when the next comes.
    if count > u64::from(u32::MAX) * u64::from(u32::MAX) {
        return Err("so many replications cannot be");
    }
    if squares < 0.0 {
        return Err("the sum of squared differences from the mean cannot be negative");
    }
    Ok(Self { count, mean, squares })
}, &'static str);

/// When to stop replicating.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StoppingRule {
    /// The half width of the confidence interval that is wanted.
    pub error: f64,
    /// The probability that the interval contains the true mean.
    pub confidence: f64,
    /// At least so many replications; below about 10, an accidentally small scatter stops too early.
    pub at_least: u64,
    /// At most so many.
    pub at_most: u64,
}

impl Replications {
    /// No replications yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { count: 0, mean: 0.0, squares: 0.0 }
    }

    /// `count` replications of `estimator`, which is given a seed each time, derived from `seed`.
    pub fn run(count: u64, seed: u64, mut estimator: impl FnMut(u64) -> f64) -> Self {
        let mut replications = Self::new();
        for i in 0..count {
            replications.push(estimator(Self::seed(seed, i)));
        }
        replications
    }

    /// Replications of `estimator` until its error is as small as wanted, or there are too many.
    ///
    /// Looking at the error after each replication makes the interval slightly too narrow; more so the smaller
    /// [`at_least`](StoppingRule::at_least) is. A NaN result never satisfies the rule.
    pub fn run_until(rule: StoppingRule, seed: u64, mut estimator: impl FnMut(u64) -> f64) -> Self {
        let mut replications = Self::new();
        while !replications.satisfies(&rule) && replications.count < rule.at_most {
            replications.push(estimator(Self::seed(seed, replications.count)));
        }
        replications
    }

    /// The seed of replication `i`: for running replications in parallel.
    #[must_use]
    pub fn seed(seed: u64, i: u64) -> u64 {
        crate::hash::combine(crate::hash::combine(0, seed), i)
    }

    /// Takes in the result of a replication.
    pub fn push(&mut self, result: f64) {
        // Welford (1962)
        self.count += 1;
        let difference = result - self.mean;
        self.mean += difference / self.count as f64;
        self.squares += difference * (result - self.mean);
    }

    /// How many replications there are.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The mean of the results; zero if there are none.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// The unbiased variance of a result; infinite for fewer than two.
    #[must_use]
    pub fn variance(&self) -> f64 {
        if self.count < 2 { f64::INFINITY } else { self.squares / (self.count - 1) as f64 }
    }

    /// The standard error of the mean; infinite for fewer than two results.
    #[must_use]
    pub fn standard_error(&self) -> f64 {
        crate::Real::sqrt(self.variance() / self.count.max(1) as f64)
    }

    /// The interval that contains the true mean with this probability, if the results are about normal (Student's t).
    ///
    /// For fewer than two results it is infinite. A confidence that is not in `(0, 1)` gives NaN.
    #[must_use]
    pub fn confidence_interval(&self, confidence: f64) -> [f64; 2] {
        let half = self.half_width(confidence);
        [self.mean - half, self.mean + half]
    }

    fn half_width(&self, confidence: f64) -> f64 {
        if !(confidence > 0.0 && confidence < 1.0) {
            return f64::NAN;
        }
        if self.count < 2 {
            return f64::INFINITY;
        }
        student_quantile(0.5 + 0.5 * confidence, (self.count - 1) as f64) * self.standard_error()
    }

    /// Whether the error is as small as wanted.
    #[must_use]
    pub fn satisfies(&self, rule: &StoppingRule) -> bool {
        self.count >= rule.at_least.max(2) && self.half_width(rule.confidence) <= rule.error
    }
}

/// The quantile of Student's t distribution for `p >= 1/2`, by bisection.
fn student_quantile(p: f64, degrees: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    while student_tail(high, degrees) > 1.0 - p && high < 1e150 {
        high *= 2.0;
    }
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if student_tail(middle, degrees) > 1.0 - p {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// The probability that Student's t exceeds `t >= 0`: half of the incomplete beta function at `n / (n + t^2)`.
fn student_tail(t: f64, degrees: f64) -> f64 {
    0.5 * incomplete_beta(degrees / (degrees + t * t), 0.5 * degrees, 0.5)
}

/// The regularised incomplete beta function, by its continued fraction (Lentz's method).
fn incomplete_beta(x: f64, a: f64, b: f64) -> f64 {
    if x <= 0.0 || x >= 1.0 {
        return if x <= 0.0 { 0.0 } else { 1.0 };
    }
    let log_front = libm::lgamma(a + b) - libm::lgamma(a) - libm::lgamma(b) + a * libm::log(x) + b * libm::log1p(-x);
    let front = libm::exp(log_front);
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - front * beta_fraction(1.0 - x, b, a) / b;
    }
    front * beta_fraction(x, a, b) / a
}

fn beta_fraction(x: f64, a: f64, b: f64) -> f64 {
    let away = |y: f64| if y.abs() < 1e-300 { 1e-300 } else { y };
    let mut c = 1.0;
    let mut d = 1.0 / away(1.0 - (a + b) * x / (a + 1.0));
    let mut fraction = d;
    for m in 1..1000 {
        let m = f64::from(m);
        for numerator in [
            m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m)),
            -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0)),
        ] {
            d = 1.0 / away(1.0 + numerator * d);
            c = away(1.0 + numerator / c);
            fraction *= c * d;
        }
        if (c * d - 1.0).abs() < 1e-15 {
            break;
        }
    }
    fraction
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From tables of the t distribution.
    #[test]
    fn student_quantiles_are_those_of_the_tables() {
        for (p, degrees, t) in [
            (0.975, 1.0, 12.706_204_736_174_69),
            (0.975, 10.0, 2.228_138_851_986_274),
            (0.995, 4.0, 4.604_094_871_349_993),
            (0.95, 100.0, 1.660_234_326_065_749),
            (0.975, 1e6, 1.959_966_4),
        ] {
            assert!((student_quantile(p, degrees) - t).abs() < 1e-6 * t, "{p} {degrees}");
        }
    }

    #[test]
    fn mean_and_error_of_known_results() {
        let mut replications = Replications::new();
        assert_eq!(replications.confidence_interval(0.5), [f64::NEG_INFINITY, f64::INFINITY]);
        for result in [1.0, 2.0, 3.0, 4.0] {
            replications.push(result);
        }
        assert_eq!((replications.mean(), replications.count()), (2.5, 4));
        assert!((replications.variance() - 5.0 / 3.0).abs() < 1e-15);
        assert!((replications.standard_error() - (5.0_f64 / 12.0).sqrt()).abs() < 1e-15);
        assert!(replications.confidence_interval(1.0)[0].is_nan());
    }

    #[test]
    fn stops_when_the_error_is_small_enough() {
        let rule = StoppingRule { error: 0.05, confidence: 0.95, at_least: 10, at_most: 100_000 };
        let uniform = |seed: u64| crate::f64_from_bits(seed);
        let result = Replications::run_until(rule, 1, uniform);
        assert!(result.satisfies(&rule) && (50..400).contains(&result.count()), "{result:?}");
        assert_eq!(Replications::run_until(StoppingRule { at_most: 20, ..rule }, 1, uniform).count(), 20);
        assert_eq!(Replications::run_until(StoppingRule { at_most: 20, ..rule }, 1, |_| f64::NAN).count(), 20);
        assert_eq!(Replications::run_until(rule, 1, |_| 3.0).count(), 10);
    }
}
