//! Rough plastic: a diffuse base under a rough dielectric coat.

use core::f32::consts::FRAC_1_PI;

use glam::Vec3A;

use super::conductor::ReflectionLobe;
use super::fresnel::refraction;
use super::microfacet::Microfacet;
use super::plastic::Base;
use super::quadrature::gauss_legendre;
use super::warp::cosine_hemisphere;
use super::{BsdfSample, Distribution};
use crate::texture::Texture;
use crate::traits::Rgb;

/// Number of angles at which transmittances are tabulated.
const ANGLES: usize = 64;

/// A rough plastic.
///
/// `f cos_i = rho_s F(wo.h) D(h) G / (4 cos_o) + rho_d / (1 - rho_d R_i) T(cos_o) T(cos_i) cos_i / (pi eta^2)`.
///
/// - `T(mu)`: share of light from the direction of cosine `mu` that crosses the rough interface from outside, by
///   single scattering: the mean of `(1 - F) G1(transmitted)` over visible normals. A table in `mu`, interpolated linearly.
/// - `R_i`: share of diffuse light from inside that the interface reflects, `2 integral R(mu) mu dmu`. It is the mean
///   over the 64 nodes of a table in `mu`, ends included: Mitsuba 3 does that, and is about 2 % of
///   `1 - R_i` off the integral; we follow it so that images agree.
///
/// Source: the model of Mitsuba's `roughplastic`, with which it agrees.
#[derive(Clone, Debug)]
pub(super) struct RoughPlastic {
    pub(super) base: Base,
    pub(super) microfacet: Microfacet,
    transmittance: [f32; ANGLES],
    /// `2 integral T(mu) mu dmu`.
    mean_transmittance: f32,
}

impl RoughPlastic {
    pub(super) fn new(
        eta: f32,
        diffuse: Texture,
        specular: Texture,
        nonlinear: bool,
        distribution: Distribution,
        alpha: f32,
    ) -> Self {
        let microfacet = Microfacet::new(distribution, [alpha; 2]);
        let outside = Rule::new(32);
        let inside = Rule::new(64);
        let transmittance = std::array::from_fn(|i| external_transmittance(&microfacet, &outside, node(i), eta));
        let internal =
            (0..ANGLES).map(|i| 2.0 * node(i) * internal_reflectance(&microfacet, &inside, node(i), 1.0 / eta));
        let internal = internal.sum::<f32>() / ANGLES as f32;
        let weighted = (0..ANGLES).map(|i| 2.0 * node(i) * transmittance[i]).sum::<f32>();
        let mean_transmittance = (weighted - transmittance[ANGLES - 1]) / (ANGLES - 1) as f32;
        let base = Base::new(eta, diffuse, specular, nonlinear, internal);
        Self { base, microfacet, transmittance, mean_transmittance }
    }

    /// Linear interpolation of the table.
    #[inline]
    fn transmittance(&self, cos: f32) -> f32 {
        let x = cos.min(1.0) * (ANGLES - 1) as f32;
        let i = (x as usize).min(ANGLES - 2);
        let (a, b) = (self.transmittance[i], self.transmittance[i + 1]);
        a + (b - a) * (x - i as f32)
    }

    #[inline]
    pub(super) fn eval_pdf(&self, diffuse: Rgb, specular: Rgb, wo: Vec3A, wi: Vec3A) -> (Rgb, f32) {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let outgoing = self.transmittance(wo.z);
        let (p_specular, p_diffuse) = self.base.probabilities(1.0 - outgoing);
        let lobe = ReflectionLobe::new(&self.microfacet, wo, wi);
        let reflectance = refraction(lobe.cos_half, self.base.eta).reflectance;
        let cosine = wi.z * FRAC_1_PI;
        let value = specular * (reflectance * lobe.value) + diffuse * (outgoing * self.transmittance(wi.z) * cosine);
        (value, p_specular * lobe.pdf + p_diffuse * cosine)
    }

    #[inline]
    pub(super) fn sample(&self, diffuse: Rgb, specular: Rgb, wo: Vec3A, u: [f32; 3]) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let (p_specular, _) = self.base.probabilities(1.0 - self.transmittance(wo.z));
        let square = [u[1], u[2]];
        let wi = if u[0] < p_specular {
            let m = self.microfacet.sample_visible(wo, square);
            m * (2.0 * wo.dot(m)) - wo
        } else {
            cosine_hemisphere(square)
        };
        BsdfSample::from_eval(wi, self.eval_pdf(diffuse, specular, wo, wi))
    }

    pub(super) fn albedo(&self, diffuse: Rgb, specular: Rgb, wo: Vec3A) -> Rgb {
        let outgoing = self.transmittance(wo.z.abs());
        specular * (1.0 - outgoing) + diffuse * (outgoing * self.mean_transmittance)
    }
}

/// Cosine of the `i`-th angle.
fn node(i: usize) -> f32 {
    (i as f32 / (ANGLES - 1) as f32).max(1e-6)
}

/// Gauss-Legendre quadrature over the square that parametrises visible normals.
struct Rule {
    along: Vec<(f64, f64)>,
    /// Over one half of the second coordinate: the other half is its mirror image.
    across: Vec<(f64, f64)>,
}

impl Rule {
    fn new(order: usize) -> Self {
        Self { along: gauss_legendre(order), across: gauss_legendre(order / 2) }
    }

    /// The mean of `f(wo, m)` over the normals that are visible from the cosine `mu`.
    fn mean(&self, microfacet: &Microfacet, mu: f32, f: impl Fn(Vec3A, Vec3A) -> f32) -> f32 {
        let wo = Vec3A::new((1.0 - mu * mu).max(0.0).sqrt(), 0.0, mu);
        let mut sum = 0.0;
        for (x, weight_x) in &self.along {
            for (y, weight_y) in &self.across {
                let m = microfacet.sample_visible(wo, [*x as f32, 0.5 * *y as f32]);
                sum += weight_x * weight_y * f64::from(f(wo, m));
            }
        }
        sum as f32
    }
}

fn external_transmittance(microfacet: &Microfacet, rule: &Rule, mu: f32, eta: f32) -> f32 {
    rule.mean(microfacet, mu, |wo, m| {
        let cos = wo.dot(m).clamp(0.0, 1.0);
        let at = refraction(cos, eta);
        let wt = m * (cos / eta - at.cos_transmitted) - wo / eta;
        if wt.z < 0.0 { (1.0 - at.reflectance) * microfacet.masking_over_cos(-wt) * -wt.z } else { 0.0 }
    })
}

fn internal_reflectance(microfacet: &Microfacet, rule: &Rule, mu: f32, eta: f32) -> f32 {
    rule.mean(microfacet, mu, |wo, m| {
        let cos = wo.dot(m).clamp(0.0, 1.0);
        let wi = m * (2.0 * cos) - wo;
        if wi.z > 0.0 { refraction(cos, eta).reflectance * microfacet.masking_over_cos(wi) * wi.z } else { 0.0 }
    })
}
