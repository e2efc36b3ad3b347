//! Parallel light from infinity.

use core::f32::consts::PI;

use glam::Vec3A;
use qmc_sampling::warp::sample_concentric_disk;

use crate::frame::Frame;
use crate::ray::SurfacePoint;
use crate::traits::{DirectSample, EmissionSample, Rgb};

/// Parallel light. Power: irradiance times the cross section `pi R^2` of the scene's bounding sphere.
#[derive(Clone, Debug)]
pub struct DirectionalEmitter {
    /// Its z axis is the direction in which the light travels.
    frame: Frame,
    irradiance: Rgb,
    center: Vec3A,
    radius: f32,
}

impl DirectionalEmitter {
    pub(crate) fn new(direction: Vec3A, irradiance: Rgb, center: Vec3A, radius: f32) -> Self {
        Self { frame: Frame::from_z(direction.normalize_or(-Vec3A::Z)), irradiance, center, radius }
    }

    pub(super) fn power(&self) -> Rgb {
        self.irradiance * (PI * self.radius * self.radius)
    }

    #[inline]
    pub(super) fn sample_direct(&self, _from: Vec3A, _u: [f32; 2]) -> Option<DirectSample<Rgb>> {
        Some(DirectSample {
            wi: -self.frame.z,
            at: None,
            radiance: self.irradiance,
            pdf_solid_angle: 1.0,
            is_delta: true,
        })
    }

    #[inline]
    pub(super) fn pdf_direct(&self, _from: Vec3A, _wi: Vec3A, _at: Option<&SurfacePoint>) -> f32 {
        0.0
    }

    #[inline]
    pub(super) fn sample_emission(&self, u_position: [f32; 2], _u: [f32; 2]) -> Option<EmissionSample<Rgb>> {
        let [x, y] = sample_concentric_disk(u_position);
        let offset = Vec3A::new(x, y, -1.0) * self.radius;
        Some(EmissionSample {
            point: SurfacePoint::in_space(self.center + self.frame.to_world(offset)),
            direction: self.frame.z,
            flux: self.power(),
            pdf_area: 1.0 / (PI * self.radius * self.radius),
            pdf_solid_angle: 1.0,
        })
    }

    #[inline]
    pub(super) fn pdf_emission(&self, _at: Option<&SurfacePoint>, _direction: Vec3A) -> (f32, f32) {
        (1.0 / (PI * self.radius * self.radius), 1.0)
    }

    /// Rays never see a single direction.
    #[inline]
    pub(super) fn radiance(&self, _at: Option<&SurfacePoint>, _direction: Vec3A) -> Rgb {
        Rgb::ZERO
    }
}
