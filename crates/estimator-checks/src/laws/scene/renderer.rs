//! All laws of a renderer at once.

use scene_core::{Emitter, EmitterId, Scene, Sensor, Spectrum, Vertex};

use super::{SensorLaws, VertexLaws, check_emitter, check_scene, check_spectrum, components};
use crate::outcome::Report;
use crate::suite::Check;

/// Rays through the sensor that look for vertices.
const RAYS: usize = 4000;

/// Checks the laws of a renderer that implements the traits of `scene-core`, with the default [`RendererLaws`].
///
/// ```no_run
/// use estimator_checks::{Check, laws::scene::check_renderer};
/// use scene_core::{ReferenceScene, builtin::Builtin};
///
/// let scene = ReferenceScene::new(Builtin::named("cornell-box").expect("it is one").description())?;
/// check_renderer(Check::new("Cornell box", 1e-6)?, &scene).expect_pass();
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn check_renderer<S: Scene>(check: Check, scene: &S) -> Report {
    RendererLaws::new().run(check, scene)
}

/// Checks the laws of everything that a [`Scene`] hands out, one after the other:
///
/// - [`check_spectrum`](super::check_spectrum) on the radiances and albedos that it shows,
/// - [`check_scene`](super::check_scene),
/// - [`SensorLaws`] of its sensor,
/// - [`VertexLaws`] of what its sensor sees: the first vertices of different albedos,
/// - [`check_emitter`](super::check_emitter) of its first emitters, with light that arrives at that one of these vertices which
///   most samples reach.
///
/// All share the level of the check. The report has their outcomes, each under a name of its own. An emitter that shines on none
/// of the vertices is left out. Cost: the sum of all, some seconds.
#[derive(Clone, Debug)]
pub struct RendererLaws {
    vertices: usize,
    emitters: usize,
    vertex: VertexLaws,
    sensor: SensorLaws,
}

impl Default for RendererLaws {
    fn default() -> Self {
        Self::new()
    }
}

impl RendererLaws {
    /// Up to four vertices and four emitters.
    pub fn new() -> Self {
        Self { vertices: 4, emitters: 4, vertex: VertexLaws::new(), sensor: SensorLaws::new() }
    }

    /// How many vertices at most.
    #[must_use]
    pub fn vertices(self, vertices: usize) -> Self {
        Self { vertices, ..self }
    }

    /// How many emitters at most.
    #[must_use]
    pub fn emitters(self, emitters: usize) -> Self {
        Self { emitters, ..self }
    }

    /// The laws of vertices.
    #[must_use]
    pub fn vertex(self, vertex: VertexLaws) -> Self {
        Self { vertex, ..self }
    }

    /// The laws of the sensor.
    #[must_use]
    pub fn sensor(self, sensor: SensorLaws) -> Self {
        Self { sensor, ..self }
    }

    /// Checks the laws.
    #[must_use = "it decides nothing until it is expected to pass or to reject"]
    pub fn run<S: Scene>(&self, check: Check, scene: &S) -> Report {
        let seen = self.seen(&check, scene);
        let name = |part: &str| format!("{}: {part}", check.test());
        let mut colours: Vec<S::Spectrum> =
            seen.iter().flat_map(|vertex| [vertex.albedo(), vertex.emitted()]).collect();
        colours.extend(scene.emitters().iter().take(self.emitters).map(Emitter::power));
        let mut outcomes = vec![check_spectrum(&name("spectrum"), &colours), check_scene(&name("scene"), scene)];
        outcomes.extend(self.sensor.run(&name("sensor"), scene.sensor()).outcomes);

        let lit = self.lit(scene, &seen);
        let vertices = (0..seen.len()).map(|i| format!("vertex {i}"));
        let names: Vec<String> = vertices.chain(lit.iter().map(|(id, _)| format!("emitter {}", id.0))).collect();
        let mut checks = check.parts(names.into_iter()).into_iter();
        for (vertex, check) in seen.iter().zip(&mut checks) {
            outcomes.extend(self.vertex.run(check, vertex).outcomes);
        }
        for ((id, vertex), check) in lit.into_iter().zip(checks) {
            outcomes.extend(check_emitter(check, scene, id, seen[vertex].point().position).outcomes);
        }
        Report { outcomes }
    }

    /// The first vertices of different albedos that the sensor sees.
    fn seen<'s, S: Scene>(&self, check: &Check, scene: &'s S) -> Vec<S::Vertex<'s>> {
        let mut uniforms = check.uniforms();
        let [width, height] = scene.sensor().resolution().map(|n| n as f32);
        let mut seen: Vec<S::Vertex<'s>> = Vec::new();
        for _ in 0..RAYS {
            if seen.len() >= self.vertices {
                break;
            }
            let [x, y, u, v] = uniforms.array().map(|u| u as f32);
            let ray = scene.sensor().sample_ray([x * width, y * height], [u, v]).ray;
            let Some(vertex) = scene.intersect(&ray) else { continue };
            let colour = |vertex: &S::Vertex<'s>| components(&vertex.albedo());
            if seen.iter().all(|other| colour(other) != colour(&vertex)) {
                seen.push(vertex);
            }
        }
        seen
    }

    /// Emitters, each with the vertex that most of its samples reach.
    fn lit<S: Scene>(&self, scene: &S, seen: &[S::Vertex<'_>]) -> Vec<(EmitterId, usize)> {
        let reaches = |emitter: &S::Emitter, vertex: &S::Vertex<'_>| {
            let grid = (0..64).map(|k| [(k % 8) as f32 / 8.0 + 0.05, (k / 8) as f32 / 8.0 + 0.05]);
            let samples = grid.filter_map(|u| emitter.sample_direct(vertex.point().position, u));
            samples.filter(|sample| !sample.radiance.is_black()).count()
        };
        let emitters = scene.emitters().iter().take(self.emitters).enumerate();
        let best = emitters.filter_map(|(i, emitter)| {
            let counts = seen.iter().enumerate().map(|(k, vertex)| (reaches(emitter, vertex), k));
            let (count, vertex) = counts.max_by_key(|&(count, k)| (count, std::cmp::Reverse(k)))?;
            (count > 0).then_some((EmitterId(i as u32), vertex))
        });
        best.collect()
    }
}
