//! Weights that include or leave out.

use range_search::distance_squared;

use super::{Similarity, binary, dot, is_close};
use crate::vertex::{HasAlbedo, HasHitDistance, HasNormal, HasObject, HasTime, HasViewDirection, HasVisibility};

/// Why there is no such weight.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimilarityError {
    /// Nothing is similar.
    #[error("a least cosine of {0}: it lies in [-1, 1)")]
    Cosine(f32),
    /// Not a threshold.
    #[error("a threshold of {0}: it is not negative, and not NaN")]
    Threshold(f32),
    /// Not an exponent.
    #[error("an exponent of {0}: it is positive and finite")]
    Exponent(f32),
}

/// Below 1 even where a cosine of a vector with itself is rounded.
fn cosine(min: f32) -> Result<f32, SimilarityError> {
    if (-1.0..1.0).contains(&min) { Ok(min) } else { Err(SimilarityError::Cosine(min)) }
}

fn threshold(value: f32) -> Result<f32, SimilarityError> {
    if value >= 0.0 { Ok(value) } else { Err(SimilarityError::Threshold(value)) }
}

/// Vertices with similar normals: `<n_i, n_j> >= 0.95` in the paper. Keeps light from being carried around corners and through thin walls.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "NormalConeName", into = "NormalConeName"))]
pub struct NormalCone {
    min_cosine: f32,
}

#[cfg(feature = "serde")]
by_name!(NormalConeName: NormalCone(f32), |value| value.min_cosine, SimilarityError);

impl NormalCone {
    /// The paper's.
    pub const PAPER: Self = Self { min_cosine: 0.95 };

    /// # Errors
    /// If the least cosine does not lie in [-1, 1).
    pub fn new(min_cosine: f32) -> Result<Self, SimilarityError> {
        Ok(Self { min_cosine: cosine(min_cosine)? })
    }
}

impl<V: HasNormal> Similarity<V> for NormalCone {
    type Features = [f32; 3];

    #[inline(always)]
    fn features(&self, vertex: &V) -> [f32; 3] {
        vertex.normal()
    }

    #[inline(always)]
    fn weight(&self, center: &[f32; 3], other: &[f32; 3]) -> f32 {
        binary(dot(*center, *other) >= self.min_cosine)
    }
}

/// Vertices of similar colour: Euclidean norm of the difference of albedos (or local throughputs) below 0.05 in the paper. Keeps textures crisp where
/// contributions are taken as stored; needless where they are [demodulated](crate::Demodulated).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "AlbedoDifferenceName", into = "AlbedoDifferenceName"))]
pub struct AlbedoDifference {
    threshold_squared: f32,
}

#[cfg(feature = "serde")]
by_name!(AlbedoDifferenceName: AlbedoDifference(f32), AlbedoDifference::threshold, SimilarityError);

impl AlbedoDifference {
    /// The paper's.
    pub const PAPER: Self = Self { threshold_squared: 0.05 * 0.05 };

    /// # Errors
    /// If the threshold is negative or NaN.
    pub fn new(max_difference: f32) -> Result<Self, SimilarityError> {
        let threshold = threshold(max_difference)?;
        Ok(Self { threshold_squared: threshold * threshold })
    }

    /// A finite threshold that has this square, bit for bit: the root of a rounded square is what was squared, and the
    /// largest number has an infinite square.
    #[cfg(feature = "serde")]
    fn threshold(self) -> f32 {
        self.threshold_squared.sqrt().min(f32::MAX)
    }
}

impl<V: HasAlbedo> Similarity<V> for AlbedoDifference {
    type Features = [f32; 3];

    #[inline(always)]
    fn features(&self, vertex: &V) -> [f32; 3] {
        vertex.albedo()
    }

    #[inline(always)]
    fn weight(&self, center: &[f32; 3], other: &[f32; 3]) -> f32 {
        // The same colour is similar at any threshold.
        binary(distance_squared(*center, *other) <= self.threshold_squared)
    }
}

/// Vertices that are seen from similar directions, for surfaces that are not diffuse.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "ViewConeName", into = "ViewConeName"))]
pub struct ViewCone {
    min_cosine: f32,
}

#[cfg(feature = "serde")]
by_name!(ViewConeName: ViewCone(f32), |value| value.min_cosine, SimilarityError);

impl ViewCone {
    /// # Errors
    /// If the least cosine does not lie in [-1, 1).
    pub fn new(min_cosine: f32) -> Result<Self, SimilarityError> {
        Ok(Self { min_cosine: cosine(min_cosine)? })
    }
}

impl<V: HasViewDirection> Similarity<V> for ViewCone {
    type Features = [f32; 3];

    #[inline(always)]
    fn features(&self, vertex: &V) -> [f32; 3] {
        vertex.view_direction()
    }

    #[inline(always)]
    fn weight(&self, center: &[f32; 3], other: &[f32; 3]) -> f32 {
        binary(dot(*center, *other) >= self.min_cosine)
    }
}

/// Vertices that see the same point lights. Keeps sharp shadows sharp.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "SameVisibilityName", into = "SameVisibilityName"))]
pub struct SameVisibility;

#[cfg(feature = "serde")]
by_name!(SameVisibilityName: SameVisibility);

impl<V: HasVisibility> Similarity<V> for SameVisibility {
    type Features = u32;

    #[inline(always)]
    fn features(&self, vertex: &V) -> u32 {
        vertex.visibility()
    }

    #[inline(always)]
    fn weight(&self, center: &u32, other: &u32) -> f32 {
        binary(center == other)
    }
}

/// Vertices on the same object.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "SameObjectName", into = "SameObjectName"))]
pub struct SameObject;

#[cfg(feature = "serde")]
by_name!(SameObjectName: SameObject);

impl<V: HasObject> Similarity<V> for SameObject {
    type Features = u32;

    #[inline(always)]
    fn features(&self, vertex: &V) -> u32 {
        vertex.object()
    }

    #[inline(always)]
    fn weight(&self, center: &u32, other: &u32) -> f32 {
        binary(center == other)
    }
}

/// Vertices whose ray into the hemisphere went about as far: blurs the shadows of ambient occlusion and of environments less.
///
/// **Biased before the radius vanishes**, by more than the other weights: it looks at the random ray that made the contribution. Of occluded and free rays
/// each is averaged with its own kind alone, and so is the variance between the two kinds never averaged away. Choose a generous threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "HitDistanceName", into = "HitDistanceName"))]
pub struct HitDistance {
    max_difference: f32,
}

#[cfg(feature = "serde")]
by_name!(HitDistanceName: HitDistance(f32), |value| value.max_difference, SimilarityError);

impl HitDistance {
    /// # Errors
    /// If the threshold, a length, is negative or NaN.
    pub fn new(max_difference: f32) -> Result<Self, SimilarityError> {
        Ok(Self { max_difference: threshold(max_difference)? })
    }
}

impl<V: HasHitDistance> Similarity<V> for HitDistance {
    type Features = f32;

    #[inline(always)]
    fn features(&self, vertex: &V) -> f32 {
        vertex.hit_distance()
    }

    #[inline(always)]
    fn weight(&self, center: &f32, other: &f32) -> f32 {
        binary(is_close(*center, *other, self.max_difference))
    }
}

/// Vertices that are close in time: motion blur, or several frames at once.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "SimilarTimeName", into = "SimilarTimeName"))]
pub struct SimilarTime {
    max_difference: f32,
}

#[cfg(feature = "serde")]
by_name!(SimilarTimeName: SimilarTime(f32), |value| value.max_difference, SimilarityError);

impl SimilarTime {
    /// # Errors
    /// If the threshold is negative or NaN.
    pub fn new(max_difference: f32) -> Result<Self, SimilarityError> {
        Ok(Self { max_difference: threshold(max_difference)? })
    }
}

impl<V: HasTime> Similarity<V> for SimilarTime {
    type Features = f32;

    #[inline(always)]
    fn features(&self, vertex: &V) -> f32 {
        vertex.time()
    }

    #[inline(always)]
    fn weight(&self, center: &f32, other: &f32) -> f32 {
        binary(is_close(*center, *other, self.max_difference))
    }
}
