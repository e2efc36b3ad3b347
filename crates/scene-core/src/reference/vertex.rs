//! A hit of the reference scene with its scattering function.

use glam::Vec3A;

use super::geometry::LocalGeometry;
use crate::frame::Frame;
use crate::material::{Bsdf, CompiledMaterial, ShadingInput};
use crate::medium::Medium;
use crate::ray::SurfacePoint;
use crate::traits::{EmitterId, Rgb, ScatterSample, TransportMode, Vertex};

/// A point on a surface of the [`ReferenceScene`](super::ReferenceScene).
#[derive(Clone, Copy)]
pub struct SceneVertex<'s> {
    point: SurfacePoint,
    frame: Frame,
    wo: Vec3A,
    wo_local: Vec3A,
    bsdf: Bsdf<'s>,
    emitter: Option<EmitterId>,
    radiance: Rgb,
    /// Whether shading and geometric normals differ, so that importance needs the correction factor.
    bent: bool,
}

impl<'s> SceneVertex<'s> {
    #[inline]
    pub(crate) fn new(
        geometry: &LocalGeometry,
        material: &'s CompiledMaterial,
        wo: Vec3A,
        emitter: Option<EmitterId>,
        radiance: Rgb,
    ) -> Self {
        let frame = if material.needs_tangents() {
            material.shading_frame(&ShadingInput {
                uv: geometry.point.uv,
                dpdu: geometry.dpdu,
                dpdv: geometry.dpdv,
                shading_normal: geometry.shading_normal,
                geometric_normal: geometry.point.normal,
            })
        } else {
            Frame::from_z(geometry.shading_normal)
        };
        Self {
            point: geometry.point,
            frame,
            wo,
            wo_local: frame.to_local(wo),
            bsdf: material.resolve(geometry.point.uv),
            emitter,
            radiance,
            bent: frame.z != geometry.point.normal,
        }
    }

    /// Roughness of the scattering function: 0 is specular, 1 diffuse.
    pub fn roughness(&self) -> f32 {
        self.bsdf.roughness()
    }

    /// `|wo.ns| |wi.ng| / (|wo.ng| |wi.ns|)`: what turns `f |cos_s|` into the adjoint's `f |cos_g|`
    /// (Veach 1997, equation 5.19).
    #[inline]
    fn correction(&self, wi: Vec3A, wi_local: Vec3A, mode: TransportMode) -> f32 {
        if mode == TransportMode::Radiance || !self.bent {
            return 1.0;
        }
        let numerator = self.wo_local.z * wi.dot(self.point.normal);
        let denominator = self.wo.dot(self.point.normal) * wi_local.z;
        let factor = (numerator / denominator).abs();
        if factor.is_finite() { factor } else { 0.0 }
    }
}

impl Vertex for SceneVertex<'_> {
    type Spectrum = Rgb;

    #[inline]
    fn point(&self) -> &SurfacePoint {
        &self.point
    }

    #[inline]
    fn shading_normal(&self) -> Vec3A {
        self.frame.z
    }

    #[inline]
    fn wo(&self) -> Vec3A {
        self.wo
    }

    #[inline]
    fn emitter(&self) -> Option<EmitterId> {
        self.emitter
    }

    #[inline]
    fn emitted(&self) -> Rgb {
        if self.emitter.is_some() && self.wo.dot(self.point.normal) > 0.0 { self.radiance } else { Rgb::ZERO }
    }

    #[inline]
    fn is_connectible(&self) -> bool {
        self.bsdf.is_connectible()
    }

    #[inline]
    fn eval(&self, wi: Vec3A, mode: TransportMode) -> Rgb {
        let wi_local = self.frame.to_local(wi);
        self.bsdf.eval(self.wo_local, wi_local, mode) * self.correction(wi, wi_local, mode)
    }

    #[inline]
    fn pdf_solid_angle(&self, wi: Vec3A, mode: TransportMode) -> f32 {
        self.bsdf.pdf(self.wo_local, self.frame.to_local(wi), mode)
    }

    #[inline]
    fn eval_pdf(&self, wi: Vec3A, mode: TransportMode) -> (Rgb, f32) {
        let wi_local = self.frame.to_local(wi);
        let (value, pdf) = self.bsdf.eval_pdf(self.wo_local, wi_local, mode);
        (value * self.correction(wi, wi_local, mode), pdf)
    }

    #[inline]
    fn sample(&self, u: [f32; 3], mode: TransportMode) -> Option<ScatterSample<Rgb>> {
        let sample = self.bsdf.sample(self.wo_local, u, mode)?;
        // Round-off of the frame would otherwise accumulate along the path.
        let wi = self.frame.to_world(sample.wi).normalize();
        Some(ScatterSample {
            wi,
            throughput: sample.throughput * self.correction(wi, sample.wi, mode),
            pdf_solid_angle: sample.pdf,
            is_specular: sample.is_specular,
            eta: sample.eta,
        })
    }

    fn albedo(&self) -> Rgb {
        self.bsdf.albedo(self.wo_local)
    }

    #[inline]
    fn reversed(&self, wi: Vec3A) -> Self {
        Self { wo: wi, wo_local: self.frame.to_local(wi), ..*self }
    }

    #[inline]
    fn medium(&self, wi: Vec3A, current: Option<Medium<Rgb>>) -> Option<Medium<Rgb>> {
        match self.bsdf.interior() {
            None => current,
            // The side on which the ray really leaves, as in `spawn_ray`.
            Some(interior) => (wi.dot(self.point.normal) < 0.0).then_some(*interior),
        }
    }

    #[inline]
    fn lambertian(&self) -> Option<Rgb> {
        if self.bent { None } else { self.bsdf.lambertian(self.wo_local) }
    }
}
