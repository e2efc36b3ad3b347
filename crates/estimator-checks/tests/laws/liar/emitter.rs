//! Emitters that lie.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use scene_core::glam::Vec3A;
use scene_core::reference::ReferenceEmitter;
use scene_core::{DirectSample, EmissionSample, Emitter, ReferenceScene, Rgb, Scene, SurfacePoint};

/// What an emitter says wrongly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum EmitterLie {
    Nothing,
    NegativePower,
    LongDirections,
    NegativeRadiance,
    NoDensityOfSamples,
    SaysDelta,
    StartsNowhere,
    OtherDistance,
    DensityOfDelta,
    DirectDensity,
    DirectRadiance,
    Dice,
    NegativeFlux,
    EmissionDensity,
    Flux,
    DarkHalf,
    DeltaCanBeFound,
    NotLambertian,
    DirectDistribution,
    EmissionDistribution,
    MorePower,
    Positions,
}

use EmitterLie as Lie;

pub(crate) struct LiarEmitter {
    scene: Arc<ReferenceScene>,
    index: usize,
    pub lie: Lie,
    middle: Vec3A,
    calls: AtomicU32,
}

impl LiarEmitter {
    pub(crate) fn new(scene: Arc<ReferenceScene>, index: usize) -> Self {
        let middle = scene.emitters()[index].sample_emission([0.5; 2], [0.5; 2]).unwrap().point.position;
        Self { scene, index, lie: Lie::Nothing, middle, calls: AtomicU32::new(0) }
    }

    fn inner(&self) -> &ReferenceEmitter {
        &self.scene.emitters()[self.index]
    }

    fn is_dark(&self, at: Option<&SurfacePoint>) -> bool {
        self.lie == Lie::DarkHalf && at.is_some_and(|point| point.position.x > self.middle.x)
    }
}

fn skewed(u: [f32; 2]) -> [f32; 2] {
    [u[0].powf(1.3).min(0.999_999), u[1]]
}

impl Emitter for LiarEmitter {
    type Spectrum = Rgb;

    fn power(&self) -> Rgb {
        match self.lie {
            Lie::NegativePower => self.inner().power() * -1.0,
            Lie::MorePower => self.inner().power() * 1.05,
            _ => self.inner().power(),
        }
    }

    fn is_delta(&self) -> bool {
        self.inner().is_delta()
    }

    fn is_infinite(&self) -> bool {
        self.inner().is_infinite()
    }

    fn is_lambertian(&self) -> bool {
        self.inner().is_lambertian()
    }

    fn sample_direct(&self, from: Vec3A, u: [f32; 2]) -> Option<DirectSample<Rgb>> {
        let u = if self.lie == Lie::DirectDistribution { skewed(u) } else { u };
        let mut sample = self.inner().sample_direct(from, u)?;
        let point = sample.at.as_ref().map(|(point, _)| *point);
        if self.is_dark(point.as_ref()) {
            return None;
        }
        match self.lie {
            Lie::LongDirections => sample.wi *= 1.01,
            Lie::NegativeRadiance => sample.radiance = sample.radiance * -1.0,
            Lie::NoDensityOfSamples => sample.pdf_solid_angle = 0.0,
            Lie::SaysDelta => sample.is_delta = true,
            Lie::StartsNowhere => sample.at = None,
            Lie::OtherDistance => sample.at = sample.at.map(|(point, distance)| (point, 1.1 * distance)),
            Lie::DensityOfDelta => sample.pdf_solid_angle = 2.0,
            Lie::DirectRadiance => sample.radiance = sample.radiance * 1.05,
            Lie::NotLambertian => sample.radiance = self.radiance(point.as_ref(), -sample.wi),
            Lie::Dice => sample.pdf_solid_angle *= 1.0 + 1e-6 * self.calls.fetch_add(1, Ordering::Relaxed) as f32,
            _ => {}
        }
        Some(sample)
    }

    fn pdf_direct(&self, from: Vec3A, wi: Vec3A, at: Option<&SurfacePoint>) -> f32 {
        let pdf = self.inner().pdf_direct(from, wi, at);
        match self.lie {
            Lie::DirectDensity => 1.05 * pdf,
            Lie::DeltaCanBeFound => 0.1,
            _ if self.is_dark(at) => 0.0,
            _ => pdf,
        }
    }

    fn sample_emission(&self, u_position: [f32; 2], u_direction: [f32; 2]) -> Option<EmissionSample<Rgb>> {
        let u_position = if self.lie == Lie::Positions { skewed(u_position) } else { u_position };
        let u_direction = if self.lie == Lie::EmissionDistribution { skewed(u_direction) } else { u_direction };
        let mut sample = self.inner().sample_emission(u_position, u_direction)?;
        match self.lie {
            Lie::NegativeFlux => sample.flux = sample.flux * -1.0,
            Lie::Flux => sample.flux = sample.flux * 1.05,
            Lie::NotLambertian => {
                let cosine = sample.point.normal.dot(sample.direction).abs();
                sample.flux = sample.flux * (1.5 * cosine);
            }
            _ => {}
        }
        Some(sample)
    }

    fn pdf_emission(&self, at: Option<&SurfacePoint>, direction: Vec3A) -> (f32, f32) {
        let (area, angle) = self.inner().pdf_emission(at, direction);
        if self.lie == Lie::EmissionDensity { (1.05 * area, angle) } else { (area, angle) }
    }

    fn radiance(&self, at: Option<&SurfacePoint>, direction: Vec3A) -> Rgb {
        let radiance = self.inner().radiance(at, direction);
        let cosine = at.map_or(1.0, |point| point.normal.dot(direction).abs());
        if self.lie == Lie::NotLambertian { radiance * (1.5 * cosine) } else { radiance }
    }
}
