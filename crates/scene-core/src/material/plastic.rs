//! Plastic: a diffuse base under a smooth dielectric coat.

use core::f32::consts::FRAC_1_PI;

use glam::Vec3A;

use super::BsdfSample;
use super::conductor::mirrored;
use super::fresnel::{diffuse_reflectance, refraction};
use super::warp::cosine_hemisphere;
use crate::texture::Texture;
use crate::traits::{Rgb, Spectrum};

/// The diffuse base that all plastics share.
#[derive(Clone, Debug)]
pub(super) struct Base {
    pub(super) diffuse_reflectance: Texture,
    pub(super) specular_reflectance: Texture,
    /// Index of refraction of the coat over the outside's.
    pub(super) eta: f32,
    /// Whether light changes colour with each reflection inside.
    nonlinear: bool,
    /// Share of diffuse light that the interface reflects back inside.
    internal_reflectance: f32,
    /// Probability of the specular lobe, were the interface to reflect one half.
    specular_weight: f32,
}

impl Base {
    pub(super) fn new(eta: f32, diffuse: Texture, specular: Texture, nonlinear: bool, internal: f32) -> Self {
        let (d, s) = (mean_of(&diffuse), mean_of(&specular));
        Self {
            diffuse_reflectance: diffuse,
            specular_reflectance: specular,
            eta,
            nonlinear,
            internal_reflectance: internal,
            specular_weight: if d + s > 0.0 { s / (d + s) } else { 1.0 },
        }
    }

    /// The factor of the diffuse lobe: `rho / ((1 - rho R_i) eta^2)`, or with `R_i` alone if not nonlinear.
    #[inline]
    pub(super) fn diffuse_factor(&self, reflectance: Rgb) -> Rgb {
        let returned = if self.nonlinear { reflectance } else { Rgb::ONE } * self.internal_reflectance;
        reflectance / ((Rgb::ONE - returned) * (self.eta * self.eta))
    }

    /// Probabilities of the specular and of the diffuse lobe, if the interface reflects the share `reflectance`.
    #[inline]
    pub(super) fn probabilities(&self, reflectance: f32) -> (f32, f32) {
        let specular = reflectance * self.specular_weight;
        let diffuse = (1.0 - reflectance) * (1.0 - self.specular_weight);
        let sum = specular + diffuse;
        if sum > 0.0 { (specular / sum, diffuse / sum) } else { (1.0, 0.0) }
    }
}

/// One number for a texture, to choose between lobes.
fn mean_of(texture: &Texture) -> f32 {
    match texture.constant() {
        Some(value) => value.mean(),
        None => texture.mean().luminance(),
    }
}

/// A smooth plastic.
///
/// A mirror reflection `F(cos_o) rho_s`, and
/// `f cos_i = rho_d / (1 - rho_d R_i) (1 - F(cos_o)) (1 - F(cos_i)) cos_i / (pi eta^2)`
/// with `R_i` the interface's diffuse reflectance from inside: the geometric series of light that is reflected
/// back inside.
///
/// Source: the model of Mitsuba's `plastic`, with which it agrees.
#[derive(Clone, Debug)]
pub(super) struct Plastic {
    pub(super) base: Base,
    /// The interface's diffuse reflectance from outside.
    external_reflectance: f32,
}

impl Plastic {
    pub(super) fn new(eta: f32, diffuse: Texture, specular: Texture, nonlinear: bool) -> Self {
        let base = Base::new(eta, diffuse, specular, nonlinear, diffuse_reflectance(1.0 / eta));
        Self { base, external_reflectance: diffuse_reflectance(eta) }
    }

    #[inline]
    fn reflectance(&self, cos: f32) -> f32 {
        refraction(cos.min(1.0), self.base.eta).reflectance
    }

    #[inline]
    pub(super) fn eval_pdf(&self, diffuse: Rgb, wo: Vec3A, wi: Vec3A) -> (Rgb, f32) {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let outgoing = self.reflectance(wo.z);
        let cosine = wi.z * FRAC_1_PI;
        let (_, probability) = self.base.probabilities(outgoing);
        let value = diffuse * ((1.0 - outgoing) * (1.0 - self.reflectance(wi.z)) * cosine);
        (value, cosine * probability)
    }

    #[inline]
    pub(super) fn sample(&self, diffuse: Rgb, specular: Rgb, wo: Vec3A, u: [f32; 3]) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let outgoing = self.reflectance(wo.z);
        let (p_specular, p_diffuse) = self.base.probabilities(outgoing);
        if u[0] < p_specular {
            return Some(BsdfSample::specular(mirrored(wo), specular * (outgoing / p_specular), 1.0));
        }
        if p_diffuse <= 0.0 {
            return None;
        }
        let wi = cosine_hemisphere([u[1], u[2]]);
        let throughput = diffuse * ((1.0 - outgoing) * (1.0 - self.reflectance(wi.z)) / p_diffuse);
        Some(BsdfSample { wi, throughput, pdf: wi.z * FRAC_1_PI * p_diffuse, is_specular: false, eta: 1.0 })
    }

    pub(super) fn albedo(&self, diffuse: Rgb, specular: Rgb, wo: Vec3A) -> Rgb {
        let outgoing = self.reflectance(wo.z.abs());
        specular * outgoing + diffuse * ((1.0 - outgoing) * (1.0 - self.external_reflectance))
    }
}
