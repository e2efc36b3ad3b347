//! The laws of similarity weights, for anybody's.

use super::Similarity;

/// How a similarity weight breaks its laws.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Violation {
    /// A weight is negative, infinite or NaN.
    #[error("the weight of vertex {other} at vertex {center} is {weight}")]
    Weight {
        /// Position of the centre in the slice.
        center: usize,
        /// Position of the other.
        other: usize,
        /// Its weight.
        weight: f32,
    },
    /// A vertex is not similar to itself.
    #[error("the weight of vertex {center} with itself is {weight}, not positive")]
    Itself {
        /// Position in the slice.
        center: usize,
        /// Its weight.
        weight: f32,
    },
    /// The same question has two answers.
    #[error("the weight of vertex {other} at vertex {center} is {first}, then {second}")]
    Answers {
        /// Position of the centre in the slice.
        center: usize,
        /// Position of the other.
        other: usize,
        /// The first answer.
        first: f32,
        /// The second.
        second: f32,
    },
}

/// Tests the laws of [`Similarity`] on all pairs of the given vertices.
///
/// # Errors
/// The first violation found.
///
/// ```
/// use path_space_filter::{Vertex, check_similarity};
/// let vertices = [0_u32, 1, 2].map(|object| Vertex { object, ..Vertex::<f32>::default() });
/// let same = |a: &Vertex<f32>, b: &Vertex<f32>| if a.object == b.object { 1.0 } else { 0.0 };
/// assert_eq!(check_similarity(&same, &vertices), Ok(()));
/// let other = |a: &Vertex<f32>, b: &Vertex<f32>| if a.object != b.object { 1.0 } else { 0.0 };
/// assert!(check_similarity(&other, &vertices).is_err());
/// ```
pub fn check_similarity<V, S: Similarity<V>>(similarity: &S, vertices: &[V]) -> Result<(), Violation> {
    let features: Vec<_> = vertices.iter().map(|vertex| similarity.features(vertex)).collect();
    for (i, center) in features.iter().enumerate() {
        for (j, other) in features.iter().enumerate() {
            let weight = similarity.weight(center, other);
            if !(weight >= 0.0 && weight.is_finite()) {
                return Err(Violation::Weight { center: i, other: j, weight });
            }
            if i == j && weight == 0.0 {
                return Err(Violation::Itself { center: i, weight });
            }
            let again = similarity.weight(&similarity.features(&vertices[i]), &similarity.features(&vertices[j]));
            if again.to_bits() != weight.to_bits() {
                return Err(Violation::Answers { center: i, other: j, first: weight, second: again });
            }
        }
    }
    Ok(())
}
