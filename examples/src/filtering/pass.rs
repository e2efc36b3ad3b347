//! Passes over the image, batch by batch.

use core::ops::Range;

use path_space_filter::{PathFilter, SwitchOff};
use qmc_sampling::SamplerFamily;
use rayon::prelude::*;
use scene_core::film::{Film, FilmError, Pixel};
use scene_core::{RayCounts, Scene};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use super::traced::Tracing;
use super::{FilterVertex, Observable, Traced};
use crate::render::{CameraPass, PassContext, PassCounts};

/// Path space filtering of an estimator.
///
/// Each batch takes the same number of samples of every pixel. With a sequence that runs through the whole image (`global-sobol`) and an image whose sides are powers of its
/// base, that is a contiguous batch of `b^m` points, as the paper has it.
///
/// **Consistent**, like the filter. With extra samples pixels prefer what can be answered (the sky to the wire before it) while some queries are left without an answer; after the first batch with
/// more than 5 % of them no more are taken, so that this vanishes as well. The image's variance layer takes samples for independent, which filtered ones are not: it is far too small.
///
/// **Cost.** The estimator's, the filter's, and memory for the paths of a batch: [`samples_in_memory`].
#[derive(Debug)]
pub struct Filtered<'a, E, P> {
    /// What is filtered, and where.
    pub tracing: Tracing<'a, E>,
    /// The filter.
    pub filter: P,
    /// Samples per pixel in a batch.
    pub batch: u64,
    /// More camera samples for each of these, without light paths: they take averages of others, which smooths edges at hardly any cost.
    pub extra: u32,
    /// Segments of those at most.
    pub max_depth: u32,
    /// Off as soon as nothing is averaged any more.
    pub switch: Mutex<SwitchOff>,
    /// Whether extra samples are still taken: not once a batch left too many without an answer.
    pub extras: AtomicBool,
}

/// The share of extra samples without an answer after which no more are taken.
const MOST_UNANSWERED: f64 = 0.05;

/// Bytes that a batch takes per path: path, vertices and averages.
fn bytes_per_path(vertices: u32, filter: &impl PathFilter<FilterVertex>) -> u64 {
    let vertex = size_of::<FilterVertex>() + 2 * size_of::<[f32; 3]>() + filter.bytes_per_vertex();
    (size_of::<super::Path>() + vertices as usize * vertex) as u64
}

/// Samples per pixel of a batch that fits into so many bytes, a power of two; one at least.
pub fn samples_in_memory(bytes: u64, pixels: u64, vertices: u32, filter: &impl PathFilter<FilterVertex>) -> u64 {
    let most = (bytes / bytes_per_path(vertices, filter) / pixels.max(1)).max(1);
    1 << most.ilog2()
}

impl<'a, E: Observable, P: PathFilter<FilterVertex> + Sync> Filtered<'a, E, P> {
    /// Filters until nothing is averaged any more.
    pub fn new(tracing: Tracing<'a, E>, filter: P, batch: u64) -> Self {
        Self {
            tracing,
            filter,
            batch: batch.max(1),
            extra: 0,
            max_depth: u32::MAX,
            switch: Mutex::new(SwitchOff::new(1)),
            extras: AtomicBool::new(true),
        }
    }

    /// Traces the given samples of every pixel.
    fn trace<S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'_, S, F>,
        size: [u32; 2],
        samples: Range<u64>,
    ) -> Traced {
        let mut all = Traced::default();
        samples.for_each(|index| all.append(self.tracing.image(context, size, index)));
        all
    }

    /// What each path says, and whether that was filtered.
    fn radiances(&self, traced: &Traced, number: u64) -> (Vec<[f32; 3]>, bool) {
        // Poisoned only if a thread has panicked.
        let mut switch = self.switch.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if switch.is_off() {
            return (traced.unfiltered(), false);
        }
        let averages = self.filter.average(&traced.vertices, number);
        switch.observe(&averages);
        (traced.radiance(averages.values()).collect(), true)
    }

    /// Adds the extra samples of a batch to the film.
    fn add_queries<S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'_, S, F>,
        film: &mut Film,
        traced: &Traced,
        samples: Range<u64>,
    ) -> RayCounts {
        let (size, number) = ([film.width(), film.height()], samples.start / self.batch + 1);
        let mut rays = RayCounts::default();
        let (mut asked, mut answered) = (0, 0);
        for index in samples {
            let queries = self.tracing.queries(context, size, index, self.extra, self.max_depth);
            rays += queries.rays;
            let means = self.filter.average_at(&queries.vertices, &traced.vertices, number);
            asked += queries.pixels.len() + queries.unanswered;
            for (pixel, radiance) in queries.answered(&means) {
                answered += 1;
                film.pixel_mut(pixel as u32 % size[0], pixel as u32 / size[0]).add(radiance);
            }
        }
        if f64::from(asked as u32 - answered) > MOST_UNANSWERED * asked as f64 {
            self.extras.store(false, Ordering::Relaxed);
        }
        rays
    }
}

impl<E: Observable, P: PathFilter<FilterVertex> + Sync> CameraPass for Filtered<'_, E, P> {
    fn batch(&self) -> u64 {
        self.batch
    }

    fn add_samples<S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'_, S, F>,
        film: &mut Film,
        samples: Range<u64>,
    ) -> Result<PassCounts, FilmError> {
        let size = [film.width(), film.height()];
        let mut counts = PassCounts::default();
        for first in samples.clone().step_by(self.batch as usize) {
            let batch = first..samples.end.min(first + self.batch);
            let traced = self.trace(context, size, batch.clone());
            let (radiances, filtered) = self.radiances(&traced, first / self.batch + 1);
            add_to_film(film, &traced, &radiances);
            counts.rays += traced.counts.rays;
            if filtered && self.extra > 0 && self.extras.load(Ordering::Relaxed) {
                counts.rays += self.add_queries(context, film, &traced, batch);
            }
        }
        Ok(counts)
    }
}

/// Adds paths, which go through all pixels once or several times, to the film.
pub(super) fn add_to_film(film: &mut Film, traced: &Traced, radiances: &[[f32; 3]]) {
    let (width, height) = (film.width() as usize, film.height() as usize);
    let rows: Vec<&mut [Pixel]> = film.rows_mut().collect();
    rows.into_par_iter().enumerate().for_each(|(y, row)| {
        for (x, pixel) in row.iter_mut().enumerate() {
            for path in (y * width + x..traced.paths.len()).step_by(width * height) {
                pixel.add(radiances[path]);
                if let Some(hit) = traced.paths[path].first_hit {
                    pixel.add_aov(hit.albedo, hit.normal, hit.depth);
                }
            }
        }
    });
}
