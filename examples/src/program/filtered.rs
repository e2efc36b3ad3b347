//! `lichtwerk render --filter psf`: estimators whose paths are filtered.

use std::ops::ControlFlow;
use std::path::Path;

use clap::ValueEnum;
use scene_core::film::{Attribute, LayeredImage, SAMPLES_PER_PIXEL};

use scene_core::{ReferenceScene, RussianRoulette, Scene, Sensor};
use vpl_gi::{LightTracing, Residual, RobustIgi};

use super::Failure;
use super::render::{EstimatorName, RenderSettings, light_photons};
use crate::choices::AnyChoice;
use crate::estimators::{AmbientOcclusion, FirstEvent, NoLightPaths, PathTracer, VirtualLights};
use crate::filtering::{Filtered, Observable, Tracing};
use crate::filters::{FilterError, FilterSettings, PathFilterName};
use crate::photons::PathLimits;
use crate::render::{Job, Progress, RenderError, Rendering, Shared};
use crate::resampling::AnyDirect;
use crate::samplers::AnyFamily;

/// Renders with the estimator that the settings name, and filters it.
pub(super) fn estimate<S: Scene + Sync>(
    scene: &S,
    settings: &RenderSettings,
    name: PathFilterName,
    samplers: &AnyFamily,
    observe: impl FnMut(Progress<'_>) -> ControlFlow<()> + Send,
) -> Result<Rendering, RenderError> {
    let choice = AnyChoice::new(settings.lights, scene.emitters());
    let roulette = RussianRoulette::PathThroughput { from_length: settings.rr_depth.saturating_sub(1) };
    let limits = PathLimits { max_depth: settings.max_depth, roulette };
    let mut run = Run { scene, settings, name, samplers, max_depth: settings.max_depth, as_stored: false };
    match settings.estimator {
        EstimatorName::Path | EstimatorName::Direct => {
            let direct_only = settings.estimator == EstimatorName::Direct;
            let resampling = settings.direct_settings();
            let probes = resampling.probes(scene);
            let resampled = resampling.resampled(scene, samplers, probes.as_ref())?;
            let photons = light_photons(scene, samplers, settings)?;
            let camera = PathTracer {
                direct: match &photons {
                    Some(photons) => AnyDirect::Photons(photons),
                    None => resampling.direct(settings.heuristic, choice, resampled),
                },
                scattering: resampling.scattering(scene),
                max_depth: if direct_only { settings.max_depth.min(2) } else { settings.max_depth },
                roulette,
                first_event: FirstEvent::Any,
            };
            run.max_depth = camera.max_depth;
            run.render(&camera, observe)
        }
        EstimatorName::Ao if settings.filtering.filter_extra > 0 => {
            Err(FilterError::Setting("--filter-extra samples see light, which ao does not").into())
        }
        EstimatorName::Ao => {
            // Occlusion has no colour.
            run.as_stored = true;
            run.render(&AmbientOcclusion { distance: settings.ao_distance }, observe)
        }
        EstimatorName::PhotonMap => {
            let resampling = settings.direct_settings();
            let probes = resampling.probes(scene);
            let resampled = resampling.resampled(scene, samplers, probes.as_ref())?;
            let direct = resampling.direct(settings.heuristic, choice.clone(), resampled);
            run.render(&settings.photons.mapping(scene, direct, choice, limits)?, observe)
        }
        EstimatorName::RobustIgi | EstimatorName::InstantRadiosity if settings.light_paths.gather > 0 => {
            Err(FilterError::Setting("--filter psf averages paths, and --gather splits them: use one of both").into())
        }
        EstimatorName::RobustIgi | EstimatorName::InstantRadiosity if !settings.photons.caustics => {
            let drops = settings.estimator == EstimatorName::InstantRadiosity;
            let eye = settings.light_paths.robust(scene, if drops { Residual::Drop } else { Residual::Scatter })?;
            let eye = RobustIgi { max_depth: settings.max_depth, roulette, ..eye };
            let light = LightTracing {
                choice,
                max_length: settings.max_depth.saturating_sub(2),
                roulette: RussianRoulette::LocalAlbedo { from_length: 0 },
            };
            let estimator = VirtualLights { eye, light, paths: settings.light_paths.light_paths, caustics: None };
            run.render(&Shared { estimator, sharing: settings.light_paths.sharing() }, observe)
        }
        _ => Err(FilterError::Estimator.into()),
    }
}

/// Name of the attribute that tells the filter.
pub(super) const PATH_FILTER: &str = "pathFilter";

/// The filter and its settings, to be compared.
pub(super) fn describe(name: PathFilterName, filtering: &FilterSettings) -> String {
    format!("{name:?} {filtering:?}")
}

/// An image that is to be continued, and how many samples per pixel it has.
pub(super) fn earlier(
    path: &Path,
    scene: &ReferenceScene,
    settings: &RenderSettings,
) -> Result<(u64, LayeredImage), Failure> {
    let image = LayeredImage::read_exr(path).map_err(|error| format!("{}: {error}", path.display()))?;
    let refuse = |what: String| Failure::from(format!("{} cannot be continued: {what}", path.display()));
    let [width, height] = scene.sensor().resolution();
    if [image.width(), image.height()] != [width, height] {
        return Err(refuse(format!("it has {} x {} pixels, not {width} x {height}", image.width(), image.height())));
    }
    let name = |value: Option<clap::builder::PossibleValue>| value.map(|v| v.get_name().to_owned()).unwrap_or_default();
    let Some(filter) = settings.path_filter else {
        return Err(refuse("--continue goes with --filter psf or psf-hash".to_owned()));
    };
    let same = [
        (PATH_FILTER, describe(filter, &settings.filtering)),
        ("maxDepth", settings.max_depth_text()),
        ("scene", scene.name().to_owned()),
        ("estimator", name(settings.estimator.to_possible_value())),
        ("sampler", name(settings.sampler.to_possible_value())),
        ("seed", settings.seed.to_string()),
    ];
    for (key, now) in same {
        let then = image.attribute(key).map(ToString::to_string).unwrap_or_default();
        if then != now {
            return Err(refuse(format!("its {key} is '{then}', not '{now}'")));
        }
    }
    let done = image.attribute(SAMPLES_PER_PIXEL).and_then(Attribute::as_u64);
    Ok((done.ok_or_else(|| refuse("it does not tell its samples per pixel".to_owned()))?, image))
}

/// What all estimators have in common.
struct Run<'a, S> {
    scene: &'a S,
    settings: &'a RenderSettings,
    name: PathFilterName,
    samplers: &'a AnyFamily,
    /// Segments of the estimator's paths at most.
    max_depth: u32,
    /// Whether contributions have no colour to be taken out.
    as_stored: bool,
}

impl<S: Scene + Sync> Run<'_, S> {
    fn render(
        &self,
        estimator: &impl Observable,
        observe: impl FnMut(Progress<'_>) -> ControlFlow<()> + Send,
    ) -> Result<Rendering, RenderError> {
        let Self { scene, settings, name, samplers, max_depth, as_stored } = *self;
        let mut filtering = settings.filtering.clone();
        filtering.filter_as_stored |= as_stored;
        let filter = filtering.filter(name, scene.sensor())?;
        let [width, height] = scene.sensor().resolution();
        let batch = filtering.batch(&filter, u64::from(width) * u64::from(height));
        let done = settings.done;
        if !done.is_multiple_of(batch) {
            return Err(FilterError::Continue { done, batch }.into());
        }
        let selection = filtering.selection()?;
        let tracing = Tracing { estimator, selection, point_lights: filtering.filter_visibility, time: 0.0 };
        let camera =
            Filtered { done, extra: filtering.filter_extra, max_depth, ..Filtered::new(tracing, filter, batch) };
        let (budget, threads) = (settings.budget, settings.threads);
        Job { scene, samplers, camera: &camera, light: None::<&NoLightPaths>, filter: settings.filter, budget, threads }
            .render(observe)
    }
}
