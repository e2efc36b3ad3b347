//! Emission from a disk.

use core::f32::consts::PI;

use glam::{Affine3A, Vec3A};
use qmc_sampling::warp::sample_concentric_disk;

use super::{direct_sample_of_area, emission_of_area, pdf_direct_of_area, pdf_emission_of_area, radiance_of_area};
use crate::ray::SurfacePoint;
use crate::traits::{DirectSample, EmissionSample, Rgb};

/// Diffuse emission of constant radiance from one side of a disk, or of an ellipse. Points are sampled uniformly by area.
#[derive(Clone, Debug)]
pub struct DiskEmitter {
    to_world: Affine3A,
    normal: Vec3A,
    area: f32,
    radiance: Rgb,
}

impl DiskEmitter {
    pub(crate) fn new(to_world: Affine3A, radiance: Rgb) -> Self {
        let m = &to_world.matrix3;
        let cross = m.x_axis.cross(m.y_axis);
        // The outside is the image of +z.
        let sign = 1.0f32.copysign(m.determinant());
        Self { to_world, normal: cross.normalize_or(Vec3A::Z) * sign, area: PI * cross.length(), radiance }
    }

    #[inline]
    fn sample_point(&self, u: [f32; 2]) -> SurfacePoint {
        let [x, y] = sample_concentric_disk(u);
        let position = self.to_world.transform_point3a(Vec3A::new(x, y, 0.0));
        let mut point = SurfacePoint::new(position, self.normal);
        let m = &self.to_world;
        let reach = m.matrix3.x_axis.abs() + m.matrix3.y_axis.abs() + m.translation.abs();
        point.error = SurfacePoint::error_of(reach.max_element());
        point
    }

    pub(super) fn power(&self) -> Rgb {
        self.radiance * (PI * self.area)
    }

    #[inline]
    pub(super) fn sample_direct(&self, from: Vec3A, u: [f32; 2]) -> Option<DirectSample<Rgb>> {
        direct_sample_of_area(from, self.sample_point(u), self.area, self.radiance)
    }

    #[inline]
    pub(super) fn pdf_direct(&self, from: Vec3A, wi: Vec3A, at: Option<&SurfacePoint>) -> f32 {
        pdf_direct_of_area(from, wi, at, self.area)
    }

    #[inline]
    pub(super) fn sample_emission(&self, u_position: [f32; 2], u: [f32; 2]) -> Option<EmissionSample<Rgb>> {
        Some(emission_of_area(self.sample_point(u_position), self.area, self.radiance, u))
    }

    #[inline]
    pub(super) fn pdf_emission(&self, at: Option<&SurfacePoint>, direction: Vec3A) -> (f32, f32) {
        pdf_emission_of_area(at, direction, self.area)
    }

    #[inline]
    pub(super) fn radiance(&self, at: Option<&SurfacePoint>, direction: Vec3A) -> Rgb {
        radiance_of_area(at, direction, self.radiance)
    }
}
