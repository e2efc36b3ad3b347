//! Direct light with reservoirs that neighbouring pixels share.

use std::ops::Range;

use glam::Vec3A;
use qmc_sampling::warp::sample_concentric_disk;
use qmc_sampling::{Independent, Sampler, SamplerFamily};
use rayon::prelude::*;
use ris::{Budget, Pairwise, Resampled, Reservoir};
use scene_core::film::{Film, FilmError, FilmTile};
use scene_core::{Counting, EmitterChoice, RayCounts, Rgb, Scene, Sharpness, Spectrum, TransportMode, Vertex};
use smallvec::SmallVec;

use super::resampled::{LightPoint, PointTarget, reusable};
use super::{FirstHit, LightSource, ResampledDirect};
use crate::render::{CameraPass, PassContext, PassCounts, TILE_SIZE};

/// Emission and direct light, with unbiased spatial reuse: every pixel draws candidates of its own, then takes over what its neighbours
/// selected, weighed pairwise against its own, and traces one shadow ray.
///
/// ```text
/// round 0:   Y, W by resampling M candidates with the pixel's target g
/// round r:   w_i = m_i(Y_i) g(Y_i) W_i   over the pixel and its neighbours,    W = 1/g(Y) * sum w_i
/// L = L_e + f cos L_e V (Y) W
/// ```
/// **Symbols.** `m_i`: pairwise weights ([`ris::Pairwise`]); `g`: luminance of the light, per area of the emitter, with its visibility or without.
///
/// **With visibility in the target** every score costs a shadow ray, but what is selected is the integrand itself: with `k` neighbours, `r` rounds
/// average up to `(k + 1)^r` samples of as many pixels for `2 k r` rays. **Without**, candidates are shared and nothing else: what occlusion adds to
/// the variance stays.
///
/// The weights `m_i` are those of targets that are normalised by the brightness of the pixels in the passes before; the first pass does without.
///
/// **Unbiased**, for any neighbours: they are chosen by normals and distances, never by what they selected; and for any normalisation, since the numbers of
/// a pass are independent of those before (they are hashed, not those of the sampler: only rays keep its stratification). All samples of a pass over the
/// image depend on each other, those of different passes by the weights alone.
///
/// **Cost.** Per pixel and sample: one closest hit, `M` candidates, `2 k` scores per round, one shadow ray.
///
/// **Source.** Bitterli, Wyman, Pharr, Shirley, Lefohn, Jarosz 2020 (*Spatiotemporal reservoir resampling for real-time ray tracing with dynamic direct
/// lighting*); Lin et al. 2022 for the weights.
#[derive(Clone, Copy, Debug)]
pub struct RestirDirect<'a, C> {
    /// The candidates. Those of the scattering part are left out (they cannot be reused without bias), and so is the number of samples.
    pub direct: ResampledDirect<'a, C>,
    /// How often samples are taken over.
    pub rounds: u32,
    /// From how many neighbours.
    pub neighbours: u32,
    /// How far away they are, in pixels.
    pub radius: f32,
    /// Whether visibility is part of the target.
    pub tests_visibility: bool,
}

/// What a pixel's ray found.
struct Eye<V: Vertex> {
    /// What it hit, unless nothing of it can be connected to light.
    vertex: Option<V>,
    first_hit: Option<FirstHit>,
    /// Radiance apart from what is resampled.
    radiance: V::Spectrum,
    /// The sensor's factor.
    weight: f32,
}

/// Pixels that a task takes.
const PIXELS_PER_TASK: usize = 256;
/// Numbers of the candidates.
const CANDIDATES_DOMAIN: u32 = 0x7265_7300;
/// Numbers of the first round of reuse; those of the others follow.
const REUSE_DOMAIN: u32 = 0x7265_7301;
/// Neighbours have normals within about 25 degrees,
const LEAST_COSINE: f32 = 0.9;
/// and distances within this part of the pixel's own.
const LARGEST_STEP: f32 = 0.1;

impl<C: EmitterChoice + Sync> CameraPass for RestirDirect<'_, C> {
    fn add_samples<S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'_, S, F>,
        film: &mut Film,
        samples: Range<u64>,
    ) -> Result<PassCounts, FilmError> {
        let rays = samples.map(|index| self.pass(context, film, index)).sum();
        Ok(PassCounts { rays, light_paths: 0 })
    }
}

/// Computes something for every pixel, in parallel; in the order of the pixels, with the rays traced.
fn for_pixels<'s, S: Scene + Sync, T: Send>(
    scene: &'s S,
    count: usize,
    compute: impl Fn(&Counting<'s, S>, usize) -> T + Sync,
) -> (Vec<T>, RayCounts) {
    let task = |task: usize| {
        let scene = Counting::new(scene);
        let pixels = task * PIXELS_PER_TASK..count.min((task + 1) * PIXELS_PER_TASK);
        let values: Vec<T> = pixels.map(|pixel| compute(&scene, pixel)).collect();
        (values, scene.counts())
    };
    let tasks: Vec<_> = (0..count.div_ceil(PIXELS_PER_TASK)).into_par_iter().map(task).collect();
    let mut all = (Vec::with_capacity(count), RayCounts::default());
    for (values, counts) in tasks {
        all.0.extend(values);
        all.1 += counts;
    }
    all
}

impl<C: EmitterChoice + Sync> RestirDirect<'_, C> {
    /// One sample for every pixel.
    fn pass<S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'_, S, F>,
        film: &mut Film,
        index: u64,
    ) -> RayCounts {
        let width = film.width() as usize;
        let count = width * film.height() as usize;
        let size = [film.width(), film.height()];

        let place = |pixel: usize| [(pixel % width) as u32, (pixel / width) as u32];
        // Independent of those of other passes, on which the weights depend.
        let numbers = |pixel: usize, domain: u32| {
            let mut seed = context.sampler(place(pixel), index).fork(domain);
            let bits = [seed.next_1d(), seed.next_1d()].map(|u| u64::from(u.to_bits()));
            Independent::new(bits[0] << 32 | bits[1]).sampler(pixel as u64, u64::from(domain))
        };
        let brightness = brightness(film);

        // Candidates of each pixel's own.
        let (eyes, mut counts) =
            for_pixels(context.scene, count, |scene, pixel| self.look(context, scene, place(pixel), index));
        let (mut picked, rays) = for_pixels(context.scene, count, |scene, pixel| {
            self.pick(scene, &eyes[pixel], numbers(pixel, CANDIDATES_DOMAIN))
        });
        counts += rays;

        // Reuse.
        for round in 0..self.rounds {
            let (reused, rays) = for_pixels(context.scene, count, |scene, pixel| {
                let numbers = numbers(pixel, REUSE_DOMAIN.wrapping_add(round));
                self.reuse(scene, &eyes, &picked, &brightness, pixel, size, numbers)
            });
            picked = reused;
            counts += rays;
        }

        // Shade.
        let shade_tile = |mut tile: FilmTile<'_>| {
            let scene = Counting::new(context.scene);
            for ([x, y], pixel) in tile.pixels_mut() {
                let number = y as usize * width + x as usize;
                let eye = &eyes[number];
                let light = self.shade(&scene, eye, &picked[number]);
                pixel.add(((eye.radiance + light) * eye.weight).to_rgb());
                if let Some(hit) = eye.first_hit {
                    pixel.add_aov(hit.albedo, hit.normal, hit.depth);
                }
            }
            scene.counts()
        };
        counts + film.tiles_mut(TILE_SIZE).into_par_iter().map(shade_tile).sum()
    }

    /// Traces the ray of a pixel, and what of its light is not resampled: emission seen directly or by specular scattering.
    fn look<'s, S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'s, S, F>,
        scene: &Counting<'s, S>,
        place: [u32; 2],
        index: u64,
    ) -> Eye<S::Vertex<'s>> {
        let (mut sampler, sensor_ray) = context.eye_ray(scene, place, index);
        let ray = sensor_ray.ray;
        let mut eye = Eye { vertex: None, first_hit: None, radiance: S::Spectrum::ZERO, weight: sensor_ray.weight };
        let Some(vertex) = scene.intersect(&ray) else {
            eye.radiance = scene.environment_radiance(ray.direction);
            return eye;
        };
        eye.radiance = vertex.emitted();
        eye.first_hit = Some(FirstHit::new(&ray, &vertex));
        if scene.sharpness() == Sharpness::Specular && vertex.lambertian().is_none() {
            let (lobe, [u, v]) = (sampler.next_1d(), sampler.next_2d());
            let sample = vertex.sample([lobe, u, v], TransportMode::Radiance).filter(|sample| sample.is_specular);
            if let Some(sample) = sample {
                let emitted = match scene.intersect(&vertex.spawn_ray(sample.wi)) {
                    Some(hit) => hit.emitted(),
                    None => scene.environment_radiance(sample.wi),
                };
                eye.radiance += sample.throughput * emitted;
            }
        }
        eye.vertex = Some(vertex).filter(Vertex::is_connectible);
        eye
    }

    /// The sample of a pixel's own candidates.
    fn pick<'s, S: Scene + Sync, R: Sampler>(
        &self,
        scene: &Counting<'s, S>,
        eye: &Eye<S::Vertex<'s>>,
        mut numbers: R,
    ) -> Resampled<LightPoint> {
        let Some(vertex) = &eye.vertex else { return Resampled::EMPTY };
        let source = LightSource { mix: self.direct.mix.without_scattering(), ..self.direct.source(scene, vertex) };
        let target = self.direct.target(scene, vertex);
        let count = Budget::round(self.direct.budget.candidates(), &mut || numbers.next_1d());
        let picked = Reservoir::draw(count, &source, &target, &mut || numbers.next_1d());
        let seen = if self.tests_visibility { picked.kept_if(|y| y.is_visible(scene, vertex)) } else { picked };
        reusable(seen, scene, vertex)
    }

    /// A pixel's sample after taking over those of its neighbours.
    fn reuse<'s, S: Scene + Sync, R: Sampler>(
        &self,
        scene: &Counting<'s, S>,
        eyes: &[Eye<S::Vertex<'s>>],
        picked: &[Resampled<LightPoint>],
        brightness: &[f32],
        pixel: usize,
        size: [u32; 2],
        mut numbers: R,
    ) -> Resampled<LightPoint> {
        let eye = &eyes[pixel];
        let Some(vertex) = &eye.vertex else { return Resampled::EMPTY };

        // Neighbours, by what they see.
        let mut neighbours = SmallVec::<[usize; 16]>::new();
        for _ in 0..self.neighbours {
            let other = neighbour(pixel, size, numbers.next_2d(), self.radius);
            neighbours.extend(other.filter(|&other| other != pixel && eye.is_like(&eyes[other])));
        }
        let confidence = neighbours.iter().map(|&other| picked[other].confidence).sum();

        // Weigh each against the pixel's own sample.
        let tests_visibility = self.tests_visibility;
        let target = PointTarget { target: self.direct.target(scene, vertex), tests_visibility };
        let mut pairwise = Pairwise::new(picked[pixel], confidence);
        for other in neighbours {
            let Some(other_vertex) = &eyes[other].vertex else { continue };
            let other_target = PointTarget { target: self.direct.target(scene, other_vertex), tests_visibility };
            let ratio = brightness[pixel] / brightness[other];
            pairwise.add_normalised(picked[other], &target, &other_target, ratio, numbers.next_1d());
        }
        pairwise.finish(numbers.next_1d())
    }

    /// The light of the selected sample.
    fn shade<'s, S: Scene + Sync>(
        &self,
        scene: &Counting<'s, S>,
        eye: &Eye<S::Vertex<'s>>,
        picked: &Resampled<LightPoint>,
    ) -> S::Spectrum {
        let unlit = S::Spectrum::ZERO;
        let (Some(vertex), Some(selected)) = (&eye.vertex, &picked.selected) else { return unlit };
        let Some((candidate, measure)) = selected.sample.seen_from(scene, vertex) else { return unlit };
        let value = candidate.value(vertex) * (measure * selected.contribution_weight);
        // What was selected with visibility in the target has been seen from here.
        let is_seen = self.tests_visibility || (!value.is_black() && candidate.is_visible(scene, vertex));
        if is_seen { value } else { unlit }
    }
}

/// How bright each pixel is by the passes before: the mean over it and its neighbours, with a floor of a hundredth of the image's mean. One for all in the
/// first pass.
fn brightness(film: &Film) -> Vec<f32> {
    let (width, height) = (film.width() as usize, film.height() as usize);
    let luminance: Vec<f64> =
        film.pixels().iter().map(|pixel| Rgb::from(pixel.mean().map(|x| x as f32)).luminance().into()).collect();
    let mean = luminance.iter().sum::<f64>() / luminance.len().max(1) as f64;
    if film.samples() == 0 || !(mean > 0.0 && mean.is_finite()) {
        return vec![1.0; luminance.len()];
    }
    let around = |center: usize, len: usize| center.saturating_sub(1)..len.min(center + 2);
    let smooth = |pixel: usize| {
        let (rows, columns) = (around(pixel / width, height), around(pixel % width, width));
        let count = rows.len() * columns.len();
        let sum: f64 =
            rows.flat_map(|y| columns.clone().map(move |x| (x, y))).map(|(x, y)| luminance[y * width + x]).sum();
        (sum / count as f64).max(FLOOR * mean) as f32
    };
    (0..luminance.len()).map(smooth).collect()
}

/// Least brightness that counts, as a part of the image's mean.
const FLOOR: f64 = 0.01;

/// The pixel that `u` chooses in a disk around another, if it is in the image.
fn neighbour(pixel: usize, [width, height]: [u32; 2], u: [f32; 2], radius: f32) -> Option<usize> {
    let [dx, dy] = sample_concentric_disk(u).map(|d| (d * radius).round() as i64);
    let (x, y) = ((pixel % width as usize) as i64 + dx, (pixel / width as usize) as i64 + dy);
    let is_inside = (0..i64::from(width)).contains(&x) && (0..i64::from(height)).contains(&y);
    is_inside.then(|| y as usize * width as usize + x as usize)
}

impl<V: Vertex> Eye<V> {
    /// Whether another pixel's sample is likely to be of use.
    fn is_like(&self, other: &Self) -> bool {
        let (Some(mine), Some(theirs)) = (&self.first_hit, &other.first_hit) else { return false };
        let cosine = Vec3A::from(mine.normal).dot(Vec3A::from(theirs.normal));
        other.vertex.is_some()
            && cosine > LEAST_COSINE
            && (mine.depth - theirs.depth).abs() <= LARGEST_STEP * mine.depth.max(theirs.depth)
    }
}
