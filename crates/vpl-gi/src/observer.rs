//! Looking on while a path is traced.

use scene_core::{ScatterSample, Vertex};

/// What found a contribution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Found {
    /// The eye path hit the light itself, with its last segment.
    Hit,
    /// A connection of its last vertex with `light` segments of a light path: 0 is direct light.
    Connection {
        /// Number of segments of the light path.
        light: u32,
    },
    /// All connections of its last vertex together, of any length.
    Connections,
    /// A photon map at its last vertex.
    Photons,
}

/// Sees what an estimator does: for auxiliary images, statistics, filters, and the contributions of single techniques.
///
/// All methods do nothing by default; `()` sees nothing and costs nothing.
///
/// Dyn compatible: `&mut dyn Observer<X>`.
pub trait Observer<X: Vertex> {
    /// The eye path has reached its vertex number `length` (1 is what the camera sees), with this throughput up to there. Contributions follow after
    /// the vertex where they were found; a hit follows after its own.
    #[inline]
    fn vertex(&mut self, length: u32, vertex: &X, throughput: X::Spectrum) {
        let _ = (length, vertex, throughput);
    }

    /// The eye path goes on from its vertex number `length`.
    #[inline]
    fn scattered(&mut self, length: u32, vertex: &X, sample: &ScatterSample<X::Spectrum>) {
        let _ = (length, vertex, sample);
    }

    /// A contribution was added, attenuated to what it is worth at the camera: found by an eye path of `eye` segments.
    #[inline]
    fn contribution(&mut self, eye: u32, found: Found, value: X::Spectrum) {
        let _ = (eye, found, value);
    }
}

impl<X: Vertex> Observer<X> for () {}
