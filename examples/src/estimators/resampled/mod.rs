//! Direct light by resampled importance sampling.

mod candidate;
mod cost;
mod probes;
mod reuse;
mod source;
mod target;

use qmc_sampling::Sampler;
use ris::{Budget, Ris};
use scene_core::{EmitterChoice, Scene, Spectrum};

use super::direct::DirectLight;

pub use candidate::LightCandidate;
pub use cost::measure_cost;
pub use probes::VisibilityProbes;
pub use reuse::{LightPoint, Place, PointTarget, reusable};
pub use source::{EnvironmentSampling, LightSource, SourceMix};
pub use target::{LightTarget, TargetName};

/// Direct light at a vertex by resampling: of `M` candidates for an emitter's point or direction one is kept in proportion to a target, and
/// only that one gets a shadow ray; `N` times.
///
/// ```text
/// L = 1/N sum_i f cos L_e V (Y_i) W_i,    W_i = 1/g(Y_i) * 1/M sum_j g(X_ij)/p(X_ij),    p = a_L p_L + a_E p_E + a_S p_S      (Talbot, Cline and Egbert 2005, equation 1)
/// ```
/// **Symbols.** `p_L`: an emitter by `choice` and a point on it; `p_E`: a direction to the environment; `p_S`: a direction by the scattering
/// function, traced to what it hits; `a`: the [`SourceMix`]. All densities by solid angle; Dirac emitters count by probability. `g`: the
/// [`TargetName`].
///
/// **Unbiased.** All direct light is found here, none by the path's own scattering (but for specular directions).
///
/// **Cost.** Per sample one shadow ray, none if scattering found the candidate; per candidate of `p_S` one closest hit; with
/// [`TargetName::GeometryVisibility`] a shadow ray per candidate.
///
/// **Source.** Talbot, Cline and Egbert 2005, section 5.1.
#[derive(Clone, Copy, Debug)]
pub struct ResampledDirect<'a, C> {
    /// `M` and `N`.
    pub budget: Budget,
    /// Chooses the emitter for candidates of `p_L`.
    pub choice: C,
    /// Shares of the sources.
    pub mix: SourceMix,
    /// How directions to the environment are drawn.
    pub environment: EnvironmentSampling,
    /// What candidates are selected by.
    pub target: TargetName,
    /// For [`TargetName::GuessedVisibility`]; without them the guess is that everything is visible.
    pub probes: Option<&'a VisibilityProbes>,
}

/// The sub-streams of the candidates' numbers, one per length.
const CANDIDATES_DOMAIN: u32 = 0x7269_736c;

impl<C: EmitterChoice> ResampledDirect<'_, C> {
    /// The source of candidates for a vertex.
    #[inline]
    pub fn source<'b, 's, S: Scene>(
        &'b self,
        scene: &'b S,
        vertex: &'b S::Vertex<'s>,
    ) -> LightSource<'b, S, S::Vertex<'s>, C> {
        let evaluates = self.target != TargetName::GeometryVisibility;
        let (choice, mix, environment) = (&self.choice, self.mix, self.environment);
        LightSource { scene, vertex, choice, mix, environment, evaluates }
    }

    /// The target of candidates for a vertex.
    #[inline]
    pub fn target<'b, 's, S: Scene>(
        &'b self,
        scene: &'b S,
        vertex: &'b S::Vertex<'s>,
    ) -> LightTarget<'b, S, S::Vertex<'s>> {
        LightTarget { scene, vertex, name: self.target, probes: self.probes }
    }
}

impl<C: EmitterChoice + Sync> DirectLight for ResampledDirect<'_, C> {
    #[inline]
    fn sample<S: Scene>(
        &self,
        scene: &S,
        vertex: &S::Vertex<'_>,
        length: u32,
        wanted: bool,
        sampler: &mut impl Sampler,
    ) -> S::Spectrum {
        let mut radiance = S::Spectrum::ZERO;
        if !wanted {
            return radiance;
        }
        let mut numbers = sampler.fork(CANDIDATES_DOMAIN.wrapping_add(length));
        let (source, target) = (self.source(scene, vertex), self.target(scene, vertex));
        Ris::new(self.budget).for_each(&source, &target, &mut || numbers.next_1d(), |candidate, weight| {
            let value = candidate.value(vertex) * weight;
            if !value.is_black() && candidate.is_visible(scene, vertex) {
                radiance += value;
            }
        });
        radiance
    }
}
