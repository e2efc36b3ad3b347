//! What a batch of paths left behind.

use photon_map::Scratch;
use qmc_sampling::{Sampler, SamplerFamily};
use rayon::prelude::*;
use scene_core::{Counting, Emitter, Ray, RayCounts, Scene, Spectrum, TransportMode, Vertex};
use vpl_gi::{Found, Observer};

use super::observable::EyeRay;
use super::{Collected, Collector, FilterVertex, Observable, Selection};
use crate::estimators::FirstHit;
use crate::render::{PassContext, PassCounts};

/// Paths that a task traces.
const PATHS_PER_TASK: usize = 512;
/// Point lights whose visibility a vertex remembers.
const POINT_LIGHTS: usize = 32;

/// A path without its vertices.
#[derive(Clone, Copy, Debug)]
pub struct Path {
    /// What stays out of the average.
    pub unfiltered: [f32; 3],
    /// What the camera ray hit first.
    pub first_hit: Option<FirstHit>,
    /// Number of its vertices: those of the paths lie one after the other.
    pub vertices: u32,
}

/// A batch of paths and their vertices, in the order of the paths.
#[derive(Clone, Debug, Default)]
pub struct Traced {
    /// The paths.
    pub paths: Vec<Path>,
    /// Their vertices, one path after the other.
    pub vertices: Vec<FilterVertex>,
    /// The attenuation of each vertex.
    pub attenuations: Vec<[f32; 3]>,
    /// What it took.
    pub counts: PassCounts,
}

impl Traced {
    /// Adds the paths of another batch behind these.
    pub fn append(&mut self, mut other: Self) {
        self.paths.append(&mut other.paths);
        self.vertices.append(&mut other.vertices);
        self.attenuations.append(&mut other.attenuations);
        self.counts.rays += other.counts.rays;
        self.counts.light_paths += other.counts.light_paths;
    }

    /// What each path says if these averages take the place of what arrives at its vertices.
    pub fn radiance(&self, averages: &[[f32; 3]]) -> impl Iterator<Item = [f32; 3]> {
        let mut first = 0;
        self.paths.iter().map(move |path| {
            let range = first..first + path.vertices as usize;
            first = range.end;
            let mut sum = path.unfiltered;
            for (mean, attenuation) in averages[range.clone()].iter().zip(&self.attenuations[range]) {
                (0..3).for_each(|k| sum[k] += mean[k] * attenuation[k]);
            }
            sum
        })
    }

    /// What each path says without a filter.
    pub fn unfiltered(&self) -> Vec<[f32; 3]> {
        let own: Vec<[f32; 3]> = self.vertices.iter().map(|vertex| vertex.contribution).collect();
        self.radiance(&own).collect()
    }
}

/// Camera paths that have no contribution of their own.
#[derive(Clone, Debug, Default)]
pub struct Queries {
    /// The pixel of each, counted row by row.
    pub pixels: Vec<usize>,
    /// What it sees apart from the average.
    pub unfiltered: Vec<[f32; 3]>,
    /// The attenuation of its vertex, if it has one.
    pub attenuations: Vec<Option<[f32; 3]>>,
    /// Those vertices, in the same order.
    pub vertices: Vec<FilterVertex>,
    /// Number of those that no average answers, and that are not among these.
    pub unanswered: usize,
    /// Rays traced.
    pub rays: RayCounts,
}

impl Queries {
    fn append(&mut self, mut other: Self) {
        self.pixels.append(&mut other.pixels);
        self.unfiltered.append(&mut other.unfiltered);
        self.attenuations.append(&mut other.attenuations);
        self.vertices.append(&mut other.vertices);
        self.unanswered += other.unanswered;
        self.rays += other.rays;
    }

    /// Pixel and radiance of each query for which there was an average, or that needs none.
    pub fn answered<'a>(&'a self, means: &'a [Option<[f32; 3]>]) -> impl Iterator<Item = (usize, [f32; 3])> + 'a {
        let mut means = means.iter();
        let paths = self.pixels.iter().zip(&self.unfiltered).zip(&self.attenuations);
        paths.filter_map(move |((&pixel, &unfiltered), attenuation)| match attenuation {
            None => Some((pixel, unfiltered)),
            Some(a) => {
                let mean = (*means.next()?)?;
                Some((pixel, std::array::from_fn(|k| unfiltered[k] + a[k] * mean[k])))
            }
        })
    }
}

/// What is wanted of paths.
#[derive(Clone, Copy, Debug)]
pub struct Tracing<'a, E> {
    /// Traces them.
    pub estimator: &'a E,
    /// At which vertices.
    pub selection: Selection,
    /// Whether vertices are to know which point lights they see, at a visibility ray for each.
    pub point_lights: bool,
    /// The point in time.
    pub time: f32,
}

impl<E: Observable> Tracing<'_, E> {
    /// One path through every pixel: sample number `index`.
    pub fn image<S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'_, S, F>,
        [width, height]: [u32; 2],
        index: u64,
    ) -> Traced {
        let count = width as usize * height as usize;
        self.trace(context, index, count, |i| {
            let place = [(i % width as usize) as u32, (i / width as usize) as u32];
            let (sampler, ray) = context.eye_ray(context.scene, place, index);
            (EyeRay { ray: ray.ray, place, index }, sampler, ray.weight)
        })
    }

    /// More camera samples without light paths, `extra` for every pixel and sample: queries for averages of others. Those that cannot be answered at all are left out; each has the number of its
    /// pixel.
    pub fn queries<S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'_, S, F>,
        [width, height]: [u32; 2],
        index: u64,
        extra: u32,
        max_depth: u32,
    ) -> Queries {
        let row = |y: u32| {
            let scene = Counting::new(context.scene);
            let mut queries = Queries::default();
            for (x, number) in (0..width).flat_map(|x| (0..extra).map(move |number| (x, number))) {
                let place = [x, y];
                let (mut sampler, ray) = context.extra_ray(&scene, place, index, number);
                let mut collector = Collector::new(self.selection, &ray.ray);
                if !look(&scene, ray.ray, max_depth, &mut sampler, self.selection, &mut collector) {
                    queries.unanswered += 1;
                    continue;
                }
                let (unfiltered, mut vertices) = collector.finish(ray.weight);
                queries.pixels.push(y as usize * width as usize + x as usize);
                queries.unfiltered.push(unfiltered);
                let found = vertices.next();
                queries.attenuations.push(found.map(|found| found.attenuation));
                queries.vertices.extend(found.map(|found| self.complete(&scene, place, found.vertex)));
            }
            queries.rays = scene.counts();
            queries
        };
        let rows: Vec<Queries> = (0..height).into_par_iter().map(row).collect();
        let mut all = Queries::default();
        rows.into_iter().for_each(|row| all.append(row));
        all
    }

    /// A vertex with what its collector does not know.
    fn complete<S: Scene>(&self, scene: &S, place: [u32; 2], vertex: FilterVertex) -> FilterVertex {
        let visibility = if self.point_lights { visibility(scene, &vertex) } else { 0 };
        FilterVertex { pixel: place, time: self.time, visibility, ..vertex }
    }

    /// So many paths, each with its ray, its numbers and the factor of its sensor.
    fn trace<S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'_, S, F>,
        index: u64,
        count: usize,
        ray: impl Fn(usize) -> (EyeRay, F::Sampler, f32) + Sync,
    ) -> Traced {
        let (prepared, counts) = self.estimator.prepare(context, index);
        let task = |task: usize| {
            let (scene, mut scratch) = (Counting::new(context.scene), Scratch::default());
            let mut traced = Traced::default();
            for i in task * PATHS_PER_TASK..count.min((task + 1) * PATHS_PER_TASK) {
                let (eye, mut sampler, weight) = ray(i);
                let mut collector = Collector::new(self.selection, &eye.ray);
                let estimator = self.estimator;
                let first_hit =
                    estimator.observe(context, &prepared, &scene, &mut scratch, eye, &mut sampler, &mut collector);
                let (unfiltered, vertices) = collector.finish(weight);
                let before = traced.vertices.len();
                for Collected { vertex, attenuation } in vertices {
                    traced.vertices.push(self.complete(&scene, eye.place, vertex));
                    traced.attenuations.push(attenuation);
                }
                traced.paths.push(Path { unfiltered, first_hit, vertices: (traced.vertices.len() - before) as u32 });
            }
            traced.counts.rays = scene.counts();
            traced
        };
        let tasks: Vec<Traced> = (0..count.div_ceil(PATHS_PER_TASK)).into_par_iter().map(task).collect();
        let mut all = Traced { counts, ..Traced::default() };
        tasks.into_iter().for_each(|task| all.append(task));
        all
    }
}

/// Follows a camera path to the vertex where it would be filtered, without light paths. Whether it got there, or ended without anything but emission on its way; not so if it met a surface
/// between sharp and diffuse, whose light it would need.
fn look<'s, S: Scene>(
    scene: &'s S,
    mut ray: Ray,
    max_depth: u32,
    sampler: &mut impl Sampler,
    selection: Selection,
    collector: &mut Collector,
) -> bool {
    let mut throughput = S::Spectrum::splat(1.0);
    for length in 1..=max_depth {
        let Some(vertex) = scene.intersect(&ray) else {
            let value = throughput * scene.environment_radiance(ray.direction);
            Observer::<S::Vertex<'s>>::contribution(collector, length, Found::Hit, value);
            return true;
        };
        collector.vertex(length, &vertex, throughput);
        Observer::<S::Vertex<'s>>::contribution(collector, length, Found::Hit, throughput * vertex.emitted());
        if length == max_depth || selection.selects(&vertex) {
            return true;
        }
        if vertex.is_connectible() {
            return false;
        }
        let (lobe, [u, v]) = (sampler.next_1d(), sampler.next_2d());
        let Some(sample) = vertex.sample([lobe, u, v], TransportMode::Radiance) else { return true };
        throughput *= sample.throughput;
        collector.scattered(length, &vertex, &sample);
        ray = vertex.spawn_ray(sample.wi);
    }
    true
}

/// Traces paths along any rays, such as those of light probes and of texels; path number `i` takes its numbers from stream `i`.
pub fn trace_rays<S: Scene + Sync, F: SamplerFamily, E: Observable>(
    tracing: &Tracing<'_, E>,
    context: &PassContext<'_, S, F>,
    rays: &[Ray],
    index: u64,
) -> Traced {
    tracing.trace(context, index, rays.len(), |i| {
        let place = [i as u32, 0];
        (EyeRay { ray: rays[i], place, index }, context.samplers.sampler(i as u64, index), 1.0)
    })
}

/// One bit for each of the first point lights: whether it is seen from the vertex.
fn visibility<S: Scene>(scene: &S, vertex: &FilterVertex) -> u32 {
    let (position, normal) = (glam::Vec3A::from_array(vertex.position), glam::Vec3A::from_array(vertex.normal));
    let mut point = scene_core::SurfacePoint::new(position, normal);
    // The vertex has forgotten whether an instance made its round-off larger.
    point.error *= 4.0;
    let mut bits = 0;
    let lights = scene.emitters().iter().filter(|emitter| emitter.is_delta()).take(POINT_LIGHTS);
    for (bit, emitter) in lights.enumerate() {
        let Some(light) = emitter.sample_direct(position, [0.5; 2]) else { continue };
        let ray = match &light.at {
            Some((at, _)) => point.ray_to(at),
            None => point.ray_along(light.wi),
        };
        bits |= u32::from(!scene.occluded(&ray)) << bit;
    }
    bits
}

/// All rays of some batches.
pub(super) fn rays(batches: &[Traced]) -> RayCounts {
    batches.iter().map(|batch| batch.counts.rays).sum()
}
