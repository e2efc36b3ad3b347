//! Candidates: light that may arrive at a vertex.

use scene_core::{DirectSample, EmitterId, Scene, TransportMode, Vertex};

/// Light of an emitter that arrives at a vertex unless something is in between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightCandidate<S> {
    /// Whose light.
    pub emitter: EmitterId,
    /// The light.
    pub light: DirectSample<S>,
    /// Whether a ray has already come through.
    pub is_seen: bool,
    /// What the vertex scatters of it, if that has been evaluated.
    pub scattered: Option<S>,
}

impl<S: scene_core::Spectrum> LightCandidate<S> {
    /// What the vertex, the one that it was drawn for, scatters of it, unoccluded: `f cos L_e`.
    #[inline]
    pub fn value<V: Vertex<Spectrum = S>>(&self, vertex: &V) -> S {
        self.scattered.unwrap_or_else(|| vertex.eval(self.light.wi, TransportMode::Radiance) * self.light.radiance)
    }

    /// The same with its value evaluated, once for all.
    #[inline]
    #[must_use]
    pub fn evaluated<V: Vertex<Spectrum = S>>(self, vertex: &V) -> Self {
        Self { scattered: Some(self.value(vertex)), ..self }
    }

    /// Whether nothing is in between.
    #[inline]
    pub fn is_visible<C: Scene<Spectrum = S>, V: Vertex>(&self, scene: &C, vertex: &V) -> bool {
        self.is_seen || !scene.occluded(&self.light.shadow_ray(vertex))
    }
}
