//! The emitters of the reference scene, and how to choose among them.

mod choice;
mod directional;
mod disk;
mod environment;
mod mesh;
mod point;
mod sphere;

use core::f32::consts::{FRAC_1_PI, PI};

use glam::Vec3A;
use qmc_sampling::warp::sample_cosine_hemisphere;

use crate::frame::Frame;
use crate::ray::SurfacePoint;
use crate::traits::{DirectSample, EmissionSample, Emitter, Rgb};

pub use choice::{PowerChoice, UniformChoice};
pub use directional::DirectionalEmitter;
pub use disk::DiskEmitter;
pub use environment::EnvironmentEmitter;
pub use mesh::MeshEmitter;
pub(crate) use mesh::{AreaTables, similarity_scale};
pub use point::{PointEmitter, SpotEmitter};
pub use sphere::SphereEmitter;

/// An emitter of the reference scene.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum ReferenceEmitter {
    /// The triangles of a mesh.
    Mesh(MeshEmitter),
    /// A sphere.
    Sphere(SphereEmitter),
    /// A disk (or an ellipse).
    Disk(DiskEmitter),
    /// A point.
    Point(PointEmitter),
    /// A point with a cone.
    Spot(SpotEmitter),
    /// Parallel light.
    Directional(DirectionalEmitter),
    /// All directions: constant, or an image.
    Environment(EnvironmentEmitter),
}

macro_rules! dispatch {
    ($self:ident, $emitter:ident => $call:expr) => {
        match $self {
            ReferenceEmitter::Mesh($emitter) => $call,
            ReferenceEmitter::Sphere($emitter) => $call,
            ReferenceEmitter::Disk($emitter) => $call,
            ReferenceEmitter::Point($emitter) => $call,
            ReferenceEmitter::Spot($emitter) => $call,
            ReferenceEmitter::Directional($emitter) => $call,
            ReferenceEmitter::Environment($emitter) => $call,
        }
    };
}

impl Emitter for ReferenceEmitter {
    type Spectrum = Rgb;

    fn power(&self) -> Rgb {
        dispatch!(self, emitter => emitter.power())
    }

    #[inline]
    fn is_delta(&self) -> bool {
        matches!(self, Self::Point(_) | Self::Spot(_) | Self::Directional(_))
    }

    #[inline]
    fn is_infinite(&self) -> bool {
        matches!(self, Self::Directional(_) | Self::Environment(_))
    }

    #[inline]
    fn is_lambertian(&self) -> bool {
        matches!(self, Self::Mesh(_) | Self::Sphere(_) | Self::Disk(_))
    }

    #[inline]
    fn sample_direct(&self, from: Vec3A, u: [f32; 2]) -> Option<DirectSample<Rgb>> {
        dispatch!(self, emitter => emitter.sample_direct(from, u))
    }

    #[inline]
    fn pdf_direct(&self, from: Vec3A, wi: Vec3A, at: Option<&SurfacePoint>) -> f32 {
        dispatch!(self, emitter => emitter.pdf_direct(from, wi, at))
    }

    #[inline]
    fn sample_emission(&self, u_position: [f32; 2], u_direction: [f32; 2]) -> Option<EmissionSample<Rgb>> {
        dispatch!(self, emitter => emitter.sample_emission(u_position, u_direction))
    }

    #[inline]
    fn pdf_emission(&self, at: Option<&SurfacePoint>, direction: Vec3A) -> (f32, f32) {
        dispatch!(self, emitter => emitter.pdf_emission(at, direction))
    }

    #[inline]
    fn radiance(&self, at: Option<&SurfacePoint>, direction: Vec3A) -> Rgb {
        dispatch!(self, emitter => emitter.radiance(at, direction))
    }
}

/// Converts the uniform density `1 / area` of a point to solid angle: `distance^2 / (area cos)`; nothing seen from behind.
#[inline]
fn direct_sample_of_area(from: Vec3A, at: SurfacePoint, area: f32, radiance: Rgb) -> Option<DirectSample<Rgb>> {
    let between = at.position - from;
    let distance_squared = between.length_squared();
    let distance = distance_squared.sqrt();
    let wi = between / distance;
    let cos = -at.normal.dot(wi);
    let pdf_solid_angle = distance_squared / (cos * area);
    (cos > 0.0 && pdf_solid_angle.is_finite() && distance > 0.0).then_some(DirectSample {
        wi,
        at: Some((at, distance)),
        radiance,
        pdf_solid_angle,
        is_delta: false,
    })
}

/// The density of [`direct_sample_of_area`].
#[inline]
fn pdf_direct_of_area(from: Vec3A, wi: Vec3A, at: Option<&SurfacePoint>, area: f32) -> f32 {
    let Some(at) = at else { return 0.0 };
    let cos = -at.normal.dot(wi);
    let pdf = (at.position - from).length_squared() / (cos * area);
    // What is seen so edge-on that the density overflows is never sampled.
    if cos > 0.0 && pdf.is_finite() { pdf } else { 0.0 }
}

/// Diffuse emission from a point that was chosen uniformly: the cosine cancels, the flux is `pi area L`.
#[inline]
fn emission_of_area(point: SurfacePoint, area: f32, radiance: Rgb, u: [f32; 2]) -> EmissionSample<Rgb> {
    let local = Vec3A::from(sample_cosine_hemisphere(u));
    EmissionSample {
        point,
        direction: Frame::from_z(point.normal).to_world(local),
        flux: radiance * (PI * area),
        pdf_area: 1.0 / area,
        pdf_solid_angle: local.z * FRAC_1_PI,
    }
}

/// The densities of [`emission_of_area`].
#[inline]
fn pdf_emission_of_area(at: Option<&SurfacePoint>, direction: Vec3A, area: f32) -> (f32, f32) {
    at.map_or((0.0, 0.0), |at| (1.0 / area, at.normal.dot(direction).max(0.0) * FRAC_1_PI))
}

/// The radiance of a one-sided surface.
#[inline]
fn radiance_of_area(at: Option<&SurfacePoint>, direction: Vec3A, radiance: Rgb) -> Rgb {
    match at {
        Some(at) if at.normal.dot(direction) > 0.0 => radiance,
        _ => Rgb::ZERO,
    }
}
