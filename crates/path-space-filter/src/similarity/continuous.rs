//! Weights by degree: the paper's negative control.

use range_search::distance_squared;

use super::{Similarity, SimilarityError, dot};
use crate::vertex::{HasAlbedo, HasNormal};

/// `max(0, <n_i, n_j>)^e`.
///
/// For comparison: "using the norms to directly weight the contributions results in higher variance" (section 2.1 of the paper).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "CosinePowerName", into = "CosinePowerName"))]
pub struct CosinePower {
    exponent: f32,
}

#[cfg(feature = "serde")]
by_name!(CosinePowerName: CosinePower(f32), |value| value.exponent, SimilarityError);

impl CosinePower {
    /// # Errors
    /// If the exponent is not positive and finite.
    pub fn new(exponent: f32) -> Result<Self, SimilarityError> {
        positive(exponent).map(|exponent| Self { exponent })
    }
}

impl<V: HasNormal> Similarity<V> for CosinePower {
    type Features = [f32; 3];

    #[inline(always)]
    fn features(&self, vertex: &V) -> [f32; 3] {
        vertex.normal()
    }

    #[inline(always)]
    fn weight(&self, center: &[f32; 3], other: &[f32; 3]) -> f32 {
        dot(*center, *other).max(0.0).powf(self.exponent)
    }
}

/// `exp(-e |a_i - a_j|^2)` of the albedos. For comparison, like [`CosinePower`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "AlbedoFalloffName", into = "AlbedoFalloffName"))]
pub struct AlbedoFalloff {
    exponent: f32,
}

#[cfg(feature = "serde")]
by_name!(AlbedoFalloffName: AlbedoFalloff(f32), |value| value.exponent, SimilarityError);

impl AlbedoFalloff {
    /// # Errors
    /// If the exponent is not positive and finite.
    pub fn new(exponent: f32) -> Result<Self, SimilarityError> {
        positive(exponent).map(|exponent| Self { exponent })
    }
}

impl<V: HasAlbedo> Similarity<V> for AlbedoFalloff {
    type Features = [f32; 3];

    #[inline(always)]
    fn features(&self, vertex: &V) -> [f32; 3] {
        vertex.albedo()
    }

    #[inline(always)]
    fn weight(&self, center: &[f32; 3], other: &[f32; 3]) -> f32 {
        (-self.exponent * distance_squared(*center, *other)).exp()
    }
}

fn positive(value: f32) -> Result<f32, SimilarityError> {
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(SimilarityError::Exponent(value)) }
}
