//! Photons by place, and the radiance that surfaces scatter of them.

use glam::Vec3A;
use photon_map::{DensityEstimation, Flux, GatherPoint, PackedPhoton, PhotonMap, Photons, Scratch};
use scene_core::{Spectrum, TransportMode, Vertex};

/// A photon map with the way to look at it.
#[derive(Clone, Debug)]
pub struct PhotonView {
    /// The photons.
    pub map: PhotonMap<[f32; 3]>,
    /// How far to look, and how photons at a distance count.
    pub estimation: DensityEstimation,
}

/// The maps that eye paths look at: what is in the one is not in the other.
#[derive(Clone, Debug)]
pub struct Maps {
    /// Photons whose last bounce was not sharp.
    pub global: PhotonView,
    /// All others; nothing if they are in the first map as well.
    pub caustic: Option<PhotonView>,
}

/// A spectrum as a sum over photons.
#[derive(Clone, Copy, Debug)]
struct Sum<S>(S);

impl<S: Spectrum> Flux for Sum<S> {
    const ZERO: Self = Self(S::ZERO);

    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }

    fn scale(self, factor: f64) -> Self {
        Self(self.0 * factor as f32)
    }

    fn is_finite(self) -> bool {
        self.0.is_finite()
    }
}

/// Cosines below are taken for this one: photons that graze the surface are few, and worth little.
const LEAST_COSINE: f32 = 1e-4;

/// Where photons or importons count for a vertex.
pub(super) fn gather_point<X: Vertex>(x: &X) -> GatherPoint {
    let point = x.point();
    let side = if point.normal.dot(x.wo()) < 0.0 { -point.normal } else { point.normal };
    let at = GatherPoint::on(point.position.to_array(), side.to_array());
    // What arrives at the other side may be transmitted; the BSDF knows.
    if x.lambertian().is_none() { at.with_least_cosine(-1.0) } else { at }
}

impl PhotonView {
    /// Sorts photons.
    ///
    /// # Panics
    /// If nobody counted their paths.
    pub fn new(photons: Photons<[f32; 3]>, estimation: DensityEstimation) -> Self {
        let map = PhotonMap::par_build(photons, estimation.gather.max_radius());
        Self { map: map.expect("paths are counted, and radii of a gather are in range"), estimation }
    }

    /// Radiance that a surface scatters towards `x.wo()` of the photons around, by the part of its BSDF without Dirac
    /// deltas.
    ///
    /// ```text
    /// L ~ 1/N sum over photons k of  K(t_k) / r^2  f(wi_k, x, wo) flux_k
    /// ```
    /// **Symbols.** As for [`PhotonMap`]. Only photons count whose paths have at most `longest` segments and whose
    /// direction `counts`.
    ///
    /// **Biased**: blurred by the radius.
    pub fn radiance<X: Vertex>(
        &self,
        x: &X,
        longest: u32,
        scratch: &mut Scratch,
        counts: impl Fn(Vec3A) -> bool,
    ) -> X::Spectrum {
        let (point, lambertian, at) = (x.point(), x.lambertian(), gather_point(x));
        let contribution = |photon: &PackedPhoton<[f32; 3]>| {
            let flux = X::Spectrum::from_rgb(photon.flux());
            if longest < u32::MAX && photon.unpack().light.is_some_and(|length| length > longest) {
                return Sum(X::Spectrum::ZERO);
            }
            if let Some(f) = lambertian {
                return Sum(f * flux);
            }
            let wi = Vec3A::from(photon.wi());
            if !counts(wi) {
                return Sum(X::Spectrum::ZERO);
            }
            let cosine = point.normal.dot(wi).abs().max(LEAST_COSINE);
            Sum(x.eval(wi, TransportMode::Radiance) * flux * (1.0 / cosine))
        };
        self.map.estimate(&self.estimation, &at, scratch, contribution).value.0
    }
}
