//! Emission from a point: equal in all directions, or into a cone.

use core::f32::consts::{PI, TAU};

use glam::Vec3A;
use qmc_sampling::warp::{sample_uniform_cone, sample_uniform_sphere};

use crate::frame::Frame;
use crate::ray::SurfacePoint;
use crate::traits::{DirectSample, EmissionSample, Rgb};

/// Light that arrives from a point of given intensity.
#[inline]
fn direct_from_point(position: Vec3A, from: Vec3A, intensity: Rgb) -> Option<DirectSample<Rgb>> {
    let between = position - from;
    let distance = between.length();
    let wi = between / distance;
    (distance > 0.0 && wi.is_finite()).then(|| DirectSample {
        wi,
        at: Some((SurfacePoint::in_space(position), distance)),
        radiance: intensity / (distance * distance),
        pdf_solid_angle: 1.0,
        is_delta: true,
    })
}

/// A point with the same intensity in all directions. Power: `4 pi I`.
#[derive(Clone, Debug)]
pub struct PointEmitter {
    position: Vec3A,
    intensity: Rgb,
}

impl PointEmitter {
    pub(crate) fn new(position: Vec3A, intensity: Rgb) -> Self {
        Self { position, intensity }
    }

    pub(super) fn power(&self) -> Rgb {
        self.intensity * (4.0 * PI)
    }

    #[inline]
    pub(super) fn sample_direct(&self, from: Vec3A, _u: [f32; 2]) -> Option<DirectSample<Rgb>> {
        direct_from_point(self.position, from, self.intensity)
    }

    #[inline]
    pub(super) fn pdf_direct(&self, _from: Vec3A, _wi: Vec3A, _at: Option<&SurfacePoint>) -> f32 {
        0.0
    }

    #[inline]
    pub(super) fn sample_emission(&self, _u_position: [f32; 2], u: [f32; 2]) -> Option<EmissionSample<Rgb>> {
        Some(EmissionSample {
            point: SurfacePoint::in_space(self.position),
            direction: sample_uniform_sphere(u).into(),
            flux: self.power(),
            pdf_area: 1.0,
            pdf_solid_angle: 1.0 / (4.0 * PI),
        })
    }

    #[inline]
    pub(super) fn pdf_emission(&self, _at: Option<&SurfacePoint>, _direction: Vec3A) -> (f32, f32) {
        (1.0, 1.0 / (4.0 * PI))
    }

    /// Rays never see a point.
    #[inline]
    pub(super) fn radiance(&self, _at: Option<&SurfacePoint>, _direction: Vec3A) -> Rgb {
        Rgb::ZERO
    }
}

/// A point with a cone: constant intensity up to the half angle `beam_width`, then falling linearly in the angle to
/// zero at `cutoff` (Mitsuba's `spot`).
#[derive(Clone, Debug)]
pub struct SpotEmitter {
    position: Vec3A,
    frame: Frame,
    intensity: Rgb,
    beam_width: f32,
    cutoff: f32,
}

impl SpotEmitter {
    pub(crate) fn new(position: Vec3A, direction: Vec3A, intensity: Rgb, beam_width: f32, cutoff: f32) -> Self {
        let cutoff = cutoff.clamp(1e-4, PI);
        let frame = Frame::from_z(direction.normalize_or(Vec3A::Z));
        Self { position, frame, intensity, beam_width: beam_width.clamp(0.0, cutoff), cutoff }
    }

    #[inline]
    fn falloff(&self, cos: f32) -> f32 {
        let angle = cos.clamp(-1.0, 1.0).acos();
        if angle <= self.beam_width {
            1.0
        } else if angle >= self.cutoff {
            0.0
        } else {
            (self.cutoff - angle) / (self.cutoff - self.beam_width)
        }
    }

    fn one_minus_cos(&self) -> f32 {
        let s = (0.5 * self.cutoff).sin();
        2.0 * s * s
    }

    /// `integral I dw`: constant to the beam width `b`, then linear to the cutoff `c`:
    /// `2 pi I [1 - cos b + cos b - (sin c - sin b) / (c - b)]`.
    pub(super) fn power(&self) -> Rgb {
        let (b, c) = (f64::from(self.beam_width), f64::from(self.cutoff));
        let mean = if c - b > 1e-6 { (c.sin() - b.sin()) / (c - b) } else { c.cos() };
        self.intensity * (TAU * (1.0 - mean) as f32)
    }

    #[inline]
    pub(super) fn sample_direct(&self, from: Vec3A, _u: [f32; 2]) -> Option<DirectSample<Rgb>> {
        let sample = direct_from_point(self.position, from, self.intensity)?;
        let falloff = self.falloff(-sample.wi.dot(self.frame.z));
        (falloff > 0.0).then(|| DirectSample { radiance: sample.radiance * falloff, ..sample })
    }

    #[inline]
    pub(super) fn pdf_direct(&self, _from: Vec3A, _wi: Vec3A, _at: Option<&SurfacePoint>) -> f32 {
        0.0
    }

    #[inline]
    pub(super) fn sample_emission(&self, _u_position: [f32; 2], u: [f32; 2]) -> Option<EmissionSample<Rgb>> {
        let local = Vec3A::from(sample_uniform_cone(u, self.one_minus_cos()));
        let solid_angle = TAU * self.one_minus_cos();
        let falloff = self.falloff(local.z);
        (falloff > 0.0).then(|| EmissionSample {
            point: SurfacePoint::in_space(self.position),
            direction: self.frame.to_world(local),
            flux: self.intensity * (falloff * solid_angle),
            pdf_area: 1.0,
            pdf_solid_angle: 1.0 / solid_angle,
        })
    }

    #[inline]
    pub(super) fn pdf_emission(&self, _at: Option<&SurfacePoint>, direction: Vec3A) -> (f32, f32) {
        let inside = self.falloff(direction.dot(self.frame.z)) > 0.0;
        (1.0, if inside { 1.0 / (TAU * self.one_minus_cos()) } else { 0.0 })
    }

    /// Rays never see a point.
    #[inline]
    pub(super) fn radiance(&self, _at: Option<&SurfacePoint>, _direction: Vec3A) -> Rgb {
        Rgb::ZERO
    }
}
