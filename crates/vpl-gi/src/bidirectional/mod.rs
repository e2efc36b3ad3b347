//! Bidirectional path tracing.

mod connections;
mod density;
mod light_paths;
mod path;
mod path_densities;
mod radiance;
mod splats;
mod techniques;

use qmc_sampling::Sampler;
use scene_core::{ChosenEmitter, EmitterChoice, EmitterId, RussianRoulette, Scene, SurfacePoint, Vertex};

use crate::lights::LightTracing;
use path::Samples;

pub use connections::{ConnectionTests, EveryConnection};
pub use light_paths::LightPaths;
pub use techniques::{Classical, PathHeuristic, PathTechniques, Stratified};

/// Which techniques are combined.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum TechniqueSet {
    /// Eye paths hit lights and are connected to light paths: Kollig and Keller's techniques 0 to `l - 1`.
    #[default]
    WithoutLens,
    /// Light paths are connected to the lens as well (technique `l`), by [`Bidirectional::splats`].
    WithLens {
        /// How many light paths are connected to the lens for each eye path of every pixel. With as many independent light paths
        /// as eye paths it is the number of pixels; if pixels share light paths, it is the number of different ones. None are if it is not
        /// positive.
        light_paths: f64,
    },
}

/// Bidirectional path tracing: every vertex of an eye path is connected to every vertex of the light paths, and a heuristic weighs the
/// contributions.
///
/// ```text
/// x_0 .. x_l: lens to light,  technique i: i light vertices
/// L  =  sum over l, i of  1/n_i sum over samples of  w(l,i) f / p(l,i),        f = f_s G f_s .. G L_e (over W_e)
/// p(l,i) = prod_(k<=l-i) p_eye(x_k) prod_(k>l-i) p_light(x_k),                 n_0 = 1,  n_i = M,  n_l = light paths to the lens
/// ```
/// **Symbols.** `p_eye(x_k)`, `p_light(x_k)`: densities by area (at infinity by solid angle) with which walks from the lens and from the lights
/// generate a vertex from those before it; `M`: light paths that an eye path is connected to; `w`: weights of a [`PathHeuristic`]. `L` in W/(m^2 sr).
///
/// **Weights** are functions of the path alone, whichever technique found it. In them
/// - a Dirac delta counts as density one in both directions, and makes connections to its vertex impossible. Each component of a scattering
///   function counts by itself: a coated surface is connected by its diffuse part;
/// - Dirac emitters cannot be hit; one that is connected to as a whole counts as one sample of probability one;
/// - Russian roulette does not occur: it divides contributions, not densities;
/// - light seen directly is found by technique 0 alone.
///
/// **Unbiased** up to `max_depth`, except for what no technique of the set can generate: light of Dirac emitters along paths without two
/// neighbours that can be connected, such as their caustics seen in a mirror, and without the connection to the lens also those seen
/// directly. `max_length` of `tracing` may be shorter than the path.
///
/// **Cost.** Per eye vertex a shading loop over all light vertices; a weight and a shadow ray for each that contributes. A weight costs four densities of
/// scattering beside the connection and one multiplication per vertex, and nothing if the heuristic asks for no densities.
///
/// **Source.** Kollig and Keller 2004, section 3.1; Veach and Guibas, "Bidirectional Estimators for Light Transport", 1994; Veach 1997, chapter 10; Lafortune and Willems, "Bi-directional
/// Path Tracing", 1993. Light paths that several eye paths share: Keller and Heidrich, "Interleaved Sampling", 2001.
///
/// # Example
/// In a closed box that emits 1 and reflects half of it the radiance is `1 + 1/2 + 1/4 + ..` everywhere.
/// ```
/// use mis_heuristics::Balance;
/// use qmc_sampling::{Independent, SamplerFamily};
/// use scene_core::{ReferenceScene, RussianRoulette, Scene, Sensor, Spectrum, UniformChoice, builtin};
/// use vpl_gi::{Bidirectional, Classical, LightPaths, LightTracing, TechniqueSet};
///
/// let scene = ReferenceScene::new(builtin::furnace_box(0.5, 1.0))?;
/// let (choice, roulette) = (UniformChoice::new(scene.emitters().len()), RussianRoulette::Never);
/// let estimator = Bidirectional {
///     heuristic: Classical(Balance),
///     techniques: TechniqueSet::WithoutLens,
///     tracing: LightTracing { choice, max_length: u32::MAX, roulette },
///     max_depth: 4,
///     roulette,
/// };
/// let samplers = Independent::new(1);
/// let mut lights = LightPaths::new(&scene); // used again for every ray
/// let mut sum = 0.0;
/// for index in 0..1000 {
///     let mut sampler = samplers.sampler(0, index);
///     estimator.trace_light_paths(&scene, &mut lights, 1, |_| samplers.sampler(1, index));
///     let ray = scene.sensor().sample_ray([10.0, 10.0], [0.5; 2]).ray;
///     sum += estimator.radiance(&scene, &lights, ray, &mut sampler, &mut ()).luminance();
/// }
/// assert!((sum / 1000.0 - 1.875).abs() < 0.1);
/// # Ok::<(), scene_core::SceneError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Bidirectional<H, C> {
    /// Weighs the techniques.
    pub heuristic: H,
    /// Which there are.
    pub techniques: TechniqueSet,
    /// How light paths are traced. They are cut where longer ones would exceed `max_depth`.
    pub tracing: LightTracing<C>,
    /// Segments of a path, eye and light path and the connection together; `u32::MAX` is unlimited.
    pub max_depth: u32,
    /// How eye paths end by chance.
    pub roulette: RussianRoulette,
}

impl<H: PathHeuristic, C: EmitterChoice> Bidirectional<H, C> {
    /// Traces `paths` new light paths into `lights`, one per sampler that `sampler(path)` returns: for one eye path, or to be shared by several.
    pub fn trace_light_paths<'s, S, R>(
        &self,
        scene: &'s S,
        lights: &mut LightPaths<S::Vertex<'s>>,
        paths: u32,
        sampler: impl FnMut(u32) -> R,
    ) where
        S: Scene,
        R: Sampler,
    {
        // The last segment leads to the lens, or to a vertex of the eye path and from there to the lens.
        let others = if self.techniques == TechniqueSet::WithoutLens { 2 } else { 1 };
        let max_length = self.tracing.max_length.min(self.max_depth.saturating_sub(others));
        let choice = Borrowed(&self.tracing.choice);
        let tracing = LightTracing { choice, max_length, roulette: self.tracing.roulette };
        lights.trace(scene, &tracing, paths, sampler);
    }

    fn samples<V: Vertex>(&self, lights: &LightPaths<V>) -> Samples {
        Samples {
            per_eye_path: f64::from(lights.paths()),
            to_lens: match self.techniques {
                TechniqueSet::WithoutLens => None,
                TechniqueSet::WithLens { light_paths } => (light_paths > 0.0).then_some(light_paths),
            },
        }
    }
}

/// Somebody else's choice.
struct Borrowed<'a, C>(&'a C);

impl<C: EmitterChoice> EmitterChoice for Borrowed<'_, C> {
    #[inline]
    fn choose(&self, from: Option<&SurfacePoint>, u: f32) -> Option<ChosenEmitter> {
        self.0.choose(from, u)
    }

    #[inline]
    fn probability(&self, from: Option<&SurfacePoint>, id: EmitterId) -> f32 {
        self.0.probability(from, id)
    }
}
