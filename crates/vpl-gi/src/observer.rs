//! Looking on while a path is traced.

use scene_core::Vertex;

/// Sees what an estimator does: for auxiliary images, statistics, and the contributions of single techniques.
///
/// All methods do nothing by default; `()` sees nothing and costs nothing.
pub trait Observer<X: Vertex> {
    /// The eye path has reached its vertex number `length` (1 is what the camera sees).
    #[inline]
    fn vertex(&mut self, length: u32, vertex: &X) {
        let _ = (length, vertex);
    }

    /// A contribution was added: `eye` segments of the eye path, and `light` segments of light paths. `None`: light that the eye path
    /// hit itself. [`RobustIgi`](crate::RobustIgi) reports the sum of all connections of a vertex as `Some(0)`.
    #[inline]
    fn contribution(&mut self, eye: u32, light: Option<u32>, value: X::Spectrum) {
        let _ = (eye, light, value);
    }
}

impl<X: Vertex> Observer<X> for () {}
