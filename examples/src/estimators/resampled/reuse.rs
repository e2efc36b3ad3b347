//! Samples of light that other vertices can use: free of the vertex that drew them.

use glam::Vec3A;
use ris::{Resampled, Selected, Target};
use scene_core::{DirectSample, Emitter, EmitterId, Scene, Spectrum, SurfacePoint, Vertex};

use super::{LightCandidate, LightTarget};

/// A point of an emitter, or a direction to one.
///
/// Its measure is area for points of surfaces, solid angle for directions, probability for Dirac emitters: the same seen from any vertex, so
/// the shift between vertices is the identity, with Jacobian one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightPoint {
    /// Whose.
    pub emitter: EmitterId,
    /// Where.
    pub place: Place,
}

/// Where light starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// On a surface.
    Surface(SurfacePoint),
    /// At infinity, seen in this direction.
    Infinity(Vec3A),
    /// Wherever the Dirac emitter is.
    Delta,
}

impl LightPoint {
    /// Of a candidate.
    pub fn of<S>(candidate: &LightCandidate<S>) -> Self {
        let place = match &candidate.light {
            light if light.is_delta => Place::Delta,
            DirectSample { at: Some((at, _)), .. } => Place::Surface(*at),
            DirectSample { wi, .. } => Place::Infinity(*wi),
        };
        Self { emitter: candidate.emitter, place }
    }

    /// The light that a vertex gets of it, and what turns densities by solid angle into the sample's measure, `cos' / d^2`; nothing if
    /// it does not shine there.
    pub fn seen_from<S: Scene, V: Vertex>(&self, scene: &S, vertex: &V) -> Option<(LightCandidate<S::Spectrum>, f32)> {
        let from = vertex.point().position;
        let emitter = &scene.emitters()[self.emitter.index()];
        let (light, measure) = match self.place {
            Place::Surface(at) => {
                let between = at.position - from;
                let distance = between.length();
                let wi = between / distance;
                let radiance = emitter.radiance(Some(&at), -wi);
                let measure = at.normal.dot(wi).abs() / (distance * distance);
                let at = Some((at, distance));
                (DirectSample { wi, at, radiance, pdf_solid_angle: 0.0, is_delta: false }, measure)
            }
            Place::Infinity(wi) => {
                let radiance = emitter.radiance(None, wi);
                (DirectSample { wi, at: None, radiance, pdf_solid_angle: 0.0, is_delta: false }, 1.0)
            }
            Place::Delta => (emitter.sample_direct(from, [0.5; 2])?, 1.0),
        };
        let is_usable = measure > 0.0 && measure.is_finite() && !light.radiance.is_black();
        is_usable.then_some((LightCandidate { emitter: self.emitter, light, is_seen: false, scattered: None }, measure))
    }
}

/// The target of a vertex, in the measure of [`LightPoint`].
#[derive(Clone, Copy, Debug)]
pub struct PointTarget<'a, S, V> {
    /// By solid angle.
    pub target: LightTarget<'a, S, V>,
    /// Whether what is occluded scores nothing: a shadow ray for each score that is positive otherwise.
    pub tests_visibility: bool,
}

impl<S, V> Target<LightPoint, f32> for PointTarget<'_, S, V>
where
    S: Scene,
    V: Vertex<Spectrum = S::Spectrum>,
{
    fn score(&self, point: &LightPoint) -> f32 {
        let LightTarget { scene, vertex, .. } = self.target;
        let Some((candidate, measure)) = point.seen_from(scene, vertex) else { return 0.0 };
        let score = self.target.score(&candidate) * measure;
        if self.tests_visibility && score > 0.0 && !candidate.is_visible(scene, vertex) { 0.0 } else { score }
    }
}

/// What a vertex selected, for others: from densities by solid angle to the measure of [`LightPoint`].
pub fn reusable<S: Scene, V: Vertex<Spectrum = S::Spectrum>>(
    picked: Resampled<LightCandidate<S::Spectrum>>,
    scene: &S,
    vertex: &V,
) -> Resampled<LightPoint> {
    let selected = picked.selected.and_then(|selected| {
        let sample = LightPoint::of(&selected.sample);
        let (_, measure) = sample.seen_from(scene, vertex)?;
        let (score, contribution_weight) = (selected.score * measure, selected.contribution_weight / measure);
        Some(Selected { sample, score, contribution_weight })
    });
    Resampled { selected, confidence: picked.confidence }
}
