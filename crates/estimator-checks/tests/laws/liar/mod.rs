//! The reference scene, with room for one lie in whatever it hands out.

mod emitter;
mod sensor;
mod vertex;

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex};

use scene_core::glam::Vec3A;
use scene_core::{EmitterId, Ray, ReferenceScene, Rgb, Scene, SceneDescription, Sharpness, SurfacePoint, Vertex};

pub(crate) use emitter::{EmitterLie, LiarEmitter};
pub(crate) use sensor::{LiarSensor, SensorLie};
pub(crate) use vertex::{LiarVertex, VertexLie};

/// What a scene says wrongly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum SceneLie {
    Nothing,
    FindsTheSecond,
    IgnoresTheEnd,
    NeverOccluded,
    OcclusionIgnoresTheEnd,
    SeesOneWay,
    SeesThroughEverything,
    EnvironmentIsALamp,
    EnvironmentDoesNotExist,
    AddsToTheEnvironment,
    SphereIsTooSmall,
    SphereIsNowhere,
    SaysDiffuse,
    Dice,
}

pub(crate) struct LiarScene {
    pub inner: Arc<ReferenceScene>,
    pub lie: SceneLie,
    pub vertex_lie: VertexLie,
    pub emitters: Vec<LiarEmitter>,
    pub sensor: LiarSensor,
    calls: AtomicU32,
    asked: Mutex<Option<[Vec3A; 2]>>,
}

impl LiarScene {
    /// A scene that tells the truth.
    pub(crate) fn new(description: SceneDescription) -> Self {
        let inner = Arc::new(ReferenceScene::new(description).unwrap());
        let emitters = (0..inner.emitters().len()).map(|index| LiarEmitter::new(inner.clone(), index)).collect();
        let sensor = LiarSensor { scene: inner.clone(), lie: SensorLie::Nothing };
        let (calls, asked) = (AtomicU32::new(0), Mutex::new(None));
        Self { inner, lie: SceneLie::Nothing, vertex_lie: VertexLie::Nothing, emitters, sensor, calls, asked }
    }

    pub(crate) fn with_emitter(mut self, lie: EmitterLie) -> Self {
        self.emitters.iter_mut().for_each(|emitter| emitter.lie = lie);
        self
    }

    fn vertex(&self, ray: &Ray) -> Option<<ReferenceScene as Scene>::Vertex<'_>> {
        let ray = if self.lie == SceneLie::IgnoresTheEnd { Ray { max_distance: f32::INFINITY, ..*ray } } else { *ray };
        let found = self.inner.intersect(&ray)?;
        match self.lie {
            SceneLie::FindsTheSecond => {
                let from = found.point().ray_along(ray.direction);
                let left = ray.max_distance - ray.origin.distance(from.origin);
                self.inner.intersect(&from.up_to(left)).or(Some(found))
            }
            SceneLie::Dice if self.calls.fetch_add(1, Ordering::Relaxed) % 100 == 50 => None,
            _ => Some(found),
        }
    }
}

impl Scene for LiarScene {
    type Spectrum = Rgb;
    type Vertex<'s> = LiarVertex<'s>;
    type Emitter = LiarEmitter;
    type Sensor = LiarSensor;

    fn intersect(&self, ray: &Ray) -> Option<LiarVertex<'_>> {
        Some(LiarVertex::new(self.vertex(ray)?, self.vertex_lie))
    }

    fn occluded(&self, ray: &Ray) -> bool {
        match self.lie {
            SceneLie::NeverOccluded => false,
            SceneLie::OcclusionIgnoresTheEnd => self.inner.occluded(&Ray { max_distance: f32::INFINITY, ..*ray }),
            _ => self.inner.occluded(ray),
        }
    }

    fn emitters(&self) -> &[LiarEmitter] {
        &self.emitters
    }

    fn environment(&self) -> Option<EmitterId> {
        match self.lie {
            SceneLie::EnvironmentIsALamp => Some(EmitterId(0)),
            SceneLie::EnvironmentDoesNotExist => Some(EmitterId(7)),
            _ => self.inner.environment(),
        }
    }

    fn sensor(&self) -> &LiarSensor {
        &self.sensor
    }

    fn bounding_sphere(&self) -> (Vec3A, f32) {
        let (center, radius) = self.inner.bounding_sphere();
        match self.lie {
            SceneLie::SphereIsTooSmall => (center, 0.5 * radius),
            SceneLie::SphereIsNowhere => (center, f32::NAN),
            _ => (center, radius),
        }
    }

    fn sharpness(&self) -> Sharpness {
        if self.lie == SceneLie::SaysDiffuse { Sharpness::Diffuse } else { self.inner.sharpness() }
    }

    fn visible(&self, a: &SurfacePoint, b: &SurfacePoint) -> bool {
        let visible = !self.occluded(&a.ray_to(b));
        match self.lie {
            // Not back from where it was just asked.
            SceneLie::SeesOneWay => {
                let asked = self.asked.lock().unwrap().replace([a.position, b.position]);
                visible && asked != Some([b.position, a.position])
            }
            SceneLie::SeesThroughEverything => true,
            _ => visible,
        }
    }

    fn environment_radiance(&self, direction: Vec3A) -> Rgb {
        let radiance = self.inner.environment_radiance(direction);
        if self.lie == SceneLie::AddsToTheEnvironment { radiance + Rgb::splat(0.1) } else { radiance }
    }
}

/// The first vertex that a ray through the middle of the sensor hits.
pub(crate) fn middle<S: Scene>(scene: &S) -> S::Vertex<'_> {
    use scene_core::Sensor;
    let raster = scene.sensor().resolution().map(|n| 0.5 * n as f32);
    scene.intersect(&scene.sensor().sample_ray(raster, [0.5; 2]).ray).unwrap()
}
