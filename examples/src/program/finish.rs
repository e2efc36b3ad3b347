//! What becomes of the estimator that the settings name.

use qmc_sampling::SamplerFamily;
use scene_core::Scene;

use super::render::RenderSettings;
use crate::estimators::{LightEstimator, NoLightPaths};
use crate::filtering::Observable;
use crate::render::{CameraPass, Job, Observe, RenderError, Rendering};

/// A scene that is to be rendered.
pub(super) struct Run<'a, S, F> {
    pub(super) scene: &'a S,
    pub(super) samplers: &'a F,
    pub(super) settings: &'a RenderSettings,
}

impl<S: Scene + Sync, F: SamplerFamily> Run<'_, S, F> {
    /// Renders it.
    pub(super) fn render(
        &self,
        camera: &impl CameraPass,
        light: Option<&impl LightEstimator>,
        observe: Observe<'_>,
    ) -> Result<Rendering, RenderError> {
        let (scene, samplers) = (self.scene, self.samplers);
        let RenderSettings { filter, budget, first, threads, .. } = *self.settings;
        Job { scene, samplers, camera, light, filter, budget, first, threads }.render(observe)
    }
}

/// What to do with an estimator.
pub(super) trait Finish {
    /// With one whose paths can be looked at.
    fn observable<S: Scene + Sync, F: SamplerFamily>(
        &self,
        run: &Run<'_, S, F>,
        camera: &(impl CameraPass + Observable),
        observe: Observe<'_>,
    ) -> Result<Rendering, RenderError>;

    /// With any other.
    fn other<S: Scene + Sync, F: SamplerFamily>(
        &self,
        run: &Run<'_, S, F>,
        camera: &impl CameraPass,
        light: Option<&impl LightEstimator>,
        observe: Observe<'_>,
    ) -> Result<Rendering, RenderError>;
}

/// Render it.
pub(super) struct Plain;

impl Finish for Plain {
    fn observable<S: Scene + Sync, F: SamplerFamily>(
        &self,
        run: &Run<'_, S, F>,
        camera: &(impl CameraPass + Observable),
        observe: Observe<'_>,
    ) -> Result<Rendering, RenderError> {
        run.render(camera, None::<&NoLightPaths>, observe)
    }

    fn other<S: Scene + Sync, F: SamplerFamily>(
        &self,
        run: &Run<'_, S, F>,
        camera: &impl CameraPass,
        light: Option<&impl LightEstimator>,
        observe: Observe<'_>,
    ) -> Result<Rendering, RenderError> {
        run.render(camera, light, observe)
    }
}
