//! The scene: what rays hit, what blocks them, what emits.

use glam::Vec3A;

use super::{Emitter, EmitterId, Sensor, Spectrum, Vertex};
use crate::ray::{Ray, SurfacePoint};

/// How sharply surfaces scatter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Sharpness {
    /// In proportion to the cosine with the shading normal, and so are directions sampled.
    Diffuse,
    /// More in some directions than in others.
    Glossy,
    /// By Dirac deltas, among others.
    Specular,
}

/// Geometry that rays can be traced against, with its emitters and its sensor.
///
/// All estimators of this project are written against this trait alone. Implementing it (with [`Vertex`],
/// [`Emitter`] and [`Sensor`]) for a foreign renderer takes about a hundred lines.
///
/// # Laws
/// - `intersect` returns the closest surface with distance in `(0, ray.max_distance)`, or nothing.
/// - `occluded(ray)` holds exactly if `intersect(ray)` returns something.
/// - A vertex `v` with `v.emitter() == Some(id)` has `id.index() < emitters().len()`, and
///   `v.emitted()` is that emitter's radiance towards `v.wo()`.
/// - Rays that leave the scene see `emitters()[environment()].radiance(None, direction)`.
///
/// Not dyn compatible: its vertices borrow from it. To choose at run time, make what uses it generic, and match
/// outside.
pub trait Scene {
    /// What light is measured in.
    type Spectrum: Spectrum;
    /// A point on a surface with its scattering function; may borrow from the scene.
    type Vertex<'s>: Vertex<Spectrum = Self::Spectrum> + Send + Sync
    where
        Self: 's;
    /// A source of light.
    type Emitter: Emitter<Spectrum = Self::Spectrum>;
    /// The camera.
    type Sensor: Sensor;

    /// The closest surface that `ray` hits.
    fn intersect(&self, ray: &Ray) -> Option<Self::Vertex<'_>>;

    /// Whether anything lies on `ray` before its end (a visibility ray).
    fn occluded(&self, ray: &Ray) -> bool;

    /// All emitters. The position in this slice is the stable [`EmitterId`].
    fn emitters(&self) -> &[Self::Emitter];

    /// The emitter that surrounds the scene, if there is one.
    fn environment(&self) -> Option<EmitterId>;

    /// The sensor through which the scene is seen.
    fn sensor(&self) -> &Self::Sensor;

    /// Centre and radius of a sphere around all geometry (emission from infinity starts on it; also the
    /// length scale that scale-normalised parameters refer to).
    fn bounding_sphere(&self) -> (Vec3A, f32);

    /// The sharpest scattering among all surfaces. If it is not sharp, rays that are traced only for what connections
    /// cannot reach may be short. [`Sharpness::Specular`] if unknown.
    fn sharpness(&self) -> Sharpness {
        Sharpness::Specular
    }

    /// Whether the open segment between two surface points is free.
    fn visible(&self, a: &SurfacePoint, b: &SurfacePoint) -> bool {
        !self.occluded(&a.ray_to(b))
    }

    /// Radiance that arrives from outside along `-direction`.
    fn environment_radiance(&self, direction: Vec3A) -> Self::Spectrum {
        match self.environment() {
            Some(id) => self.emitters()[id.index()].radiance(None, direction),
            None => Self::Spectrum::ZERO,
        }
    }
}
