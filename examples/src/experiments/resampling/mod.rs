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

use qmc_sampling::{Independent, Sampler, SamplerFamily};
use rayon::prelude::*;
use ris::{Budget, RatioMap, Source, Target, VarianceModel};
use scene_core::texture::{ColorSpace, Image};
use scene_core::{Scene, Sensor, Spectrum, Vertex, builtin};

use super::claims::{at_least, at_most, equals, reported};
use super::setup::asset_file;
use super::{Context, Ratio, Setup};
use crate::choices::{AnyChoice, LightSelection};
use crate::estimators::{DirectLight, EnvironmentSampling, ResampledDirect, SourceMix};
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

fn with_budget(resampling: &ResamplingSettings, budget: Budget) -> ResamplingSettings {
    let (candidates, samples) = (budget.candidates() as f32, budget.samples() as f32);
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

/// Resampled direct light.
type Direct<'a> = ResampledDirect<'a, AnyChoice>;

/// The model of each pixel's luminance by `direct`, from `count` candidates that `drawn` draws at what the ray through the pixel's centre hits. No traced
/// directions may be among them, unless the two are the same.
fn models(setup: &Setup, direct: &Direct<'_>, drawn: &Direct<'_>, samplers: &Independent, count: u32) -> RatioMap<1> {
    let [width, height] = setup.scene.sensor().resolution();
    let scene = &setup.scene;
    let model = |pixel: u32| {
        let mut model = VarianceModel::<1>::new();
        let (x, y) = (pixel % width, pixel / width);
        let ray = scene.sensor().sample_ray([x as f32 + 0.5, y as f32 + 0.5], [0.5; 2]).ray;
        let Some(vertex) = scene.intersect(&ray).filter(Vertex::is_connectible) else { return model };
        let (source, drawn) = (direct.source(scene, &vertex), drawn.source(scene, &vertex));
        let target = direct.target(scene, &vertex);
        let mut sampler = samplers.sampler(u64::from(pixel), 0);
        for _ in 0..count {
            match drawn.propose(&mut || sampler.next_1d()) {
                Some(proposal) => {
                    let candidate = proposal.sample;
                    let value = candidate.value(&vertex);
                    let is_seen = !value.is_black() && candidate.is_visible(scene, &vertex);
                    let f = if is_seen { value.luminance() } else { 0.0 };
                    let density = source.density_of_other(&candidate);
                    model.add_drawn([f], target.score(&candidate), density, proposal.density);
                }
                None => model.add_nothing(),
            }
        }
        model
    };
    let all: Vec<_> = (0..width * height).into_par_iter().map(model).collect();
    let mut map = RatioMap::new(width as usize, height as usize);
    for (pixel, model) in all.iter().enumerate() {
        if let Some(place) = map.pixel_mut(pixel % width as usize, pixel / width as usize) {
            *place = *model;
        }
    }
    map
}

/// The variance of each pixel that its model predicts.
fn predicted(map: &RatioMap<1>, budget: Budget) -> Vec<f64> {
    let [width, height] = map.size();
    let of_pixel = |pixel: usize| {
        let [variance] = map.pooled(pixel % width, pixel / width, 0).predict(budget);
        if variance.is_nan() { 0.0 } else { variance }
    };
    (0..width * height).map(of_pixel).collect()
}

/// The blob under a photographed sky, if the image is there.
fn blob_hdr(context: &Context, size: [u32; 2]) -> Result<Option<Setup>, Failure> {
    let Some(path) = asset_file("env/spiaggia_di_mondello_1k.hdr") else { return Ok(None) };
    let image = Arc::new(Image::open(&path, ColorSpace::Linear)?);
    Setup::of(context, builtin::blob_under(image, 1.0, 90.0), size).map(Some)
}

/// `1 - ratio`, with its interval.
fn reduction(ratio: Ratio) -> Ratio {
    Ratio { value: 1.0 - ratio.value, ci95: [1.0 - ratio.ci95[1], 1.0 - ratio.ci95[0]] }
}
