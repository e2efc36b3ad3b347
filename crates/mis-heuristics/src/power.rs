//! The power heuristic.

use crate::math::{pow, powi, ratio, ratio_weight};
use crate::{Balance, Densities, Float, Heuristic, Maximum};

/// The power heuristic: weights in proportion to a power of the densities.
///
/// ```text
/// w_i = d_i^beta / sum_j d_j^beta,    d_j = n_j p_j
/// ```
///
/// **Symbols.** `d_j`: density of technique `j`, all in the same measure. `beta` in `[1, inf]`: 1 is the
/// [`Balance`] heuristic, 2 the usual choice, infinity the [`Maximum`] heuristic. (The sum runs over its own
/// index; Kollig and Keller's print reuses `i`.)
///
/// **Assumptions.** The laws of [`Heuristic`]; none beyond.
///
/// **Unbiased.** For beta = 2 the variance is bounded by Kollig and Keller's equation 5, see
/// [`variance_bound`](crate::variance_bound).
/// Larger beta favour the technique of largest density, which pays where one technique fits the integrand well.
///
/// **Cost.** Asks for all densities, each once; for one only if the technique's own density is zero (the maximum
/// heuristic stops at the first larger one). For beta = 2 and two techniques: two multiplications, an addition, a
/// division. Whole beta up to 16 are multiplied out; any other takes a logarithm and an exponential per technique
/// (40 ns where `std` needs 15), because `core` has no power function and this crate no dependency that has one.
///
/// **Range.** Powers of densities overflow `f32` from `1.8e19` on. Outside the safe range, and always for more than two
/// techniques, the equivalent `w_i = 1 / sum_j (d_j / d_i)^beta` is used: a ratio that overflows stands for a weight
/// of zero.
///
/// **Source.** E. Veach and L. Guibas 1995, section 4; Kollig and Keller 2004, section 3.1.
///
/// # Example
/// ```
/// use mis_heuristics::{Heuristic, Power};
/// const LIGHT: usize = 0;
/// let (p_light, p_bsdf) = (3.0_f32, 1.0);
/// assert_eq!(Power::TWO.weight(LIGHT, &[p_light, p_bsdf]), 0.9);
/// let steep = Power::new(3.5)?;
/// assert!(steep.weight(LIGHT, &[p_light, p_bsdf]) > 0.97);
/// # Ok::<(), mis_heuristics::PowerError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "f64", into = "f64"))]
pub struct Power {
    exponent: Exponent,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Exponent {
    One,
    Two,
    Whole(u32),
    Any(f64),
    Infinite,
}

/// Largest beta that is multiplied out.
const LARGEST_WHOLE: u32 = 16;

/// Why there is no [`Power`] heuristic with the wanted exponent.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PowerError {
    /// The exponent is below one, or NaN.
    Exponent(f64),
}

impl core::fmt::Display for PowerError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Exponent(beta) => write!(f, "the power heuristic needs an exponent in [1, inf], not {beta}"),
        }
    }
}

impl core::error::Error for PowerError {}

impl Power {
    /// beta = 1, the balance heuristic.
    pub const ONE: Self = Self { exponent: Exponent::One };
    /// beta = 2, the usual choice.
    pub const TWO: Self = Self { exponent: Exponent::Two };
    /// beta = infinity, the maximum heuristic.
    pub const MAXIMUM: Self = Self { exponent: Exponent::Infinite };

    /// The power heuristic with exponent `beta`.
    ///
    /// # Errors
    /// [`PowerError::Exponent`] if `beta` is below one or NaN.
    pub fn new(beta: f64) -> Result<Self, PowerError> {
        if beta.is_nan() || beta < 1.0 {
            return Err(PowerError::Exponent(beta));
        }
        let exponent = if beta == 1.0 {
            Exponent::One
        } else if beta == 2.0 {
            Exponent::Two
        } else if beta == f64::INFINITY {
            Exponent::Infinite
        } else if beta <= f64::from(LARGEST_WHOLE) && f64::from(beta as u32) == beta {
            Exponent::Whole(beta as u32)
        } else {
            Exponent::Any(beta)
        };
        Ok(Self { exponent })
    }

    /// The exponent.
    #[must_use]
    pub fn beta(&self) -> f64 {
        match self.exponent {
            Exponent::One => 1.0,
            Exponent::Two => 2.0,
            Exponent::Whole(beta) => f64::from(beta),
            Exponent::Any(beta) => beta,
            Exponent::Infinite => f64::INFINITY,
        }
    }
}

impl TryFrom<f64> for Power {
    type Error = PowerError;
    fn try_from(beta: f64) -> Result<Self, PowerError> {
        Self::new(beta)
    }
}

impl From<Power> for f64 {
    fn from(power: Power) -> Self {
        power.beta()
    }
}

/// beta = 2.
impl Default for Power {
    fn default() -> Self {
        Self::TWO
    }
}

impl<F: Float> Heuristic<F> for Power {
    // Always inlined: with a constant exponent and an array of two all but a few instructions vanish.
    #[inline(always)]
    fn weight(&self, technique: usize, densities: &(impl Densities<F> + ?Sized)) -> F {
        match self.exponent {
            Exponent::One => Balance.weight(technique, densities),
            Exponent::Two => square_weight(technique, densities),
            Exponent::Whole(beta) => ratio_weight(technique, densities, |x| powi(x, beta)),
            Exponent::Any(beta) => ratio_weight(technique, densities, |x| F::from_f64(pow(x.to_f64(), beta))),
            Exponent::Infinite => Maximum.weight(technique, densities),
        }
    }
}

/// beta = 2; the two techniques of next event estimation in a few instructions.
#[inline(always)]
fn square_weight<F: Float>(technique: usize, densities: &(impl Densities<F> + ?Sized)) -> F {
    if densities.len() != 2 {
        return ratio_weight(technique, densities, |x| x * x);
    }
    let own = densities.density(technique).positive_part();
    if own <= F::ZERO {
        return F::ZERO;
    }
    let other = densities.density(1 - technique).positive_part();
    let square = own * own;
    let sum = square + other * other;
    if sum >= F::SAFE_SQUARE && sum < F::INFINITY {
        return square / sum;
    }
    // The squares leave the range. Inlined: a call, although never made, would cost the caller its registers.
    let quotient = ratio(other, own);
    F::ONE / (F::ONE + quotient * quotient)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::HeuristicExt;

    #[test]
    fn exponents_are_checked() {
        for beta in [0.0, 0.999, -1.0, f64::NEG_INFINITY] {
            assert_eq!(Power::new(beta), Err(PowerError::Exponent(beta)));
        }
        assert!(matches!(Power::new(f64::NAN), Err(PowerError::Exponent(beta)) if beta.is_nan()));
        for beta in [1.0, 1.5, 2.0, 3.0, 16.0, 17.0, 1e300, f64::INFINITY] {
            assert_eq!(Power::new(beta).unwrap().beta(), beta);
        }
        assert_eq!(Power::new(1.0), Ok(Power::ONE));
        assert_eq!(Power::new(2.0), Ok(Power::TWO));
        assert_eq!(Power::new(f64::INFINITY), Ok(Power::MAXIMUM));
    }

    #[test]
    fn every_way_to_compute_a_power_agrees() {
        let densities = [0.3_f64, 2.0, 0.7, 1.1];
        for beta in [1.0_f64, 2.0, 3.0, 7.0, 16.0, 2.5, 17.25] {
            let total: f64 = densities.iter().map(|d| d.powf(beta)).sum();
            for (i, d) in densities.iter().enumerate() {
                let weight = Power::new(beta).unwrap().weight(i, &densities);
                assert!((weight - d.powf(beta) / total).abs() < 1e-14, "beta {beta}, technique {i}: {weight}");
            }
        }
    }

    #[test]
    fn two_techniques_agree_with_the_ratio_form_over_the_whole_range() {
        for a in -45..=38 {
            for b in -45..=38 {
                let pair = [1.5 * 10_f32.powi(a), 10_f32.powi(b)];
                let quotient = f64::from(pair[1]) / f64::from(pair[0]);
                let expected = if pair[0] > 0.0 { 1.0 / (1.0 + quotient * quotient) } else { 0.0 };
                let weight = f64::from(Power::TWO.weight(0, &pair));
                assert!((weight - expected).abs() < 3e-7, "{pair:?}: {weight} instead of {expected}");
            }
        }
    }

    #[test]
    fn special_values() {
        let inf = f32::INFINITY;
        for heuristic in [1.0, 2.0, 3.0, 2.5].map(|beta| Power::new(beta).unwrap()) {
            assert_eq!(heuristic.weight(0, &[inf, 1.0]), 1.0);
            assert_eq!(heuristic.weight(1, &[inf, 1.0]), 0.0);
            assert_eq!(heuristic.weight(1, &[inf, inf]), 0.5);
            assert_eq!(heuristic.weight(2, &[inf, 1.0, inf]), 0.5);
            assert_eq!(heuristic.weight(0, &[0.0_f32, 0.0]), 0.0);
            assert_eq!(heuristic.weight(0, &[f32::NAN, 1.0]), 0.0);
            assert_eq!(heuristic.weight(1, &[f32::NAN, 1.0]), 1.0);
            assert_eq!(heuristic.weight(1, &[-5.0_f32, 1.0]), 1.0);
            assert_eq!(heuristic.weight(0, &[7.0_f32]), 1.0);
            assert_eq!(heuristic.weight_sum(&[] as &[f32; 0]), 0.0);
        }
    }
}
