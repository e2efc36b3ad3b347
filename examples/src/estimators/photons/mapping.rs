//! Photon mapping with one pair of maps for the whole image.

use core::ops::Range;
use std::sync::OnceLock;

use photon_map::{DensityEstimation, Deposition, KeepAll, MapPartition, PhotonMaps};
use qmc_sampling::SamplerFamily;
use scene_core::film::{Film, FilmError};
use scene_core::{EmitterChoice, RayCounts, Scene};

use super::{GuidanceTracing, ImportonTracing, Maps, PhotonEye, PhotonTracing, PhotonView, Storing};
use crate::distributed::{Ranks, RanksError};
use crate::estimators::DirectLight;
use crate::render::{CameraPass, PassContext, PassCounts};

/// Photon mapping: a global and a caustic map are made once, then eye paths look at them.
///
/// **Biased**, see [`PhotonEye`]; more samples per pixel do not help against it, nor against the noise of the maps.
/// [`ProgressivePhotons`](super::ProgressivePhotons) is consistent.
///
/// **Cost.** The light paths, once; their rays count as rays of the first pass. Several ranks trace a part of them each, see
/// [`prepare`](Self::prepare).
#[derive(Debug)]
pub struct PhotonMapping<D, C> {
    /// The eye paths.
    pub eye: PhotonEye<D>,
    /// The light paths.
    pub light: PhotonTracing<C>,
    /// Their number.
    pub paths: u64,
    /// How photons are shared out between the maps.
    pub partition: MapPartition,
    /// Where photons are kept; everywhere without.
    pub importons: Option<ImportonTracing>,
    /// Where light paths are sent; as emitters and materials have it without.
    pub guidance: Option<GuidanceTracing>,
    /// How the global map is looked at.
    pub global: DensityEstimation,
    /// How the caustic map is looked at.
    pub caustic: DensityEstimation,
    /// The maps, once they are made.
    pub maps: OnceLock<Maps>,
}

impl<D: DirectLight, C: EmitterChoice + Clone + Sync> PhotonMapping<D, C> {
    /// The maps, which are made first if they are not there yet, and the rays that this took.
    pub fn maps<S: Scene + Sync, F: SamplerFamily>(&self, context: &PassContext<'_, S, F>) -> (&Maps, RayCounts) {
        let mut rays = RayCounts::default();
        let maps = self.maps.get_or_init(|| {
            let made = self.make(context, &Ranks::default());
            let (maps, counts) = made.expect("one process waits for no other");
            rays = counts;
            maps
        });
        (maps, rays)
    }

    /// Makes the maps together with all other ranks: each traces a contiguous part of the light paths and of the importons,
    /// and has all photons in the end, in the order of the paths. So the maps are those of one process, bit for bit. Returns
    /// the rays of this rank.
    ///
    /// # Errors
    /// If a rank has failed.
    pub fn prepare<S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'_, S, F>,
        ranks: &Ranks,
    ) -> Result<RayCounts, RanksError> {
        let (maps, rays) = self.make(context, ranks)?;
        // Maps that are there already are the same.
        let _ = self.maps.set(maps);
        Ok(rays)
    }

    fn make<S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'_, S, F>,
        ranks: &Ranks,
    ) -> Result<(Maps, RayCounts), RanksError> {
        let (photons, rays) = match &self.importons {
            Some(importons) => {
                let (deposition, mut rays) = importons.trace(context, ranks)?;
                let (photons, counts) = self.photons(context, deposition, ranks)?;
                rays += counts;
                (photons, rays)
            }
            None => self.photons(context, KeepAll, ranks)?,
        };
        Ok((self.sorted(photons), rays))
    }

    fn photons<S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'_, S, F>,
        deposition: impl Deposition + Sync,
        ranks: &Ranks,
    ) -> Result<(PhotonMaps<[f32; 3]>, RayCounts), RanksError> {
        let storing = Storing { partition: self.partition, deposition, primary: self.eye.gather > 0, global: true };
        let (mut own, paths) = (PhotonMaps::new(), ranks.share(self.paths));
        let rays = match self.guidance {
            Some(guidance) => {
                let (guidance, mut rays) = guidance.trace(context, &self.light.choice, ranks)?;
                rays += storing.trace(context, &self.light.clone().guided(guidance), 0, paths, &mut own);
                rays
            }
            None => storing.trace(context, &self.light, 0, paths, &mut own),
        };
        let mut photons = ranks.gather(own)?;
        photons.add_paths(&self.partition, self.paths);
        Ok((photons, rays))
    }

    /// Maps of photons whose paths were counted.
    fn sorted(&self, photons: PhotonMaps<[f32; 3]>) -> Maps {
        let global = PhotonView::new(photons.global, self.global);
        Maps { global, caustic: Some(PhotonView::new(photons.caustic, self.caustic)) }
    }
}

impl<D: DirectLight, C: EmitterChoice + Clone + Sync> CameraPass for PhotonMapping<D, C> {
    fn add_samples<S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'_, S, F>,
        film: &mut Film,
        samples: Range<u64>,
    ) -> Result<PassCounts, FilmError> {
        let (maps, mut rays) = self.maps(context);
        rays += context.add_all(film, samples, |scene, scratch, ray, sampler| {
            self.eye.trace(scene, maps, scratch, ray, sampler, &mut ())
        });
        Ok(PassCounts { rays, light_paths: 0 })
    }
}
