//! The laws of `Scene`.

use scene_core::glam::Vec3A;
use scene_core::{Emitter, Ray, Scene, Sensor, Sharpness, Spectrum, SurfacePoint, TransportMode, Vertex};

use super::{alike, is_amount, is_unit, on_sphere};
use crate::laws::{Law, hold};
use crate::outcome::Outcome;
use crate::seed::{Uniforms, seed};
use crate::verdict::Violation;

/// Paths that are followed, from the sensor and from anywhere.
const PATHS: usize = 2000;
/// Hits of one path.
const HITS: usize = 4;
/// Cosines below are too small for rays to tell what is in front.
const GRAZING: f32 = 0.02;
/// The share of rays that may break the laws of what is closest and visible: those that pass through edges.
const OUTLIERS: f64 = 1e-3;

/// Checks the laws of a [`Scene`].
///
/// ```text
/// (1)  what `intersect` finds lies on the ray, before its end; nothing is before it; wo points back
/// (2)  occluded(ray)  <=>  intersect(ray) finds something: for rays that end before, at and behind what they hit
/// (3)  what is found from a vertex is visible from there, and back; `visible` is not `occluded`
/// (4)  a vertex of emitter `id` has the radiance of `emitters()[id]`, one of none has none
/// (5)  the environment is an emitter at infinity; what comes from outside is its radiance, or nothing if there is none
/// (6)  the bounding sphere contains everything that is hit
/// (7)  nothing scatters more sharply than `sharpness` says
/// (8)  the same ray finds the same point
/// ```
///
/// The rays: through the sensor, through the bounding sphere, and on from what they hit, by samples of the scattering
/// functions. What they hit at grazing angles is not compared, and one of 1000 rays may break (1) to (3): those through the edges of
/// surfaces. No chance is involved but in the choice of rays, which follows from the name. Cost: some 100 000 rays.
///
/// That emitters found by rays have the density of their samplers is a law of [`check_emitter`](super::check_emitter).
///
/// ```
/// # fn scene<S: scene_core::Scene>(scene: &S) {
/// estimator_checks::laws::scene::check_scene("scene", scene).expect_pass();
/// # }
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn check_scene<S: Scene>(test: &str, scene: &S) -> Outcome {
    let mut rays = Rays { scene, checked: 0, outliers: Vec::new() };
    let law = rays.laws(&mut Uniforms::new(seed(test)));
    Outcome::of_laws(test, law.and_then(|()| rays.judge()))
}

struct Rays<'s, S> {
    scene: &'s S,
    checked: u64,
    outliers: Vec<Violation>,
}

impl<'s, S: Scene> Rays<'s, S> {
    fn laws(&mut self, uniforms: &mut Uniforms) -> Law {
        let (center, radius) = self.scene.bounding_sphere();
        let finite = center.is_finite() && radius.is_finite() && radius >= 0.0;
        hold("the bounding sphere is finite", finite, || format!("centre {center}, radius {radius}"))?;
        self.environment(uniforms)?;
        let [width, height] = self.scene.sensor().resolution().map(|n| n as f32);
        let mut last = None;
        for path in 0..PATHS {
            let u = uniforms.array::<4>().map(|u| u as f32);
            let mut ray = if path % 2 == 0 {
                self.scene.sensor().sample_ray([u[0] * width, u[1] * height], [u[2], u[3]]).ray
            } else {
                let origin = center + radius * on_sphere(uniforms) * u[0];
                Ray::new(origin, on_sphere(uniforms))
            };
            for _ in 0..HITS {
                let Some(vertex) = self.ray(&ray)? else { break };
                let sample = vertex.sample(uniforms.array().map(|u| u as f32), TransportMode::Radiance);
                let Some(sample) = sample.filter(|sample| is_unit(sample.wi)) else { break };
                let sharp = !sample.is_specular || self.scene.sharpness() == Sharpness::Specular;
                let shown = || format!("{sample:?} in a scene that is {:?}", self.scene.sharpness());
                hold("nothing scatters more sharply than the scene says", sharp, shown)?;
                self.visibility(&vertex, sample.wi)?;
                // Most points of different paths do not see each other.
                if let Some(other) = last.replace(*vertex.point()) {
                    self.visible(&other, vertex.point())?;
                }
                ray = vertex.spawn_ray(sample.wi);
            }
        }
        Ok(())
    }

    /// (5)
    fn environment(&self, uniforms: &mut Uniforms) -> Law {
        let (scene, emitters) = (self.scene, self.scene.emitters());
        let id = scene.environment();
        let emitter = id.and_then(|id| emitters.get(id.index()));
        let exists = id.is_none() || emitter.is_some();
        hold("the environment is an emitter", exists, || format!("{id:?} of {}", emitters.len()))?;
        let infinite = emitter.is_none_or(Emitter::is_infinite);
        hold("the environment is at infinity", infinite, || format!("{id:?}"))?;
        for _ in 0..100 {
            let direction = on_sphere(uniforms);
            let expected = emitter.map_or(S::Spectrum::ZERO, |emitter| emitter.radiance(None, direction));
            let found = scene.environment_radiance(direction);
            let shown = || format!("{found:?}, not {expected:?}, along {direction}");
            let same = is_amount(&found) && alike(&found, &expected, 1e-5);
            hold("what comes from outside is the environment's radiance", same, shown)?;
        }
        Ok(())
    }

    /// (1), (2), (4), (6) and (8): what a ray hits.
    fn ray(&mut self, ray: &Ray) -> Result<Option<S::Vertex<'s>>, Violation> {
        let scene = self.scene;
        self.occluded(ray, scene.intersect(ray).is_some())?;
        let Some(vertex) = scene.intersect(ray) else { return Ok(None) };
        let point = vertex.point();
        let (to, wo) = (point.position - ray.origin, vertex.wo());
        let distance = to.dot(ray.direction);
        let shown = || format!("{point:?} at distance {distance} of {ray:?}");
        let again = scene.intersect(ray).map(|vertex| *vertex.point());
        hold("the same ray finds the same point", again == Some(*point), || format!("{again:?}, then {}", shown()))?;
        hold("normals have unit length", is_unit(point.normal) || point.normal == Vec3A::ZERO, shown)?;
        hold("wo points back along the ray", wo.distance(-ray.direction) <= 1e-4, || format!("wo {wo}, {}", shown()))?;
        self.emitted(&vertex)?;
        let (center, radius) = scene.bounding_sphere();
        let slack = 1e-3 * radius + point.error;
        let inside = point.position.distance(center) <= radius + slack;
        hold("the bounding sphere contains all that is hit", inside, || {
            format!("centre {center}, radius {radius}, {}", shown())
        })?;
        if point.normal.dot(ray.direction).abs() < GRAZING {
            return Ok(Some(vertex));
        }
        let size = ray.origin.abs().max_element() + point.position.abs().max_element();
        let off = (to - ray.direction * distance).length();
        self.tolerate("what is hit lies on the ray", off <= 1e-4 * size + 2.0 * point.error, shown)?;
        let before = distance > -1e-4 * size && distance <= ray.max_distance * (1.0 + 1e-4) + 1e-4 * size;
        self.tolerate("what is hit lies before the end of the ray", before, shown)?;
        // Rays that end clearly before and behind.
        let margin = 1e-3 * distance + 1e-4 * size + 4.0 * point.error;
        if distance > 2.0 * margin {
            let nearer = scene.intersect(&ray.up_to(distance - margin)).map(|vertex| *vertex.point());
            self.tolerate("nothing is before what is hit", nearer.is_none(), || format!("{nearer:?} is, {}", shown()))?;
            self.occluded(&ray.up_to(distance - margin), nearer.is_some())?;
            self.occluded(&ray.up_to(0.5 * distance), scene.intersect(&ray.up_to(0.5 * distance)).is_some())?;
        }
        let longer = ray.up_to((distance + margin).min(ray.max_distance));
        let found = scene.intersect(&longer).is_some();
        self.tolerate("a ray that ends behind what is hit finds it", found, shown)?;
        self.occluded(&longer, found)?;
        Ok(Some(vertex))
    }

    fn occluded(&mut self, ray: &Ray, expected: bool) -> Law {
        let found = self.scene.occluded(ray);
        let shown =
            || format!("{found} for {ray:?}, and intersect finds {}", if expected { "something" } else { "nothing" });
        self.tolerate("a ray is occluded if it hits something, and only then", found == expected, shown)
    }

    /// (3): what is found in a direction.
    fn visibility(&mut self, vertex: &S::Vertex<'_>, wi: Vec3A) -> Law {
        let scene = self.scene;
        let Some(next) = scene.intersect(&vertex.spawn_ray(wi)) else { return Ok(()) };
        let (a, b) = (*vertex.point(), *next.point());
        let cosines = [&a, &b].map(|point| if point.normal == Vec3A::ZERO { 1.0 } else { point.normal.dot(wi).abs() });
        let shown = || format!("from {a:?} to {b:?}");
        let visible = self.visible(&a, &b)?;
        if cosines.iter().any(|&cosine| cosine < GRAZING)
            || a.position.distance(b.position) < 10.0 * (a.error + b.error)
        {
            return Ok(());
        }
        self.tolerate("what a ray finds is visible", visible, shown)?;
        self.tolerate("visibility is symmetric", visible == scene.visible(&b, &a), shown)
    }

    /// Whether two points see each other, by both ways to ask.
    fn visible(&mut self, a: &SurfacePoint, b: &SurfacePoint) -> Result<bool, Violation> {
        let visible = self.scene.visible(a, b);
        let same = visible != self.scene.occluded(&a.ray_to(b));
        self.tolerate("visible is not occluded", same, || format!("visible is {visible} from {a:?} to {b:?}"))?;
        Ok(visible)
    }

    /// (4)
    fn emitted(&self, vertex: &S::Vertex<'_>) -> Law {
        let (emitters, id, emitted) = (self.scene.emitters(), vertex.emitter(), vertex.emitted());
        let emitter = id.and_then(|id| emitters.get(id.index()));
        let exists = id.is_none() || emitter.is_some();
        hold("the emitter of a vertex exists", exists, || format!("{id:?} of {}", emitters.len()))?;
        let expected = emitter.map_or(S::Spectrum::ZERO, |emitter| emitter.radiance(Some(vertex.point()), vertex.wo()));
        let shown = || {
            format!("{emitted:?}, not {expected:?} of emitter {id:?}, towards {} at {:?}", vertex.wo(), vertex.point())
        };
        // Which side of it a grazing ray sees is a matter of round-off.
        let grazing = vertex.point().normal.dot(vertex.wo()).abs() < 1e-3;
        let same = is_amount(&emitted) && (grazing || alike(&emitted, &expected, 2e-3));
        hold("a vertex emits what its emitter does", same, shown)
    }

    /// A law that rays through edges may break.
    fn tolerate(&mut self, law: &'static str, holds: bool, counterexample: impl FnOnce() -> String) -> Law {
        self.checked += 1;
        if let Err(violation) = hold(law, holds, counterexample) {
            self.outliers.push(violation);
        }
        Ok(())
    }

    fn judge(mut self) -> Law {
        let allowed = OUTLIERS * self.checked as f64;
        if self.outliers.len() as f64 > allowed { Err(self.outliers.swap_remove(0)) } else { Ok(()) }
    }
}
