//! One virtual point light.

use glam::Vec3A;
use scene_core::{Emitter, EmitterId, Scene, Spectrum, SurfacePoint, TransportMode, Vertex};

/// What kind of point a light path has left.
#[derive(Clone, Debug)]
pub enum LightKind<V> {
    /// The start of a light path on a surface that emits.
    Emission {
        /// The emitter.
        emitter: EmitterId,
        /// Where on it.
        point: SurfacePoint,
    },
    /// A Dirac emitter (a point, or parallel light): every light path that starts there starts alike.
    Delta {
        /// The emitter.
        emitter: EmitterId,
    },
    /// The start of a light path at infinity.
    Distant {
        /// The emitter, an environment.
        emitter: EmitterId,
        /// Unit direction to look in.
        towards: Vec3A,
    },
    /// A vertex where a light path scattered; its `wo` points to where the light came from.
    Surface(V),
}

/// A vertex of a light path that eye paths can be connected to: a virtual point light.
#[derive(Clone, Debug)]
pub struct VirtualPointLight<V: Vertex> {
    /// What it is.
    pub kind: LightKind<V>,
    /// For [`LightKind::Surface`] the flux that arrives, in W; otherwise one over the density of the start (by area, by solid
    /// angle if distant) and the probability of its emitter. Over the number of light paths, except for Dirac emitters that are
    /// taken once each, where it is one.
    pub scale: V::Spectrum,
    /// Segments of the light path up to here: 0 for its start.
    pub length: u32,
    /// Density by solid angle with which the light path took the direction that led here; zero at the start and after a Dirac
    /// delta.
    pub pdf_solid_angle: f32,
    /// Whether the light path came here by a Dirac delta.
    pub after_specular: bool,
    /// Whether no eye path that goes on to this vertex finds the light path's light any more: it starts at a Dirac emitter, which no ray
    /// hits, and a Dirac delta is at an end of each of its segments, so that no connection could be made further on. Then connections
    /// take all, whatever the geometry term.
    pub is_last_chance: bool,
}

/// Where a connection leads from the lit point, and how it spreads.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Towards {
    /// Unit direction to the light.
    pub(crate) wi: Vec3A,
    /// Squared distance.
    pub(crate) d2: f32,
}

impl Towards {
    #[inline]
    pub(crate) fn new(from: Vec3A, to: Vec3A) -> Self {
        let between = to - from;
        let d2 = between.length_squared();
        Self { wi: between / d2.sqrt(), d2 }
    }
}

impl<V: Vertex> VirtualPointLight<V> {
    /// A light where a light path starts.
    pub fn start(kind: LightKind<V>, scale: V::Spectrum) -> Self {
        Self { kind, scale, length: 0, pdf_solid_angle: 0.0, after_specular: false, is_last_chance: false }
    }

    /// Where it is, unless it is a Dirac emitter or at infinity.
    #[inline]
    pub fn point(&self) -> Option<&SurfacePoint> {
        match &self.kind {
            LightKind::Emission { point, .. } => Some(point),
            LightKind::Surface(vertex) => Some(vertex.point()),
            LightKind::Delta { .. } | LightKind::Distant { .. } => None,
        }
    }

    /// Whether connections can end here.
    #[inline]
    pub fn is_connectible(&self) -> bool {
        match &self.kind {
            LightKind::Surface(vertex) => vertex.is_connectible(),
            _ => true,
        }
    }

    /// Radiant intensity towards `-wi`, in W/sr, over the number of light paths: `L_e |cos| / (p M)` or `f |cos| flux / M`. For lights at a
    /// point on a surface; zero for others.
    #[inline]
    pub(crate) fn intensity<S>(&self, scene: &S, wi: Vec3A) -> V::Spectrum
    where
        S: Scene<Spectrum = V::Spectrum>,
    {
        match &self.kind {
            LightKind::Emission { emitter, point } => {
                let radiance = scene.emitters()[emitter.index()].radiance(Some(point), -wi);
                self.scale * radiance * point.normal.dot(wi).abs()
            }
            LightKind::Surface(vertex) => self.scale * vertex.eval(-wi, TransportMode::Importance),
            LightKind::Delta { .. } | LightKind::Distant { .. } => V::Spectrum::ZERO,
        }
    }

    /// The constant `I` if the intensity is `I cos` on the side of the returned normal, and zero on the other side.
    pub(crate) fn lambertian<S>(&self, scene: &S) -> Option<(V::Spectrum, Vec3A)>
    where
        S: Scene<Spectrum = V::Spectrum>,
    {
        match &self.kind {
            LightKind::Emission { emitter, point } => {
                let emitter = &scene.emitters()[emitter.index()];
                let radiance = emitter.radiance(Some(point), point.normal);
                emitter.is_lambertian().then_some((self.scale * radiance, point.normal))
            }
            LightKind::Surface(vertex) => {
                let normal = vertex.point().normal;
                let facing = normal * 1f32.copysign(normal.dot(vertex.wo()));
                vertex.lambertian().map(|f| (self.scale * f, facing))
            }
            LightKind::Delta { .. } | LightKind::Distant { .. } => None,
        }
    }
}
