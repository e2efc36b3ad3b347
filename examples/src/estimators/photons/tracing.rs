//! Light paths, and which of their photons are kept.

use core::ops::{ControlFlow, Range};

use photon_map::{CausticRule, Deposition, MapPartition, Photon, PhotonMaps};
use qmc_sampling::{Sampler, SamplerFamily};
use rayon::prelude::*;
use scene_core::{
    Counting, Emitter, EmitterChoice, RayCounts, RussianRoulette, Scene, Spectrum, TransportMode, Vertex, WalkStart,
    random_walk,
};

use super::sharpness::{Departure, Sharpness};
use crate::render::PassContext;

/// Light paths of a photon map.
///
/// ```text
/// flux_1 = L_e |cos| / (p_light p_area p_angle),    flux_(k+1) = flux_k f* |cos| / (p q)
/// ```
/// **Symbols.** `p`: densities of what was sampled; `q`: probability to survive Russian roulette; `f*`: adjoint BSDF.
/// W, of one path: the maps divide by the number of paths.
///
/// **Cost.** One closest hit per photon.
#[derive(Clone, Copy, Debug)]
pub struct PhotonTracing<C> {
    /// Chooses the emitter.
    pub choice: C,
    /// Largest number of segments.
    pub max_length: u32,
    /// How paths end by chance.
    pub roulette: RussianRoulette,
    /// Which photons are caustic.
    pub sharpness: Sharpness,
}

/// Longest paths whose length a photon can tell: longer ones end.
pub const MAX_LENGTH: u32 = Photon::<f32>::MAX_LIGHT;

impl<C: EmitterChoice> PhotonTracing<C> {
    /// Traces one path, and shows its photons: where connections can be made, as connections are what they stand for.
    pub fn trace<S: Scene>(
        &self,
        scene: &S,
        sampler: &mut impl Sampler,
        mut arrive: impl FnMut(Photon<[f32; 3]>) -> ControlFlow<()>,
    ) {
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
            max_length: self.max_length.min(MAX_LENGTH),
            roulette: self.roulette,
        };

        // Walk.
        let mut departure: Option<Departure> = None;
        random_walk(scene, start, sampler, |walk| {
            let vertex = walk.vertex;
            let flow = if vertex.is_connectible() {
                let last = self.sharpness.last_bounce(departure.as_ref(), &walk);
                let photon =
                    Photon::new(vertex.point().position.to_array(), vertex.wo().to_array(), walk.throughput.to_rgb());
                arrive(CausticRule::label(&self.sharpness.rule, photon.from_light(walk.length), last))
            } else {
                ControlFlow::Continue(())
            };
            departure = Some(Departure::of(vertex));
            flow
        });
    }
}

/// Which photons are kept.
#[derive(Clone, Copy, Debug)]
pub struct Storing<D> {
    /// How they are shared out between the two maps.
    pub partition: MapPartition,
    /// With which probability they are kept.
    pub deposition: D,
    /// Whether those that come directly from an emitter are.
    pub primary: bool,
    /// Whether those that are not caustic are.
    pub global: bool,
}

/// Number of light paths that one task traces.
const PATHS_PER_TASK: u64 = 4096;
/// Numbers of deposition.
const DEPOSITION_DOMAIN: u32 = 0x6465_706f;

/// A number of 48 bits: probabilities may be small.
fn fine(sampler: &mut impl Sampler) -> f64 {
    let [high, low] = [sampler.next_1d(), sampler.next_1d()].map(f64::from);
    const STEPS: f64 = (1_u64 << 24) as f64;
    ((high * STEPS).floor() + low) / STEPS
}

impl<D: Deposition + Sync> Storing<D> {
    /// Traces the light paths of these numbers on all threads, and appends the photons that are kept, in the order of
    /// the paths. `first` is the number of the path that counts as the first one of the partition.
    ///
    /// Counts no paths: whoever has them all calls [`PhotonMaps::add_paths`].
    pub fn trace<S: Scene + Sync, F: SamplerFamily, C: EmitterChoice + Sync>(
        &self,
        context: &PassContext<'_, S, F>,
        tracing: &PhotonTracing<C>,
        first: u64,
        paths: Range<u64>,
        maps: &mut PhotonMaps<[f32; 3]>,
    ) -> RayCounts {
        let starts: Vec<u64> = paths.clone().step_by(PATHS_PER_TASK as usize).collect();
        let task = |start: u64| {
            let scene = Counting::new(context.scene);
            let mut kept = PhotonMaps::new();
            for path in start..paths.end.min(start + PATHS_PER_TASK) {
                self.trace_path(&scene, tracing, context.photon_sampler(path), path - first, &mut kept);
            }
            (kept, scene.counts())
        };
        let tasks: Vec<_> = starts.into_par_iter().map(task).collect();
        let mut rays = RayCounts::default();
        for (kept, counts) in tasks {
            maps.append(kept);
            rays += counts;
        }
        rays
    }

    fn trace_path<S: Scene>(
        &self,
        scene: &S,
        tracing: &PhotonTracing<impl EmitterChoice>,
        mut sampler: impl Sampler,
        path: u64,
        kept: &mut PhotonMaps<[f32; 3]>,
    ) {
        let mut numbers = sampler.fork(DEPOSITION_DOMAIN);
        tracing.trace(scene, &mut sampler, |photon| {
            let u = [fine(&mut numbers), fine(&mut numbers)];
            let wanted = if photon.caustic { true } else { self.global && (self.primary || !photon.primary) };
            if wanted && let Some(photon) = self.partition.decide(photon, path, &self.deposition, u) {
                kept.store(photon);
            }
            ControlFlow::Continue(())
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use qmc_sampling::{Independent, SamplerFamily};

    #[test]
    fn fine_numbers_are_in_range() {
        let mut sampler = Independent::new(3).sampler(0, 0);
        for _ in 0..1000 {
            assert!((0.0..1.0).contains(&fine(&mut sampler)));
        }
        let largest: f64 = f64::from(1.0 - f32::EPSILON / 2.0);
        assert!(((largest * (1_u64 << 24) as f64).floor() + largest) / ((1_u64 << 24) as f64) < 1.0);
    }
}
