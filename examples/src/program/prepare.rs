//! From the arguments of `render` to a scene and to settings.

use scene_core::film::Filter;
use scene_core::{ReferenceScene, Scene, SceneDescription};

use super::render::{EstimatorName, FilterName, RenderSettings};
use super::{Failure, RenderArguments, load_description, report};
use crate::distributed::Ranks;
use crate::render::Budget;
use crate::samplers::SamplerName;

/// Samples per pixel where neither the user nor the scene asks for a number.
const DEFAULT_SAMPLES: u64 = 64;

/// What a scene asks for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wishes {
    filter: Filter,
    max_depth: Option<u32>,
    samples: Option<u32>,
}

impl RenderArguments {
    /// Loads the scene at the size that is asked for.
    pub(super) fn description(&self) -> Result<SceneDescription, Failure> {
        let mut description = load_description(&self.scene, &self.definitions)?;
        if let Some([width, height]) = self.size {
            (description.camera.width, description.camera.height) = (width, height);
        }
        Ok(description)
    }

    /// Builds the scene, and reports its warnings.
    pub(super) fn build(&self, description: SceneDescription) -> Result<(ReferenceScene, Wishes), Failure> {
        let wishes = Wishes {
            filter: description.filter,
            max_depth: description.max_depth,
            samples: description.samples_per_pixel,
        };
        let scene = ReferenceScene::new(description).map_err(|error| format!("{}: {error}", self.scene))?;
        for warning in scene.warnings() {
            report(&format!("warning: {warning}"));
        }
        Ok((scene, wishes))
    }

    /// Finds out whether the estimator can do anything with the scene.
    pub(super) fn check(&self, scene: &ReferenceScene) -> Result<(), Failure> {
        if scene.emitters().is_empty() && self.estimator != EstimatorName::Ao {
            return Err(format!("{}: the scene has no light, so every pixel would be black", self.scene).into());
        }
        if scene.has_media() && !self.estimator.knows_media() {
            report("warning: this estimator takes participating media for clear; path and direct know them");
        }
        Ok(())
    }

    /// How to render: what is asked for, or else what the scene asks for.
    pub(super) fn settings(&self, scene: &ReferenceScene, wishes: &Wishes) -> Result<RenderSettings, Failure> {
        let (reconstruction, path_filter) = FilterName::sort(&self.filter)?;
        let samples = self.spp.or(wishes.samples.map(u64::from)).unwrap_or(DEFAULT_SAMPLES);
        let settings = RenderSettings {
            estimator: self.estimator,
            heuristic: self.heuristic,
            lights: self.lights,
            // Batches of the filter are contiguous in a sequence through the whole image.
            sampler: self.sampler.unwrap_or(match path_filter {
                Some(_) => SamplerName::GlobalSobol,
                None => SamplerName::default(),
            }),
            budget: self.time.map_or(Budget::Samples(samples), Budget::Seconds),
            seed: self.seed,
            threads: self.threads,
            max_depth: self.max_depth.or(wishes.max_depth).unwrap_or(u32::MAX),
            rr_depth: self.rr_depth,
            filter: reconstruction.unwrap_or(wishes.filter),
            path_filter,
            filtering: self.filtering.clone(),
            first: 0,
            planned: None,
            light_paths: self.light_paths.clone(),
            resampling: self.resampling.clone(),
            light_photons: self.light_photons.clone(),
            photons: self.photons.clone(),
            definitions: self.definitions.clone(),
            ranks: Ranks::default(),
            ao_distance: self.ao_distance.map_or(0.1 * scene.bounding_sphere().1, |d| d as f32),
        };
        if settings.selects_by_photons() && settings.light_photons.other_rays == 0 {
            report(
                "warning: without shadow rays for other lights, light that the photons missed is lost (--other-rays 1 finds it)",
            );
        }
        Ok(settings)
    }
}
