//! Sensors that lie.

use std::sync::Arc;

use scene_core::glam::Vec3A;
use scene_core::{ReferenceScene, Scene, Sensor, SensorConnection, SensorRay};

/// What a sensor says wrongly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum SensorLie {
    Nothing,
    NoPixels,
    LongDirections,
    NoWeight,
    Blind,
    ShiftsTheRaster,
    ShiftsTheLens,
    LooksAway,
    SameDirection,
    WeightOfConnections,
    Density,
    DensityOnTheLens,
    DensityOffTheFilm,
    SeesBehind,
}

use SensorLie as Lie;

pub(crate) struct LiarSensor {
    pub scene: Arc<ReferenceScene>,
    pub lie: Lie,
}

impl Sensor for LiarSensor {
    fn resolution(&self) -> [u32; 2] {
        if self.lie == Lie::NoPixels { [64, 0] } else { self.scene.sensor().resolution() }
    }

    fn sample_ray(&self, raster: [f32; 2], u_lens: [f32; 2]) -> SensorRay {
        let mut sampled = self.scene.sensor().sample_ray(raster, u_lens);
        match self.lie {
            Lie::LongDirections => sampled.ray.direction *= 1.01,
            Lie::NoWeight => sampled.weight = 0.0,
            _ => {}
        }
        sampled
    }

    fn connect(&self, from: Vec3A, u_lens: [f32; 2]) -> Option<SensorConnection> {
        let mut found = match self.scene.sensor().connect(from, u_lens) {
            Some(found) => found,
            None if self.lie == Lie::SeesBehind => {
                let origin = self.scene.sensor().sample_ray([0.5; 2], u_lens).ray.origin;
                self.scene.sensor().connect(2.0 * origin - from, u_lens)?
            }
            None => return None,
        };
        match self.lie {
            Lie::Blind => return None,
            Lie::ShiftsTheRaster => found.raster[0] += 0.5,
            Lie::ShiftsTheLens => found.lens.position.x += 0.1 * found.distance,
            Lie::LooksAway => found.lens.normal *= -1.0,
            Lie::SameDirection => found.wi *= -1.0,
            Lie::WeightOfConnections => found.weight *= 1.05,
            _ => {}
        }
        Some(found)
    }

    fn pdf_ray(&self, lens: Vec3A, direction: Vec3A) -> (f32, f32) {
        let (area, angle) = self.scene.sensor().pdf_ray(lens, direction);
        match self.lie {
            Lie::Density => (area, 1.05 * angle),
            Lie::DensityOnTheLens => (1.05 * area, angle),
            Lie::DensityOffTheFilm if angle == 0.0 => (area, 0.1),
            _ => (area, angle),
        }
    }
}
