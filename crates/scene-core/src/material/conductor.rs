//! Smooth and rough metals.

use glam::Vec3A;

use super::BsdfSample;
use super::fresnel::ConductorFresnel;
use super::microfacet::Microfacet;
use crate::texture::Texture;
use crate::traits::Rgb;

/// A mirror of metal: `f = F(cos) rho delta(wi - reflected wo) / cos`. Agrees with Mitsuba's `conductor`.
#[derive(Clone, Debug)]
pub(super) struct Conductor {
    pub(super) fresnel: ConductorFresnel,
    pub(super) specular_reflectance: Texture,
}

impl Conductor {
    #[inline]
    pub(super) fn sample(&self, specular: Rgb, wo: Vec3A) -> Option<BsdfSample> {
        (wo.z > 0.0).then(|| BsdfSample::specular(mirrored(wo), specular * self.fresnel.reflectance(wo.z), 1.0))
    }
}

/// The mirror direction.
#[inline]
pub(super) fn mirrored(wo: Vec3A) -> Vec3A {
    Vec3A::new(-wo.x, -wo.y, wo.z)
}

/// A rough metal.
///
/// `f cos_i = rho F(wo.h) D(h) G1(wo) G1(wi) / (4 cos_o)`, with the half vector `h` and Smith's separable masking, see
/// [`Microfacet`]; samples visible normals, so that the throughput is `rho F G1(wi)`.
///
/// Source: Torrance and Sparrow 1967; Walter et al. 2007, equation 20. Agrees with Mitsuba's `roughconductor`.
#[derive(Clone, Debug)]
pub(super) struct RoughConductor {
    pub(super) fresnel: ConductorFresnel,
    pub(super) specular_reflectance: Texture,
    pub(super) microfacet: Microfacet,
}

impl RoughConductor {
    #[inline]
    pub(super) fn eval_pdf(&self, specular: Rgb, wo: Vec3A, wi: Vec3A) -> (Rgb, f32) {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let lobe = ReflectionLobe::new(&self.microfacet, wo, wi);
        (specular * self.fresnel.reflectance(lobe.cos_half) * lobe.value, lobe.pdf)
    }

    #[inline]
    pub(super) fn sample(&self, specular: Rgb, wo: Vec3A, u: [f32; 2]) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let m = self.microfacet.sample_visible(wo, u);
        let cos_half = wo.dot(m);
        let wi = m * (2.0 * cos_half) - wo;
        if wi.z <= 0.0 || cos_half <= 0.0 {
            return None;
        }
        let (weight, visibility) = sampled_masking(&self.microfacet, wo, wi);
        let throughput = specular * self.fresnel.reflectance(cos_half) * weight;
        let pdf = 0.25 * self.microfacet.density(m) * visibility;
        (pdf > 0.0).then_some(BsdfSample { wi, throughput, pdf, is_specular: false, eta: 1.0 })
    }
}

/// Masking over the density's masking, `G1(wo) G1(wi) / G1'(wo)`, and `G1'(wo) / cos_o`, with `G1'` that of the sampling.
/// `wi` may lie on either side.
#[inline]
pub(super) fn sampled_masking(microfacet: &Microfacet, wo: Vec3A, wi: Vec3A) -> (f32, f32) {
    let wi = wi.with_z(wi.z.abs());
    let masking = microfacet.masking_over_cos(wi) * wi.z;
    let visibility = microfacet.sampling_over_cos(wo);
    if microfacet.is_beckmann() {
        (masking * microfacet.masking_over_cos(wo) / visibility, visibility)
    } else {
        (masking, visibility)
    }
}

/// Reflection off visible normals, without Fresnel's factor: `D G1(wo) G1(wi) / (4 cos_o)`, and the density of `wi`.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReflectionLobe {
    pub(super) value: f32,
    pub(super) pdf: f32,
    /// `wo.h = wi.h`.
    pub(super) cos_half: f32,
}

impl ReflectionLobe {
    /// Only for directions in the upper hemisphere.
    #[inline]
    pub(super) fn new(microfacet: &Microfacet, wo: Vec3A, wi: Vec3A) -> Self {
        let h = wo + wi;
        // wo.h = 1 + wo.wi is half the squared length of h, for unit vectors.
        let cos_half = (0.5 * h.length()).min(1.0);
        let quarter_density = 0.25 * microfacet.density(h);
        let shadowing = microfacet.masking_over_cos(wi) * wi.z;
        let masking = microfacet.masking_over_cos(wo);
        let visibility = if microfacet.is_beckmann() { microfacet.sampling_over_cos(wo) } else { masking };
        Self { value: quarter_density * masking * shadowing, pdf: quarter_density * visibility, cos_half }
    }
}
