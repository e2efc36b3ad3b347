//! The camera: rays into the scene, and connections from the scene to it.

use glam::Vec3A;

use crate::ray::{Ray, SurfacePoint};

/// A ray that leaves the sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorRay {
    /// The ray, of unit direction.
    pub ray: Ray,
    /// Factor for the radiance that arrives: importance over density. One for the sensors of this crate.
    pub weight: f32,
}

/// A connection from a point of the scene to the sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorConnection {
    /// The point on the lens. Its normal is the viewing direction.
    pub lens: SurfacePoint,
    /// Unit direction from the point of the scene to the lens.
    pub wi: Vec3A,
    /// Distance to the lens.
    pub distance: f32,
    /// Where on the raster the light arrives, in pixels from the upper left corner.
    pub raster: [f32; 2],
    /// `W_e |cos| / (pdf_lens * distance^2)`: times `f |cos|` at the point and the flux that arrives there it is
    /// the value to add at `raster`; the mean over all light paths is the pixel's radiance.
    pub weight: f32,
}

/// A sensor with `width * height` pixels.
///
/// # Laws
/// - Importance `W_e` is scaled such that the measurement of a pixel with box filter is the mean radiance over it:
///   `integral W_e |cos| dA dw = 1` over the pixel and the lens, in units of 1/(m^2 sr).
/// - `sample_ray` followed by `connect` from a point on the ray, with the same `u_lens`, returns the same raster
///   position and the opposite direction.
///
/// Dyn compatible: `&dyn Sensor`.
pub trait Sensor {
    /// Width and height in pixels.
    fn resolution(&self) -> [u32; 2];
    /// The ray through `raster` (in pixels from the upper left corner) and the point `u_lens` of the lens.
    fn sample_ray(&self, raster: [f32; 2], u_lens: [f32; 2]) -> SensorRay;
    /// Connects the point `from` to the lens; nothing if the sensor does not see it.
    fn connect(&self, from: Vec3A, u_lens: [f32; 2]) -> Option<SensorConnection>;
    /// Densities of [`sample_ray`](Self::sample_ray) for a ray that leaves the lens in `direction`, with the raster
    /// position uniform over the whole film: by area of the lens (1 for a pinhole) and by solid angle. Zero for
    /// directions that miss the film.
    fn pdf_ray(&self, lens: Vec3A, direction: Vec3A) -> (f32, f32);
}

// Its docs say so.
const _: Option<&dyn Sensor> = None;
