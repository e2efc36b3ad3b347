//! Glass: smooth, thin and rough.

use glam::Vec3A;

use super::BsdfSample;
use super::conductor::{ReflectionLobe, mirrored, sampled_masking};
use super::fresnel::refraction;
use super::microfacet::Microfacet;
use crate::medium::Medium;
use crate::texture::Texture;
use crate::traits::{Rgb, TransportMode};

/// What all dielectrics have.
#[derive(Clone, Debug)]
pub(super) struct Interface {
    /// Index of refraction inside over outside; the normal points outside.
    eta: f32,
    inverse_eta: f32,
    pub(super) specular_reflectance: Texture,
    pub(super) specular_transmittance: Texture,
    /// What is inside, unless it is clear.
    pub(super) interior: Option<Medium<Rgb>>,
}

impl Interface {
    pub(super) fn new(int_ior: f32, ext_ior: f32, reflectance: Texture, transmittance: Texture) -> Self {
        Self {
            eta: int_ior / ext_ior,
            inverse_eta: ext_ior / int_ior,
            specular_reflectance: reflectance,
            specular_transmittance: transmittance,
            interior: None,
        }
    }

    /// The index of the far side over that of the side of `wo`, and its reciprocal.
    #[inline]
    fn eta_towards(&self, wo: Vec3A) -> (f32, f32) {
        if wo.z > 0.0 { (self.eta, self.inverse_eta) } else { (self.inverse_eta, self.eta) }
    }

    /// Reflected share of the power for the cosine `cos >= 0` on the outside.
    #[inline]
    pub(super) fn reflectance_outside(&self, cos: f32) -> f32 {
        refraction(cos, self.eta).reflectance
    }

    /// A smooth interface: reflects with the probability of Fresnel's reflectance, else refracts.
    ///
    /// Radiance that crosses it is scaled by `(eta_o / eta_i)^2`, importance is not (Veach 1997, section 5.2).
    /// Agrees with Mitsuba's `dielectric`.
    #[inline]
    pub(super) fn sample(&self, tint: [Rgb; 2], wo: Vec3A, u: f32, mode: TransportMode) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let (eta, inverse) = self.eta_towards(wo);
        let at = refraction(wo.z.abs().min(1.0), eta);
        if u < at.reflectance {
            return Some(BsdfSample::specular(mirrored(wo), tint[0], 1.0));
        }
        let wi = Vec3A::new(-inverse * wo.x, -inverse * wo.y, -at.cos_transmitted.copysign(wo.z));
        (at.cos_transmitted > 0.0).then(|| BsdfSample::specular(wi, tint[1] * radiance_scale(inverse, mode), eta))
    }

    /// A thin pane: light leaves it in its old direction. With all reflections inside, the pane reflects `2 R / (1 + R)`.
    /// Agrees with Mitsuba's `thindielectric`.
    #[inline]
    pub(super) fn sample_thin(&self, tint: [Rgb; 2], wo: Vec3A, u: f32) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        if u < self.thin_reflectance(wo.z.abs()) {
            Some(BsdfSample::specular(mirrored(wo), tint[0], 1.0))
        } else {
            Some(BsdfSample::specular(-wo, tint[1], 1.0))
        }
    }

    /// Reflectance of a thin pane.
    #[inline]
    pub(super) fn thin_reflectance(&self, cos: f32) -> f32 {
        let r = self.reflectance_outside(cos.min(1.0));
        2.0 * r / (1.0 + r)
    }

    /// The share of the power that is reflected towards the side of `wo`.
    #[inline]
    pub(super) fn reflectance(&self, wo: Vec3A) -> f32 {
        refraction(wo.z.abs().min(1.0), self.eta_towards(wo).0).reflectance
    }
}

/// What radiance is scaled by when `inverse` is the index of its side over the far side's.
#[inline]
fn radiance_scale(inverse: f32, mode: TransportMode) -> f32 {
    match mode {
        TransportMode::Radiance => inverse * inverse,
        TransportMode::Importance => 1.0,
    }
}

/// A rough interface.
///
/// Reflection: `f cos_i = rho F D G / (4 cos_o)`. Transmission, with `eta = eta_i / eta_o` and the half vector
/// `h` along `wo + eta wi`:
/// `f cos_i = tau (1 - F) D G eta^2 (wo.h) |wi.h| / (cos_o (wo.h + eta wi.h)^2)`, times `1 / eta^2` for radiance.
/// `G = G1(wo) G1(wi)`; reflects with probability `F` of the sampled visible normal.
///
/// Source: Walter et al. 2007, equations 20 and 21. Agrees with Mitsuba's `roughdielectric`.
#[derive(Clone, Debug)]
pub(super) struct RoughDielectric {
    pub(super) interface: Interface,
    pub(super) microfacet: Microfacet,
}

impl RoughDielectric {
    pub(super) fn eval_pdf(&self, tint: [Rgb; 2], wo: Vec3A, wi: Vec3A, mode: TransportMode) -> (Rgb, f32) {
        if wo.z == 0.0 || wi.z == 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let (eta, inverse) = self.interface.eta_towards(wo);
        // Look at it from the side of wo.
        let side = 1.0f32.copysign(wo.z);
        let (wo, wi) = (wo.with_z(wo.z * side), wi.with_z(wi.z * side));
        if wi.z > 0.0 {
            let lobe = ReflectionLobe::new(&self.microfacet, wo, wi);
            let reflectance = refraction(lobe.cos_half, eta).reflectance;
            return (tint[0] * (reflectance * lobe.value), reflectance * lobe.pdf);
        }
        let h = wo + wi * eta;
        let length2 = h.length_squared();
        if length2 == 0.0 || h.z == 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let m = h * (1.0f32.copysign(h.z) / length2.sqrt());
        let (cos_o, cos_i) = (wo.dot(m), wi.dot(m));
        if cos_o <= 0.0 || cos_i >= 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let transmittance = 1.0 - refraction(cos_o.min(1.0), eta).reflectance;
        // (wo.m + eta wi.m)^2 is the squared length of h.
        let jacobian = eta * eta * -cos_i / length2;
        let visible = self.microfacet.density(m) * cos_o * transmittance * jacobian;
        let shadowing = self.microfacet.masking_over_cos(-wi) * -wi.z;
        let value = visible * self.microfacet.masking_over_cos(wo) * shadowing * radiance_scale(inverse, mode);
        (tint[1] * value, visible * self.microfacet.sampling_over_cos(wo))
    }

    pub(super) fn sample(&self, tint: [Rgb; 2], wo: Vec3A, u: [f32; 3], mode: TransportMode) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let (eta, inverse) = self.interface.eta_towards(wo);
        let side = 1.0f32.copysign(wo.z);
        let wo = wo.with_z(wo.z * side);
        let m = self.microfacet.sample_visible(wo, [u[1], u[2]]);
        let cos_o = wo.dot(m).min(1.0);
        if cos_o <= 0.0 {
            return None;
        }
        let at = refraction(cos_o, eta);
        let density = self.microfacet.density(m);
        let reflected = u[0] < at.reflectance;
        let wi =
            if reflected { m * (2.0 * cos_o) - wo } else { m * (inverse * cos_o - at.cos_transmitted) - wo * inverse };
        if (wi.z > 0.0) != reflected || wi.z == 0.0 || (!reflected && at.cos_transmitted <= 0.0) {
            return None;
        }
        let (weight, visibility) = sampled_masking(&self.microfacet, wo, wi);
        let (throughput, pdf, eta) = if reflected {
            (tint[0] * weight, at.reflectance * 0.25 * density * visibility, 1.0)
        } else {
            let jacobian = eta * eta * at.cos_transmitted / (wo + wi * eta).length_squared();
            let pdf = (1.0 - at.reflectance) * density * visibility * cos_o * jacobian;
            (tint[1] * (weight * radiance_scale(inverse, mode)), pdf, eta)
        };
        let wi = wi.with_z(wi.z * side);
        (pdf > 0.0 && pdf.is_finite()).then_some(BsdfSample { wi, throughput, pdf, is_specular: false, eta })
    }
}
