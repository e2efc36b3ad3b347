//! How many candidates, how many samples.

use crate::{Float, Uniform};

/// `M` candidates for each of `N` samples, both real.
///
/// Whoever draws rounds them up or down at random such that the expectation stays (Talbot, Cline and Egbert 2005, end of section 4.2). A rounded count
/// has `E[1/M] > 1/E[M]`: the prediction of variances accounts for it, see [`mean_inverse`](Self::mean_inverse).
///
/// Numbers below one, and NaN, count as one; those above `2^24` as `2^24`.
///
/// ```
/// use ris::Budget;
/// let budget = Budget { candidates: 15.75, samples: 10.64 };
/// assert_eq!(Budget::round(budget.candidates, &mut || 0.7), 16);
/// assert_eq!(Budget::round(budget.candidates, &mut || 0.8), 15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// `M`, the number of candidates per sample.
    pub candidates: f32,
    /// `N`, the number of samples.
    pub samples: f32,
}

impl Budget {
    /// One sample of one candidate: importance sampling.
    pub const ONE: Self = Self { candidates: 1.0, samples: 1.0 };

    /// At least one, at most what fits.
    #[inline]
    fn clamp(count: f32) -> f32 {
        if count > 1.0 { count.min(16_777_216.0) } else { 1.0 }
    }

    /// The integer below or above with expectation `count`. Draws no number if `count` is an integer.
    #[inline]
    pub fn round<F: Float>(count: f32, uniform: &mut impl Uniform<F>) -> u32 {
        let count = Self::clamp(count);
        let floor = count as u32;
        let part = f64::from(count) - f64::from(floor);
        if part > 0.0 && uniform.next_uniform().to_f64() < part { floor + 1 } else { floor }
    }

    /// `E[1/K]` of the rounded count `K`.
    pub fn mean_inverse(count: f32) -> f64 {
        let count = f64::from(Self::clamp(count));
        let floor = (count as u32) as f64;
        let part = count - floor;
        (1.0 - part) / floor + part / (floor + 1.0)
    }

    /// Expected cost: `N (M T_X + T_Y)`.
    pub fn cost(&self, cost: crate::CostModel) -> f64 {
        let (m, n) = (f64::from(Self::clamp(self.candidates)), f64::from(Self::clamp(self.samples)));
        n * (m * cost.candidate + cost.sample)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_keeps_the_expectation() {
        for count in [1.0_f32, 1.25, 2.5, 15.75, 60.0] {
            let steps = 4096;
            let sum: u32 =
                (0..steps).map(|k| Budget::round(count, &mut || (f64::from(k) + 0.5) / f64::from(steps))).sum();
            assert_eq!(f64::from(sum) / f64::from(steps), f64::from(count));
            let inverse: f64 = (0..steps)
                .map(|k| 1.0 / f64::from(Budget::round(count, &mut || (f64::from(k) + 0.5) / f64::from(steps))))
                .sum();
            assert!((inverse / f64::from(steps) - Budget::mean_inverse(count)).abs() < 1e-12);
        }
    }

    #[test]
    fn what_is_no_count_is_one() {
        for count in [0.0, -3.0, f32::NAN, f32::NEG_INFINITY, 0.999] {
            assert_eq!(Budget::round(count, &mut || 0.0_f64), 1);
            assert_eq!(Budget::mean_inverse(count), 1.0);
        }
        assert_eq!(Budget::round(f32::INFINITY, &mut || 0.0_f64), 1 << 24);
    }
}
