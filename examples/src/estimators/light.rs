//! Light tracing.

use core::ops::ControlFlow;

use qmc_sampling::Sampler;
use scene_core::{
    Emitter, EmitterChoice, RussianRoulette, Scene, Sensor, Spectrum, TransportMode, Vertex, WalkStart, random_walk,
};

use super::LightEstimator;

/// Light tracing: paths start at the emitters, and every vertex is connected to the sensor.
///
/// ```text
/// pixel j: mean over paths of  sum over vertices of  beta f* |cos| V W_e |cos'| / (p_lens d^2) h_j
/// ```
/// with the flux `beta` that arrives at a vertex, the adjoint BSDF `f*`, the importance `W_e` of the lens and the
/// reconstruction filter `h_j`. Directly visible emission and paths whose vertex next to the sensor scatters
/// specularly are left to a [`PathTracer`](super::PathTracer) with
/// [`FirstEvent::SpecularOnly`](super::FirstEvent::SpecularOnly): the two together are complete.
///
/// Unbiased up to `max_depth`. Cost: one closest hit and at most one visibility ray per vertex.
///
/// Source: Arvo 1986; Dutré, Lafortune, Willems 1993; Veach 1997, chapter 4.
#[derive(Clone, Copy, Debug)]
pub struct LightTracer<C> {
    /// Chooses the emitter.
    pub choice: C,
    /// Number of segments including the one to the sensor, as for the path tracer.
    pub max_depth: u32,
    /// How paths end by chance.
    pub roulette: RussianRoulette,
}

impl<C: EmitterChoice + Sync> LightEstimator for LightTracer<C> {
    #[inline]
    fn trace<S: Scene>(&self, scene: &S, sampler: &mut impl Sampler, mut splat: impl FnMut([f32; 2], S::Spectrum)) {
        // Emit.
        let choose = sampler.next_1d();
        let (u_position, u_direction) = (sampler.next_2d(), sampler.next_2d());
        let Some(chosen) = self.choice.choose(None, choose) else { return };
        let emitter = &scene.emitters()[chosen.id.index()];
        let Some(emission) = emitter.sample_emission(u_position, u_direction) else { return };
        let start = WalkStart {
            ray: emission.point.ray_along(emission.direction),
            throughput: emission.flux * (1.0 / chosen.probability),
            mode: TransportMode::Importance,
            max_length: self.max_depth.saturating_sub(1),
            roulette: self.roulette,
        };

        // Connect every vertex to the lens.
        let mut lens_sampler = sampler.fork(LENS_DOMAIN);
        random_walk(scene, start, sampler, |walk| {
            let u_lens = lens_sampler.next_2d();
            let vertex = walk.vertex;
            if !vertex.is_connectible() {
                return ControlFlow::Continue(());
            }
            if let Some(connection) = scene.sensor().connect(vertex.point().position, u_lens) {
                let scattered = vertex.eval(connection.wi, TransportMode::Importance);
                let value = walk.throughput * scattered * connection.weight;
                if !value.is_black() && scene.visible(vertex.point(), &connection.lens) {
                    splat(connection.raster, value);
                }
            }
            ControlFlow::Continue(())
        });
    }
}

/// The sub-stream of the numbers that choose points of the lens.
const LENS_DOMAIN: u32 = 0x6c65_6e73;
