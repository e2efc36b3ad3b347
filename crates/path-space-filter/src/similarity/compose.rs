//! Weights made of weights.

use super::Similarity;

/// All vertices are alike: `w = 1`. Consistent, and blurred as far as the radius reaches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "EverythingName", into = "EverythingName"))]
pub struct Everything;

#[cfg(feature = "serde")]
by_name!(EverythingName: Everything);

impl<V> Similarity<V> for Everything {
    type Features = ();

    #[inline(always)]
    fn features(&self, _: &V) {}

    #[inline(always)]
    fn weight(&self, (): &(), (): &()) -> f32 {
        1.0
    }
}

/// The product of two weights: with binary ones, what both include.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct And<A, B>(A, B);

impl<V, A: Similarity<V>, B: Similarity<V>> Similarity<V> for And<A, B> {
    type Features = (A::Features, B::Features);

    #[inline(always)]
    fn features(&self, vertex: &V) -> Self::Features {
        (self.0.features(vertex), self.1.features(vertex))
    }

    #[inline(always)]
    fn weight(&self, center: &Self::Features, other: &Self::Features) -> f32 {
        self.0.weight(&center.0, &other.0) * self.1.weight(&center.1, &other.1)
    }
}

/// Conveniences for every [`Similarity`].
pub trait SimilarityExt: Sized {
    /// The product with another weight.
    ///
    /// ```
    /// use path_space_filter::{AlbedoDifference, NormalCone, SimilarityExt};
    /// let alike = NormalCone::new(0.95)?.and(AlbedoDifference::new(0.05)?);
    /// # Ok::<(), path_space_filter::SimilarityError>(())
    /// ```
    fn and<B>(self, other: B) -> And<Self, B> {
        And(self, other)
    }
}

impl<A> SimilarityExt for A {}
