//! Paths that no connection reaches.

use scene_core::Vertex;

/// An estimate of caustics, for instance a photon map.
///
/// Connections cannot reach a specular vertex. Hence light that comes from a specular surface to one that is not is found only
/// if a scattered ray hits the specular surface and then, by chance, the light (Kollig and Keller 2004, section 4.2: "some caustic paths cannot be captured
/// efficiently by any path tracing algorithm, however, these easily are complemented by a caustic photon map").
///
/// # Laws
/// `radiance(x)` is the radiance that `x` scatters towards `x.wo()`, by the part of its BSDF without Dirac deltas, of light whose last
/// scattering before `x` was a Dirac delta: photons that arrive at `x` by a specular bounce. Nothing else, or light is counted twice.
///
/// Dyn compatible: `&dyn CausticMap<X>`.
pub trait CausticMap<X: Vertex> {
    /// The caustic's radiance.
    fn radiance(&self, x: &X) -> X::Spectrum;
}

/// No caustics: biased, and rays may be short (where nothing is glossy, or peaks do not count).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NoCaustics;

impl<X: Vertex> CausticMap<X> for NoCaustics {
    #[inline]
    fn radiance(&self, _: &X) -> X::Spectrum {
        <X::Spectrum as scene_core::Spectrum>::ZERO
    }
}
