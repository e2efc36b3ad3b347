//! Eye paths: hitting lights, and connecting to light paths.

use glam::Vec3A;
use qmc_sampling::Sampler;
use scene_core::{Emitter, EmitterChoice, EmitterId, Ray, Scene, Sensor, Spectrum, TransportMode, Vertex};
use smallvec::SmallVec;

use super::Bidirectional;
use super::connections::{ConnectionTests, EveryConnection};
use super::density::by_area;
use super::light_paths::{LightPaths, backward};
use super::path::{CENTRE, EyeVertex, Joint, LensRay, Path, Samples};
use super::techniques::PathHeuristic;
use crate::lights::LightKind;
use crate::observer::{Found, Observer};
use crate::partition::Partition;
use crate::shading::{Connections, for_each_unshadowed, shadow_ray};

/// The vertices of an eye path; longer ones move to the heap.
type EyeVertices = SmallVec<[EyeVertex; 8]>;

impl<H: PathHeuristic, C: EmitterChoice> Bidirectional<H, C> {
    /// An estimate of the radiance that arrives along `ray`, without what is left to [`splats`](Self::splats).
    ///
    /// `lights` are light paths that [`trace_light_paths`](Self::trace_light_paths) made: for this ray alone, or for many. The observer sees the
    /// contributions of single techniques.
    pub fn radiance<'s, S, V, O>(
        &self,
        scene: &'s S,
        lights: &LightPaths<V>,
        ray: Ray,
        sampler: &mut impl Sampler,
        observer: &mut O,
    ) -> S::Spectrum
    where
        S: Scene,
        V: Vertex<Spectrum = S::Spectrum>,
        O: Observer<S::Vertex<'s>>,
    {
        self.radiance_with(scene, lights, ray, sampler, observer, &mut EveryConnection)
    }

    /// [`radiance`](Self::radiance) with shadow rays as `tests` decides. The observer sees what is added at once, not what is put off to the
    /// end of the eye path.
    pub fn radiance_with<'s, S, V, O, T>(
        &self,
        scene: &'s S,
        lights: &LightPaths<V>,
        ray: Ray,
        sampler: &mut impl Sampler,
        observer: &mut O,
        tests: &mut T,
    ) -> S::Spectrum
    where
        S: Scene,
        V: Vertex<Spectrum = S::Spectrum>,
        O: Observer<S::Vertex<'s>>,
        T: ConnectionTests<S::Spectrum>,
    {
        let [width, height] = scene.sensor().resolution();
        let pixels = f64::from(width) * f64::from(height);
        let density = pixels * f64::from(scene.sensor().pdf_ray(ray.origin, ray.direction).1);
        let lens = LensRay { origin: ray.origin, density };
        let eye_path = EyePath {
            settings: self,
            scene,
            lights,
            lens,
            samples: self.samples(lights),
            vertices: EyeVertices::new(),
        };
        let at_once = eye_path.trace(ray, sampler, observer, tests);
        at_once + tests.finish(|ray| scene.occluded(ray))
    }
}

/// An eye path and what it is traced with.
struct EyePath<'a, 's, S, V: Vertex, H, C> {
    settings: &'a Bidirectional<H, C>,
    scene: &'s S,
    lights: &'a LightPaths<V>,
    lens: LensRay,
    samples: Samples,
    vertices: EyeVertices,
}

impl<'s, S, V, H, C> EyePath<'_, 's, S, V, H, C>
where
    S: Scene,
    V: Vertex<Spectrum = S::Spectrum>,
    H: PathHeuristic,
    C: EmitterChoice,
{
    fn trace<O: Observer<S::Vertex<'s>>>(
        mut self,
        mut ray: Ray,
        sampler: &mut impl Sampler,
        observer: &mut O,
        tests: &mut impl ConnectionTests<S::Spectrum>,
    ) -> S::Spectrum {
        let settings = self.settings;
        let mut radiance = S::Spectrum::ZERO;
        let mut throughput = S::Spectrum::splat(1.0);
        let mut eta = 1.0;
        let everything = Partition::hard(f32::INFINITY).expect("infinity is a threshold");
        // Rays that miss the film are of no technique but the eye path's: any density will do.
        let mut pdf = if self.lens.density > 0.0 { self.lens.density } else { 1.0 };
        let mut from = ray.origin;
        for length in 1..=settings.max_depth {
            // Hit a light.
            let Some(vertex) = self.scene.intersect(&ray) else {
                if let Some(id) = self.scene.environment() {
                    self.vertices.push(EyeVertex { point: None, forward: pdf, ratio: 0.0, is_specular: false });
                    let value = throughput * self.scene.environment_radiance(ray.direction);
                    radiance += self.hit(None, -ray.direction, id, value, observer);
                }
                return radiance;
            };
            observer.vertex(length, &vertex, throughput);
            let point = *vertex.point();
            let forward = pdf * by_area(1.0, from, &point);
            self.vertices.push(EyeVertex { point: Some(point), forward, ratio: 0.0, is_specular: false });
            if let Some(id) = vertex.emitter() {
                radiance += self.hit(Some(&vertex), vertex.wo(), id, throughput * vertex.emitted(), observer);
            }
            if length == settings.max_depth {
                return radiance;
            }

            // Connect to the light paths.
            if vertex.is_connectible() {
                let longest = settings.max_depth - length - 1;
                let lights = self.lights.lights();
                let connections = Connections::up_to(longest, &everything);
                for_each_unshadowed(self.scene, &vertex, lights, &connections, |light, value| {
                    radiance += self.connect(&vertex, light, throughput * value, observer, tests);
                });
            }

            // Scatter.
            let (lobe, [u, v]) = (sampler.next_1d(), sampler.next_2d());
            let Some(sample) = vertex.sample([lobe, u, v], TransportMode::Radiance) else { return radiance };
            throughput *= sample.throughput;
            eta *= sample.eta;

            // Survive.
            let survival = settings.roulette.survival_probability(length, sample.throughput, throughput, eta);
            if survival < 1.0 {
                if sampler.next_1d() >= survival {
                    return radiance;
                }
                throughput *= S::Spectrum::splat(1.0 / survival);
            }
            if throughput.is_black() || !throughput.is_finite() {
                return radiance;
            }
            observer.scattered(length, &vertex, &sample);
            self.leave(&vertex, sample.wi, sample.is_specular);
            pdf = if sample.is_specular { 1.0 } else { f64::from(sample.pdf_solid_angle) };
            from = point.position;
            ray = vertex.spawn_ray(sample.wi);
        }
        radiance
    }

    /// The last vertex is left in direction `wi`: now it is known how light would have come to the one before.
    #[inline]
    fn leave(&mut self, vertex: &S::Vertex<'s>, wi: Vec3A, is_specular: bool) {
        let [.., before, last] = self.vertices.as_mut_slice() else {
            if let Some(last) = self.vertices.last_mut() {
                last.is_specular = is_specular;
            }
            return;
        };
        last.is_specular = is_specular;
        let pdf = if is_specular { 1.0 } else { backward(vertex, wi, TransportMode::Importance) };
        let density = before.point.as_ref().map_or(0.0, |before| by_area(pdf, vertex.point().position, before));
        before.ratio = density / before.forward;
    }

    fn path<'b>(&'b self, joint: Joint<'b, S::Vertex<'s>>, technique: usize) -> Path<'b, S, S::Vertex<'s>, V> {
        let (scene, lights, lens, samples) = (self.scene, self.lights, self.lens, self.samples);
        Path { scene, lights, eye: &self.vertices, lens, samples, joint, technique }
    }

    /// The contribution of technique 0: the eye path's last vertex emits `value`.
    fn hit<O: Observer<S::Vertex<'s>>>(
        &self,
        vertex: Option<&S::Vertex<'s>>,
        towards_eye: Vec3A,
        emitter: EmitterId,
        value: S::Spectrum,
        observer: &mut O,
    ) -> S::Spectrum {
        if value.is_black() {
            return value;
        }
        let length = self.vertices.len();
        let value = if length == 1 {
            value
        } else {
            let probability = self.settings.tracing.choice.probability(None, emitter);
            let path = self.path(Joint::Hit { vertex, towards_eye, emitter, probability }, 0);
            value * self.settings.heuristic.weight(0, &path) as f32
        };
        observer.contribution(length as u32, Found::Hit, value);
        value
    }

    /// The contribution `value` of a connection, weighted, and zero where something is in between.
    #[inline]
    fn connect<O: Observer<S::Vertex<'s>>, T: ConnectionTests<S::Spectrum>>(
        &self,
        vertex: &S::Vertex<'s>,
        light: usize,
        value: S::Spectrum,
        observer: &mut O,
        tests: &mut T,
    ) -> S::Spectrum {
        let lights = self.lights.lights();
        let end = &lights.as_slice()[light];
        let wi = match &end.kind {
            LightKind::Distant { towards, .. } => *towards,
            LightKind::Delta { emitter } => {
                let direct = self.scene.emitters()[emitter.index()].sample_direct(vertex.point().position, CENTRE);
                match direct {
                    Some(direct) => direct.wi,
                    None => return S::Spectrum::ZERO,
                }
            }
            LightKind::Emission { point, .. } => (point.position - vertex.point().position).normalize(),
            LightKind::Surface(y) => (y.point().position - vertex.point().position).normalize(),
        };
        let heuristic = &self.settings.heuristic;
        let ray = || shadow_ray(self.scene, vertex, lights, light);
        // A ray is cheaper than a weight for which densities are needed; whoever chooses among connections has to know the weight.
        let test_first = T::TESTS_ALL && !heuristic.weighs_first();
        if test_first && self.scene.occluded(&ray()) {
            return S::Spectrum::ZERO;
        }
        let technique = end.length as usize + 1;
        let weight = heuristic.weight(technique, &self.path(Joint::Connection { vertex, light, wi }, technique)) as f32;
        if weight == 0.0 {
            return S::Spectrum::ZERO;
        }
        let value = value * weight;
        let value = if test_first { value } else { tests.connect(value, ray(), |ray| self.scene.occluded(ray)) };
        if !value.is_black() {
            let found = Found::Connection { light: end.length };
            observer.contribution(self.vertices.len() as u32, found, value);
        }
        value
    }
}
