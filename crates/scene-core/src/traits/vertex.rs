//! A vertex of a path: a point on a surface and how it scatters.

use glam::Vec3A;

use super::{EmitterId, Spectrum};
use crate::medium::Medium;
use crate::ray::{Ray, SurfacePoint};

/// Which quantity a walk transports, in the direction in which it runs.
///
/// A walk from the sensor gathers **radiance**, a walk from an emitter carries flux that is measured with
/// **importance**. The two differ where scattering is not symmetric (Veach 1997, chapter 5): refraction scales
/// radiance by the squared ratio of the indices of refraction and not importance, and shading normals need the
/// factor `|wo.ns| |wi.ng| / (|wo.ng| |wi.ns|)` on walks from emitters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TransportMode {
    /// The walk started at the sensor: `wo` points to the sensor's side, `wi` to where light comes from.
    Radiance,
    /// The walk started at an emitter: `wo` points to where light came from, `wi` to where it goes.
    Importance,
}

/// The direction in which a path goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScatterSample<S> {
    /// Unit direction, away from the surface.
    pub wi: Vec3A,
    /// The throughput factor `f |cos| / pdf`.
    pub throughput: S,
    /// Density of `wi` by solid angle, in 1/sr. Without meaning (zero) if `is_specular`.
    pub pdf_solid_angle: f32,
    /// Whether the direction came from a Dirac delta: no other technique can generate it.
    pub is_specular: bool,
    /// Ratio of the indices of refraction, of the side that `wi` points to over the side of `wo`; 1 for reflection.
    /// Its product along a path undoes the squared scaling of radiance in Russian roulette.
    pub eta: f32,
}

/// A point on a surface, seen from `wo`, with its scattering function.
///
/// # Laws
/// With `f` the BSDF including the correction for shading normals, and all directions of unit length, away from
/// the surface:
/// - `eval(wi, mode)` is `f(wo, wi) |cos(wi, geometric normal)|`, without any Dirac component, in 1/sr.
///   It is zero where it is not connectible.
/// - `sample` returns `wi` with density `pdf_solid_angle(wi, mode)`, and, unless `is_specular`,
///   `throughput * pdf_solid_angle == eval(wi, mode)`.
/// - `eval(wi, mode) > 0` implies `pdf_solid_angle(wi, mode) > 0`.
/// - Adjoint: with `g = |cos(.., geometric normal)|`, `eval(wi, Radiance) / g(wi)` equals
///   `reversed(wi).eval(wo, Importance) / g(wo)`, for reflection and transmission alike: radiance from `wi` to `wo` is what
///   importance sees from `wo` to `wi` (Veach 1997, section 3.7.5). So a path has one contribution, whichever end it is
///   walked from. Exceptions are implementations whose shading frame depends on `wo`.
/// - All values are finite and not negative for all pairs of unit vectors.
///
/// # Where the two normals disagree
/// Directions may lie on the front of the shading normal and behind the geometric one, or the other way around. Like
/// Mitsuba's, the reference scene's vertices look at the shading frame alone: such a direction scatters as the shading normal
/// says (no energy is lost at the silhouettes of smooth meshes), and [`spawn_ray`](Self::spawn_ray) leaves on the side of
/// the surface that it really points to. Both modes do so, hence the adjoint law holds there too.
///
/// # Transport
/// What is transported is always said: a light path that scatters as a camera path does is wrong by `eta^2` in glass, and
/// looks right. A default would be that mistake.
///
/// ```
/// use scene_core::{Spectrum, TransportMode, Vertex, glam::Vec3A};
/// fn on_a_light_path<V: Vertex>(vertex: &V, wi: Vec3A) -> V::Spectrum {
///     vertex.eval(wi, TransportMode::Importance)
/// }
/// ```
///
/// ```compile_fail,E0061
/// use scene_core::{Spectrum, TransportMode, Vertex, glam::Vec3A};
/// fn on_a_light_path<V: Vertex>(vertex: &V, wi: Vec3A) -> V::Spectrum {
///     vertex.eval(wi)
/// }
/// ```
///
/// # Connections
/// Two eval's and no further cosine make the connection of two vertices: `a.eval(a->b) * b.eval(b->a) / distance^2`.
///
/// Not dyn compatible: vertices are cloned. To choose at run time, implement it for an enum of the choices.
pub trait Vertex: Clone {
    /// What light is measured in.
    type Spectrum: Spectrum;

    /// Position, geometric normal and bound of the position's round-off.
    fn point(&self) -> &SurfacePoint;
    /// The unit normal that shading uses (interpolated, bumped or mapped). Interpolated normals lie in the hemisphere of the
    /// geometric one; a strong normal map may tilt it further.
    fn shading_normal(&self) -> Vec3A;
    /// Unit direction to where the path came from.
    fn wo(&self) -> Vec3A;
    /// The emitter that this surface is, if it is one.
    fn emitter(&self) -> Option<EmitterId>;
    /// Radiance emitted towards `wo`.
    fn emitted(&self) -> Self::Spectrum;
    /// Whether anything of the scattering function is not a Dirac delta, so that connections can find it.
    fn is_connectible(&self) -> bool;
    /// BSDF times the cosine with the geometric normal, in 1/sr.
    fn eval(&self, wi: Vec3A, mode: TransportMode) -> Self::Spectrum;
    /// Density with which [`sample`](Self::sample) returns `wi`, by solid angle.
    fn pdf_solid_angle(&self, wi: Vec3A, mode: TransportMode) -> f32;
    /// A direction to go on to, from three numbers in `[0, 1)` (the first selects the component),
    /// or nothing if the path is absorbed.
    fn sample(&self, u: [f32; 3], mode: TransportMode) -> Option<ScatterSample<Self::Spectrum>>;
    /// The directional albedo towards `wo`, or a cheap estimate of it in `[0, 1]` (for auxiliary images and guidance).
    fn albedo(&self) -> Self::Spectrum;
    /// The same vertex seen from `wi`, which becomes its `wo`.
    #[must_use]
    fn reversed(&self, wi: Vec3A) -> Self;

    /// The constant `f`, in 1/sr, if in both modes [`eval`](Self::eval) is `f |cos(wi, geometric normal)|` for all `wi` on
    /// the side of `wo`, zero on the other side, and there are no Dirac deltas: loops over many directions may then leave
    /// `eval` out. `None` if it is not so, or unknown.
    #[inline]
    fn lambertian(&self) -> Option<Self::Spectrum> {
        None
    }

    /// The medium that the ray which leaves in direction `wi` runs through, if that which arrived from `wo` ran through
    /// `current`. The boundary of a medium knows what is on either side of it; any other surface changes nothing, which
    /// is the default.
    ///
    /// An estimator that knows media keeps this beside its ray and lets [`Medium::walk`] take the place of
    /// [`Scene::intersect`](super::Scene::intersect). Others see through media as through clear glass.
    #[inline]
    fn medium(&self, wi: Vec3A, current: Option<Medium<Self::Spectrum>>) -> Option<Medium<Self::Spectrum>> {
        let _ = wi;
        current
    }

    /// [`eval`](Self::eval) and [`pdf_solid_angle`](Self::pdf_solid_angle) at once.
    #[inline]
    fn eval_pdf(&self, wi: Vec3A, mode: TransportMode) -> (Self::Spectrum, f32) {
        (self.eval(wi, mode), self.pdf_solid_angle(wi, mode))
    }

    /// The ray that leaves this vertex in direction `wi`.
    #[inline]
    fn spawn_ray(&self, wi: Vec3A) -> Ray {
        self.point().ray_along(wi)
    }
}
