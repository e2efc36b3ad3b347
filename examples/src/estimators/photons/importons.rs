//! Where photons are wanted.

use core::ops::ControlFlow;

use photon_map::{
    Bound, BoundError, DensityEstimation, Deposition, ImportanceMap, ImportanceScale, ImportonDeposition, Photon,
    PhotonMap, Photons,
};
use qmc_sampling::{Sampler, SamplerFamily};
use rayon::prelude::*;
use scene_core::{
    Counting, RayCounts, RussianRoulette, Scene, Sensor, Spectrum, TransportMode, Vertex, WalkStart, random_walk,
};

use super::Sharpness;
use crate::render::PassContext;

/// Paths from the sensor, which leave importons where eye paths ask for photons.
///
/// Where eye paths look at the maps directly, these are the first vertices that scatter other than sharply; with final
/// gathering, the vertices after them, too. (P2 and Peter and Pietrek follow importons farther: photons are then kept
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

/// Number of paths that one task traces.
const PATHS_PER_TASK: u64 = 1024;
/// Largest number of sharp bounces of an importon's path.
const MAX_BOUNCES: u32 = 64;

impl ImportonTracing {
    /// Traces importons, and finds the scale.
    ///
    /// # Errors
    /// If the bound is out of range.
    pub fn trace<S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'_, S, F>,
    ) -> Result<(Importance, RayCounts), BoundError> {
        let bound = self.bound.validate()?;
        let paths = self.paths.max(1);
        let (importons, mut rays) = self.paths(context, 0, paths);
        let map = PhotonMap::par_build(importons, self.estimation.gather.max_radius());
        let map = map.expect("paths are counted, and radii of a gather are in range");
        let map = ImportanceMap::new(map, self.estimation);
        let (tests, counts) = self.paths(context, paths, self.test_paths);
        rays += counts;
        let queries: Vec<f64> = tests.as_slice().par_iter().map(|test| map.at(test.position())).collect();
        let scale = ImportanceScale::from_queries(queries, self.quantile).ok();
        Ok((Importance { map, scale, bound }, rays))
    }

    /// The importons of so many paths, from number `first` on.
    fn paths<S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'_, S, F>,
        first: u64,
        count: u64,
    ) -> (Photons<f32>, RayCounts) {
        let end = first + count;
        let task = |start: u64| {
            let scene = Counting::new(context.scene);
            let mut importons = Photons::new();
            for path in start..end.min(start + PATHS_PER_TASK) {
                self.path(&scene, context.importon_sampler(path), &mut importons);
                importons.add_paths(1);
            }
            (importons, scene.counts())
        };
        let starts: Vec<u64> = (first..end).step_by(PATHS_PER_TASK as usize).collect();
        let tasks: Vec<_> = starts.into_par_iter().map(task).collect();
        let mut all = (Photons::new(), RayCounts::default());
        for (importons, counts) in tasks {
            all.0.append(importons);
            all.1 += counts;
        }
        all
    }

    fn path<S: Scene>(&self, scene: &S, mut sampler: impl Sampler, importons: &mut Photons<f32>) {
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
            if let Some(departure) = &departure {
                let last = self.sharpness.last_bounce(Some(departure), &walk);
                bounces += u32::from(!self.sharpness.rule.is_caustic(last));
            }
            if bounces > self.bounces {
                return ControlFlow::Break(());
            }
            let vertex = walk.vertex;
            if vertex.is_connectible() {
                let (position, wi) = (vertex.point().position.to_array(), vertex.wo().to_array());
                importons.store(Photon::new(position, wi, walk.throughput.luminance()));
            }
            departure = Some(super::sharpness::Departure::of(vertex));
            ControlFlow::Continue(())
        });
    }
}

impl Deposition for Importance {
    fn probability(&self, position: [f32; 3], wi: [f32; 3]) -> f64 {
        let deposition = self.scale.and_then(|scale| ImportonDeposition::new(&self.map, scale, self.bound).ok());
        deposition.map_or(1.0, |deposition| deposition.probability(position, wi))
    }
}
