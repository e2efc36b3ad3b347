//! Light paths, and which of their photons are kept.

use core::ops::{ControlFlow, Range};

use photon_map::{CausticRule, Deposition, MapPartition, Photon, PhotonMaps};
use qmc_sampling::{Sampler, SamplerFamily};
use rayon::prelude::*;
use scene_core::{
    Counting, EmitterChoice, RayCounts, RussianRoulette, Scene, Spectrum, TransportMode, Vertex, WalkStart, guided_walk,
};

use super::guidance::{PathGuidance, Unguided};
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
/// **Cost.** One closest hit per photon, and what the guidance takes.
#[derive(Clone, Copy, Debug)]
pub struct PhotonTracing<C, G = Unguided> {
    /// Chooses the emitter.
    pub choice: C,
    /// Largest number of segments.
    pub max_length: u32,
    /// How paths end by chance.
    pub roulette: RussianRoulette,
    /// Which photons are caustic.
    pub sharpness: Sharpness,
    /// Where paths are sent.
    pub guidance: G,
}

/// Longest paths whose length a photon can tell: longer ones end.
pub const MAX_LENGTH: u32 = Photon::<f32>::MAX_LIGHT;

impl<C, G> PhotonTracing<C, G> {
    /// The same with another guidance.
    pub fn guided<H>(self, guidance: H) -> PhotonTracing<C, H> {
        let Self { choice, max_length, roulette, sharpness, .. } = self;
        PhotonTracing { choice, max_length, roulette, sharpness, guidance }
    }
}

impl<C: EmitterChoice, G: PathGuidance> PhotonTracing<C, G> {
    /// Traces one path, and shows its photons: where connections can be made, as connections are what they stand for.
    ///
    /// The path is that of [`random_walk`](scene_core::random_walk), with the choice of directions left to the guidance.
    pub fn trace<S: Scene>(
        &self,
        scene: &S,
        scratch: &mut G::Scratch,
        sampler: &mut impl Sampler,
        mut arrive: impl FnMut(Photon<[f32; 3]>) -> ControlFlow<()>,
    ) {
        let Some((ray, throughput)) = self.guidance.emit(scene, &self.choice, scratch, sampler) else { return };
        let start = WalkStart {
            ray,
            throughput,
            mode: TransportMode::Importance,
            max_length: self.max_length.min(MAX_LENGTH),
            roulette: self.roulette,
        };
        let scatter = |vertex: &S::Vertex<'_>, sampler: &mut _| self.guidance.scatter(vertex, scratch, sampler);
        let mut departure: Option<Departure> = None;
        guided_walk(scene, start, sampler, scatter, |walk| {
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
    pub fn trace<S: Scene + Sync, F: SamplerFamily, C: EmitterChoice + Sync, G: PathGuidance>(
        &self,
        context: &PassContext<'_, S, F>,
        tracing: &PhotonTracing<C, G>,
        first: u64,
        paths: Range<u64>,
        maps: &mut PhotonMaps<[f32; 3]>,
    ) -> RayCounts {
        let starts: Vec<u64> = paths.clone().step_by(PATHS_PER_TASK as usize).collect();
        let task = |start: u64| {
            let scene = Counting::new(context.scene);
            let (mut kept, mut scratch) = (PhotonMaps::new(), tracing.guidance.scratch());
            for path in start..paths.end.min(start + PATHS_PER_TASK) {
                let sampler = context.photon_sampler(path);
                self.trace_path(&scene, tracing, &mut scratch, sampler, path - first, &mut kept);
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

    fn trace_path<S: Scene, G: PathGuidance>(
        &self,
        scene: &S,
        tracing: &PhotonTracing<impl EmitterChoice, G>,
        scratch: &mut G::Scratch,
        mut sampler: impl Sampler,
        path: u64,
        kept: &mut PhotonMaps<[f32; 3]>,
    ) {
        let mut numbers = sampler.fork(DEPOSITION_DOMAIN);
        tracing.trace(scene, scratch, &mut sampler, |photon| {
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
