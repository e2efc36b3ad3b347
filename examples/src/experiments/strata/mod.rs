//! The strata of robust instant global illumination: figures 2 to 5 of Kollig and Keller 2004.

mod eye_paths;
mod single_light;
mod weight_maps;

use std::ops::ControlFlow;

use qmc_sampling::{OwenSobol, Replications};
use scene_core::film::LayeredImage;

use super::{Context, Report, Row, Setup};
use crate::estimators::NoLightPaths;
use crate::program::Failure;
use crate::render::{Budget, CameraPass, Job, Rendering};

/// Weights per partition, weight maps per heuristic, lengths of eye paths, and what each stratum contributes.
pub(super) fn measure(context: &Context) -> Result<Report, Failure> {
    let mut report = context.report();
    single_light::measure(context, &mut report)?;
    weight_maps::measure(context, &mut report)?;
    eye_paths::measure(context, &mut report)?;
    Ok(report)
}

/// Renders with an estimator that the program does not offer.
fn render(setup: &Setup, camera: &impl CameraPass, samples: u64, seed: u64) -> Result<Rendering, Failure> {
    let job = Job {
        scene: &setup.scene,
        samplers: &OwenSobol::new(seed),
        camera,
        light: None::<&NoLightPaths>,
        filter: setup.settings.filter,
        first: 0,
        budget: Budget::Samples(samples),
        threads: setup.settings.threads,
    };
    Ok(job.render(&mut |_| ControlFlow::Continue(()))?)
}

/// What the renderings of a row cost, and their means.
#[derive(Clone, Copy, Debug, Default)]
struct Cost {
    seconds: Replications,
    rays: Replications,
}

impl Cost {
    fn push(&mut self, rendering: &Rendering) {
        self.seconds.push(rendering.seconds);
        self.rays.push(rendering.rays.total() as f64);
    }

    fn fill(&self, row: Row) -> Row {
        Row { seconds: self.seconds.mean(), rays: self.rays.mean().round() as u64, ..row }
    }
}

/// The mean of the image over pixels and channels.
fn mean(image: &LayeredImage) -> Result<f64, Failure> {
    let pixels = image.rgb()?;
    Ok(pixels.iter().flatten().map(|&value| f64::from(value)).sum::<f64>() / (3 * pixels.len()).max(1) as f64)
}

/// The mean of several, with its 95 % interval.
fn interval(values: &Replications) -> (f64, [f64; 2]) {
    (values.mean(), values.confidence_interval(0.95))
}
