//! The scattering function at one point.

use core::f32::consts::FRAC_1_PI;

use glam::Vec3A;

use super::surface::{Lobe, Surface};
use super::warp::{ONE_MINUS_EPSILON, UNIFORM_HEMISPHERE_PDF, uniform_hemisphere};
use crate::medium::Medium;
use crate::traits::{Rgb, TransportMode};

/// A direction in which a path goes on, in the local frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample {
    /// Unit direction, away from the surface.
    pub wi: Vec3A,
    /// `f |cos| / pdf`; for Dirac deltas their weight over the probability of choosing them.
    pub throughput: Rgb,
    /// Density by solid angle; zero, and without meaning, for Dirac deltas.
    pub pdf: f32,
    /// Whether the direction came from a Dirac delta.
    pub is_specular: bool,
    /// Index of refraction of the side that `wi` points to over that of `wo`'s side; 1 for reflection.
    pub eta: f32,
}

impl BsdfSample {
    #[inline]
    pub(super) fn specular(wi: Vec3A, throughput: Rgb, eta: f32) -> Self {
        Self { wi, throughput, pdf: 0.0, is_specular: true, eta }
    }

    /// A sample of reflection with the value and density of its direction, or nothing where that is zero.
    #[inline]
    pub(super) fn from_eval(wi: Vec3A, (value, pdf): (Rgb, f32)) -> Option<Self> {
        (pdf > 0.0).then(|| Self { wi, throughput: value / pdf, pdf, is_specular: false, eta: 1.0 })
    }
}

/// The scattering function at one point: textures are looked up, all by value or by reference to the material.
///
/// All directions are unit vectors in a local frame whose z axis is the shading normal; `wo` points to where the path
/// came from, `wi` to where it goes on, both away from the surface. `mode` is the direction of the walk.
///
/// # Laws
/// - `sample` returns `wi` with density `pdf`, Dirac deltas aside, and `throughput * pdf` is `eval`.
/// - `eval > 0` implies `pdf > 0`; `pdf` integrates to one less the probabilities of Dirac deltas and of absorption.
/// - No function returns infinities or NaN for any pair of unit vectors.
#[derive(Clone, Copy, Debug)]
pub struct Bsdf<'m> {
    pub(super) lobe: Lobe<'m>,
    /// What `wo` sees from behind, if it differs: looked up when it does.
    pub(super) back: Option<&'m Surface>,
    pub(super) uv: [f32; 2],
    pub(super) opacity: f32,
    pub(super) two_sided: bool,
    pub(super) evaluate_only: bool,
}

impl<'m> Bsdf<'m> {
    /// The BSDF times the cosine of `wi` with the shading normal, without Dirac deltas, in 1/sr.
    #[inline]
    pub fn eval(&self, wo: Vec3A, wi: Vec3A, mode: TransportMode) -> Rgb {
        self.eval_pdf(wo, wi, mode).0
    }

    /// The density with which [`sample`](Self::sample) returns `wi`, by solid angle.
    #[inline]
    pub fn pdf(&self, wo: Vec3A, wi: Vec3A, mode: TransportMode) -> f32 {
        self.eval_pdf(wo, wi, mode).1
    }

    /// [`eval`](Self::eval) and [`pdf`](Self::pdf) at once.
    #[inline]
    pub fn eval_pdf(&self, wo: Vec3A, wi: Vec3A, mode: TransportMode) -> (Rgb, f32) {
        // Diffuse surfaces are most of most scenes.
        if let Lobe::Diffuse(reflectance) = self.lobe
            && self.is_plain()
        {
            if wo.z * wi.z <= 0.0 || (wo.z < 0.0 && !self.two_sided) {
                return (Rgb::ZERO, 0.0);
            }
            let pdf = wi.z.abs() * FRAC_1_PI;
            return (reflectance * pdf, pdf);
        }
        self.eval_pdf_general(wo, wi, mode)
    }

    /// A direction to go on to; `u[0]` selects the component. Nothing if the path is absorbed.
    #[inline]
    pub fn sample(&self, wo: Vec3A, u: [f32; 3], mode: TransportMode) -> Option<BsdfSample> {
        if let Lobe::Diffuse(reflectance) = self.lobe
            && self.is_plain()
        {
            let side = if self.two_sided { 1.0f32.copysign(wo.z) } else { 1.0 };
            let mut sample = super::diffuse::sample(reflectance, wo.with_z(wo.z * side), [u[1], u[2]])?;
            sample.wi.z *= side;
            return Some(sample);
        }
        self.sample_general(wo, u, mode)
    }

    /// The directional albedo, or a cheap estimate, in `[0, 1]`.
    pub fn albedo(&self, wo: Vec3A) -> Rgb {
        let mut slot = None;
        let (lobe, side) = self.side(wo, &mut slot);
        let wo = wo.with_z(wo.z * side);
        let opaque = if lobe.is_one_sided() && wo.z <= 0.0 { Rgb::ZERO } else { lobe.albedo(wo).clamp(0.0, 1.0) };
        opaque * self.opacity + Rgb::splat(1.0 - self.opacity)
    }

    /// Whether it has a component that is not a Dirac delta, so that connections can find it.
    #[inline]
    pub fn is_connectible(&self) -> bool {
        !matches!(self.lobe, Lobe::Conductor(..) | Lobe::Dielectric(..) | Lobe::ThinDielectric(..))
            || self.back.is_some_and(Surface::is_connectible)
    }

    /// `f` if the BSDF is that constant where `wo` and `wi` are on one side, and zero elsewhere.
    #[inline]
    pub fn lambertian(&self, wo: Vec3A) -> Option<Rgb> {
        match self.lobe {
            Lobe::Diffuse(reflectance) if self.is_plain() && (wo.z > 0.0 || self.two_sided) => {
                Some(reflectance * FRAC_1_PI)
            }
            _ => None,
        }
    }

    /// The participating medium behind the surface, opposite to the normal, if it is the boundary of one.
    #[inline]
    pub fn interior(&self) -> Option<&'m Medium<Rgb>> {
        self.lobe.interior()
    }

    /// From 0 for Dirac deltas alone to 1 for diffuse: the smallest roughness of the other components, of the front side.
    pub fn roughness(&self) -> f32 {
        self.lobe.roughness()
    }

    /// Whether nothing is wrapped around the lobe but a second side of the same kind.
    #[inline]
    fn is_plain(&self) -> bool {
        self.opacity == 1.0 && !self.evaluate_only && self.back.is_none()
    }

    /// What `wo` sees, and the factor for z that brings `wo` to its front. `slot` keeps a back side that had to be looked up.
    #[inline]
    fn side<'a>(&'a self, wo: Vec3A, slot: &'a mut Option<Lobe<'m>>) -> (&'a Lobe<'m>, f32) {
        if wo.z >= 0.0 || !self.two_sided {
            return (&self.lobe, 1.0);
        }
        match self.back {
            Some(back) => (slot.insert(back.resolve(self.uv)), -1.0),
            None => (&self.lobe, -1.0),
        }
    }

    fn eval_pdf_general(&self, wo: Vec3A, wi: Vec3A, mode: TransportMode) -> (Rgb, f32) {
        let mut slot = None;
        let (lobe, side) = self.side(wo, &mut slot);
        let (wo, wi) = (wo.with_z(wo.z * side), wi.with_z(wi.z * side));
        let (value, pdf) = lobe.eval_pdf(wo, wi, mode);
        if self.evaluate_only {
            if wo.z * wi.z <= 0.0 || (lobe.is_one_sided() && wo.z < 0.0) {
                return (Rgb::ZERO, 0.0);
            }
            return (value * self.opacity, UNIFORM_HEMISPHERE_PDF * self.opacity);
        }
        (value * self.opacity, pdf * self.opacity)
    }

    fn sample_general(&self, wo: Vec3A, mut u: [f32; 3], mode: TransportMode) -> Option<BsdfSample> {
        // Pass through where it is not opaque.
        if u[0] >= self.opacity {
            return Some(BsdfSample::specular(-wo, Rgb::ONE, 1.0));
        }
        u[0] = (u[0] / self.opacity).min(ONE_MINUS_EPSILON);
        let mut slot = None;
        let (lobe, side) = self.side(wo, &mut slot);
        let wo = wo.with_z(wo.z * side);
        let mut sample = if self.evaluate_only {
            if wo.z == 0.0 || (lobe.is_one_sided() && wo.z < 0.0) {
                return None;
            }
            let mut wi = uniform_hemisphere([u[1], u[2]]);
            wi.z = wi.z.copysign(wo.z);
            BsdfSample::from_eval(wi, (lobe.eval_pdf(wo, wi, mode).0, UNIFORM_HEMISPHERE_PDF))?
        } else {
            lobe.sample(wo, u, mode)?
        };
        sample.wi.z *= side;
        sample.pdf *= self.opacity;
        Some(sample)
    }
}
