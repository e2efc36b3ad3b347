//! Variance, cost and efficiency of an estimator.

/// Mean and variance of a stream of values.
///
/// ```text
/// mean = 1/n sum x_i,    variance = 1/(n-1) sum (x_i - mean)^2
/// ```
///
/// **Assumptions.** The values are independent and of equal distribution. A value that is infinite or NaN makes the
/// results NaN.
///
/// **Unbiased**, both.
///
/// **Cost.** One division and a few additions per value; 24 bytes.
///
/// **Source.** B. P. Welford 1962; merging: T. Chan, G. Golub, R. LeVeque 1979.
///
/// # Example
/// ```
/// use mis_heuristics::RunningVariance;
/// let values: RunningVariance = [1.0, 2.0, 3.0, 4.0].into_iter().collect();
/// assert_eq!((values.mean(), values.variance()), (Some(2.5), Some(5.0 / 3.0)));
/// assert_eq!(RunningVariance::new().mean(), None);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RunningVariance {
    count: u64,
    mean: f64,
    /// Sum of the squared deviations from the mean.
    squares: f64,
}

impl RunningVariance {
    /// No values.
    pub const fn new() -> Self {
        Self { count: 0, mean: 0.0, squares: 0.0 }
    }

    /// Adds a value.
    #[inline]
    pub fn push(&mut self, value: f64) {
        self.count += 1;
        let before = value - self.mean;
        self.mean += before / self.count as f64;
        self.squares += before * (value - self.mean);
    }

    /// Adds the values of another stream.
    pub fn merge(&mut self, other: &Self) {
        if other.count == 0 {
            return;
        }
        if self.count == 0 {
            *self = *other;
            return;
        }
        let count = self.count + other.count;
        let apart = other.mean - self.mean;
        let fraction = other.count as f64 / count as f64;
        self.mean += apart * fraction;
        self.squares += other.squares + apart * apart * fraction * self.count as f64;
        self.count = count;
    }

    /// Number of values.
    pub const fn count(&self) -> u64 {
        self.count
    }

    /// Their mean; `None` if there are none.
    pub fn mean(&self) -> Option<f64> {
        (self.count > 0).then_some(self.mean)
    }

    /// The variance of **one** value; `None` if there are fewer than two.
    pub fn variance(&self) -> Option<f64> {
        (self.count > 1).then(|| self.squares / (self.count - 1) as f64)
    }

    /// The variance of the mean; `None` if there are fewer than two values.
    pub fn variance_of_mean(&self) -> Option<f64> {
        self.variance().map(|variance| variance / self.count as f64)
    }
}

impl Extend<f64> for RunningVariance {
    fn extend<I: IntoIterator<Item = f64>>(&mut self, values: I) {
        values.into_iter().for_each(|value| self.push(value));
    }
}

impl FromIterator<f64> for RunningVariance {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        let mut stream = Self::new();
        stream.extend(values);
        stream
    }
}

/// How efficient an estimator is: variance and cost of its realisations.
///
/// ```text
/// efficiency = 1 / (sigma^2(eta) T(eta))
/// ```
///
/// **Symbols.** `sigma^2`: variance of one realisation of the estimator `eta`; `T`: its mean cost, in seconds, rays,
/// densities asked for: whatever is
/// added, the same for all that are compared.
///
/// **Assumptions.** Realisations are independent. Taking the mean of `n` of them divides the variance and multiplies
/// the cost, so the efficiency
/// does not depend on `n`; at equal variance, the ratio of two efficiencies is the ratio of the costs.
///
/// **Consistent** (the reciprocal of an unbiased variance is not unbiased).
///
/// **Cost.** As two [`RunningVariance`] values.
///
/// **Source.** Kollig and Keller 2004, section 4.1.
///
/// # Example
/// ```
/// use mis_heuristics::Efficiency;
/// let (mut cheap, mut dear) = (Efficiency::new(), Efficiency::new());
/// for (a, b) in [(0.0, 0.5), (2.0, 1.5), (0.0, 0.5), (2.0, 1.5)] {
///     cheap.add(a, 1.0); // a quarter of the cost,
///     dear.add(b, 4.0);  // four times the variance
/// }
/// assert_eq!(cheap.efficiency(), Some(0.75));
/// assert_eq!(cheap.relative_to(&dear), Some(1.0));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Efficiency {
    values: RunningVariance,
    costs: RunningVariance,
}

impl Efficiency {
    /// No realisations.
    pub const fn new() -> Self {
        Self { values: RunningVariance::new(), costs: RunningVariance::new() }
    }

    /// Adds a realisation: its value and what it cost.
    #[inline]
    pub fn add(&mut self, value: f64, cost: f64) {
        self.values.push(value);
        self.costs.push(cost);
    }

    /// Adds the realisations of another stream of the same estimator.
    pub fn merge(&mut self, other: &Self) {
        self.values.merge(&other.values);
        self.costs.merge(&other.costs);
    }

    /// The values.
    pub const fn values(&self) -> &RunningVariance {
        &self.values
    }

    /// The costs.
    pub const fn costs(&self) -> &RunningVariance {
        &self.costs
    }

    /// `1 / (variance * cost)`: infinite if either is zero; `None` with fewer than two realisations.
    pub fn efficiency(&self) -> Option<f64> {
        Some(1.0 / (self.values.variance()? * self.costs.mean()?))
    }

    /// How many times more efficient than `other`; `None` if either has fewer than two realisations or both are
    /// infinite.
    pub fn relative_to(&self, other: &Self) -> Option<f64> {
        let ratio = self.efficiency()? / other.efficiency()?;
        (!ratio.is_nan()).then_some(ratio)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stream_equals_two_passes_far_from_zero() {
        let values = (0..1000).map(|k| 1e9 + f64::from(k % 17));
        let mean = (0..1000).map(|k| f64::from(k % 17)).sum::<f64>() / 1000.0;
        let variance = (0..1000).map(|k| (f64::from(k % 17) - mean).powi(2)).sum::<f64>() / 999.0;
        let stream: RunningVariance = values.collect();
        assert!((stream.mean().unwrap() - 1e9 - mean).abs() < 1e-6);
        assert!((stream.variance().unwrap() / variance - 1.0).abs() < 1e-6);
    }

    #[test]
    fn merging_equals_one_stream() {
        let value = |k: u32| f64::from((k * 37) % 101);
        let whole: RunningVariance = (0..500).map(value).collect();
        for cut in [0, 1, 250, 499, 500] {
            let mut merged: RunningVariance = (0..cut).map(value).collect();
            merged.merge(&(cut..500).map(value).collect());
            assert_eq!(merged.count(), 500);
            assert!((merged.mean().unwrap() - whole.mean().unwrap()).abs() < 1e-12);
            assert!((merged.variance().unwrap() - whole.variance().unwrap()).abs() < 1e-9);
        }
    }

    #[test]
    fn too_few_values() {
        let mut stream = Efficiency::new();
        assert_eq!((stream.efficiency(), stream.values().variance()), (None, None));
        stream.add(1.0, 2.0);
        assert_eq!((stream.efficiency(), stream.costs().mean()), (None, Some(2.0)));
        stream.add(1.0, 2.0);
        assert_eq!(stream.efficiency(), Some(f64::INFINITY));
        assert_eq!(stream.relative_to(&stream), None);
        stream.add(f64::NAN, 2.0);
        assert!(stream.efficiency().is_some_and(f64::is_nan));
    }
}
