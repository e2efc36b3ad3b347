//! Figures and claims of Talbot, Cline and Egbert 2005, and reuse between pixels.

mod brdf;
mod density;
mod direct;
mod ratio;
mod reuse;

pub(super) use brdf::measure as brdf;
pub(super) use density::measure as density;
pub(super) use direct::measure as direct;
pub(super) use ratio::measure as ratio;
pub(super) use reuse::measure as reuse;

use std::sync::Arc;

use qmc_sampling::{Independent, Replications, SamplerFamily};
use rayon::prelude::*;
use scene_core::texture::{ColorSpace, Image};
use scene_core::{Scene, Sensor, Spectrum, Vertex, builtin};

use super::setup::asset_file;
use super::{Claim, Context, Ratio, Setup, Trials};
use crate::choices::LightSelection;
use crate::estimators::{DirectLight, EnvironmentSampling, SourceMix};
use crate::program::{EstimatorName, Failure, RenderSettings};
use crate::resampling::{Candidates, DirectName, ResamplingSettings};
use crate::samplers::SamplerName;

/// The paper's own proposals: a light chosen uniformly, the environment one of them and sampled uniformly.
fn papers_proposals() -> ResamplingSettings {
    ResamplingSettings {
        direct: DirectName::Ris,
        candidate_lights: LightSelection::Uniform,
        candidate_mix: SourceMix::LIGHTS,
        environment_candidates: EnvironmentSampling::Uniform,
        ..ResamplingSettings::default()
    }
}

/// Strong proposals: lights by power, the environment by importance, and what scattered rays hit.
fn strong_proposals() -> ResamplingSettings {
    ResamplingSettings {
        direct: DirectName::Ris,
        candidate_mix: SourceMix::new(2.0, 1.0, 1.0).expect("a mixture"),
        ..ResamplingSettings::default()
    }
}

/// Direct light with independent numbers: variances are then those of the theory.
fn direct_light(setup: &Setup, resampling: ResamplingSettings) -> RenderSettings {
    RenderSettings {
        estimator: EstimatorName::Direct,
        sampler: SamplerName::Independent,
        max_depth: 2,
        resampling,
        ..setup.settings.clone()
    }
}

fn with_budget(resampling: &ResamplingSettings, candidates: f32, samples: f32) -> ResamplingSettings {
    ResamplingSettings { candidates: Candidates::Count(candidates), samples, ..resampling.clone() }
}

/// The luminance of direct light at what the ray through the centre of each pixel hits, once: nothing but the direct light varies.
fn at_centres(setup: &Setup, direct: &impl DirectLight, seed: u64) -> Vec<f64> {
    let [width, height] = setup.scene.sensor().resolution();
    let (scene, samplers) = (&setup.scene, Independent::new(seed));
    let value = |pixel: u32| {
        let (x, y) = (pixel % width, pixel / width);
        let ray = scene.sensor().sample_ray([x as f32 + 0.5, y as f32 + 0.5], [0.5; 2]).ray;
        let vertex = scene.intersect(&ray).filter(Vertex::is_connectible);
        let mut sampler = samplers.sampler(u64::from(pixel), 0);
        vertex.map_or(0.0, |vertex| f64::from(direct.sample(scene, &vertex, 1, true, &mut sampler).luminance()))
    };
    (0..width * height).into_par_iter().map(value).collect()
}

/// The blob under a photographed sky, if the image is there.
fn blob_hdr(context: &Context, size: [u32; 2]) -> Result<Option<Setup>, Failure> {
    let Some(path) = asset_file("env/spiaggia_di_mondello_1k.hdr") else { return Ok(None) };
    let image = Arc::new(Image::open(&path, ColorSpace::Linear)?);
    Setup::of(context, builtin::blob_under(image, 1.0, 90.0), size).map(Some)
}

/// Renderings of one setting: error times cost of each trial, in seconds and in rays.
#[derive(Default)]
struct Cost {
    trials: Trials,
    by_seconds: Replications,
    by_rays: Replications,
}

impl Cost {
    /// The measure of error times cost does not depend on the number of samples: variance falls as one over the time.
    fn push(
        &mut self,
        rendering: &crate::render::Rendering,
        reference: &scene_core::film::LayeredImage,
    ) -> Result<(), Failure> {
        let (count, before) = (self.trials.count() as f64, self.trials.relative_mse().mean());
        self.trials.push(rendering, reference)?;
        let total = self.trials.relative_mse().mean() * (count + 1.0);
        let error = if count > 0.0 { total - before * count } else { total };
        self.by_seconds.push(error * rendering.seconds);
        self.by_rays.push(error * rendering.rays.total() as f64);
        Ok(())
    }
}

/// `1 - ratio`, with its interval.
fn reduction(ratio: Ratio) -> Ratio {
    Ratio { value: 1.0 - ratio.value, ci95: [1.0 - ratio.ci95[1], 1.0 - ratio.ci95[0]] }
}

fn at_least(id: String, ratio: Ratio, limit: f64) -> Claim {
    let holds = ratio.value >= limit;
    Claim { id, paper: format!(">= {limit}"), measured: ratio.value, ci95: ratio.ci95, holds }
}

fn at_most(id: String, ratio: Ratio, limit: f64) -> Claim {
    let holds = ratio.value <= limit;
    Claim { id, paper: format!("<= {limit}"), measured: ratio.value, ci95: ratio.ci95, holds }
}

/// A claim without a limit: reported as it is.
fn reported(id: String, ratio: Ratio) -> Claim {
    Claim { id, paper: "-".to_owned(), measured: ratio.value, ci95: ratio.ci95, holds: true }
}
