//! The metallic-roughness model of glTF 2.0.

use core::f32::consts::FRAC_1_PI;

use glam::Vec3A;

use super::conductor::ReflectionLobe;
use super::microfacet::Microfacet;
use super::warp::cosine_hemisphere;
use super::{BsdfSample, Distribution};
use crate::texture::Texture;
use crate::traits::{Rgb, Spectrum};

/// A mixture of a metal and of a dielectric coat over a diffuse base:
///
/// ```text
/// f = m F(b, 1) S + (1 - m) [ w F(f_0, 1) S + (1 - w max F(f_0, 1)) b / pi ]
/// F(f_0, f_90) = f_0 + (f_90 - f_0) (1 - wo.h)^5         S = D(h) G1(wo) G1(wi) / (4 cos_o cos_i)
/// f_0 = min(((n - 1) / (n + 1))^2 c, 1)                  alpha = r^2
/// ```
///
/// **Symbols.** `b` base colour, `m` metalness, `r` roughness, `n` index of refraction, `w` and `c` weight and colour of the dielectric's
/// reflection; `D` is GGX, `G1` Smith's masking, `h` the half vector; `max` is over the components.
///
/// **Energy.** The metal never reflects more than arrives. The dielectric does at grazing angles: its coat reflects by the angle to
/// the half vector of its own lobe, but takes from the base by that of the base's. For a white smooth dielectric the sum is up to 1.03
/// at 60 degrees and nears 2 at the horizon. That is the specification's formula, and kept so that pictures agree with other renderers'.
///
/// **Sampling.** Of the visible normals or of the cosine, chosen by Fresnel's factor at the normal and by the albedo of the base.
///
/// Sources: Khronos 2021, "glTF 2.0 Specification", appendix B.2 and B.3, with the extensions `KHR_materials_ior` and
/// `KHR_materials_specular`; Schlick 1994 for `F`.
#[derive(Clone, Debug)]
pub(super) struct MetallicRoughness {
    pub(super) base_color: Texture,
    /// Roughness in green, metalness in blue.
    pub(super) metallic_roughness: Texture,
    metallic: f32,
    roughness: f32,
    /// Reflectance of the dielectric at normal incidence.
    f0: Rgb,
    specular: f32,
}

/// The parameters at one point.
struct Point {
    microfacet: Microfacet,
    base: Rgb,
    metallic: f32,
}

impl MetallicRoughness {
    pub(super) fn new(
        base_color: Texture,
        metallic_roughness: Texture,
        [metallic, roughness]: [f32; 2],
        ior: f32,
        specular: f32,
        specular_color: Rgb,
    ) -> Self {
        let root = (ior - 1.0) / (ior + 1.0);
        let f0 = (specular_color * (root * root)).clamp(0.0, 1.0);
        Self { base_color, metallic_roughness, metallic, roughness, f0, specular }
    }

    /// Roughness (green) and metalness (blue) of what the texture says.
    #[inline]
    pub(super) fn scaled(&self, texel: Rgb) -> Rgb {
        Rgb::new(0.0, texel[1] * self.roughness, texel[2] * self.metallic).clamp(0.0, 1.0)
    }

    #[inline]
    fn point(base: Rgb, surface: Rgb) -> Point {
        Point { microfacet: microfacet(surface), base: base.clamp(0.0, 1.0), metallic: surface[2] }
    }

    /// The factors of the glossy lobe and of the diffuse one, for `cos = wo.h`.
    #[inline]
    fn factors(&self, point: &Point, cos: f32) -> (Rgb, Rgb) {
        let away = 1.0 - cos;
        let grazing = (away * away) * (away * away) * away;
        let schlick = |f0: Rgb| f0 + (Rgb::ONE - f0) * grazing;
        let coat = schlick(self.f0) * self.specular;
        let glossy = schlick(point.base) * point.metallic + coat * (1.0 - point.metallic);
        let diffuse = point.base * ((1.0 - point.metallic) * (1.0 - coat.max_component()));
        (glossy, diffuse)
    }

    /// The probability of sampling the glossy lobe. Not below a sixth where there is one: its factor may be larger at the half
    /// vector than at the normal.
    #[inline]
    fn glossy_probability(&self, point: &Point, wo: Vec3A) -> f32 {
        let diffuse = point.base.max_component() * (1.0 - point.metallic);
        if diffuse <= 0.0 {
            return 1.0;
        }
        if point.metallic == 0.0 && self.specular == 0.0 {
            return 0.0;
        }
        let glossy = self.factors(point, wo.z.min(1.0)).0.max_component().max(0.2 * diffuse);
        glossy / (glossy + diffuse)
    }

    /// With `surface` as [`scaled`](Self::scaled) returns it.
    #[inline]
    pub(super) fn eval_pdf(&self, base: Rgb, surface: Rgb, wo: Vec3A, wi: Vec3A) -> (Rgb, f32) {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let point = Self::point(base, surface);
        let lobe = ReflectionLobe::new(&point.microfacet, wo, wi);
        let (glossy, diffuse) = self.factors(&point, lobe.cos_half);
        let probability = self.glossy_probability(&point, wo);
        let cosine = wi.z * FRAC_1_PI;
        (glossy * lobe.value + diffuse * cosine, probability * lobe.pdf + (1.0 - probability) * cosine)
    }

    #[inline]
    pub(super) fn sample(&self, base: Rgb, surface: Rgb, wo: Vec3A, u: [f32; 3]) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let point = Self::point(base, surface);
        let square = [u[1], u[2]];
        let wi = if u[0] < self.glossy_probability(&point, wo) {
            let m = point.microfacet.sample_visible(wo, square);
            m * (2.0 * wo.dot(m)) - wo
        } else {
            cosine_hemisphere(square)
        };
        BsdfSample::from_eval(wi, self.eval_pdf(base, surface, wo, wi))
    }

    /// An estimate: Fresnel's factor at the normal.
    pub(super) fn albedo(&self, base: Rgb, surface: Rgb, wo: Vec3A) -> Rgb {
        let (glossy, diffuse) = self.factors(&Self::point(base, surface), wo.z.abs().min(1.0));
        glossy + diffuse
    }
}

#[inline]
fn microfacet(surface: Rgb) -> Microfacet {
    Microfacet::new(Distribution::Ggx, [surface[1] * surface[1]; 2])
}

/// As [`Bsdf::roughness`](super::Bsdf::roughness).
pub(super) fn roughness(surface: Rgb) -> f32 {
    microfacet(surface).roughness()
}
