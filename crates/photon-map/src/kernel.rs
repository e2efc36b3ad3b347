//! Kernels of density estimation.

use std::f64::consts::PI;

/// A kernel on the unit disk: how photons at a distance count.
///
/// ```text
/// constant        K(t) = 1 / pi
/// cone            K(t) = (1 - sqrt(t) / k) / (pi (1 - 2 / (3 k)))
/// Epanechnikov    K(t) = 2 (1 - t) / pi          t = (d / r)^2 in [0, 1),  0 beyond
/// ```
///
/// **Symbols.** `d`: distance from the centre, `r`: radius; `K(t) / r^2` has the unit 1/area and integrates to one over
/// the disk. `k >= 1`: how flat Jensen's cone is; with `k = 1` it reaches zero at the rim.
///
/// The disk is open: a photon at distance `r` does not count. So the `k`-th nearest photon, whose distance is the
/// radius, is left out, and that is what makes estimates from the nearest photons unbiased on a uniform sheet: see
/// [`Gather::nearest`](crate::Gather::nearest).
///
/// | kernel | bias `1/2 mu_2 r^2 laplacian(E)`, `mu_2 =` | variance relative to constant, same `r` |
/// |---|---|---|
/// | constant | 1/4 | 1 |
/// | cone, `k = 1` | 3/20 | 3/2 |
/// | Epanechnikov | 1/6 | 4/3 |
///
/// `mu_2` is the second moment along one axis for `r = 1`. At its best radius Epanechnikov has the least mean squared
/// error of all kernels that are not negative.
///
/// **Source.** H. W. Jensen, *Realistic Image Synthesis Using Photon Mapping*, 2001; B. W.
/// Silverman, *Density Estimation for Statistics and Data Analysis*, 1986.
///
/// # Example
/// ```
/// use photon_map::Kernel;
/// assert_eq!(Kernel::Constant.at(0.3), Kernel::Constant.at(0.9));
/// assert_eq!(Kernel::Epanechnikov.at(1.0), 0.0);
/// assert!(Kernel::cone(0.5).is_err());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Named", into = "Named"))]
pub enum Kernel {
    /// All photons of the disk alike: Jensen's plain estimate.
    Constant,
    /// Linear in the distance.
    Cone(Cone),
    /// Linear in the squared distance.
    #[default]
    Epanechnikov,
}

/// The flatness of a cone, see [`Kernel::cone`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    inverse_flatness: f64,
}

/// Why there is no such kernel.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum KernelError {
    /// The cone would be negative at the rim, or is not a number.
    #[error("a cone needs a flatness of at least 1, not {0}")]
    Flatness(f64),
}

/// As it is in a file: the name, and the flatness of a cone.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
enum Named {
    Constant,
    Cone(f64),
    Epanechnikov,
}

#[cfg(feature = "serde")]
impl TryFrom<Named> for Kernel {
    type Error = KernelError;

    fn try_from(named: Named) -> Result<Self, KernelError> {
        match named {
            Named::Constant => Ok(Self::Constant),
            Named::Cone(flatness) => Self::cone(flatness),
            Named::Epanechnikov => Ok(Self::Epanechnikov),
        }
    }
}

#[cfg(feature = "serde")]
impl From<Kernel> for Named {
    fn from(kernel: Kernel) -> Self {
        match kernel {
            Kernel::Constant => Self::Constant,
            // The inverse of an inverse has that inverse again, bit for bit, unless it is subnormal.
            Kernel::Cone(Cone { inverse_flatness }) => Self::Cone(1.0 / inverse_flatness),
            Kernel::Epanechnikov => Self::Epanechnikov,
        }
    }
}

impl Kernel {
    /// The cone that reaches zero at the rim.
    pub const CONE: Self = Self::Cone(Cone { inverse_flatness: 1.0 });

    /// Jensen's cone filter with flatness `k`; infinity is the constant kernel.
    ///
    /// # Errors
    /// [`KernelError::Flatness`] if `k` is below one or NaN.
    pub fn cone(k: f64) -> Result<Self, KernelError> {
        if k >= 1.0 { Ok(Self::Cone(Cone { inverse_flatness: 1.0 / k })) } else { Err(KernelError::Flatness(k)) }
    }

    /// `K(t)` at the squared ratio `t` of distance and radius; zero for `t >= 1` and NaN.
    #[inline]
    pub fn at(&self, t: f64) -> f64 {
        if t.is_nan() || t >= 1.0 {
            return 0.0;
        }
        match self {
            Self::Constant => 1.0 / PI,
            Self::Cone(Cone { inverse_flatness }) => {
                (1.0 - inverse_flatness * t.max(0.0).sqrt()) / (PI * (1.0 - inverse_flatness * (2.0 / 3.0)))
            }
            Self::Epanechnikov => (2.0 / PI) * (1.0 - t.max(0.0)),
        }
    }

    /// The integral of `x^2 K` over the unit disk: the bias of an estimate is half of it, times `r^2` and the
    /// Laplacian of the irradiance.
    #[must_use]
    pub fn second_moment(&self) -> f64 {
        match self {
            Self::Constant => 0.25,
            Self::Cone(Cone { inverse_flatness: s }) => (0.25 - s / 5.0) / (1.0 - s * (2.0 / 3.0)),
            Self::Epanechnikov => 1.0 / 6.0,
        }
    }

    /// The integral of `K^2` over the unit disk: the variance of an estimate is this over
    /// `r^2`, times the sum of `(flux / N)^2` per area.
    #[must_use]
    pub fn roughness(&self) -> f64 {
        match self {
            Self::Constant => 1.0 / PI,
            Self::Cone(Cone { inverse_flatness: s }) => {
                (1.0 - s * (4.0 / 3.0) + 0.5 * s * s) / (PI * (1.0 - s * (2.0 / 3.0)).powi(2))
            }
            Self::Epanechnikov => 4.0 / (3.0 * PI),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kernels() -> Vec<Kernel> {
        let cones = [1.0, 1.1, 2.0, f64::INFINITY].map(|k| Kernel::cone(k).unwrap());
        [Kernel::Constant, Kernel::Epanechnikov].into_iter().chain(cones).collect()
    }

    /// Integrates over the unit disk: `2 pi d dd = pi dt`, by the midpoint rule in `d`.
    fn over_disk(f: impl Fn(f64) -> f64) -> f64 {
        const STEPS: i32 = 100_000;
        let d = |i: i32| (f64::from(i) + 0.5) / f64::from(STEPS);
        (0..STEPS).map(|i| f(d(i)) * 2.0 * PI * d(i)).sum::<f64>() / f64::from(STEPS)
    }

    #[test]
    fn kernels_integrate_to_one_and_have_the_stated_moments() {
        for kernel in kernels() {
            let integral = over_disk(|d| kernel.at(d * d));
            assert!((integral - 1.0).abs() < 1e-9, "{kernel:?}: {integral}");
            let second = over_disk(|d| 0.5 * d * d * kernel.at(d * d));
            assert!((second - kernel.second_moment()).abs() < 1e-9, "{kernel:?}: {second}");
            let roughness = over_disk(|d| kernel.at(d * d).powi(2));
            assert!((roughness - kernel.roughness()).abs() < 1e-9, "{kernel:?}: {roughness}");
            assert!((0..=100).all(|i| kernel.at(f64::from(i) / 100.0) >= 0.0));
        }
        assert!((Kernel::CONE.second_moment() - 0.15).abs() < 1e-12);
        assert!((Kernel::CONE.roughness() * PI - 1.5).abs() < 1e-12);
    }

    #[test]
    fn the_rim_and_nonsense_count_nothing() {
        for kernel in kernels() {
            assert_eq!([1.0, 2.0, f64::INFINITY, f64::NAN].map(|t| kernel.at(t)), [0.0; 4]);
        }
        assert!(matches!(Kernel::cone(f64::NAN), Err(KernelError::Flatness(_))));
    }
}
