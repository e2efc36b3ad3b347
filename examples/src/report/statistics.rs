//! Means, intervals and slopes from independent trials.

use qmc_sampling::Replications;

/// A number that is positive in truth, and the interval that contains it with a probability of 95 %.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// The interval.
    pub ci95: [f64; 2],
}

impl Estimate {
    /// The mean of what trials measured.
    ///
    /// The logarithm of the mean is about normal with the standard error `s / mean`, for a standard error `s` of the mean that is
    /// small beside it; the quantile is Student's. An interval of this kind never reaches below zero. Fewer than two values say
    /// nothing about their scatter: the interval is `[0, inf]`. Without values, and for means that are not positive, NaN.
    ///
    /// ```
    /// use lichtwerk::report::Estimate;
    ///
    /// let mean = Estimate::of_mean(&[1.9, 2.0, 2.1, 2.0]);
    /// assert!((mean.value - 2.0).abs() < 1e-12 && 1.8 < mean.ci95[0] && mean.ci95[1] < 2.2);
    /// assert_eq!(Estimate::of_mean(&[2.0]).ci95, [0.0, f64::INFINITY]);
    /// ```
    pub fn of_mean(values: &[f64]) -> Self {
        let all = replications(values.iter().copied());
        Self::with_relative_error(all.mean(), all.standard_error() / all.mean(), all.count())
    }

    /// One over the product of two means: the efficiency `1 / (error * time)`.
    ///
    /// Trials that err less may do so because they took longer: the standard error of the logarithm is that of the sums `a / mean(a) +
    /// b / mean(b)`, which has their covariance in it. Slices of different lengths are cut to the shorter one.
    pub fn of_inverse_product(a: &[f64], b: &[f64]) -> Self {
        let count = a.len().min(b.len());
        let (a, b) = (&a[..count], &b[..count]);
        let [mean_a, mean_b] = [a, b].map(|values| replications(values.iter().copied()).mean());
        let sums = replications(a.iter().zip(b).map(|(a, b)| a / mean_a + b / mean_b));
        Self::with_relative_error(1.0 / (mean_a * mean_b), sums.standard_error(), sums.count())
    }

    fn with_relative_error(value: f64, relative_error: f64, count: u64) -> Self {
        if count == 0 || value.is_nan() || value <= 0.0 {
            return Self { value: f64::NAN, ci95: [f64::NAN; 2] };
        }
        if count < 2 {
            return Self { value, ci95: [0.0, f64::INFINITY] };
        }
        let half = student_quantile(count - 1) * relative_error;
        Self { value, ci95: [value * (-half).exp(), value * half.exp()] }
    }

    /// Whether the intervals have a point in common. Not if one of them is NaN.
    pub fn overlaps(&self, other: &Self) -> bool {
        self.ci95[0] <= other.ci95[1] && other.ci95[0] <= self.ci95[1]
    }
}

/// A law `y = factor * x^exponent`, fitted to points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerLaw {
    /// The exponent: the slope in a plot with two logarithmic axes.
    pub exponent: Estimate,
    /// The value at `x = 1`.
    pub factor: f64,
}

impl PowerLaw {
    /// Least squares in the logarithms, all points weighing the same; the interval of the exponent by Student's quantile with two degrees
    /// of freedom less than points. Points that are not positive and finite are passed over. Nothing for fewer than three of them, or
    /// if all have the same `x`.
    ///
    /// ```
    /// use lichtwerk::report::PowerLaw;
    ///
    /// let points: Vec<[f64; 2]> = (1..9).map(|i| [f64::from(i), 3.0 / f64::from(i)]).collect();
    /// let law = PowerLaw::fit(&points).ok_or("no law")?;
    /// assert!((law.exponent.value + 1.0).abs() < 1e-9 && (law.factor - 3.0).abs() < 1e-9);
    /// # Ok::<(), &str>(())
    /// ```
    pub fn fit(points: &[[f64; 2]]) -> Option<Self> {
        let usable = points.iter().filter(|point| point.iter().all(|x| *x > 0.0 && x.is_finite()));
        let logs: Vec<[f64; 2]> = usable.map(|point| point.map(f64::ln)).collect();
        let count = logs.len() as f64;
        let [mean_x, mean_y] = [0, 1].map(|axis| logs.iter().map(|point| point[axis]).sum::<f64>() / count);
        let xx: f64 = logs.iter().map(|[x, _]| (x - mean_x).powi(2)).sum();
        let xy: f64 = logs.iter().map(|[x, y]| (x - mean_x) * (y - mean_y)).sum();
        // Rounding alone makes equal logarithms differ by this much.
        if logs.len() < 3 || xx <= 1e-12 * count * mean_x.powi(2).max(1.0) {
            return None;
        }
        let slope = xy / xx;
        let residual: f64 = logs.iter().map(|[x, y]| (y - mean_y - slope * (x - mean_x)).powi(2)).sum();
        let error = (residual / (count - 2.0) / xx).sqrt();
        let half = student_quantile(logs.len() as u64 - 2) * error;
        let exponent = Estimate { value: slope, ci95: [slope - half, slope + half] };
        Some(Self { exponent, factor: (mean_y - slope * mean_x).exp() })
    }
}

fn replications(values: impl Iterator<Item = f64>) -> Replications {
    let mut all = Replications::new();
    values.for_each(|value| all.push(value));
    all
}

/// How many standard errors a two-sided interval of 95 % reaches to either side.
fn student_quantile(degrees_of_freedom: u64) -> f64 {
    // The interval of any values with these degrees of freedom tells; Student's distribution is the normal one long before the limit.
    let values = (0..=degrees_of_freedom.min(10_000)).map(|index| (index % 2) as f64);
    let all = replications(values);
    (all.confidence_interval(0.95)[1] - all.mean()) / all.standard_error()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From tables of the t distribution.
    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (degrees, quantile) in [(1, 12.7062), (7, 2.3646), (22, 2.0739), (1_000_000, 1.9602)] {
            assert!((student_quantile(degrees) - quantile).abs() < 2e-4, "{degrees}");
        }
    }

    #[test]
    fn a_known_power_law_is_found_and_its_interval_covers() {
        // y = 2 x^-1, with a noise of known spread in the logarithm, many times.
        let mut state = 1u64;
        let mut noise = || {
            let mut uniform = || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 11) as f64 / (1u64 << 53) as f64
            };
            0.1 * ((0..12).map(|_| uniform()).sum::<f64>() - 6.0)
        };
        let mut covered = 0;
        for _ in 0..1000 {
            let points: Vec<[f64; 2]> =
                (0..12).map(|i| f64::from(1 << (i % 4))).map(|x| [x, 2.0 / x * noise().exp()]).collect();
            let law = PowerLaw::fit(&points).unwrap();
            assert!((law.exponent.value + 1.0).abs() < 0.3);
            let [low, high] = law.exponent.ci95;
            covered += u32::from(low < -1.0 && -1.0 < high);
        }
        // 950, give or take four standard deviations.
        assert!((922..=978).contains(&covered), "{covered}");
    }

    #[test]
    fn points_without_a_slope_have_none() {
        assert!(PowerLaw::fit(&[[1.0, 1.0], [2.0, 0.5]]).is_none());
        assert!(PowerLaw::fit(&[[7.0, 1.0], [7.0, 0.5], [7.0, 0.7]]).is_none());
        assert!(PowerLaw::fit(&[[1.0, 0.0], [2.0, f64::NAN], [3.0, 1.0], [-1.0, 1.0], [f64::INFINITY, 2.0]]).is_none());
        assert!(PowerLaw::fit(&[]).is_none());
    }

    #[test]
    fn means_that_say_nothing_are_nan() {
        for values in [&[][..], &[0.0, 0.0], &[-1.0, -2.0], &[1.0, f64::NAN]] {
            assert!(Estimate::of_mean(values).value.is_nan(), "{values:?}");
        }
        assert!(!Estimate::of_mean(&[]).overlaps(&Estimate::of_mean(&[1.0])));
        assert_eq!(Estimate::of_mean(&[3.0, 3.0]), Estimate { value: 3.0, ci95: [3.0, 3.0] });
    }

    #[test]
    fn the_efficiency_knows_of_covariance() {
        // Error times time is 6 in every trial, however they share it.
        let (errors, seconds) = ([0.99, 1.0, 1.01, 1.0], [6.06, 6.0, 5.94, 6.0]);
        let efficiency = Estimate::of_inverse_product(&errors, &seconds);
        assert!((efficiency.value - 1.0 / 6.0).abs() < 1e-9);
        assert!(efficiency.ci95[1] - efficiency.ci95[0] < 1e-9, "{efficiency:?}");
        let same = Estimate::of_inverse_product(&errors, &errors);
        assert!(same.ci95[1] / same.ci95[0] > 1.02, "{same:?}");
    }
}
