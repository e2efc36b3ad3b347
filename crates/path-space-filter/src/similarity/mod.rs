//! Which contributions could have been made at another vertex.
//!
//! One weight per file; [`Similarity`] says what a weight is, [`SimilarityExt`] composes them.

mod binary;
mod compose;
mod continuous;
mod laws;

pub use binary::{
    AlbedoDifference, HitDistance, NormalCone, SameObject, SameVisibility, SimilarTime, SimilarityError, ViewCone,
};
pub use compose::{And, Everything, SimilarityExt};
pub use continuous::{AlbedoFalloff, CosinePower};
pub use laws::{Violation, check_similarity};

/// The weight `w_ij` of the contribution of vertex `j` in the average at vertex `i`: how likely it could have been made at `i` by splitting the path.
///
/// Best is a binary one, which includes or leaves out (0 or 1): the denominator of equation 1 is then the number of contributions, and no fewer of them could
/// lower the variance as much. Continuous weights raise the variance.
///
/// Closures `Fn(&V, &V) -> f32` over vertices are weights, too.
///
/// **Laws**, tested by [`check_similarity`]: weights are finite and not negative; the weight of a vertex with itself is positive, or it is included with
/// weight 1 all the same, since the average would not be consistent without its centre. Symmetry is not needed.
///
/// **Cost.** Asked once for each pair of neighbours, with what [`features`](Self::features) took from both vertices beforehand, once for each: these lie
/// together in memory in the order in which they are read. A closure's features are the whole vertex.
///
/// Dyn compatible: `&dyn Similarity<V, Features = T>`.
pub trait Similarity<V> {
    /// What the weight needs of a vertex.
    type Features: Clone;

    /// Takes it out.
    fn features(&self, vertex: &V) -> Self::Features;

    /// The weight of `other`'s contribution at `center`.
    fn weight(&self, center: &Self::Features, other: &Self::Features) -> f32;
}

// Its docs say so.
const _: Option<&dyn Similarity<f32, Features = f32>> = None;

impl<V: Clone, F: Fn(&V, &V) -> f32> Similarity<V> for F {
    type Features = V;

    #[inline]
    fn features(&self, vertex: &V) -> V {
        vertex.clone()
    }

    #[inline]
    fn weight(&self, center: &V, other: &V) -> f32 {
        self(center, other)
    }
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Whether two lengths or times differ by this at most; equal infinities do, though their difference is NaN.
#[inline(always)]
fn is_close(a: f32, b: f32, max_difference: f32) -> bool {
    a == b || (a - b).abs() <= max_difference
}

/// 1 if included.
#[inline(always)]
fn binary(included: bool) -> f32 {
    f32::from(u8::from(included))
}
