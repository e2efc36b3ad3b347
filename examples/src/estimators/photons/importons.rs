//! Where photons are wanted.

use core::ops::ControlFlow;

use photon_map::{
    Bound, DensityEstimation, Deposition, ImportanceMap, ImportanceScale, ImportonDeposition, Photon, PhotonMap,
    Photons,
};
use qmc_sampling::{Sampler, SamplerFamily};
use rayon::prelude::*;
use scene_core::{
    Counting, RayCounts, RussianRoulette, Scene, Sensor, Spectrum, TransportMode, Vertex, WalkStart, WalkVertex,
    random_walk,
};

use super::Sharpness;
use crate::distributed::{Ranks, RanksError};
use crate::render::PassContext;

/// Paths from the sensor, which leave importons where eye paths ask for photons.
///
/// Where eye paths look at the maps directly, these are the first vertices that scatter other than sharply; with final
/// gathering, the vertices after them, too. (Keller and Wald 2000 and Peter and Pietrek follow importons farther: photons are then kept
/// where nobody asks for them.)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImportonTracing {
    /// Number of paths.
    pub paths: u64,
    /// Number of other paths whose queries give the scale.
    pub test_paths: u64,
    /// Quantile of the queries: see [`ImportanceScale`].
    pub quantile: f64,
    /// What happens where importance is small.
    pub bound: Bound,
    /// How importance is estimated from importons.
    pub estimation: DensityEstimation,
    /// Which bounces are followed.
    pub sharpness: Sharpness,
    /// Bounces that are not sharp: 0 to look at the maps directly, 1 with final gathering.
    pub bounces: u32,
    /// Longest paths.
    pub max_length: u32,
}

/// The visual importance of places, with its scale.
#[derive(Clone, Debug)]
pub struct Importance {
    /// The importons.
    pub map: ImportanceMap,
    /// The scale; nothing if no test path found importance, because the camera sees nothing: then every photon is kept.
    pub scale: Option<ImportanceScale>,
    /// What happens where importance is small.
    bound: Bound,
}

/// What importons are left for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purpose {
    /// To tell where photons are kept: where eye paths ask for them.
    Deposition,
    /// To tell where light paths go: where what they do next arrives at places of the first kind, or goes on to some.
    Guidance,
}

/// Importons while they are collected.
#[derive(Debug, Default)]
pub(super) struct Importons {
    /// At surfaces that scatter.
    pub(super) surfaces: Photons<f32>,
    /// At emitters, of their names, for guidance: each carries importance times radiance.
    pub(super) emitters: Photons<f32>,
}

impl Importons {
    pub(super) fn append(&mut self, other: Self) {
        self.surfaces.append(other.surfaces);
        self.emitters.append(other.emitters);
    }
}

/// Importons by place; `radius` is what most queries will have.
///
/// # Panics
/// If nobody counted their paths, or the radius is not positive and finite.
pub(super) fn sorted(importons: Photons<f32>, estimation: DensityEstimation, radius: f32) -> ImportanceMap {
    let map = PhotonMap::par_build(importons, radius);
    ImportanceMap::new(map.expect("paths are counted, and radii of a gather are in range"), estimation)
}

/// Number of paths that one task traces.
const PATHS_PER_TASK: u64 = 1024;
/// Largest number of sharp bounces of an importon's path.
const MAX_BOUNCES: u32 = 64;

impl ImportonTracing {
    /// Traces importons, and finds the scale; the rays are those of this rank. With a bound that is out of range, every
    /// photon is kept.
    ///
    /// # Errors
    /// If a rank has failed.
    pub fn trace<S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'_, S, F>,
        ranks: &Ranks,
    ) -> Result<(Importance, RayCounts), RanksError> {
        let paths = self.paths.max(1);
        let (importons, mut rays) = self.paths(context, ranks, Purpose::Deposition, 0, paths)?;
        let map = sorted(importons.surfaces, self.estimation, self.estimation.gather.max_radius());
        let (tests, counts) = self.paths(context, ranks, Purpose::Deposition, paths, self.test_paths)?;
        rays += counts;
        let tests = tests.surfaces;
        let queries: Vec<f64> = tests.as_slice().par_iter().map(|test| map.at(test.position())).collect();
        let scale = ImportanceScale::from_queries(queries, self.quantile).ok();
        Ok((Importance { map, scale, bound: self.bound }, rays))
    }

    /// The importons of so many paths, from number `first` on: each rank traces its part of them, and has all.
    pub(super) fn paths<S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'_, S, F>,
        ranks: &Ranks,
        purpose: Purpose,
        first: u64,
        count: u64,
    ) -> Result<(Importons, RayCounts), RanksError> {
        let share = ranks.share(count);
        let (first, end) = (first + share.start, first + share.end);
        let task = |start: u64| {
            let scene = Counting::new(context.scene);
            let mut importons = Importons::default();
            let paths = start..end.min(start + PATHS_PER_TASK);
            importons.surfaces.add_paths(paths.end - paths.start);
            importons.emitters.add_paths(paths.end - paths.start);
            for path in paths {
                self.path(&scene, context.importon_sampler(path), purpose, &mut importons);
            }
            (importons, scene.counts())
        };
        let starts: Vec<u64> = (first..end).step_by(PATHS_PER_TASK as usize).collect();
        let tasks: Vec<_> = starts.into_par_iter().map(task).collect();
        let (mut own, mut rays) = (Importons::default(), RayCounts::default());
        for (importons, counts) in tasks {
            own.append(importons);
            rays += counts;
        }
        Ok((ranks.gather(own)?, rays))
    }

    fn path<S: Scene>(&self, scene: &S, mut sampler: impl Sampler, purpose: Purpose, importons: &mut Importons) {
        let [width, height] = scene.sensor().resolution().map(|side| side as f32);
        let [x, y] = sampler.next_2d();
        let ray = scene.sensor().sample_ray([x * width, y * height], sampler.next_2d());
        let start = WalkStart {
            ray: ray.ray,
            throughput: S::Spectrum::splat(ray.weight),
            mode: TransportMode::Radiance,
            max_length: self.max_length.min(MAX_BOUNCES),
            roulette: RussianRoulette::LocalAlbedo { from_length: 0 },
        };
        // The number of bounces so far that were not sharp, and what the next vertex needs to know of this one.
        let (mut bounces, mut departure) = (0, None);
        random_walk(scene, start, &mut sampler, |walk| {
            let mut is_sharp = false;
            if let Some(departure) = &departure {
                let last = self.sharpness.last_bounce(Some(departure), &walk);
                is_sharp = self.sharpness.rule.is_caustic(last);
                bounces += u32::from(!is_sharp);
            }
            match purpose {
                Purpose::Deposition if bounces > self.bounces => return ControlFlow::Break(()),
                Purpose::Deposition => importons.leave_at_surface(&walk),
                Purpose::Guidance => {
                    // Light from here to the last vertex is asked for there, or scattered to where it is. A caustic is
                    // asked for wherever eye paths ask for anything.
                    let caustic = bounces > 0 && is_sharp;
                    if bounces > self.bounces || caustic {
                        importons.leave_at_surface(&walk);
                    }
                    // The same with final gathering; without, direct light is found otherwise.
                    if bounces > 1 || caustic {
                        importons.leave_at_emitter(&walk);
                    }
                }
            }
            departure = Some(super::sharpness::Departure::of(walk.vertex));
            ControlFlow::Continue(())
        });
    }
}

impl Importons {
    fn leave_at_surface<V: Vertex>(&mut self, walk: &WalkVertex<'_, V, V::Spectrum>) {
        if walk.vertex.is_connectible() {
            self.surfaces.store(importon(walk.vertex, walk.throughput.luminance()));
        }
    }

    fn leave_at_emitter<V: Vertex>(&mut self, walk: &WalkVertex<'_, V, V::Spectrum>) {
        let Some(emitter) = walk.vertex.emitter() else { return };
        let importance = (walk.throughput * walk.vertex.emitted()).luminance();
        if importance > 0.0 {
            self.emitters.store(importon(walk.vertex, importance).from_light(emitter.0));
        }
    }
}

fn importon<V: Vertex>(vertex: &V, importance: f32) -> Photon<f32> {
    Photon::new(vertex.point().position.to_array(), vertex.wo().to_array(), importance)
}

impl Deposition for Importance {
    fn probability(&self, position: [f32; 3], wi: [f32; 3]) -> f64 {
        let deposition = self.scale.and_then(|scale| ImportonDeposition::new(&self.map, scale, self.bound).ok());
        deposition.map_or(1.0, |deposition| deposition.probability(position, wi))
    }
}
