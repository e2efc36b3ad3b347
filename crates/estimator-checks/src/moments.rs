//! Mean and variance of a stream of numbers.

/// Count, mean and variance of a stream of numbers, accumulated without cancellation.
///
/// ```text
/// mean_n = mean_{n-1} + (x - mean_{n-1}) / n,     M2_n = M2_{n-1} + (x - mean_{n-1}) (x - mean_n)
/// ```
///
/// `variance = M2 / (n - 1)` is the unbiased sample variance. NaN and infinities make mean and variance NaN. Accumulators
/// of parts can be [merged](Self::merge) (Chan, Golub, LeVeque 1979). The cost is one division per number.
///
/// Source: Welford, "Note on a method for calculating corrected sums of squares and products", Technometrics 4 (1962).
///
/// ```
/// let moments: estimator_checks::Moments = [1.0, 2.0, 3.0].into_iter().collect();
/// assert_eq!((moments.count(), moments.mean(), moments.variance()), (3, 2.0, 1.0));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    count: u64,
    mean: f64,
    m2: f64,
}

impl Moments {
    /// No numbers yet.
    pub const fn new() -> Self {
        Self { count: 0, mean: 0.0, m2: 0.0 }
    }

    /// Adds a number.
    pub fn push(&mut self, x: f64) {
        self.count += 1;
        let delta = x - self.mean;
        self.mean += delta / self.count as f64;
        self.m2 += delta * (x - self.mean);
    }

    /// Adds all numbers of another accumulator.
    pub fn merge(&mut self, other: &Self) {
        if other.count == 0 {
            return;
        }
        let (n_a, n_b) = (self.count as f64, other.count as f64);
        let delta = other.mean - self.mean;
        self.count += other.count;
        self.mean += delta * (n_b / (n_a + n_b));
        self.m2 += other.m2 + delta * delta * (n_a * n_b / (n_a + n_b));
    }

    /// How many numbers.
    pub const fn count(&self) -> u64 {
        self.count
    }

    /// The mean; NaN if empty.
    pub fn mean(&self) -> f64 {
        if self.count == 0 { f64::NAN } else { self.mean }
    }

    /// The unbiased variance; NaN for fewer than two numbers.
    pub fn variance(&self) -> f64 {
        if self.count < 2 { f64::NAN } else { self.m2 / (self.count - 1) as f64 }
    }

    /// The estimated variance of the mean, `variance / n`, for independent numbers.
    pub fn variance_of_mean(&self) -> f64 {
        self.variance() / self.count as f64
    }

    /// The moments of the numbers multiplied by a constant.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self { count: self.count, mean: self.mean * factor, m2: self.m2 * factor * factor }
    }
}

impl Extend<f64> for Moments {
    fn extend<I: IntoIterator<Item = f64>>(&mut self, numbers: I) {
        numbers.into_iter().for_each(|x| self.push(x));
    }
}

impl FromIterator<f64> for Moments {
    fn from_iter<I: IntoIterator<Item = f64>>(numbers: I) -> Self {
        let mut moments = Self::new();
        moments.extend(numbers);
        moments
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn empty_and_single() {
        assert!(Moments::new().mean().is_nan() && Moments::new().variance().is_nan());
        let one: Moments = [4.0].into_iter().collect();
        assert!(one.mean() == 4.0 && one.variance().is_nan());
        let mut merged = one;
        merged.merge(&Moments::new());
        assert_eq!(merged, one);
        let nan: Moments = [1.0, f64::NAN].into_iter().collect();
        assert!(nan.mean().is_nan() && nan.variance().is_nan());
    }

    #[test]
    fn no_cancellation_far_from_zero() {
        let moments: Moments = (0..1000).map(|i| 1e9 + f64::from(i % 2)).collect();
        assert!((moments.variance() - 0.25 * 1000.0 / 999.0).abs() < 1e-6);
    }

    proptest! {
        #[test]
        fn merging_equals_pushing(a in prop::collection::vec(-10.0..10.0_f64, 0..20), b in prop::collection::vec(-10.0..10.0_f64, 2..20)) {
            let mut merged: Moments = a.iter().copied().collect();
            merged.merge(&b.iter().copied().collect());
            let all: Moments = a.into_iter().chain(b).collect();
            prop_assert!((merged.mean() - all.mean()).abs() < 1e-12);
            prop_assert!((merged.variance() - all.variance()).abs() < 1e-10);
        }
    }
}
