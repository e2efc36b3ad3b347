//! Which photons are caustic.

use crate::Photon;

/// How a photon's path was scattered the last time before the photon arrived.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LastBounce {
    /// Not at all: the photon comes directly from a light.
    Emission,
    /// By a diffuse part of a surface.
    Diffuse,
    /// By a glossy part of a surface, of this roughness: the square root of a microfacet distribution's width is *not*
    /// taken, so this is the `alpha` of GGX and Beckmann.
    Glossy(f32),
    /// By a Dirac delta: smooth mirrors and glass.
    Specular,
}

/// Which photons belong to the caustic map: those whose **last** bounce was sharper than a threshold.
///
/// ```text
/// caustic  <=>  the last bounce was specular, or glossy with roughness <= threshold
/// ```
///
/// Keller and Wald 2000 says "scattered by a non-diffuse surface". Taken literally for any bounce of the path, nearly every photon of a
/// scene with some glass in it would be caustic; what focuses light is the last bounce. A photon that comes
/// directly from a light is never caustic.
///
/// **Source.** Keller and Wald 2000, section 2.2.
///
/// # Example
/// ```
/// use photon_map::{CausticRule, LastBounce};
/// let rule = CausticRule::new(0.2)?;
/// assert!(rule.is_caustic(LastBounce::Specular) && rule.is_caustic(LastBounce::Glossy(0.1)));
/// assert!(!rule.is_caustic(LastBounce::Glossy(0.5)) && !rule.is_caustic(LastBounce::Diffuse));
/// # Ok::<(), photon_map::CausticRuleError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Named", into = "Named"))]
pub struct CausticRule {
    roughness: f32,
}

/// Why there is no such rule.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CausticRuleError {
    /// Negative or NaN.
    #[error("the largest roughness of a caustic generator is at least 0, not {0}")]
    Roughness(f32),
}

/// As it is in a file.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
enum Named {
    Specular,
    Roughness(f32),
}

#[cfg(feature = "serde")]
impl TryFrom<Named> for CausticRule {
    type Error = CausticRuleError;

    fn try_from(named: Named) -> Result<Self, CausticRuleError> {
        match named {
            Named::Specular => Ok(Self::SPECULAR),
            Named::Roughness(roughness) => Self::new(roughness),
        }
    }
}

#[cfg(feature = "serde")]
impl From<CausticRule> for Named {
    fn from(rule: CausticRule) -> Self {
        rule.roughness().map_or(Self::Specular, Self::Roughness)
    }
}

impl CausticRule {
    /// Only Dirac deltas make caustics.
    pub const SPECULAR: Self = Self { roughness: -1.0 };

    /// Glossy bounces up to this roughness make caustics, and Dirac deltas; infinity means everything that is not
    /// diffuse.
    ///
    /// # Errors
    /// [`CausticRuleError::Roughness`] if it is negative or NaN.
    pub fn new(roughness: f32) -> Result<Self, CausticRuleError> {
        if roughness >= 0.0 { Ok(Self { roughness }) } else { Err(CausticRuleError::Roughness(roughness)) }
    }

    /// The threshold; `None` if only Dirac deltas make caustics.
    #[must_use]
    pub fn roughness(&self) -> Option<f32> {
        (self.roughness >= 0.0).then_some(self.roughness)
    }

    /// Whether a photon with this last bounce is caustic. NaN as roughness is not.
    #[must_use]
    pub fn is_caustic(&self, last: LastBounce) -> bool {
        match last {
            LastBounce::Emission | LastBounce::Diffuse => false,
            LastBounce::Glossy(roughness) => roughness <= self.roughness,
            LastBounce::Specular => true,
        }
    }

    /// Sets the flags of a photon: primary, and caustic.
    #[must_use]
    pub fn label<F>(&self, mut photon: Photon<F>, last: LastBounce) -> Photon<F> {
        photon.primary = last == LastBounce::Emission;
        photon.caustic = self.is_caustic(last);
        photon
    }
}

/// [`CausticRule::SPECULAR`].
impl Default for CausticRule {
    fn default() -> Self {
        Self::SPECULAR
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_bounce_decides() {
        let everything = CausticRule::new(f32::INFINITY).unwrap();
        assert!(everything.is_caustic(LastBounce::Glossy(1e30)) && !everything.is_caustic(LastBounce::Diffuse));
        assert!(!CausticRule::SPECULAR.is_caustic(LastBounce::Glossy(0.0)));
        assert!(CausticRule::new(0.0).unwrap().is_caustic(LastBounce::Glossy(0.0)));
        assert!(!everything.is_caustic(LastBounce::Glossy(f32::NAN)));
        assert!(matches!(CausticRule::new(f32::NAN), Err(CausticRuleError::Roughness(_))));
        assert_eq!(CausticRule::SPECULAR.roughness(), None);

        let photon = Photon::new([0.0; 3], [0.0, 0.0, 1.0], 1.0_f32);
        let flags = |last| {
            let photon = everything.label(photon, last);
            (photon.primary, photon.caustic)
        };
        assert_eq!(flags(LastBounce::Emission), (true, false));
        assert_eq!(flags(LastBounce::Specular), (false, true));
        assert_eq!(flags(LastBounce::Diffuse), (false, false));
    }
}
