//! Which bounces are sharp.

use core::f32::consts::PI;

use glam::Vec3A;
use photon_map::{CausticRule, LastBounce};
use scene_core::{ScatterSample, TransportMode, Vertex, WalkVertex};

/// Which bounces are sharp: too sharp for density estimation, so that eye paths follow them, and sharp enough to make
/// caustics.
///
/// ```text
/// roughness of a bounce = 1/2 sqrt(|cos| / (pi p)),     sharp  <=>  Dirac delta, or roughness <= threshold
/// ```
/// **Symbols.** `p`: density by solid angle with which the surface samples the direction; the cosine is that with the
/// shading normal.
///
/// Materials of a [`Vertex`] do not tell their roughness, but their density does: in the mirror direction of a
/// microfacet distribution of width `alpha` it is `1 / (4 pi alpha^2)`, seen along the normal, so the formula gives
/// `alpha` there, more in the tails of the lobe, and 1/2 on a diffuse surface. It is a function of the *pair* of
/// directions: a coat of varnish is sharp and what is below it is not, as it should be. Any rule would do, if only
/// those who ask agree on it:
///
/// - **Eye paths** go on if the direction that they sampled is sharp, and ask the maps for the photons of all others.
/// - A **photon** is caustic if its last bounce was sharp, seen from the light. Final gathering leaves exactly these
///   bounces out, which it can, because it knows where the photons at the other end came from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sharpness {
    /// The threshold.
    pub rule: CausticRule,
}

/// What the next vertex of a light path needs to know of this one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Departure {
    normal: Vec3A,
    is_diffuse: bool,
}

impl Departure {
    pub(super) fn of<V: Vertex>(vertex: &V) -> Self {
        Self { normal: vertex.shading_normal(), is_diffuse: vertex.lambertian().is_some() }
    }
}

/// The roughness of a bounce in a direction of this density.
fn roughness(pdf_solid_angle: f32, cosine: f32) -> f32 {
    0.5 * (cosine.abs() / (PI * pdf_solid_angle)).sqrt()
}

impl Sharpness {
    /// Whether some bounces of a surface may be sharp without being Dirac deltas.
    fn may_be_glossy<V: Vertex>(&self, vertex: &V) -> bool {
        self.rule.roughness().is_some() && vertex.lambertian().is_none()
    }

    fn is_sharp(&self, pdf_solid_angle: f32, cosine: f32) -> bool {
        self.rule.is_caustic(LastBounce::Glossy(roughness(pdf_solid_angle, cosine)))
    }

    /// Whether an eye path that was scattered so goes on.
    pub fn is_followed<V: Vertex>(&self, vertex: &V, sample: &ScatterSample<V::Spectrum>) -> bool {
        let cosine = || vertex.shading_normal().dot(sample.wi);
        sample.is_specular || self.may_be_glossy(vertex) && self.is_sharp(sample.pdf_solid_angle, cosine())
    }

    /// Whether an eye path at `vertex` would follow the direction `wi`: then its photons do not count.
    pub fn is_left_to_eye_path<V: Vertex>(&self, vertex: &V, wi: Vec3A) -> bool {
        self.may_be_glossy(vertex)
            && self.is_sharp(vertex.pdf_solid_angle(wi, TransportMode::Radiance), vertex.shading_normal().dot(wi))
    }

    /// Whether light that arrives at `vertex` from `wi` is scattered so sharply towards `vertex.wo()` that the photon
    /// there is caustic.
    pub fn is_left_to_caustics<V: Vertex>(&self, vertex: &V, wi: Vec3A) -> bool {
        let pdf = || vertex.reversed(wi).pdf_solid_angle(vertex.wo(), TransportMode::Importance);
        self.may_be_glossy(vertex) && self.is_sharp(pdf(), vertex.shading_normal().dot(vertex.wo()))
    }

    /// How the light path was scattered before it arrived, having left from `departure`.
    pub(super) fn last_bounce<V: Vertex>(
        &self,
        departure: Option<&Departure>,
        walk: &WalkVertex<'_, V, V::Spectrum>,
    ) -> LastBounce {
        match departure {
            None => LastBounce::Emission,
            Some(_) if walk.after_specular => LastBounce::Specular,
            Some(departure) if departure.is_diffuse => LastBounce::Diffuse,
            Some(departure) => {
                LastBounce::Glossy(roughness(walk.pdf_solid_angle, departure.normal.dot(walk.vertex.wo())))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_roughness_is_that_of_the_mirror_direction() {
        for alpha in [0.01_f32, 0.1, 0.3] {
            assert!((roughness(1.0 / (4.0 * PI * alpha * alpha), 1.0) / alpha - 1.0).abs() < 1e-5);
        }
        assert!((roughness(0.3 / PI, 0.3) - 0.5).abs() < 1e-6);
        // What is never sampled is not sharp, and neither is nonsense.
        let sharpness = Sharpness { rule: CausticRule::new(0.4).unwrap() };
        assert!(!sharpness.is_sharp(0.0, 1.0) && !sharpness.is_sharp(f32::NAN, 1.0) && sharpness.is_sharp(10.0, 1.0));
    }
}
