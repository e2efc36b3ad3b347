//! Places that the camera sees, and the indirect light that they scatter.

use photon_map::{DensityEstimation, Gather, Kernel, PhotonMap, Scratch};
use qmc_sampling::{Independent, Replications, Sampler, SamplerFamily};
use rayon::prelude::*;
use scene_core::{ReferenceScene, Scene, Sensor, Spectrum, TransportMode, Vertex};
use std::time::Instant;

use super::limits;
use crate::estimators::{CameraEstimator, FirstEvent, OwnSampling, PathTracer, PhotonView};
use crate::experiments::Setup;
use crate::program::Failure;
use crate::resampling::{Candidates, ResamplingSettings};

/// A diffuse place that the ray through the centre of a pixel hits, with the luminance of the indirect light that it
/// scatters.
pub(super) struct Place<'s> {
    vertex: <ReferenceScene as Scene>::Vertex<'s>,
    truth: f64,
    /// Variance of the truth.
    variance: f64,
}

/// The places of a scene.
pub(super) struct Places<'s> {
    all: Vec<Place<'s>>,
    /// What is added to squares of the truth, so that dark places do not decide alone.
    epsilon: f64,
    /// Between these coordinates lie 96 percent of the places, along x and z.
    pub(super) seen: [[f32; 2]; 2],
}

/// What a map says of the places, with a fixed radius.
pub(super) struct Look {
    pub(super) values: Vec<f64>,
    /// Relative mean squared error.
    pub(super) error: f64,
    /// Seconds per query, on one thread.
    pub(super) seconds: f64,
    /// Photons within the radius, mean.
    pub(super) photons: f64,
}

impl<'s> Places<'s> {
    /// Path tracing with this number of paths per place, direct light by resampling.
    pub(super) fn new(setup: &'s Setup, paths: u64, seed: u64) -> Result<Self, Failure> {
        let (scene, samplers) = (&setup.scene, Independent::new(seed));
        let resampling = ResamplingSettings { candidates: Candidates::Count(12.0), ..ResamplingSettings::default() };
        let tracer = PathTracer {
            direct: resampling.resampled(scene, &samplers, None)?,
            scattering: OwnSampling,
            max_depth: limits().max_depth,
            roulette: limits().roulette,
            first_event: FirstEvent::Any,
        };
        let [width, height] = scene.sensor().resolution();
        let place = |pixel: u32| {
            let raster = [(pixel % width) as f32 + 0.5, (pixel / width) as f32 + 0.5];
            let ray = scene.sensor().sample_ray(raster, [0.5; 2]).ray;
            let vertex = scene.intersect(&ray).filter(|x| x.lambertian().is_some() && x.emitter().is_none())?;
            let mut moments = Replications::new();
            for path in 0..paths {
                let mut sampler = samplers.sampler(u64::from(pixel), path);
                moments.push(f64::from(indirect(scene, &tracer, &vertex, &mut sampler)));
            }
            let variance = moments.variance() / paths as f64;
            Some(Place { vertex, truth: moments.mean(), variance })
        };
        let all: Vec<Place<'s>> = (0..width * height).into_par_iter().filter_map(place).collect();
        if all.is_empty() {
            return Err("the camera sees no diffuse surface".into());
        }
        let mean = all.iter().map(|place| place.truth).sum::<f64>() / all.len() as f64;
        let seen = [0, 2].map(|axis| {
            let mut along: Vec<f32> = all.iter().map(|place| place.vertex.point().position[axis]).collect();
            along.sort_unstable_by(f32::total_cmp);
            [along[along.len() / 50], along[along.len() - 1 - along.len() / 50]]
        });
        Ok(Self { all, epsilon: (0.1 * mean).powi(2), seen })
    }

    /// Looks at a map with a fixed radius.
    pub(super) fn look(&self, map: &PhotonMap<[f32; 3]>, radius: f32) -> Result<Look, Failure> {
        let estimation = DensityEstimation { gather: Gather::within(radius)?, kernel: Kernel::Epanechnikov };
        let view = PhotonView { map: map.clone(), estimation };
        let (mut scratch, start) = (Scratch::default(), Instant::now());
        let value = |place: &Place<'_>| view.radiance(&place.vertex, u32::MAX, &mut scratch, |_| true).luminance();
        let values: Vec<f64> = self.all.iter().map(value).map(f64::from).collect();
        let seconds = start.elapsed().as_secs_f64() / values.len() as f64;
        let photons = self.all.iter().map(|place| {
            let (position, normal) = (place.vertex.point().position, place.vertex.point().normal);
            let at = photon_map::GatherPoint::on(position.to_array(), normal.to_array());
            map.collect(radius, &at, |_| 0.0_f32).0 as f64
        });
        let photons = photons.sum::<f64>() / values.len() as f64;
        Ok(Look { error: self.error(&values), values, seconds, photons })
    }

    /// The error of values, without the noise of the truth: unbiased.
    fn error(&self, values: &[f64]) -> f64 {
        let relative = |(place, value): (&Place<'_>, &f64)| {
            ((value - place.truth).powi(2) - place.variance) / (place.truth.powi(2) + self.epsilon)
        };
        self.all.iter().zip(values).map(relative).sum::<f64>() / values.len() as f64
    }

    /// Relative mean squared error of the truth itself.
    pub(super) fn noise(&self) -> f64 {
        let relative = |place: &Place<'_>| place.variance / (place.truth.powi(2) + self.epsilon);
        self.all.iter().map(relative).sum::<f64>() / self.all.len() as f64
    }

    /// The share of points that lie in the box of what is seen.
    pub(super) fn share(&self, points: impl ExactSizeIterator<Item = [f32; 3]>) -> f64 {
        let (count, [x, z]) = (points.len().max(1) as f64, self.seen);
        let inside = |p: &[f32; 3]| (x[0]..=x[1]).contains(&p[0]) && (z[0]..=z[1]).contains(&p[2]);
        points.filter(inside).count() as f64 / count
    }
}

/// One sample of the indirect light that a place scatters.
fn indirect<S: Scene>(
    scene: &S,
    tracer: &impl CameraEstimator,
    vertex: &S::Vertex<'_>,
    sampler: &mut impl Sampler,
) -> f32 {
    let (lobe, [u, v]) = (sampler.next_1d(), sampler.next_2d());
    let Some(sample) = vertex.sample([lobe, u, v], TransportMode::Radiance) else { return 0.0 };
    let ray = vertex.spawn_ray(sample.wi);
    // What the ray hits emits direct light.
    let Some(hit) = scene.intersect(&ray) else { return 0.0 };
    let arriving = tracer.radiance(scene, ray, sampler).0 - hit.emitted();
    (sample.throughput * arriving).luminance()
}
