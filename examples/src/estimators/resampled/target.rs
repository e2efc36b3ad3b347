//! What candidates for light are selected by.

use clap::ValueEnum;
use ris::Target;
use scene_core::{Scene, Spectrum, Vertex};

use super::{LightCandidate, VisibilityProbes};

/// Targets, by what of the integrand `F G V L` they contain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum TargetName {
    /// `F G L`: luminance of scattering function, geometry and emission, without visibility.
    #[default]
    #[value(name = "fgl")]
    Unshadowed,
    /// `G V`: geometry and visibility, with a shadow ray for every candidate.
    #[value(name = "gv")]
    GeometryVisibility,
    /// `F G L` times a guess of the visibility from probes of distances to occluders.
    #[value(name = "fgl-guess")]
    GuessedVisibility,
}

/// The target for one vertex, as a density by solid angle (so `G` is the cosine at the vertex).
#[derive(Clone, Copy, Debug)]
pub struct LightTarget<'a, S, V> {
    /// The scene.
    pub scene: &'a S,
    /// The vertex.
    pub vertex: &'a V,
    /// Which.
    pub name: TargetName,
    /// For the guess.
    pub probes: Option<&'a VisibilityProbes>,
}

impl<S, V> Target<LightCandidate<S::Spectrum>, f32> for LightTarget<'_, S, V>
where
    S: Scene,
    V: Vertex<Spectrum = S::Spectrum>,
{
    #[inline]
    fn score(&self, candidate: &LightCandidate<S::Spectrum>) -> f32 {
        match self.name {
            TargetName::Unshadowed => candidate.value(self.vertex).luminance(),
            TargetName::GeometryVisibility => {
                let cosine = candidate.light.wi.dot(self.vertex.point().normal).abs();
                if candidate.is_visible(self.scene, self.vertex) { cosine.max(GRAZING) } else { 0.0 }
            }
            TargetName::GuessedVisibility => {
                let distance = candidate.light.at.as_ref().map_or(f32::INFINITY, |(_, distance)| *distance);
                let guess = self
                    .probes
                    .map_or(1.0, |probes| probes.guess(self.vertex.point().position, candidate.light.wi, distance));
                candidate.value(self.vertex).luminance() * guess
            }
        }
    }
}

/// Least cosine that the target `G V` counts: shading normals scatter where the geometric one says zero, and a target of zero there
/// would lose that light.
const GRAZING: f32 = 1e-3;
