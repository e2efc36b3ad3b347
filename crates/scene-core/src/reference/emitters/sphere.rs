//! Emission from a sphere.

use core::f32::consts::PI;

use glam::Vec3A;
use qmc_sampling::warp::{sample_uniform_cone, sample_uniform_sphere};

use super::{direct_sample_of_area, emission_of_area, pdf_direct_of_area, pdf_emission_of_area, radiance_of_area};
use crate::frame::Frame;
use crate::ray::SurfacePoint;
use crate::traits::{DirectSample, EmissionSample, Rgb};

/// Diffuse emission of constant radiance from the outside of a sphere (or its inside).
///
/// From outside, directions are uniform in the cone that the sphere subtends (Shirley, Wang, Zimmerman 1996);
/// from inside, points are uniform by area.
#[derive(Clone, Debug)]
pub struct SphereEmitter {
    center: Vec3A,
    radius: f32,
    inward: bool,
    radiance: Rgb,
}

impl SphereEmitter {
    pub(crate) fn new(center: Vec3A, radius: f32, inward: bool, radiance: Rgb) -> Self {
        Self { center, radius, inward, radiance }
    }

    fn area(&self) -> f32 {
        4.0 * PI * self.radius * self.radius
    }

    fn point(&self, outward: Vec3A) -> SurfacePoint {
        let position = self.center + outward * self.radius;
        let mut point = SurfacePoint::new(position, if self.inward { -outward } else { outward });
        point.error = SurfacePoint::error_of(position.abs().max(self.center.abs()).max_element().max(self.radius));
        point
    }

    /// The density in the cone; nothing where the sphere is so far away that it overflows.
    #[inline]
    fn cone_pdf(one_minus_cos: f32) -> Option<f32> {
        let pdf = 1.0 / (2.0 * PI * one_minus_cos);
        pdf.is_finite().then_some(pdf)
    }

    /// Squared sine and `1 - cos` of the half angle of the cone that the sphere subtends; nothing from inside.
    #[inline]
    fn cone(&self, from: Vec3A) -> Option<(f32, f32)> {
        let sin2 = self.radius * self.radius / (self.center - from).length_squared();
        // 1 - cos = sin^2 / (1 + cos) keeps its digits for small cones.
        let one_minus_cos = sin2 / (1.0 + (1.0 - sin2).sqrt());
        (sin2 < 1.0).then_some((sin2, one_minus_cos))
    }

    pub(super) fn power(&self) -> Rgb {
        self.radiance * (PI * self.area())
    }

    #[inline]
    pub(super) fn sample_direct(&self, from: Vec3A, u: [f32; 2]) -> Option<DirectSample<Rgb>> {
        let cone = if self.inward { None } else { self.cone(from) };
        let Some((sin2_max, one_minus_cos)) = cone else {
            let point = self.point(sample_uniform_sphere(u).into());
            return direct_sample_of_area(from, point, self.area(), self.radiance);
        };
        let pdf_solid_angle = Self::cone_pdf(one_minus_cos)?;
        let local = Vec3A::from(sample_uniform_cone(u, one_minus_cos));
        let between = self.center - from;
        let distance_to_center = between.length();
        let wi = Frame::from_z(between / distance_to_center).to_world(local);
        // Distance along wi to the near side, with sin^2 taken from the components that are exact.
        let sin2 = (local.x * local.x + local.y * local.y).min(sin2_max);
        let half_chord = distance_to_center * (sin2_max - sin2).max(0.0).sqrt();
        let near = distance_to_center * local.z - half_chord;
        let outward = (from + wi * near - self.center).normalize_or(-wi);
        let at = self.point(outward);
        Some(DirectSample { wi, at: Some((at, near)), radiance: self.radiance, pdf_solid_angle, is_delta: false })
    }

    #[inline]
    pub(super) fn pdf_direct(&self, from: Vec3A, wi: Vec3A, at: Option<&SurfacePoint>) -> f32 {
        let cone = if self.inward { None } else { self.cone(from) };
        match cone {
            Some((_, one_minus_cos)) => match at {
                Some(at) if at.normal.dot(wi) < 0.0 => Self::cone_pdf(one_minus_cos).unwrap_or(0.0),
                _ => 0.0,
            },
            None => pdf_direct_of_area(from, wi, at, self.area()),
        }
    }

    #[inline]
    pub(super) fn sample_emission(&self, u_position: [f32; 2], u: [f32; 2]) -> Option<EmissionSample<Rgb>> {
        let point = self.point(sample_uniform_sphere(u_position).into());
        Some(emission_of_area(point, self.area(), self.radiance, u))
    }

    #[inline]
    pub(super) fn pdf_emission(&self, at: Option<&SurfacePoint>, direction: Vec3A) -> (f32, f32) {
        pdf_emission_of_area(at, direction, self.area())
    }

    #[inline]
    pub(super) fn radiance(&self, at: Option<&SurfacePoint>, direction: Vec3A) -> Rgb {
        radiance_of_area(at, direction, self.radiance)
    }
}
