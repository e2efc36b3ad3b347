//! Path tracing with next event estimation.

use qmc_sampling::Sampler;
use scene_core::{Ray, RussianRoulette, Scene, Spectrum, SurfacePoint, Vertex};
use vpl_gi::{Found, Observer};

use super::direct::{DirectLight, Scattered};
use super::media::through;
use super::scattering::{OwnSampling, ScatterSampling};
use super::{CameraEstimator, FirstHit};

/// Which paths to add up, by the event at their first vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FirstEvent {
    /// All paths.
    #[default]
    Any,
    /// Directly visible light, and paths whose first scattering is specular: what light tracing cannot find.
    SpecularOnly,
}

/// Unidirectional path tracing: at each vertex light is found by a search for emitters (such as next event estimation) and by
/// scattering into one, each with its share.
///
/// ```text
/// L = sum over vertices k of beta_k [ w_s L_e(x_k -> x_{k-1})  +  w_l f cos L_e V / p_l ],
/// beta_{k+1} = beta_k f cos / (p_s q)
/// ```
/// with the path throughput `beta`, densities `p_l`, `p_s` by solid angle of light and scattering samples, the
/// probability of surviving Russian roulette `q`, and shares `w_l + w_s = 1`. Light without area (Dirac deltas) has
/// `w_l = 1`; after specular scattering `w_s = 1`.
///
/// Where the path runs through a participating medium, a walk from surface to surface takes the place of a segment,
/// however often it scatters; light is found there by leaving.
///
/// Unbiased up to `max_depth`. Cost: one closest hit per vertex, and what the search for emitters takes.
///
/// Source: Kajiya 1986; Veach and Guibas 1995.
#[derive(Clone, Copy, Debug)]
pub struct PathTracer<D, B = OwnSampling> {
    /// Finds emitters: [`NextEvent`](super::NextEvent), [`ResampledDirect`](super::ResampledDirect), ..
    pub direct: D,
    /// Chooses directions.
    pub scattering: B,
    /// Number of segments: 1 is directly visible emission, 2 direct light, ..; `u32::MAX` is unlimited.
    pub max_depth: u32,
    /// How paths end by chance.
    pub roulette: RussianRoulette,
    /// Which paths to add up.
    pub first_event: FirstEvent,
}

impl<D: DirectLight, B: ScatterSampling> CameraEstimator for PathTracer<D, B> {
    #[inline]
    fn trace<'s, S: Scene, O: Observer<S::Vertex<'s>>>(
        &self,
        scene: &'s S,
        mut ray: Ray,
        sampler: &mut impl Sampler,
        observer: &mut O,
    ) -> (S::Spectrum, Option<FirstHit>) {
        let mut radiance = S::Spectrum::ZERO;
        let mut throughput = S::Spectrum::splat(1.0);
        let mut eta = 1.0;
        let mut first_hit = None;
        let mut last: Option<(SurfacePoint, f32)> = None;
        let mut medium = None;
        for length in 1..=self.max_depth {
            let vertex = match &medium {
                None => scene.intersect(&ray),
                Some(medium) => {
                    let Some(exit) = through(scene, medium, ray, throughput, length, sampler) else { break };
                    // What scattered inside could not have been found from the last vertex.
                    last = last.filter(|_| exit.scatterings == 0);
                    (ray, throughput) = (exit.ray, exit.throughput);
                    exit.vertex
                }
            };
            let from = last.as_ref().map(|(point, pdf)| Scattered { point, pdf_solid_angle: *pdf });

            // Light found by scattering (or seen directly).
            let emission = self.direct.emission(scene, &ray, vertex.as_ref(), from, throughput);
            if let Some(vertex) = &vertex {
                observer.vertex(length, vertex, throughput);
            }
            observer.contribution(length, Found::Hit, emission);
            radiance += emission;
            let Some(vertex) = vertex else { break };
            if length == 1 {
                first_hit = Some(FirstHit::new(&ray, &vertex));
            }
            if length == self.max_depth {
                break;
            }
            let only_specular = length == 1 && self.first_event == FirstEvent::SpecularOnly;

            // Light found by a search for emitters.
            let wanted = vertex.is_connectible() && !only_specular;
            let direct = self.direct.sample(scene, &vertex, length, wanted, sampler);
            if wanted {
                let value = throughput * direct;
                observer.contribution(length, Found::Connection { light: 0 }, value);
                radiance += value;
            }

            // Scatter.
            let Some(sample) = self.scattering.scatter(&vertex, length, sampler) else { break };
            if only_specular && !sample.is_specular {
                break;
            }
            throughput *= sample.throughput;
            eta *= sample.eta;

            // Survive.
            let survival = self.roulette.survival_probability(length, sample.throughput, throughput, eta);
            if survival < 1.0 {
                if sampler.next_1d() >= survival {
                    break;
                }
                throughput *= S::Spectrum::splat(1.0 / survival);
            }
            observer.scattered(length, &vertex, &sample);
            last = (!sample.is_specular).then(|| (*vertex.point(), sample.pdf_solid_angle));
            ray = vertex.spawn_ray(sample.wi);
            medium = vertex.medium(sample.wi, medium);
        }
        (radiance, first_hit)
    }
}
