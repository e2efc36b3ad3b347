//! Caustics for estimators that cannot find them.

use core::ops::Range;

use photon_map::{CausticRule, KeepAll, Kernel, MapPartition, PhotonMaps, ProgressiveRadius, Scratch};
use qmc_sampling::SamplerFamily;
use scene_core::film::{Film, FilmError};
use scene_core::{EmitterChoice, Scene, Vertex};
use vpl_gi::CausticMap;

use super::progressive::{radius_of, within};
use super::{PhotonTracing, PhotonView, Sharpness, Storing};
use crate::estimators::VirtualLights;
use crate::render::{CameraPass, PassContext, PassCounts, Shared};

/// A caustic photon map for `vpl-gi`: photons whose last bounce was a Dirac delta, and no others, wherever eye paths
/// are connected.
///
/// **Biased** by its radius. Knows no `max_depth` but that of its light paths.
#[derive(Clone, Debug)]
pub struct PhotonCaustics(pub PhotonView);

impl<X: Vertex> CausticMap<X> for PhotonCaustics {
    fn radiance(&self, x: &X) -> X::Spectrum {
        if !x.is_connectible() {
            return <X::Spectrum as scene_core::Spectrum>::ZERO;
        }
        self.0.radiance(x, u32::MAX, &mut Scratch::default(), |_| true)
    }
}

/// Robust instant global illumination with a caustic map, one for each pass over the image, of a radius that shrinks
/// from pass to pass.
///
/// **Consistent**, as [`ProgressivePhotons`](super::ProgressivePhotons), up to `max_depth`, which light and eye paths
/// obey separately.
///
/// Source: Kollig and Keller 2004, section 4.2: "some caustic paths cannot be captured efficiently by any path tracing
/// algorithm, however, these easily are complemented by a caustic photon map".
#[derive(Clone, Copy, Debug)]
pub struct WithCaustics<C> {
    /// What is complemented; its own field for caustics is not looked at.
    pub camera: Shared<VirtualLights<'static, C>>,
    /// The light paths.
    pub light: PhotonTracing<C>,
    /// Their number in each pass.
    pub paths: u64,
    /// The first radius.
    pub radius: ProgressiveRadius,
    /// How photons at a distance count.
    pub kernel: Kernel,
}

impl<C: EmitterChoice + Clone + Sync> CameraPass for WithCaustics<C> {
    fn add_samples<S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'_, S, F>,
        film: &mut Film,
        samples: Range<u64>,
    ) -> Result<PassCounts, FilmError> {
        let partition = MapPartition::one_number(1.0).expect("a ratio of one");
        let storing = Storing { partition, deposition: KeepAll, primary: false, global: false };
        // Dirac deltas alone: for everything else there are connections.
        let light = PhotonTracing { sharpness: Sharpness { rule: CausticRule::SPECULAR }, ..self.light.clone() };
        let VirtualLights { eye, light: virtual_light, paths, .. } = self.camera.estimator.clone();
        let mut counts = PassCounts::default();
        for index in samples {
            let mut photons = PhotonMaps::new();
            let first = index * self.paths;
            counts.rays += storing.trace(context, &light, first, first..first + self.paths, &mut photons);
            photons.add_paths(&partition, self.paths);
            let estimation = within(radius_of(self.radius, index), self.kernel);
            let map = PhotonCaustics(PhotonView::new(photons.caustic, estimation));
            let estimator = VirtualLights { eye, light: virtual_light.clone(), paths, caustics: Some(&map) };
            let pass =
                Shared { estimator, sharing: self.camera.sharing }.add_samples(context, film, index..index + 1)?;
            counts.rays += pass.rays;
            counts.light_paths += pass.light_paths;
        }
        Ok(counts)
    }
}
