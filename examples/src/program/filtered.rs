//! `lichtwerk render --filter psf`: estimators whose paths are filtered.

use std::path::Path;

use qmc_sampling::SamplerFamily;
use scene_core::film::{Attribute, LayeredImage, SAMPLES_PER_PIXEL};
use scene_core::{ReferenceScene, Scene, Sensor};

use super::Failure;
use super::attributes::{PATH_FILTER, attributes, difference};
use super::finish::{Finish, Run};
use super::render::{EstimatorName, RenderSettings};
use crate::estimators::{LightEstimator, NoLightPaths};
use crate::filtering::{AnyFilter, Filtered, Observable, Tracing};
use crate::filters::{FilterError, FilterSettings, PathFilterName};
use crate::render::{CameraPass, Observe, RenderError, Rendering};

/// Refuses what does not go together with a filter.
pub(super) fn check(settings: &RenderSettings) -> Result<(), FilterError> {
    match settings.estimator {
        EstimatorName::Ao if settings.filtering.filter_extra > 0 => {
            Err(FilterError::Setting("--filter-extra samples see light, which ao does not"))
        }
        EstimatorName::RobustIgi | EstimatorName::InstantRadiosity if settings.light_paths.gather > 0 => {
            Err(FilterError::Setting("--filter psf averages paths, and --gather splits them: use one of both"))
        }
        EstimatorName::RobustIgi | EstimatorName::InstantRadiosity if settings.photons.caustics => {
            Err(FilterError::Estimator)
        }
        _ => Ok(()),
    }
}

/// The filter, and how many samples per pixel of an image by this sensor are averaged together.
pub(super) fn filter_and_batch(
    name: PathFilterName,
    filtering: &FilterSettings,
    sensor: &impl Sensor,
) -> Result<(AnyFilter, u64), FilterError> {
    let filter = filtering.filter(name, sensor)?;
    let [width, height] = sensor.resolution();
    let batch = filtering.batch(&filter, u64::from(width) * u64::from(height));
    Ok((filter, batch))
}

impl Finish for PathFilterName {
    /// Filters it.
    fn observable<S: Scene + Sync, F: SamplerFamily>(
        &self,
        run: &Run<'_, S, F>,
        camera: &(impl CameraPass + Observable),
        observe: Observe<'_>,
    ) -> Result<Rendering, RenderError> {
        let (settings, sensor) = (run.settings, run.scene.sensor());
        let filtering = settings.path_filtering();
        let (filter, batch) = filter_and_batch(*self, &filtering, sensor)?;
        let first = settings.first;
        if !first.is_multiple_of(batch) {
            return Err(FilterError::Continue { first, batch }.into());
        }
        let selection = filtering.selection()?;
        let tracing = Tracing { estimator: camera, selection, point_lights: filtering.filter_visibility, time: 0.0 };
        let (extra, max_depth) = (filtering.filter_extra, settings.longest());
        let camera = Filtered { extra, max_depth, ..Filtered::new(tracing, filter, batch) };
        run.render(&camera, None::<&NoLightPaths>, observe)
    }

    fn other<S: Scene + Sync, F: SamplerFamily>(
        &self,
        _: &Run<'_, S, F>,
        _: &impl CameraPass,
        _: Option<&impl LightEstimator>,
        _: Observe<'_>,
    ) -> Result<Rendering, RenderError> {
        Err(FilterError::Estimator.into())
    }
}

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
    if settings.path_filter.is_none() {
        return Err(refuse("--continue goes with --filter psf or psf-hash".to_owned()));
    }
    let (now, then) = (attributes(scene, settings), |key: &str| image.attribute(key).map(ToString::to_string));
    if let Some((key, [then, now])) = difference(then, |key| now.get(key).cloned(), &["renderer"]) {
        return Err(refuse(format!("its {key} is '{then}', not '{now}'")));
    }
    // Without these nobody knows which samples it has.
    if let Some(key) = ["sampler", "seed", PATH_FILTER].iter().find(|key| image.attribute(key).is_none()) {
        return Err(refuse(format!("it does not tell its {key}")));
    }
    let done = image.attribute(SAMPLES_PER_PIXEL).and_then(Attribute::as_u64);
    Ok((done.ok_or_else(|| refuse("it does not tell its samples per pixel".to_owned()))?, image))
}
