//! How many candidates, how many samples.

use crate::{Float, Uniform};

/// `M` candidates for each of `N` samples, both real.
///
/// Whoever draws rounds them up or down at random such that the expectation stays (Talbot, Cline and Egbert 2005, end of section 4.2). A rounded count
/// has `E[1/M] > 1/E[M]`: the prediction of variances accounts for it, see [`mean_inverse`](Self::mean_inverse).
///
/// Numbers below one, and NaN, are one; those above `2^24` are `2^24`.
///
/// ```
/// use ris::Budget;
/// let budget = Budget::new(15.75, 10.64);
/// assert_eq!((budget.candidates(), budget.samples()), (15.75, 10.64));
/// assert_eq!(Budget::round(budget.candidates(), &mut || 0.7), 16);
/// assert_eq!(Budget::round(budget.candidates(), &mut || 0.8), 15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "Numbers"))]
pub struct Budget {
    candidates: f64,
    samples: f64,
}

/// As they are in a file.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Numbers {
    candidates: f64,
    samples: f64,
}

#[cfg(feature = "serde")]
impl From<Numbers> for Budget {
    fn from(Numbers { candidates, samples }: Numbers) -> Self {
        Self::new(candidates, samples)
    }
}

impl Budget {
    /// One sample of one candidate: importance sampling.
    pub const ONE: Self = Self { candidates: 1.0, samples: 1.0 };

    /// `M` candidates for each of `N` samples, each at least one and at most `2^24`.
    #[inline]
    #[must_use]
    pub const fn new(candidates: f64, samples: f64) -> Self {
        Self { candidates: Self::clamp(candidates), samples: Self::clamp(samples) }
    }

    /// `M`, the number of candidates per sample.
    #[inline]
    #[must_use]
    pub const fn candidates(&self) -> f64 {
        self.candidates
    }

    /// `N`, the number of samples.
    #[inline]
    #[must_use]
    pub const fn samples(&self) -> f64 {
        self.samples
    }

    /// The same with another number of candidates.
    #[inline]
    #[must_use]
    pub const fn with_candidates(self, candidates: f64) -> Self {
        Self::new(candidates, self.samples)
    }

    /// The same with another number of samples.
    #[inline]
    #[must_use]
    pub const fn with_samples(self, samples: f64) -> Self {
        Self::new(self.candidates, samples)
    }

    /// At least one, at most what fits.
    #[inline]
    const fn clamp(count: f64) -> f64 {
        if count > 1.0 { count.min(16_777_216.0) } else { 1.0 }
    }

    /// The integer below or above with expectation `count`. Draws no number if `count` is an integer.
    #[inline]
    pub fn round<F: Float>(count: f64, uniform: &mut impl Uniform<F>) -> u32 {
        let count = Self::clamp(count);
        let floor = count as u32;
        let part = count - f64::from(floor);
        if part > 0.0 && uniform.next_uniform().to_f64() < part { floor + 1 } else { floor }
    }

    /// `E[1/K]` of the rounded count `K`.
    #[must_use]
    pub fn mean_inverse(count: f64) -> f64 {
        let count = Self::clamp(count);
        let floor = f64::from(count as u32);
        let part = count - floor;
        (1.0 - part) / floor + part / (floor + 1.0)
    }

    /// Expected cost: `N (M T_X + T_Y)`.
    #[must_use]
    pub fn cost(&self, cost: crate::CostModel) -> f64 {
        self.samples * (self.candidates * cost.candidate() + cost.sample())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_keeps_the_expectation() {
        for count in [1.0, 1.25, 2.5, 15.75, 60.0] {
            let steps = 4096;
            let sum: u32 =
                (0..steps).map(|k| Budget::round(count, &mut || (f64::from(k) + 0.5) / f64::from(steps))).sum();
            assert_eq!(f64::from(sum) / f64::from(steps), count);
            let inverse: f64 = (0..steps)
                .map(|k| 1.0 / f64::from(Budget::round(count, &mut || (f64::from(k) + 0.5) / f64::from(steps))))
                .sum();
            assert!((inverse / f64::from(steps) - Budget::mean_inverse(count)).abs() < 1e-12);
        }
    }

    #[test]
    fn what_is_no_count_is_one() {
        for count in [0.0, -3.0, f64::NAN, f64::NEG_INFINITY, 0.999] {
            assert_eq!(Budget::round(count, &mut || 0.0_f64), 1);
            assert_eq!(Budget::mean_inverse(count), 1.0);
            assert_eq!(Budget::new(count, 2.0), Budget::new(1.0, 2.0));
            assert_eq!(Budget::ONE.with_samples(count), Budget::ONE);
        }
        assert_eq!(Budget::ONE.with_candidates(f64::INFINITY).candidates(), 16_777_216.0);
        assert_eq!(Budget::round(f64::INFINITY, &mut || 0.0_f64), 1 << 24);
    }
}
