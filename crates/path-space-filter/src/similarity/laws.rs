//! The laws of similarity weights, for anybody's.

use super::Similarity;

pub use range_search::check::Violation;
use range_search::check::hold;

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
            let shown = || format!("the weight of vertex {j} at vertex {i} is {weight}");
            hold("weights are finite and not negative", weight >= 0.0 && weight.is_finite(), shown)?;
            hold("the weight of a vertex with itself is positive", i != j || weight > 0.0, shown)?;
            let again = similarity.weight(&similarity.features(&vertices[i]), &similarity.features(&vertices[j]));
            let shown = || format!("{}, then {again}", shown());
            hold("the same vertices have the same weight", again.to_bits() == weight.to_bits(), shown)?;
        }
    }
    Ok(())
}
