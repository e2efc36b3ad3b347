//! Which photons are stored.

use crate::{Flux, Photon};

/// Smallest probability: below it, no uniform number of 53 bits can decide.
pub(crate) const LEAST: f64 = f64::EPSILON / 2.0;

/// With which probability a photon is stored.
///
/// ```text
/// sum_k delta_k flux_k  =  E sum_k delta_k flux_k / p_k  [u_k < p_k]          u_k uniform in [0, 1)
/// ```
///
/// **Symbols.** `p_k = p(x_k, wi_k)`: the probability, `u_k`: a random number of its own. Storing is a Russian
/// roulette: what is kept is worth `1 / p`.
///
/// **Unbiased** if `p > 0` wherever a stored photon matters, whatever `p` is otherwise: anything may be used for it,
/// the estimate of an importance with all its errors included, as long as `u_k` does not depend on it.
///
/// **Laws.** A probability lies in `[0, 1]`: above counts as 1, negative and below `2^-53` as 0. NaN counts as 1: a
/// photon that nothing is known about is kept as it is. The same place and direction give the same answer.
/// [`check_deposition`](crate::check::check_deposition) tests this on anybody's implementation, and
/// [`check_positive`](crate::check::check_positive) that `p > 0`.
///
/// **Source.** Keller and Wald 2000, section 2.1.
///
/// # Example
/// Closures are depositions.
/// ```
/// use photon_map::{DepositionExt, Photon};
/// let near_the_eye = |x: [f32; 3], _wi: [f32; 3]| if x[0] < 1.0 { 1.0 } else { 0.25 };
/// let photon = Photon::new([3.0, 0.0, 0.0], [0.0, 0.0, 1.0], 2.0_f32);
/// assert_eq!(near_the_eye.decide(photon, 0.2).map(|p| p.flux), Some(8.0));
/// assert_eq!(near_the_eye.decide(photon, 0.3), None);
/// ```
///
/// Dyn compatible: `&dyn Deposition`.
pub trait Deposition {
    /// The probability to store a photon that arrives at `position` from `wi`.
    fn probability(&self, position: [f32; 3], wi: [f32; 3]) -> f64;
}

// Its docs say so.
const _: Option<&dyn Deposition> = None;

impl<P: Fn([f32; 3], [f32; 3]) -> f64> Deposition for P {
    #[inline]
    fn probability(&self, position: [f32; 3], wi: [f32; 3]) -> f64 {
        self(position, wi)
    }
}

/// Stores every photon: the plain photon map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct KeepAll;

impl Deposition for KeepAll {
    #[inline]
    fn probability(&self, _: [f32; 3], _: [f32; 3]) -> f64 {
        1.0
    }
}

/// What every [`Deposition`] can do.
pub trait DepositionExt: Deposition {
    /// Keeps the photon with its probability, its flux divided by it; `None` to discard it.
    ///
    /// `u` is uniform in `[0, 1)` and used for nothing else. A number of `b` bits rounds the probability up to a
    /// multiple of `2^-b`: with the 24 bits of an `f32` that is a relative bias below `2^-24 / p`, so do not let such
    /// numbers decide on probabilities below, say, 1e-4. NaN discards.
    #[inline]
    fn decide<F: Flux>(&self, photon: Photon<F>, u: f64) -> Option<Photon<F>> {
        let p = sanitised(self.probability(photon.position, photon.wi));
        (u < p).then(|| if p < 1.0 { photon.scaled(1.0 / p) } else { photon })
    }

    /// Both decide, by one number: the probability is the product. Unbiased if both are.
    ///
    /// ```
    /// use photon_map::{Deposition, DepositionExt};
    /// let half = |_: [f32; 3], _: [f32; 3]| 0.5;
    /// let from_above = |_: [f32; 3], wi: [f32; 3]| if wi[2] > 0.0 { 1.0 } else { 0.1 };
    /// assert_eq!(half.and(from_above).probability([0.0; 3], [0.0, 0.0, 1.0]), 0.5);
    /// ```
    fn and<D: Deposition>(self, other: D) -> Both<Self, D>
    where
        Self: Sized,
    {
        Both { first: self, second: other }
    }
}

impl<D: Deposition + ?Sized> DepositionExt for D {}

/// Two rules together, see [`DepositionExt::and`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Both<A, B> {
    first: A,
    second: B,
}

impl<A: Deposition, B: Deposition> Deposition for Both<A, B> {
    #[inline]
    fn probability(&self, position: [f32; 3], wi: [f32; 3]) -> f64 {
        // The second is not asked where the first says never.
        match sanitised(self.first.probability(position, wi)) {
            0.0 => 0.0,
            p => p * sanitised(self.second.probability(position, wi)),
        }
    }
}

/// The laws of [`Deposition`] applied.
#[inline]
fn sanitised(p: f64) -> f64 {
    if p.is_nan() || p >= 1.0 {
        1.0
    } else if p < LEAST {
        0.0
    } else {
        p
    }
}

/// What happens where importance is too small.
///
/// | | where the importance gives `p < eps` | |
/// |---|---|---|
/// | [`Floor`](Self::Floor) | `p = eps` | unbiased; few photons of `1 / eps` times the flux |
/// | [`Cutoff`](Self::Cutoff) | `p = 0` | **biased**: what lies there is lost |
///
/// **Source.** Keller and Wald 2000, section 2.3.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Unchecked", rename_all = "snake_case"))]
pub enum Bound {
    /// The smallest probability, in `(0, 1]`.
    Floor(f64),
    /// The probability below which nothing is stored, in `[0, 1]`.
    Cutoff(f64),
}

/// Why there is no such bound.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BoundError {
    /// A floor that is no probability, or not above the resolution `2^-53` of random numbers.
    #[error("the floor of a deposition probability lies in [2^-53, 1], not at {0}")]
    Floor(f64),
    /// A cutoff that is no probability.
    #[error("the cutoff of a deposition probability lies in [0, 1], not at {0}")]
    Cutoff(f64),
}

/// What is read, before it is checked.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(rename_all = "snake_case")]
enum Unchecked {
    Floor(f64),
    Cutoff(f64),
}

#[cfg(feature = "serde")]
impl TryFrom<Unchecked> for Bound {
    type Error = BoundError;

    fn try_from(unchecked: Unchecked) -> Result<Self, BoundError> {
        match unchecked {
            Unchecked::Floor(eps) => Self::Floor(eps),
            Unchecked::Cutoff(eps) => Self::Cutoff(eps),
        }
        .validate()
    }
}

impl Bound {
    /// Checks the number.
    ///
    /// # Errors
    /// [`BoundError`] if it is out of range or NaN.
    pub fn validate(self) -> Result<Self, BoundError> {
        match self {
            Self::Floor(eps) if !(LEAST..=1.0).contains(&eps) => Err(BoundError::Floor(eps)),
            Self::Cutoff(eps) if !(0.0..=1.0).contains(&eps) => Err(BoundError::Cutoff(eps)),
            _ => Ok(self),
        }
    }

    /// The bounded probability; NaN stays.
    #[inline]
    pub fn apply(self, p: f64) -> f64 {
        match self {
            // Not f64::max, which would turn NaN into the floor.
            Self::Floor(eps) => {
                if p < eps {
                    eps
                } else {
                    p
                }
            }
            Self::Cutoff(eps) => {
                if p < eps {
                    0.0
                } else {
                    p
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn photon() -> Photon<f64> {
        Photon::new([0.0; 3], [0.0, 0.0, 1.0], 3.0)
    }

    /// The expectation over a random number, exactly: `p` is a multiple of 1/64, the numbers lie between the multiples.
    fn expected_flux(deposition: &impl Deposition) -> f64 {
        let kept = |i: i32| deposition.decide(photon(), (f64::from(i) + 0.5) / 64.0).map_or(0.0, |p| p.flux);
        (0..64).map(kept).sum::<f64>() / 64.0
    }

    #[test]
    fn flux_is_preserved_in_expectation_for_every_probability() {
        for numerator in 1..=64 {
            let p = f64::from(numerator) / 64.0;
            assert!((expected_flux(&move |_: [f32; 3], _: [f32; 3]| p) - 3.0).abs() < 1e-13, "{p}");
        }
        assert_eq!(expected_flux(&KeepAll), 3.0);
        let (half, quarter) = (|_: [f32; 3], _: [f32; 3]| 0.5, |_: [f32; 3], _: [f32; 3]| 0.25);
        assert!((expected_flux(&half.and(quarter).and(KeepAll)) - 3.0).abs() < 1e-13);
    }

    #[test]
    fn a_floor_preserves_flux_and_a_cutoff_loses_it() {
        for importance in [0.0, 1.0 / 64.0, 0.5, 1.0, 7.0] {
            let floor = Bound::Floor(1.0 / 32.0).validate().unwrap();
            assert!((expected_flux(&move |_: [f32; 3], _: [f32; 3]| floor.apply(importance)) - 3.0).abs() < 1e-13);
            let cutoff = Bound::Cutoff(1.0 / 32.0).validate().unwrap();
            let kept = if importance < 1.0 / 32.0 { 0.0 } else { 3.0 };
            assert!((expected_flux(&move |_: [f32; 3], _: [f32; 3]| cutoff.apply(importance)) - kept).abs() < 1e-13);
        }
    }

    #[test]
    fn nonsense_is_answered_as_documented() {
        let decide = |p: f64, u: f64| (move |_: [f32; 3], _: [f32; 3]| p).decide(photon(), u).map(|photon| photon.flux);
        assert_eq!(decide(f64::NAN, 0.99), Some(3.0));
        assert_eq!(decide(f64::INFINITY, 0.99), Some(3.0));
        assert_eq!(decide(-1.0, 0.0), None);
        assert_eq!(decide(1e-300, 0.0), None);
        assert_eq!(decide(0.5, f64::NAN), None);
        assert!(Bound::Floor(f64::NAN).apply(f64::NAN).is_nan());
        for bad in [0.0, -1.0, 2.0, f64::NAN] {
            assert!(matches!(Bound::Floor(bad).validate(), Err(BoundError::Floor(_))));
        }
        assert!(matches!(Bound::Cutoff(f64::NAN).validate(), Err(BoundError::Cutoff(_))));
    }
}
