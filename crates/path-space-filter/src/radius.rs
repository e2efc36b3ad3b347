//! How far a vertex averages.

use std::f32::consts::PI;

/// Why there is no such radius.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RadiusError {
    /// Not a length, or a factor.
    #[error("an initial radius of {0}: it is finite and not negative")]
    Initial(f32),
    /// Not a solid angle.
    #[error("a solid angle of {0} sr: it is finite and not negative")]
    SolidAngle(f32),
    /// Consistency needs a radius that vanishes, and averages more and more contributions while it does.
    #[error("an exponent of {0}: it lies in (0, 1)")]
    Exponent(f32),
}

/// The radius of the ball that a vertex averages over, for batch number `n`:
///
/// ```text
/// r(n) = r_0 / n^alpha            r_0 = absolute,  or  s d,  s = sqrt(omega / pi)                    (2)
/// ```
///
/// **Symbols.** `n`: number of the batch, from 1; the paper counts paths, which would make the radius depend on the resolution. `alpha` in (0, 1): 1/4 unless
/// said otherwise; the radius itself shrinks like this, unlike that of progressive photon mapping, whose square shrinks as `n^(alpha-1)`.
/// `d`: length of the camera path; `omega`: solid angle of a disk of radius `r_0` at this distance, perpendicular to the path, in sr.
///
/// **Asymmetry.** A radius that depends on the vertex makes neighbourhoods asymmetric: `i` averages `j` and `j` does not average `i`. Then the mean of
/// the averages is not the mean of the contributions; as the radius vanishes so does the difference.
///
/// **Source.** A. Keller, K. Dahm, N. Binder, *Path Space Filtering*, 2014, section 2.2.
///
/// ```
/// use path_space_filter::Radius;
/// let radius = Radius::pixels(3.0, 1e-6)?;   // a disk as large as 3 x 3 pixels of 1e-6 sr
/// let at_2_m = radius.at(1, 2.0);
/// assert!((at_2_m - 2.0 * (9e-6_f32 / std::f32::consts::PI).sqrt()).abs() < 1e-6);
/// assert!((radius.at(16, 2.0) - 0.5 * at_2_m).abs() < 1e-6);
/// # Ok::<(), path_space_filter::RadiusError>(())
/// ```
///
/// A number alone is no radius, for nobody could tell pixels from metres:
///
/// ```compile_fail,E0308
/// use path_space_filter::PathSpaceFilter;
/// let filter = PathSpaceFilter::new(3.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Named", into = "Named"))]
pub struct Radius {
    /// The part that does not depend on the distance.
    absolute: f32,
    /// Radius over distance.
    slope: f32,
    exponent: f32,
}

/// As it is in a file: the name of the constructor, what it takes, and the exponent, which is zero if the radius is held.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
enum Named {
    Absolute { initial: f32, exponent: f32 },
    OfDistance { factor: f32, exponent: f32 },
}

#[cfg(feature = "serde")]
impl TryFrom<Named> for Radius {
    type Error = RadiusError;

    fn try_from(named: Named) -> Result<Self, RadiusError> {
        let (radius, exponent) = match named {
            Named::Absolute { initial, exponent } => (Self::absolute(initial)?, exponent),
            Named::OfDistance { factor, exponent } => (Self::of_distance(factor)?, exponent),
        };
        if exponent == 0.0 { Ok(radius.held()) } else { radius.with_exponent(exponent) }
    }
}

#[cfg(feature = "serde")]
impl From<Radius> for Named {
    fn from(radius: Radius) -> Self {
        let Radius { absolute, slope, exponent } = radius;
        if radius.is_absolute() {
            Self::Absolute { initial: absolute, exponent }
        } else {
            Self::OfDistance { factor: slope, exponent }
        }
    }
}

impl Radius {
    /// The exponent that the paper calls "a robustly working choice".
    pub const EXPONENT: f32 = 0.25;

    /// The same radius everywhere.
    ///
    /// # Errors
    /// If it is negative or not finite.
    pub fn absolute(initial: f32) -> Result<Self, RadiusError> {
        Ok(Self { absolute: checked(initial)?, slope: 0.0, exponent: Self::EXPONENT })
    }

    /// `factor` times the length of the camera path.
    ///
    /// # Errors
    /// If the factor is negative or not finite.
    pub fn of_distance(factor: f32) -> Result<Self, RadiusError> {
        Ok(Self { absolute: 0.0, slope: checked(factor)?, exponent: Self::EXPONENT })
    }

    /// A disk of this solid angle, in sr, as seen along the camera path.
    ///
    /// # Errors
    /// If the solid angle is negative or not finite.
    pub fn solid_angle(solid_angle: f32) -> Result<Self, RadiusError> {
        if solid_angle >= 0.0 && solid_angle.is_finite() {
            Self::of_distance((solid_angle / PI).sqrt())
        } else {
            Err(RadiusError::SolidAngle(solid_angle))
        }
    }

    /// A disk as large as `side` times `side` pixels of the given solid angle, in sr; the paper's example is 3.
    ///
    /// # Errors
    /// If the side is negative, or anything is not finite.
    pub fn pixels(side: f32, pixel_solid_angle: f32) -> Result<Self, RadiusError> {
        let side = checked(side)?;
        Self::solid_angle(side * side * pixel_solid_angle)
    }

    /// Another exponent.
    ///
    /// # Errors
    /// If it does not lie in (0, 1).
    pub fn with_exponent(self, exponent: f32) -> Result<Self, RadiusError> {
        if exponent > 0.0 && exponent < 1.0 {
            Ok(Self { exponent, ..self })
        } else {
            Err(RadiusError::Exponent(exponent))
        }
    }

    /// The radius that never shrinks. **Not consistent**: for comparison, and for pictures that nobody continues.
    #[must_use]
    pub fn held(self) -> Self {
        Self { exponent: 0.0, ..self }
    }

    /// The radius in batch number `batch`, counted from 1 (0 counts as 1), at the end of a camera path of this length.
    #[inline]
    pub fn at(&self, batch: u64, path_length: f32) -> f32 {
        (self.absolute + self.slope * path_length) * self.shrinkage(batch)
    }

    /// `1 / n^alpha`.
    #[inline]
    pub(crate) fn shrinkage(&self, batch: u64) -> f32 {
        (batch.max(1) as f64).powf(-f64::from(self.exponent)) as f32
    }

    /// Whether all vertices have the same one.
    #[inline]
    pub(crate) fn is_absolute(&self) -> bool {
        self.slope == 0.0
    }
}

fn checked(value: f32) -> Result<f32, RadiusError> {
    if value >= 0.0 && value.is_finite() { Ok(value) } else { Err(RadiusError::Initial(value)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radii_shrink_by_batches() {
        let radius = Radius::absolute(2.0).unwrap();
        assert_eq!([0, 1, 16, 81].map(|n| radius.at(n, 7.0)), [2.0, 2.0, 1.0, 2.0 / 3.0]);
        assert_eq!(radius.with_exponent(0.5).unwrap().at(4, 7.0), 1.0);
        assert_eq!(radius.held().at(1000, 7.0), 2.0);
        assert_eq!(Radius::of_distance(0.5).unwrap().at(1, 3.0), 1.5);
    }

    #[test]
    fn what_is_no_radius_is_refused() {
        for bad in [-1.0, f32::NAN, f32::INFINITY] {
            assert!(Radius::absolute(bad).is_err());
            assert!(Radius::of_distance(bad).is_err());
            assert!(Radius::solid_angle(bad).is_err());
            assert!(Radius::pixels(bad, 1e-6).is_err() && Radius::pixels(3.0, bad).is_err());
        }
        for bad in [0.0, 1.0, -0.5, f32::NAN] {
            let error = Radius::absolute(1.0).unwrap().with_exponent(bad).unwrap_err();
            assert!(error.to_string().contains(&bad.to_string()));
        }
    }
}
