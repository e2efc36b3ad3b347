//! Stochastic progressive photon mapping.

use core::ops::Range;

use photon_map::{DensityEstimation, Gather, KeepAll, Kernel, MapPartition, PhotonMaps, ProgressiveRadius};
use qmc_sampling::SamplerFamily;
use scene_core::film::{Film, FilmError};
use scene_core::{EmitterChoice, Scene};

use super::{Maps, PhotonEye, PhotonTracing, PhotonView, Storing};
use crate::estimators::DirectLight;
use crate::render::{CameraPass, PassContext, PassCounts};

/// Progressive photon mapping: every pass over the image, one sample per pixel, has photons of its own and a radius
/// that is smaller than the last one's.
///
/// ```text
/// L = 1/n sum over passes i of L_i,   L_i as for PhotonEye with radius r_i
/// r_(i+1)^2 = r_i^2 (i + alpha) / (i + 1)
/// ```
/// **Consistent**: variance falls as `n^-alpha` and bias as `n^(alpha - 1)`, the mean squared error as `n^(-2/3)` with
/// `alpha = 2/3`, where irradiance is smooth. At its edges bias is of first order in the radius, and falls half as fast.
/// Biased after finitely many passes.
///
/// The radius is the same for all pixels and depends on the number of the pass alone: every pass is the same at any
/// number of threads and in any order.
///
/// **Source.** C. Knaus and M. Zwicker, "Progressive Photon Mapping: A Probabilistic Approach", 2011.
#[derive(Clone, Copy, Debug)]
pub struct ProgressivePhotons<D, C> {
    /// The eye paths; without final gathering.
    pub eye: PhotonEye<D>,
    /// The light paths.
    pub light: PhotonTracing<C>,
    /// Their number in each pass.
    pub paths: u64,
    /// The first radius.
    pub radius: ProgressiveRadius,
    /// How photons at a distance count.
    pub kernel: Kernel,
}

/// The radius of pass number `index`, from zero.
pub(super) fn radius_of(first: ProgressiveRadius, index: u64) -> f32 {
    let mut radius = first;
    for _ in 0..index {
        radius.advance();
    }
    radius.radius()
}

/// A fixed radius; beyond what is possible the nearest possible one.
pub(super) fn within(radius: f32, kernel: Kernel) -> DensityEstimation {
    let gather = Gather::within(radius.clamp(1e-15, 1e18));
    DensityEstimation { gather: gather.expect("a radius in range"), kernel }
}

impl<D: DirectLight, C: EmitterChoice + Sync> CameraPass for ProgressivePhotons<D, C> {
    fn add_samples<S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'_, S, F>,
        film: &mut Film,
        samples: Range<u64>,
    ) -> Result<PassCounts, FilmError> {
        // Direct light is found otherwise, and one map is enough for a single radius.
        let partition = MapPartition::one_number(1.0).expect("a ratio of one");
        let storing = Storing { partition, deposition: KeepAll, primary: false, global: true };
        let mut counts = PassCounts::default();
        for index in samples {
            let mut photons = PhotonMaps::new();
            let first = index * self.paths;
            counts.rays += storing.trace(context, &self.light, first, first..first + self.paths, &mut photons);
            let mut all = photons.global;
            all.append(photons.caustic);
            all.add_paths(self.paths);
            let estimation = within(radius_of(self.radius, index), self.kernel);
            let maps = Maps { global: PhotonView::new(all, estimation), caustic: None };
            counts.rays += context.add_all(film, index..index + 1, |scene, scratch, ray, sampler| {
                self.eye.trace(scene, &maps, scratch, ray, sampler, &mut ())
            });
        }
        Ok(counts)
    }
}
