//! The cutoff heuristic.

use crate::math::ratio;
use crate::{Balance, Densities, Float, Heuristic};

/// The cutoff heuristic: the balance heuristic among the techniques whose density is not far below the largest.
///
/// ```text
/// w_i = d_i / sum { d_j : d_j >= alpha d_max }  if d_i >= alpha d_max, else 0,    d_max = max_j d_j
/// ```
///
/// **Symbols.** `d_j = n_j p_j`: density of technique `j`, all in the same measure; `alpha` in `[0, 1]`: 0 is the
/// [`Balance`] heuristic, 1 leaves only the largest density (equal ones share).
///
/// **Assumptions.** The laws of [`Heuristic`]; none beyond.
///
/// **Unbiased.**
///
/// **Cost.** Asks for all densities once where the weight is positive, and stops at the first one that cuts the
/// technique
/// off. Beyond 32 techniques the densities of the others are asked for a second time.
///
/// **Source.** E. Veach and L. Guibas 1995, section 4.
///
/// # Example
/// ```
/// use mis_heuristics::{Cutoff, Heuristic};
/// let densities = [0.01, 1.0, 3.0];
/// let weights = [0, 1, 2].map(|i| Cutoff::new(0.1).map(|cutoff| cutoff.weight(i, &densities)));
/// assert_eq!(weights, [Ok(0.0), Ok(0.25), Ok(0.75)]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "f64", into = "f64"))]
pub struct Cutoff {
    alpha: f64,
}

/// Why there is no [`Cutoff`] heuristic with the wanted `alpha`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum CutoffError {
    /// It is not in `[0, 1]`.
    Alpha(f64),
}

impl core::fmt::Display for CutoffError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Alpha(alpha) => write!(f, "the cutoff heuristic needs an alpha in [0, 1], not {alpha}"),
        }
    }
}

impl core::error::Error for CutoffError {}

/// How many densities are remembered between the search for the largest and the sum.
const REMEMBERED: usize = 32;

impl Cutoff {
    /// Cuts off techniques whose density is below `alpha` times the largest.
    ///
    /// # Errors
    /// [`CutoffError::Alpha`] if `alpha` is not in `[0, 1]`.
    pub fn new(alpha: f64) -> Result<Self, CutoffError> {
        if (0.0..=1.0).contains(&alpha) { Ok(Self { alpha }) } else { Err(CutoffError::Alpha(alpha)) }
    }

    /// The fraction of the largest density below which a technique is cut off.
    #[must_use]
    pub fn alpha(&self) -> f64 {
        self.alpha
    }
}

impl TryFrom<f64> for Cutoff {
    type Error = CutoffError;
    fn try_from(alpha: f64) -> Result<Self, CutoffError> {
        Self::new(alpha)
    }
}

impl From<Cutoff> for f64 {
    fn from(cutoff: Cutoff) -> Self {
        cutoff.alpha()
    }
}

impl<F: Float> Heuristic<F> for Cutoff {
    fn weight(&self, technique: usize, densities: &(impl Densities<F> + ?Sized)) -> F {
        let alpha = F::from_f64(self.alpha);
        if alpha == F::ZERO {
            return Balance.weight(technique, densities);
        }
        let own = densities.density(technique).positive_part();
        if own <= F::ZERO {
            return F::ZERO;
        }

        // Find the largest density; give up as soon as the technique is cut off.
        let others = || (0..densities.len()).filter(|&other| other != technique);
        let mut remembered = [F::ZERO; REMEMBERED];
        let mut largest = own;
        for other in others() {
            let density = densities.density(other).positive_part();
            if own < alpha * density {
                return F::ZERO;
            }
            if density > largest {
                largest = density;
            }
            if other < REMEMBERED {
                remembered[other] = density;
            }
        }

        // Balance among those that are left.
        let mut sum = F::ONE;
        for other in others() {
            let density = if other < REMEMBERED { remembered[other] } else { densities.density(other).positive_part() };
            if density >= alpha * largest {
                sum = sum + ratio(density, own);
            }
        }
        F::ONE / sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Counting, HeuristicExt, Lazy};

    #[test]
    fn alpha_is_checked() {
        for alpha in [-0.1, 1.1, f64::INFINITY] {
            assert_eq!(Cutoff::new(alpha), Err(CutoffError::Alpha(alpha)));
        }
        assert!(Cutoff::new(f64::NAN).is_err());
    }

    #[test]
    fn limits() {
        let densities = [0.5_f32, 2.0, 1.0, 2.0];
        let (zero, one) = (Cutoff::new(0.0).unwrap(), Cutoff::new(1.0).unwrap());
        for i in 0..4 {
            assert_eq!(zero.weight(i, &densities), Balance.weight(i, &densities));
        }
        assert_eq!([0, 1, 2, 3].map(|i| one.weight(i, &densities)), [0.0, 0.5, 0.0, 0.5]);
        assert_eq!(one.weight(1, &[1.0, f32::INFINITY]), 1.0);
        assert_eq!(one.weight(1, &[f32::INFINITY, f32::INFINITY]), 0.5);
        assert_eq!(one.weight(0, &[0.0_f32; 3]), 0.0);
        assert_eq!(one.weight(1, &[f32::NAN, 1e-45]), 1.0);
    }

    #[test]
    fn asks_once_for_few_techniques_and_sums_to_one_for_many() {
        let cutoff = Cutoff::new(0.2).unwrap();
        let few = Counting::new([1.0_f64; 32]);
        assert_eq!(cutoff.weight(3, &few), 1.0 / 32.0);
        assert_eq!(few.take(), 32);
        let many = Lazy::new(50, |i| ((i * 7) % 50) as f64);
        assert!((cutoff.weight_sum(&many) - 1.0).abs() < 1e-14);
    }
}
