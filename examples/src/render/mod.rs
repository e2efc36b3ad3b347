//! The loop over pixels, passes and threads.
//!
//! Every pixel sample has its own sampler, numbered by pixel and sample, and every pixel is summed by one thread in the
//! order of its samples; light paths are numbered too and their splats are added in that order. So the image is the same
//! bit for bit at any number of threads, and however the passes were cut.

mod budget;
mod camera;

use std::ops::{ControlFlow, Range};
use std::time::{Duration, Instant};

use qmc_sampling::SamplerFamily;
use qmc_sampling::sequences::SequenceError;
use rayon::prelude::*;
use scene_core::film::{Film, FilmError, Filter, SplatBuffer};
use scene_core::{Counting, RayCounts, Scene, Sensor, Spectrum};

pub use budget::Budget;
pub(crate) use budget::MAX_PASS;
use budget::Schedule;
pub use camera::{CameraPass, PassContext, PassCounts, Shared, Sharing, SharingEstimator};

use crate::estimators::{LightEstimator, NoLightPaths};

/// Side of the squares of pixels that threads take.
pub const TILE_SIZE: u32 = 16;
/// Number of light paths that one task traces.
const LIGHT_PATHS_PER_TASK: u64 = 4096;
/// Number of such tasks whose splats wait in memory at once.
const LIGHT_TASKS_PER_WAVE: u64 = 64;
/// The stream of the light paths' samplers, apart from those of the pixels: no image has so many.
pub(crate) const LIGHT_STREAM: u64 = 1 << 40;

/// What to render, and how.
#[derive(Debug)]
pub struct Job<'a, S, F, E, L = NoLightPaths> {
    /// The scene.
    pub scene: &'a S,
    /// Numbers for each path.
    pub samplers: &'a F,
    /// Paths from the sensor, one per sample: a [`CameraEstimator`](crate::estimators::CameraEstimator), or [`Shared`].
    pub camera: &'a E,
    /// Paths from the emitters, as many as there are pixels for each sample per pixel.
    pub light: Option<&'a L>,
    /// Reconstruction filter.
    pub filter: Filter,
    /// When to stop.
    pub budget: Budget,
    /// Number of the first sample of each pixel: others take those before.
    pub first: u64,
    /// Number of threads; zero is one per core.
    pub threads: usize,
}

/// How far a rendering is.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a> {
    /// The image so far.
    pub film: &'a Film,
    /// Samples per pixel so far.
    pub samples: u64,
    /// Light paths so far.
    pub light_paths: u64,
    /// Rays so far.
    pub rays: RayCounts,
    /// Part of the budget that is spent, from 0 to 1.
    pub fraction: f64,
    /// Time since the start.
    pub elapsed: Duration,
}

/// A finished (or interrupted) rendering.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// The image.
    pub film: Film,
    /// Samples per pixel.
    pub samples: u64,
    /// Light paths.
    pub light_paths: u64,
    /// Rays traced.
    pub rays: RayCounts,
    /// Time spent in rendering, with what came before the first pass.
    pub seconds: f64,
    /// The part of it before the first pass: photons that tell which lights contribute.
    pub preparation_seconds: f64,
    /// Number of threads that rendered.
    pub threads: usize,
}

impl Rendering {
    /// As after its last pass.
    pub fn progress(&self) -> Progress<'_> {
        Progress {
            film: &self.film,
            samples: self.samples,
            light_paths: self.light_paths,
            rays: self.rays,
            fraction: 1.0,
            elapsed: Duration::from_secs_f64(self.seconds),
        }
    }
}

/// Why a rendering could not start.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// The image's size.
    #[error(transparent)]
    Film(#[from] FilmError),
    /// The image that was made.
    #[error(transparent)]
    Image(#[from] scene_core::film::LayeredImageError),
    /// The stratification heuristic asked to weigh two densities.
    #[error("the stratification heuristic weighs whole paths: use it with bdpt, or the estimator robust-igi")]
    Heuristic,
    /// The threshold of the geometry term.
    #[error(transparent)]
    Partition(#[from] vpl_gi::PartitionError),
    /// The image's size again: a sequence through all of it does not go that far.
    #[error("the sampler cannot be used: {0}")]
    Sampler(#[from] SequenceError),
    /// The costs of resampling could not be measured.
    #[error("the robust number of candidates cannot be measured: {0}; give one with --candidates")]
    Cost(#[from] ris::CostError),
    /// Lights cannot be selected by photons.
    #[error("lights cannot be selected by photons: {0}")]
    LightPhotons(#[from] crate::light_photons::LightPhotonsError),
    /// The path space filter.
    #[error(transparent)]
    Filter(#[from] crate::filters::FilterError),
    /// Settings of photon maps.
    #[error(transparent)]
    Photons(#[from] crate::photons::PhotonError),
    /// The other processes.
    #[error(transparent)]
    Ranks(#[from] crate::distributed::RanksError),
    /// The threads could not be started.
    #[error("cannot start {threads} threads: {reason}")]
    Threads {
        /// How many were asked for.
        threads: usize,
        /// What the system says.
        reason: String,
    },
}

/// What is told after each pass, and may stop. A trait object, for one copy of the renderer is enough.
pub type Observe<'a> = &'a mut (dyn FnMut(Progress<'_>) -> ControlFlow<()> + Send);

/// So many threads; zero is one per core.
///
/// # Errors
/// If they cannot be started.
pub fn thread_pool(threads: usize) -> Result<rayon::ThreadPool, RenderError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|error| RenderError::Threads { threads, reason: error.to_string() })
}

impl<S, F, E, L> Job<'_, S, F, E, L>
where
    S: Scene + Sync,
    F: SamplerFamily,
    E: CameraPass,
    L: LightEstimator,
{
    /// Renders pass by pass until the budget is spent or `observe` breaks.
    ///
    /// # Errors
    /// If the image has no pixels or too many, or threads cannot be started.
    pub fn render(&self, observe: Observe<'_>) -> Result<Rendering, RenderError> {
        let [width, height] = self.scene.sensor().resolution();
        let mut film = Film::new(width, height)?;
        let pool = thread_pool(self.threads)?;
        let start = Instant::now();
        let mut schedule = Schedule::new(self.budget, self.camera.batch(), self.first);
        let (mut rays, mut light_paths) = (RayCounts::default(), 0);
        let context = PassContext { scene: self.scene, samplers: self.samplers, filter: self.filter };
        let pixels = u64::from(width) * u64::from(height);
        pool.install(|| {
            while let Some(samples) = schedule.next_pass(start.elapsed().as_secs_f64()) {
                let camera = self.camera.add_samples(&context, &mut film, samples.clone())?;
                rays += camera.rays;
                light_paths += camera.light_paths;
                if let Some(light) = self.light {
                    rays += self.light_pass(light, &mut film, samples.start * pixels..samples.end * pixels)?;
                    light_paths += (samples.end - samples.start) * pixels;
                }
                let elapsed = start.elapsed();
                let progress = Progress {
                    film: &film,
                    samples: schedule.done(),
                    light_paths,
                    rays,
                    fraction: schedule.fraction(elapsed.as_secs_f64()),
                    elapsed,
                };
                if observe(progress).is_break() {
                    break;
                }
            }
            Ok::<(), RenderError>(())
        })?;
        let samples = schedule.done();
        let (seconds, threads) = (start.elapsed().as_secs_f64(), pool.current_num_threads());
        Ok(Rendering { film, samples, light_paths, rays, seconds, preparation_seconds: 0.0, threads })
    }

    /// Traces the light paths with the given numbers, wave by wave, and adds their splats in order.
    fn light_pass(&self, light: &L, film: &mut Film, paths: Range<u64>) -> Result<RayCounts, FilmError> {
        let mut rays = RayCounts::default();
        let mut first = paths.start;
        while first < paths.end {
            let end = paths.end.min(first + LIGHT_PATHS_PER_TASK * LIGHT_TASKS_PER_WAVE);
            let starts: Vec<u64> = (first..end).step_by(LIGHT_PATHS_PER_TASK as usize).collect();
            let tasks: Vec<(SplatBuffer, RayCounts)> = starts
                .into_par_iter()
                .map(|start| self.light_task(light, start..end.min(start + LIGHT_PATHS_PER_TASK)))
                .collect();
            for (splats, counts) in &tasks {
                film.add_splats(splats)?;
                rays += *counts;
            }
            first = end;
        }
        Ok(rays)
    }

    fn light_task(&self, light: &L, paths: Range<u64>) -> (SplatBuffer, RayCounts) {
        let scene = Counting::new(self.scene);
        let [width, height] = scene.sensor().resolution();
        let mut splats = SplatBuffer::new(width, height, self.filter);
        for index in paths {
            let mut sampler = self.samplers.sampler(LIGHT_STREAM, index);
            light.trace(&scene, &mut sampler, |raster, value| splats.add(raster, value.to_rgb()));
        }
        (splats, scene.counts())
    }
}
