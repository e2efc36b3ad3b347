//! The perspective camera: pinhole and thin lens.

use glam::{Affine3A, Vec3A};
use qmc_sampling::warp::sample_concentric_disk;
use thiserror::Error;

use super::description::CameraDescription;
use crate::ray::{Ray, SurfacePoint};
use crate::traits::{Sensor, SensorConnection, SensorRay};

/// Why a camera cannot be used.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum CameraError {
    /// An image without pixels, or with more than can be counted.
    #[error("cannot render an image of {0} x {1} pixels: both must be between 1 and 65536")]
    Resolution(u32, u32),
    /// The angle of view is not between 0 and 180 degrees.
    #[error("horizontal angle of view is {0} degrees, but must lie between 0 and 180")]
    FieldOfView(f32),
    /// The lens or its focus makes no sense.
    #[error(
        "thin lens with aperture radius {0} and focus distance {1}: the first must not be negative, the second positive"
    )]
    Lens(f32, f32),
    /// The transform has no inverse.
    #[error("camera transform {0:?} has no inverse")]
    Transform(Affine3A),
}

/// A perspective camera with a pinhole or a thin lens.
///
/// With `A` the area of the film at distance 1 and `theta` the angle to the viewing direction, a ray through a uniform
/// raster position has the density `1 / (A cos^3 theta)` by solid angle; importance for `n` pixels is
/// `W_e = n / (A A_lens cos^4 theta)`, which integrates to one over a pixel and the lens.
///
/// Source: Pharr, Jakob, Humphreys, "Physically Based Rendering", 3rd edition, section 16.1.1.
#[derive(Clone, Debug)]
pub struct PerspectiveCamera {
    origin: Vec3A,
    x: Vec3A,
    y: Vec3A,
    z: Vec3A,
    tan: [f32; 2],
    aperture_radius: f32,
    focus_distance: f32,
    resolution: [u32; 2],
}

impl PerspectiveCamera {
    /// A camera of its description. A scale in the transform has no effect.
    ///
    /// # Errors
    /// No pixels, an angle of view outside (0, 180) degrees, a lens that makes no sense, a transform without inverse.
    pub fn new(description: &CameraDescription) -> Result<Self, CameraError> {
        let CameraDescription { to_world, fov_x, aperture_radius, focus_distance, width, height } = *description;
        if width == 0 || height == 0 || width > 1 << 16 || height > 1 << 16 {
            return Err(CameraError::Resolution(width, height));
        }
        if !(fov_x > 0.0 && fov_x < core::f32::consts::PI) {
            return Err(CameraError::FieldOfView(fov_x.to_degrees()));
        }
        let lens_is_valid = aperture_radius == 0.0 || (focus_distance > 0.0 && focus_distance.is_finite());
        if !(aperture_radius >= 0.0 && aperture_radius.is_finite() && lens_is_valid) {
            return Err(CameraError::Lens(aperture_radius, focus_distance));
        }
        let axes =
            [to_world.matrix3.x_axis, to_world.matrix3.y_axis, to_world.matrix3.z_axis].map(Vec3A::try_normalize);
        let ([Some(x), Some(y), Some(z)], true) = (axes, to_world.is_finite()) else {
            return Err(CameraError::Transform(to_world));
        };
        if x.cross(y).dot(z).abs() < 1e-3 {
            return Err(CameraError::Transform(to_world));
        }
        let tan_x = (0.5 * fov_x).tan();
        Ok(Self {
            origin: to_world.translation,
            x,
            y,
            z,
            tan: [tan_x, tan_x * height as f32 / width as f32],
            aperture_radius,
            focus_distance: if aperture_radius > 0.0 { focus_distance } else { 1.0 },
            resolution: [width, height],
        })
    }

    /// Area of the film at distance 1.
    #[inline]
    fn film_area(&self) -> f32 {
        4.0 * self.tan[0] * self.tan[1]
    }

    /// Raster position of a point of the plane at distance 1, if it is on the film.
    #[inline]
    fn raster_of(&self, x: f32, y: f32) -> Option<[f32; 2]> {
        let [width, height] = self.resolution.map(|n| n as f32);
        let px = 0.5 * (1.0 - x / self.tan[0]) * width;
        let py = 0.5 * (1.0 - y / self.tan[1]) * height;
        (px >= 0.0 && px < width && py >= 0.0 && py < height).then_some([px, py])
    }

    #[inline]
    fn lens_offset(&self, u: [f32; 2]) -> [f32; 2] {
        if self.aperture_radius > 0.0 { sample_concentric_disk(u).map(|x| x * self.aperture_radius) } else { [0.0; 2] }
    }

    #[inline]
    fn to_world(&self, v: Vec3A) -> Vec3A {
        self.x * v.x + self.y * v.y + self.z * v.z
    }

    #[inline]
    fn to_local(&self, v: Vec3A) -> Vec3A {
        Vec3A::new(v.dot(self.x), v.dot(self.y), v.dot(self.z))
    }

    /// Where a ray from `lens` (local, z = 0) in local `direction` crosses the film at distance 1.
    #[inline]
    fn film_crossing(&self, lens: [f32; 2], direction: Vec3A) -> Option<[f32; 2]> {
        if direction.z <= 0.0 {
            return None;
        }
        let scale = 1.0 / direction.z;
        let x = lens[0] / self.focus_distance + direction.x * scale;
        let y = lens[1] / self.focus_distance + direction.y * scale;
        self.raster_of(x, y)
    }
}

impl Sensor for PerspectiveCamera {
    fn resolution(&self) -> [u32; 2] {
        self.resolution
    }

    #[inline]
    fn sample_ray(&self, raster: [f32; 2], u_lens: [f32; 2]) -> SensorRay {
        let x = (1.0 - 2.0 * raster[0] / self.resolution[0] as f32) * self.tan[0];
        let y = (1.0 - 2.0 * raster[1] / self.resolution[1] as f32) * self.tan[1];
        let [lx, ly] = self.lens_offset(u_lens);
        let direction = Vec3A::new(x - lx / self.focus_distance, y - ly / self.focus_distance, 1.0).normalize();
        let origin = self.origin + self.x * lx + self.y * ly;
        SensorRay { ray: Ray::new(origin, self.to_world(direction)), weight: 1.0 }
    }

    #[inline]
    fn connect(&self, from: Vec3A, u_lens: [f32; 2]) -> Option<SensorConnection> {
        let [lx, ly] = self.lens_offset(u_lens);
        let position = self.origin + self.x * lx + self.y * ly;
        let between = position - from;
        let distance = between.length();
        let wi = between / distance;
        if !(distance > 0.0 && wi.is_finite()) {
            return None;
        }
        let local = self.to_local(-wi);
        let raster = self.film_crossing([lx, ly], local)?;
        let pixels = self.resolution[0] as f32 * self.resolution[1] as f32;
        let weight = pixels / (self.film_area() * local.z.powi(3) * distance * distance);
        let lens = SurfacePoint { normal: self.z, ..SurfacePoint::in_space(position) };
        weight.is_finite().then_some(SensorConnection { lens, wi, distance, raster, weight })
    }

    #[inline]
    fn pdf_ray(&self, lens: Vec3A, direction: Vec3A) -> (f32, f32) {
        let offset = self.to_local(lens - self.origin);
        let local = self.to_local(direction);
        if self.film_crossing([offset.x, offset.y], local).is_none() {
            return (0.0, 0.0);
        }
        let area = core::f32::consts::PI * self.aperture_radius * self.aperture_radius;
        let pdf_area = if self.aperture_radius > 0.0 { 1.0 / area } else { 1.0 };
        (pdf_area, 1.0 / (self.film_area() * local.z.powi(3)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn description() -> CameraDescription {
        CameraDescription {
            to_world: Affine3A::from_translation(glam::Vec3::new(1.0, 2.0, 3.0))
                * Affine3A::from_rotation_y(0.7)
                * Affine3A::from_rotation_x(-0.3),
            fov_x: 0.9,
            aperture_radius: 0.2,
            focus_distance: 3.0,
            width: 64,
            height: 48,
        }
    }

    #[test]
    fn connections_invert_rays() {
        for aperture_radius in [0.0, 0.2] {
            let camera = PerspectiveCamera::new(&CameraDescription { aperture_radius, ..description() }).unwrap();
            for k in 0..200 {
                let raster = [0.25 + (k as f32 * 7.31) % 63.0, 0.25 + (k as f32 * 3.77) % 47.0];
                let u = [(k as f32 * 0.137) % 1.0, (k as f32 * 0.311) % 1.0];
                let ray = camera.sample_ray(raster, u).ray;
                let connection = camera.connect(ray.at(5.0), u).unwrap();
                assert!((connection.wi + ray.direction).length() < 1e-5);
                assert!((connection.raster[0] - raster[0]).abs() < 2e-3);
                assert!((connection.raster[1] - raster[1]).abs() < 2e-3);
                assert!((connection.distance - 5.0).abs() < 1e-5);
                let (_, pdf) = camera.pdf_ray(ray.origin, ray.direction);
                let weight = pdf * 64.0 * 48.0 / 25.0;
                assert!((connection.weight / weight - 1.0).abs() < 1e-4);
            }
        }
    }

    #[test]
    fn lenses_focus_where_they_say() {
        let camera = PerspectiveCamera::new(&description()).unwrap();
        let point = |u| {
            let ray = camera.sample_ray([10.0, 20.0], u).ray;
            ray.at(3.0 / camera.to_local(ray.direction).z)
        };
        assert!((point([0.1, 0.9]) - point([0.8, 0.3])).length() < 1e-4);
    }

    #[test]
    fn importance_integrates_to_one_over_a_pixel() {
        let camera = PerspectiveCamera::new(&CameraDescription { aperture_radius: 0.0, ..description() }).unwrap();
        // Integrate over a plane at distance 2 in front of the camera: sum of weight * cos(plane) * dA.
        let (mut sum, n, size) = (0.0f64, 800, 4.0f32);
        for i in 0..n {
            for j in 0..n {
                let at = |k: i32| ((k as f32 + 0.5) / n as f32 - 0.5) * size;
                let local = Vec3A::new(at(i), at(j), 2.0);
                let from = camera.origin + camera.to_world(local);
                if let Some(c) = camera.connect(from, [0.5; 2]).filter(|c| c.raster[0] < 16.0 && c.raster[1] < 16.0) {
                    let cos = camera.z.dot(-c.wi);
                    sum += f64::from(c.weight * cos * (size / n as f32).powi(2));
                }
            }
        }
        assert!((sum / 256.0 - 1.0).abs() < 0.01, "{sum}");
    }

    #[test]
    fn nonsense_is_refused() {
        let with = |change: fn(&mut CameraDescription)| {
            let mut d = description();
            change(&mut d);
            PerspectiveCamera::new(&d).unwrap_err()
        };
        assert_eq!(with(|d| d.width = 0), CameraError::Resolution(0, 48));
        assert!(matches!(with(|d| d.fov_x = f32::NAN), CameraError::FieldOfView(_)));
        assert!(matches!(with(|d| d.aperture_radius = -1.0), CameraError::Lens(..)));
        assert!(matches!(with(|d| d.focus_distance = 0.0), CameraError::Lens(..)));
        assert!(matches!(with(|d| d.to_world.matrix3 = glam::Mat3A::ZERO), CameraError::Transform(_)));
    }
}
