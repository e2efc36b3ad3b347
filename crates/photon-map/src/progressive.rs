//! Radii that shrink.

use std::f64::consts::PI;

use crate::Flux;

/// Why a progressive estimate cannot begin, or go on from a file.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProgressiveError {
    /// The first radius is not positive and finite.
    #[error("the first radius is positive and finite, not {0}")]
    Radius(f32),
    /// The exponent is not strictly between zero and one.
    #[error("alpha lies strictly between 0 and 1, not at {0}")]
    Alpha(f64),
    /// The squared radius of a file is not positive and finite.
    #[error("a squared radius is positive, and its root finite in single precision, not {0}")]
    RadiusSquared(f64),
    /// The iteration of a file is not one of those that are counted exactly.
    #[error("iterations are counted from 1 to 2^53, not {0}")]
    Iteration(u64),
    /// The number of photons of a file is negative or not finite.
    #[error("the number of photons is finite and not negative, not {0}")]
    Photons(f64),
    /// The flux of a file is not finite.
    #[error("the flux that a point has gathered is not finite")]
    Flux,
}

fn validate(radius: f32, alpha: f64) -> Result<f64, ProgressiveError> {
    if !(radius > 0.0 && radius.is_finite()) {
        return Err(ProgressiveError::Radius(radius));
    }
    exponent(alpha)?;
    Ok(f64::from(radius) * f64::from(radius))
}

fn exponent(alpha: f64) -> Result<f64, ProgressiveError> {
    if alpha > 0.0 && alpha < 1.0 { Ok(alpha) } else { Err(ProgressiveError::Alpha(alpha)) }
}

/// A squared radius that has shrunk already: its root may be too small for an `f32`, but not too large.
#[cfg(feature = "serde")]
fn shrunk(radius_squared: f64) -> Result<f64, ProgressiveError> {
    let valid = radius_squared > 0.0 && radius_squared <= f64::from(f32::MAX).powi(2);
    if valid { Ok(radius_squared) } else { Err(ProgressiveError::RadiusSquared(radius_squared)) }
}

/// A radius that shrinks from iteration to iteration, so that the mean of the iterations' estimates is consistent.
///
/// ```text
/// r_(i+1)^2 = r_i^2 (i + alpha) / (i + 1),    i = 1, 2, ..        result: mean over i of the estimate with radius r_i
/// ```
///
/// **Symbols.** `r_i`: radius of iteration `i`, the same for all points or any first radius of each point; `alpha` in
/// `(0, 1)`.
///
/// **Assumptions.** Each iteration traces photons of its own. Any kernel.
///
/// **Consistent**, for every `alpha` in `(0, 1)`: `r_i^2 ~ r_1^2 i^(alpha-1) / Gamma(1+alpha)`, so the variance of
/// the mean falls as `n^-alpha` and its bias as `n^(alpha-1)`. Biased after finitely many. `alpha = 2/3` balances
/// variance and squared bias: the mean squared error falls as `n^(-2/3)`, and no `alpha` does better.
///
/// **Cost.** Two multiplications per iteration; 24 bytes.
///
/// **Source.** C. Knaus and M. Zwicker, "Progressive Photon Mapping: A Probabilistic Approach", ACM TOG 30(3), 2011.
///
/// # Example
/// ```
/// use photon_map::ProgressiveRadius;
/// let mut radius = ProgressiveRadius::new(1.0, 0.5)?;
/// radius.advance();
/// assert!((radius.radius_squared() - 0.75).abs() < 1e-12);  // (1 + 1/2) / (1 + 1)
/// # Ok::<(), photon_map::ProgressiveError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Unchecked"))]
pub struct ProgressiveRadius {
    radius_squared: f64,
    iteration: u64,
    alpha: f64,
}

#[cfg(feature = "serde")]
read_through!(ProgressiveRadius { radius_squared: f64, iteration: u64, alpha: f64 } => {
    if !(1..=1 << f64::MANTISSA_DIGITS).contains(&iteration) {
        return Err(ProgressiveError::Iteration(iteration));
    }
    Ok(Self { radius_squared: shrunk(radius_squared)?, iteration, alpha: exponent(alpha)? })
}, ProgressiveError);

impl ProgressiveRadius {
    /// The radius of the first iteration.
    ///
    /// # Errors
    /// [`ProgressiveError`] if the radius is not positive and finite, or `alpha` not in `(0, 1)`.
    pub fn new(radius: f32, alpha: f64) -> Result<Self, ProgressiveError> {
        Ok(Self { radius_squared: validate(radius, alpha)?, iteration: 1, alpha })
    }

    /// On to the next iteration.
    pub fn advance(&mut self) {
        let i = self.iteration as f64;
        self.radius_squared *= (i + self.alpha) / (i + 1.0);
        self.iteration += 1;
    }

    /// The number of the current iteration, from one.
    #[must_use]
    pub const fn iteration(&self) -> u64 {
        self.iteration
    }

    /// The radius of the current iteration.
    #[must_use]
    pub fn radius(&self) -> f32 {
        self.radius_squared.sqrt() as f32
    }

    /// Its square.
    #[must_use]
    pub const fn radius_squared(&self) -> f64 {
        self.radius_squared
    }
}

/// What a point remembers in progressive photon mapping: its radius shrinks by how many photons it finds.
///
/// ```text
/// R'^2 = R^2 (N + alpha M) / (N + M),   N' = N + alpha M,   tau' = (tau + tau_M) R'^2 / R^2
/// radiance ~ tau / (pi R^2 n)
/// ```
///
/// **Symbols.** `R`: radius; `N`: photons counted so far; `M`, `tau_M`: number and sum of flux times BSDF of the
/// photons that the current iteration finds within `R`; `n`: paths of all iterations together.
///
/// **Assumptions.** The density of photons is uniform within `R` (that is what the factor `R'^2 / R^2` says), and
/// each iteration traces photons of its own. With stochastic progressive photon mapping the point moves within a
/// pixel from iteration to iteration, and the state belongs to the pixel.
///
/// **Consistent**, biased after finitely many iterations. The radius depends on the photons, hence on chance; with
/// [`ProgressiveRadius`] it does not, which is easier to reason about and lets any kernel be used.
///
/// **Cost.** A division per iteration; `24 + size of F` bytes, up to padding.
///
/// **Source.** T. Hachisuka, S. Ogaki, H. W. Jensen, "Progressive Photon Mapping", SIGGRAPH Asia 2008;
/// T. Hachisuka, H. W. Jensen, "Stochastic Progressive Photon Mapping", SIGGRAPH Asia 2009.
///
/// # Example
/// ```
/// use photon_map::ProgressivePoint;
/// let mut point = ProgressivePoint::new(1.0, 0.5)?;
/// point.add(2, 8.0_f64);      // the first photons: R^2 becomes 1/2
/// assert_eq!((point.radius_squared(), point.photons()), (0.5, 1.0));
/// let radiance = point.radiance(100);
/// assert!((radiance - 8.0 / (std::f64::consts::PI * 100.0)).abs() < 1e-12);
/// # Ok::<(), photon_map::ProgressiveError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(try_from = "UncheckedPoint<F>", bound(deserialize = "F: Flux + serde::Deserialize<'de>"))
)]
pub struct ProgressivePoint<F> {
    radius_squared: f64,
    photons: f64,
    alpha: f64,
    flux: F,
}

/// The fields, before they are checked.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct UncheckedPoint<F> {
    radius_squared: f64,
    photons: f64,
    alpha: f64,
    flux: F,
}

#[cfg(feature = "serde")]
impl<F: Flux> TryFrom<UncheckedPoint<F>> for ProgressivePoint<F> {
    type Error = ProgressiveError;

    fn try_from(unchecked: UncheckedPoint<F>) -> Result<Self, ProgressiveError> {
        let UncheckedPoint { radius_squared, photons, alpha, flux } = unchecked;
        if !(photons >= 0.0 && photons.is_finite()) {
            return Err(ProgressiveError::Photons(photons));
        }
        if !flux.is_finite() {
            return Err(ProgressiveError::Flux);
        }
        Ok(Self { radius_squared: shrunk(radius_squared)?, photons, alpha: exponent(alpha)?, flux })
    }
}

impl<F: Flux> ProgressivePoint<F> {
    /// A point that has seen no photon.
    ///
    /// # Errors
    /// [`ProgressiveError`] if the radius is not positive and finite, or `alpha` not in `(0, 1)`.
    pub fn new(radius: f32, alpha: f64) -> Result<Self, ProgressiveError> {
        Ok(Self { radius_squared: validate(radius, alpha)?, photons: 0.0, alpha, flux: F::ZERO })
    }

    /// Adds what an iteration found within [`radius`](Self::radius): the number of photons, and the sum of their flux
    /// times BSDF, not weighted by a kernel and not divided by the number of paths.
    ///
    /// Sums that are not finite are ignored, photons included.
    pub fn add(&mut self, found: u64, flux: F) {
        if found == 0 || !flux.is_finite() {
            return;
        }
        let found = found as f64;
        let kept = self.photons + self.alpha * found;
        let shrinkage = kept / (self.photons + found);
        self.radius_squared *= shrinkage;
        self.photons = kept;
        self.flux = self.flux.add(flux).scale(shrinkage);
    }

    /// The radius to search the next iteration's photons in.
    #[must_use]
    pub fn radius(&self) -> f32 {
        self.radius_squared.sqrt() as f32
    }

    /// Its square.
    #[must_use]
    pub const fn radius_squared(&self) -> f64 {
        self.radius_squared
    }

    /// The number of photons that the current radius is worth.
    #[must_use]
    pub const fn photons(&self) -> f64 {
        self.photons
    }

    /// The estimate after `paths` paths in all iterations together; zero if there were none.
    #[must_use]
    pub fn radiance(&self, paths: u64) -> F {
        if paths == 0 { F::ZERO } else { self.flux.scale(1.0 / (PI * self.radius_squared * paths as f64)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `prod_(i=1..n) (i + a)/(i + 1) -> n^(a-1) / Gamma(1+a)`; with `a = 1/2`, `Gamma(3/2) = sqrt(pi)/2`.
    #[test]
    fn the_squared_radius_shrinks_as_derived() {
        let mut radius = ProgressiveRadius::new(2.0, 0.5).unwrap();
        while radius.iteration() < 1_000_000 {
            radius.advance();
        }
        let limit = 4.0 * 1e6_f64.powf(-0.5) / (PI.sqrt() / 2.0);
        assert!((radius.radius_squared() / limit - 1.0).abs() < 1e-5);
        assert!((f64::from(radius.radius()).powi(2) / limit - 1.0).abs() < 1e-5);
    }

    /// Bias goes with the mean of `r_i^2`, variance with that of `1 / r_i^2` over `n`: slopes between `10^5` and
    /// `10^6` iterations.
    #[test]
    fn bias_and_variance_fall_at_the_stated_rates() {
        for alpha in [0.4, 2.0 / 3.0, 0.8] {
            let mut radius = ProgressiveRadius::new(1.0, alpha).unwrap();
            let (mut bias, mut variance, mut at) = (0.0, 0.0, Vec::new());
            for n in 1..=1_000_000_u32 {
                bias += radius.radius_squared();
                variance += 1.0 / radius.radius_squared();
                if n == 100_000 || n == 1_000_000 {
                    at.push((bias / f64::from(n), variance / f64::from(n).powi(2)));
                }
                radius.advance();
            }
            let slopes = ((at[1].0 / at[0].0).log10(), (at[1].1 / at[0].1).log10());
            assert!((slopes.0 - (alpha - 1.0)).abs() < 4e-3 && (slopes.1 + alpha).abs() < 4e-3, "{alpha}: {slopes:?}");
        }
    }

    /// With photons of uniform density `1/area` per path the estimate is that density throughout, whatever the radius.
    #[test]
    fn a_uniform_density_is_left_alone() {
        let mut point = ProgressivePoint::new(1.0, 0.7).unwrap();
        let (mut paths, per_iteration) = (0, 1e15);
        for _ in 0..1000 {
            let found = per_iteration * PI * point.radius_squared() / 10.0;
            point.add(found as u64, found);
            paths += per_iteration as u64;
        }
        assert!(point.radius() < 0.4);
        assert!((point.radiance(paths) - 0.1).abs() < 1e-9, "{}", point.radiance(paths));
    }

    #[test]
    fn nothing_found_changes_nothing() {
        let mut point = ProgressivePoint::new(1.0, 0.7).unwrap();
        let before = point;
        point.add(0, 0.0_f32);
        point.add(3, f32::NAN);
        assert_eq!(point, before);
        assert_eq!(point.radiance(0), 0.0);
        assert_eq!(point.photons(), 0.0);
    }

    #[test]
    fn impossible_beginnings_are_refused() {
        for radius in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert!(matches!(ProgressiveRadius::new(radius, 0.5), Err(ProgressiveError::Radius(_))));
        }
        for alpha in [0.0, 1.0, f64::NAN] {
            assert!(matches!(ProgressivePoint::<f32>::new(1.0, alpha), Err(ProgressiveError::Alpha(_))));
        }
    }
}
