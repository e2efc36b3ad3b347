//! Sources of light, and how to choose among them.

use glam::Vec3A;

use super::{Spectrum, Vertex};
use crate::ray::{Ray, SurfacePoint};

/// The position of an emitter in [`Scene::emitters`](super::Scene::emitters): stable for the life of the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct EmitterId(pub u32);

impl EmitterId {
    /// As an index.
    #[inline]
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

/// Light that arrives at a point, sampled at its emitter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectSample<S> {
    /// Unit direction from the lit point to the emitter.
    pub wi: Vec3A,
    /// Where the light starts, with the distance; `None` for emitters at infinity.
    pub at: Option<(SurfacePoint, f32)>,
    /// Radiance that arrives along `-wi`, in W/(m^2 sr); for Dirac emitters the irradiance on a plane facing `wi`.
    pub radiance: S,
    /// Density of `wi` by solid angle from the lit point; 1 for Dirac emitters.
    pub pdf_solid_angle: f32,
    /// Whether no other technique can find this emitter.
    pub is_delta: bool,
}

impl<S> DirectSample<S> {
    /// The ray from the lit vertex that asks whether anything is in between.
    #[inline]
    pub fn shadow_ray<V: Vertex>(&self, vertex: &V) -> Ray {
        match &self.at {
            Some((at, _)) => vertex.point().ray_to(at),
            None => vertex.spawn_ray(self.wi),
        }
    }
}

/// A ray of light, sampled at its emitter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmissionSample<S> {
    /// Where the light starts: on the emitter, or on a disk outside the scene for emitters at infinity.
    /// The normal is zero for points in space.
    pub point: SurfacePoint,
    /// Unit direction in which it leaves.
    pub direction: Vec3A,
    /// Flux of this ray: `L_e |cos| / (pdf_area * pdf_solid_angle)`, in W.
    pub flux: S,
    /// Density of the position by area (1 for Dirac positions).
    pub pdf_area: f32,
    /// Density of the direction by solid angle (1 for Dirac directions).
    pub pdf_solid_angle: f32,
}

/// A source of light.
///
/// # Laws
/// - `sample_direct` returns `wi` with density `pdf_direct(from, wi, at)`, and `radiance(at, -wi)` of the returned
///   point (`radiance(None, wi)` for emitters at infinity) is its radiance, unless the sample is a Dirac delta. Where
///   several points of one emitter lie in direction `wi`, the density is that of reaching this one.
/// - `sample_emission` returns rays whose flux has the expectation [`power`](Self::power) (for emitters at
///   infinity: the power that enters the scene's bounding sphere, see each).
/// - Both reach every point and direction with positive radiance.
///
/// Dyn compatible: `&dyn Emitter<Spectrum = S>`.
pub trait Emitter {
    /// What light is measured in.
    type Spectrum: Spectrum;

    /// Emitted flux, in W.
    fn power(&self) -> Self::Spectrum;
    /// Whether rays can never hit it: a Dirac delta in position or direction.
    fn is_delta(&self) -> bool;
    /// Whether its light comes from infinity: [`DirectSample::at`] is `None`, and light paths start outside the scene.
    fn is_infinite(&self) -> bool;
    /// Whether every point of it emits the same radiance in all directions of its normal's side, and none on the other:
    /// estimators may then look it up once per point. False if unknown.
    #[inline]
    fn is_lambertian(&self) -> bool {
        false
    }
    /// Light that arrives at `from`, unoccluded; nothing if the emitter cannot shine there.
    fn sample_direct(&self, from: Vec3A, u: [f32; 2]) -> Option<DirectSample<Self::Spectrum>>;
    /// Density with which [`sample_direct`](Self::sample_direct) returns `wi` at `from`, by solid angle, if the
    /// ray in that direction meets the emitter `at` this point (`None`: at infinity). Zero for Dirac emitters.
    fn pdf_direct(&self, from: Vec3A, wi: Vec3A, at: Option<&SurfacePoint>) -> f32;
    /// A ray of light, from two numbers for the position and two for the direction.
    fn sample_emission(&self, u_position: [f32; 2], u_direction: [f32; 2]) -> Option<EmissionSample<Self::Spectrum>>;
    /// Densities of [`sample_emission`](Self::sample_emission), by area of the point and by solid angle of the
    /// direction. For emitters at infinity (`at` is `None`) the area is that of the disk outside the scene.
    fn pdf_emission(&self, at: Option<&SurfacePoint>, direction: Vec3A) -> (f32, f32);
    /// Radiance that leaves in `direction` from the point `at`. With `None`, radiance that arrives from infinity
    /// when looking in `direction` (so light travels along `-direction`).
    fn radiance(&self, at: Option<&SurfacePoint>, direction: Vec3A) -> Self::Spectrum;
}

// Its docs say so.
const _: Option<&dyn Emitter<Spectrum = super::Rgb>> = None;

/// The emitter that was chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChosenEmitter {
    /// Which one.
    pub id: EmitterId,
    /// With what probability.
    pub probability: f32,
}

/// How to choose an emitter for a point, replaceable by cleverer estimators.
///
/// # Laws
/// `choose` returns `id` with probability `probability(from, id)`; these sum to one over all emitters, or
/// `choose` returns nothing for every `u`. To stay unbiased, every emitter that shines on `from` has a positive one.
///
/// Dyn compatible: `&dyn EmitterChoice`.
pub trait EmitterChoice {
    /// Chooses for the point `from` (`None`: for the start of a light path) with a number in `[0, 1)`.
    fn choose(&self, from: Option<&SurfacePoint>, u: f32) -> Option<ChosenEmitter>;
    /// The probability with which `id` is chosen.
    fn probability(&self, from: Option<&SurfacePoint>, id: EmitterId) -> f32;
}

// Its docs say so.
const _: Option<&dyn EmitterChoice> = None;
