//! The model of Cook and Torrance.

use core::f32::consts::FRAC_1_PI;

use glam::Vec3A;

use super::fresnel::refraction;
use super::microfacet::Microfacet;
use super::phong::specular_probability;
use super::warp::{ONE_MINUS_EPSILON, cosine_hemisphere, sin_cos_turn};
use super::{BsdfSample, Distribution};
use crate::texture::Texture;
use crate::traits::Rgb;

/// Diffuse reflection and a glossy lobe off facets that form V-shaped grooves:
/// `f = rho_d / pi + rho_s F(wo.h) D(h) G / (4 cos_o cos_i)`.
///
/// - `D`: Beckmann's distribution, with root mean square slope `alpha`.
/// - `G = min(1, 2 h_z cos_o / wo.h, 2 h_z cos_i / wo.h)`: masking by the facet on the other side of the groove.
/// - `F`: Fresnel's reflectance of a dielectric of index `ior`.
///
/// The original has `pi` in place of 4; 4 is what the derivation gives, and conserves energy for `rho_d + rho_s <= 1`. The
/// lobes are chosen in proportion to the luminance of their reflectances. The glossy one samples the normals of the
/// grooves that are visible, with the density `D min(1, 2 h_z cos_o / wo.h) (wo.h) / cos_o`.
///
/// Sources: Cook and Torrance 1982, "A Reflectance Model for Computer Graphics"; the factor 4: Walter et al. 2007;
/// sampling: Heitz and d'Eon 2014, "Importance Sampling Microfacet-Based BSDFs using the Distribution of Visible
/// Normals", algorithm for V-cavities. (Talbot, Cline, Egbert 2005 resample this model without giving parameters.)
#[derive(Clone, Debug)]
pub(super) struct CookTorrance {
    pub(super) diffuse_reflectance: Texture,
    pub(super) specular_reflectance: Texture,
    ior: f32,
    alpha: f32,
    pub(super) microfacet: Microfacet,
}

impl CookTorrance {
    pub(super) fn new(diffuse: Texture, specular: Texture, ior: f32, alpha: f32) -> Self {
        let alpha = alpha.max(1e-4);
        Self {
            diffuse_reflectance: diffuse,
            specular_reflectance: specular,
            ior,
            alpha,
            microfacet: Microfacet::new(Distribution::Beckmann, [alpha; 2]),
        }
    }

    #[inline]
    pub(super) fn eval_pdf(&self, diffuse: Rgb, specular: Rgb, wo: Vec3A, wi: Vec3A) -> (Rgb, f32) {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let h = wo + wi;
        let length = h.length();
        let cos_half = (0.5 * length).min(1.0);
        // 2 h_z / wo.h for the normalised half vector.
        let groove = 4.0 * h.z / (length * length).max(f32::MIN_POSITIVE);
        let quarter_density = 0.25 * self.microfacet.density(h);
        // min(1, x cos) / cos = min(1 / cos, x), which is finite at grazing angles.
        let visibility = groove.min(1.0 / wo.z.max(1e-30));
        let both = visibility.min(groove * wi.z / wo.z.max(1e-30));
        let reflectance = refraction(cos_half, self.ior).reflectance;
        let p_specular = specular_probability(diffuse, specular);
        let cosine = wi.z * FRAC_1_PI;
        let value = diffuse * cosine + specular * (reflectance * quarter_density * both);
        (value, (1.0 - p_specular) * cosine + p_specular * quarter_density * visibility)
    }

    pub(super) fn sample(&self, diffuse: Rgb, specular: Rgb, wo: Vec3A, u: [f32; 3]) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let p_specular = specular_probability(diffuse, specular);
        let wi = if u[0] < p_specular {
            let m = self.sample_visible(wo, (u[0] / p_specular).min(ONE_MINUS_EPSILON), [u[1], u[2]]);
            m * (2.0 * wo.dot(m)) - wo
        } else {
            cosine_hemisphere([u[1], u[2]])
        };
        BsdfSample::from_eval(wi, self.eval_pdf(diffuse, specular, wo, wi))
    }

    /// Fresnel's reflectance at the cosine `cos`.
    pub(super) fn reflectance(&self, cos: f32) -> f32 {
        refraction(cos.min(1.0), self.ior).reflectance
    }

    /// A normal from Beckmann's distribution, or of the opposite facet of its groove, by how much of each `wo` sees.
    fn sample_visible(&self, wo: Vec3A, choice: f32, u: [f32; 2]) -> Vec3A {
        let tan2 = -(1.0 - u[0]).ln() * self.alpha * self.alpha;
        let cos = 1.0 / (1.0 + tan2).sqrt();
        let sin = tan2.sqrt() * cos;
        let (y, x) = sin_cos_turn(u[1]);
        let m = Vec3A::new(sin * x, sin * y, cos);
        let opposite = Vec3A::new(-m.x, -m.y, m.z);
        let (a, b) = (wo.dot(m).max(0.0), wo.dot(opposite).max(0.0));
        if choice * (a + b) < a { m } else { opposite }
    }
}
