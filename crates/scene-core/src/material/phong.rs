//! The modified Phong model.

use core::f32::consts::FRAC_1_PI;

use glam::Vec3A;

use super::BsdfSample;
use super::conductor::mirrored;
use super::warp::{cosine_hemisphere, sin_cos_turn};
use crate::frame::Frame;
use crate::texture::Texture;
use crate::traits::{Rgb, Spectrum};

/// Diffuse reflection and a glossy lobe around the mirror direction:
/// `f = rho_d / pi + rho_s (n + 2) / (2 pi) (cos a)^n`, with `a` between `wi` and the mirrored `wo`.
///
/// Reciprocal; conserves energy for `rho_d + rho_s <= 1`. The lobes are chosen in proportion to the luminance of their
/// reflectances; the glossy one is sampled with density `(n + 1) / (2 pi) (cos a)^n`, directions below the surface are lost.
///
/// Source: Lafortune and Willems 1994, "Using the Modified Phong Reflectance Model for Physically Based Rendering".
#[derive(Clone, Debug)]
pub(super) struct Phong {
    pub(super) diffuse_reflectance: Texture,
    pub(super) specular_reflectance: Texture,
    pub(super) exponent: f32,
}

/// The probability of the specular lobe.
#[inline]
pub(super) fn specular_probability(diffuse: Rgb, specular: Rgb) -> f32 {
    let (d, s) = (diffuse.luminance(), specular.luminance());
    if d + s > 0.0 { s / (d + s) } else { 0.0 }
}

impl Phong {
    #[inline]
    pub(super) fn eval_pdf(&self, diffuse: Rgb, specular: Rgb, wo: Vec3A, wi: Vec3A) -> (Rgb, f32) {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let p_specular = specular_probability(diffuse, specular);
        let cos = mirrored(wo).dot(wi).clamp(0.0, 1.0);
        let lobe = cos.powf(self.exponent) * (0.5 * FRAC_1_PI);
        let cosine = wi.z * FRAC_1_PI;
        let value = diffuse * cosine + specular * ((self.exponent + 2.0) * lobe * wi.z);
        (value, (1.0 - p_specular) * cosine + p_specular * (self.exponent + 1.0) * lobe)
    }

    pub(super) fn sample(&self, diffuse: Rgb, specular: Rgb, wo: Vec3A, u: [f32; 3]) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let wi = if u[0] < specular_probability(diffuse, specular) {
            let cos = (1.0 - u[1]).powf(1.0 / (self.exponent + 1.0));
            let r = (1.0 - cos * cos).max(0.0).sqrt();
            let (y, x) = sin_cos_turn(u[2]);
            Frame::from_z(mirrored(wo)).to_world(Vec3A::new(r * x, r * y, cos))
        } else {
            cosine_hemisphere([u[1], u[2]])
        };
        BsdfSample::from_eval(wi, self.eval_pdf(diffuse, specular, wo, wi))
    }

    /// The roughness of the microfacet lobe of about this width.
    pub(super) fn roughness(&self) -> f32 {
        (2.0 / (self.exponent + 2.0)).sqrt()
    }
}
