//! Path tracing with next event estimation.

use mis_heuristics::Heuristic;
use qmc_sampling::Sampler;
use scene_core::{Emitter, EmitterChoice, Ray, RussianRoulette, Scene, Spectrum, SurfacePoint, TransportMode, Vertex};

use super::{CameraEstimator, FirstHit};

/// Position of next event estimation among the two techniques that find light.
const LIGHT: usize = 0;
/// Position of scattering.
const SCATTERING: usize = 1;

/// Which paths to add up, by the event at their first vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FirstEvent {
    /// All paths.
    #[default]
    Any,
    /// Directly visible light, and paths whose first scattering is specular: what light tracing cannot find.
    SpecularOnly,
}

/// Unidirectional path tracing: at each vertex light is found by sampling an emitter (next event estimation) and by
/// scattering into one, the two combined by a multiple importance sampling heuristic.
///
/// ```text
/// L = sum over vertices k of beta_k [ w_s L_e(x_k -> x_{k-1})  +  w_l f cos L_e V / (p_choice p_l) ],
/// beta_{k+1} = beta_k f cos / (p_s q)
/// ```
/// with the path throughput `beta`, densities `p_l`, `p_s` by solid angle of light and scattering samples, the
/// probability of surviving Russian roulette `q`, and the weights `w_l + w_s = 1`. Light without area (Dirac deltas) has
/// `w_l = 1`; after specular scattering `w_s = 1`.
///
/// Unbiased up to `max_depth`. Cost: one closest hit and at most one visibility ray per vertex.
///
/// Source: Kajiya 1986; Veach and Guibas 1995.
#[derive(Clone, Copy, Debug)]
pub struct PathTracer<H, C> {
    /// Combines the two techniques.
    pub heuristic: H,
    /// Chooses the emitter for next event estimation.
    pub choice: C,
    /// Number of segments: 1 is directly visible emission, 2 direct light, ..; `u32::MAX` is unlimited.
    pub max_depth: u32,
    /// How paths end by chance.
    pub roulette: RussianRoulette,
    /// Which paths to add up.
    pub first_event: FirstEvent,
}

/// Where the last scattering that other techniques could have generated happened, and its density.
#[derive(Clone, Copy)]
struct Scattered<'a> {
    point: &'a SurfacePoint,
    pdf_solid_angle: f32,
}

impl<H: Heuristic<f32> + Sync, C: EmitterChoice + Sync> PathTracer<H, C> {
    /// The weight of light found by scattering.
    #[inline]
    fn scattering_weight<S: Scene>(
        &self,
        scene: &S,
        from: Option<Scattered<'_>>,
        ray: &Ray,
        id: scene_core::EmitterId,
        at: Option<&SurfacePoint>,
    ) -> f32 {
        let Some(from) = from else { return 1.0 };
        let probability = self.choice.probability(Some(from.point), id);
        let pdf = scene.emitters()[id.index()].pdf_direct(from.point.position, ray.direction, at);
        self.heuristic.weight(SCATTERING, &[probability * pdf, from.pdf_solid_angle])
    }

    /// Next event estimation at `vertex`: `w_l f cos L_e V / (p_choice p_l)`.
    #[inline]
    fn next_event<S: Scene>(&self, scene: &S, vertex: &S::Vertex<'_>, u: [f32; 3]) -> S::Spectrum {
        let unlit = S::Spectrum::ZERO;
        let point = vertex.point();
        let Some(chosen) = self.choice.choose(Some(point), u[0]) else { return unlit };
        let emitter = &scene.emitters()[chosen.id.index()];
        let Some(light) = emitter.sample_direct(point.position, [u[1], u[2]]) else { return unlit };
        let (scattered, pdf_scattering) = vertex.eval_pdf(light.wi, TransportMode::Radiance);
        if scattered.is_black() {
            return unlit;
        }
        let pdf_light = chosen.probability * light.pdf_solid_angle;
        let weight = if light.is_delta { 1.0 } else { self.heuristic.weight(LIGHT, &[pdf_light, pdf_scattering]) };
        let value = scattered * light.radiance * (weight / pdf_light);
        if value.is_black() {
            return unlit;
        }
        let shadow_ray = match &light.at {
            Some((at, _)) => point.ray_to(at),
            None => vertex.spawn_ray(light.wi),
        };
        if scene.occluded(&shadow_ray) { unlit } else { value }
    }
}

impl<H: Heuristic<f32> + Sync, C: EmitterChoice + Sync> CameraEstimator for PathTracer<H, C> {
    #[inline]
    fn radiance<S: Scene>(
        &self,
        scene: &S,
        mut ray: Ray,
        sampler: &mut impl Sampler,
    ) -> (S::Spectrum, Option<FirstHit>) {
        let mut radiance = S::Spectrum::ZERO;
        let mut throughput = S::Spectrum::splat(1.0);
        let mut eta = 1.0;
        let mut first_hit = None;
        let mut last: Option<(SurfacePoint, f32)> = None;
        for length in 1..=self.max_depth {
            let from = last.as_ref().map(|(point, pdf)| Scattered { point, pdf_solid_angle: *pdf });

            // Light found by scattering (or seen directly).
            let Some(vertex) = scene.intersect(&ray) else {
                if let Some(id) = scene.environment() {
                    let weight = self.scattering_weight(scene, from, &ray, id, None);
                    radiance += throughput * scene.environment_radiance(ray.direction) * weight;
                }
                break;
            };
            if let Some(id) = vertex.emitter() {
                let emitted = vertex.emitted();
                if !emitted.is_black() {
                    let weight = self.scattering_weight(scene, from, &ray, id, Some(vertex.point()));
                    radiance += throughput * emitted * weight;
                }
            }
            if length == 1 {
                first_hit = Some(FirstHit::new(&ray, &vertex));
            }
            if length == self.max_depth {
                break;
            }
            let only_specular = length == 1 && self.first_event == FirstEvent::SpecularOnly;

            // Light found by sampling an emitter. The numbers are drawn at every vertex, so that each keeps its
            // dimensions of a quasi-Monte Carlo point.
            let (choose, [light_u, light_v]) = (sampler.next_1d(), sampler.next_2d());
            if vertex.is_connectible() && !only_specular {
                radiance += throughput * self.next_event(scene, &vertex, [choose, light_u, light_v]);
            }

            // Scatter.
            let (lobe, [scatter_u, scatter_v]) = (sampler.next_1d(), sampler.next_2d());
            let Some(sample) = vertex.sample([lobe, scatter_u, scatter_v], TransportMode::Radiance) else { break };
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
            last = (!sample.is_specular).then(|| (*vertex.point(), sample.pdf_solid_angle));
            ray = vertex.spawn_ray(sample.wi);
        }
        (radiance, first_hit)
    }
}
