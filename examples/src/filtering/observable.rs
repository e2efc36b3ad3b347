//! Estimators whose paths can be looked at.

use photon_map::Scratch;
use qmc_sampling::{Sampler, SamplerFamily};
use scene_core::{Counting, EmitterChoice, Ray, Scene, Vertex};
use vpl_gi::VirtualPointLights;

use super::Collector;
use crate::estimators::{CameraEstimator, DirectLight, FirstHit, PhotonMapping, VirtualLights};
use crate::render::{PassContext, PassCounts, Shared, Sharing, SharingEstimator};

/// A path from the sensor that is to be traced.
#[derive(Clone, Copy, Debug)]
pub struct EyeRay {
    /// The ray.
    pub ray: Ray,
    /// Column and row of its pixel.
    pub place: [u32; 2],
    /// Number of its sample.
    pub index: u64,
}

/// Estimators that tell a [`Collector`] what they find.
pub trait Observable: Sync {
    /// What the samples of a pass over the image share.
    type Prepared<V: Vertex + Send + Sync>: Send + Sync;

    /// Makes what sample number `index` of all pixels shares.
    fn prepare<'s, S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'s, S, F>,
        index: u64,
    ) -> (Self::Prepared<S::Vertex<'s>>, PassCounts);

    /// Traces a path.
    fn observe<'s, S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'s, S, F>,
        prepared: &Self::Prepared<S::Vertex<'s>>,
        scene: &Counting<'s, S>,
        scratch: &mut Scratch,
        eye: EyeRay,
        sampler: &mut impl Sampler,
        collector: &mut Collector,
    ) -> Option<FirstHit>;
}

impl<E: CameraEstimator> Observable for E {
    type Prepared<V: Vertex + Send + Sync> = ();

    fn prepare<'s, S: Scene + Sync, F: SamplerFamily>(&self, _: &PassContext<'s, S, F>, _: u64) -> ((), PassCounts) {
        ((), PassCounts::default())
    }

    fn observe<'s, S: Scene + Sync, F: SamplerFamily>(
        &self,
        _: &PassContext<'s, S, F>,
        (): &(),
        scene: &Counting<'s, S>,
        _: &mut Scratch,
        eye: EyeRay,
        sampler: &mut impl Sampler,
        collector: &mut Collector,
    ) -> Option<FirstHit> {
        self.trace(scene, eye.ray, sampler, collector).1
    }
}

impl<D: DirectLight, C: EmitterChoice + Clone + Sync> Observable for PhotonMapping<D, C> {
    type Prepared<V: Vertex + Send + Sync> = ();

    fn prepare<'s, S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'s, S, F>,
        _: u64,
    ) -> ((), PassCounts) {
        let (_, rays) = self.maps(context);
        ((), PassCounts { rays, light_paths: 0 })
    }

    fn observe<'s, S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'s, S, F>,
        (): &(),
        scene: &Counting<'s, S>,
        scratch: &mut Scratch,
        eye: EyeRay,
        sampler: &mut impl Sampler,
        collector: &mut Collector,
    ) -> Option<FirstHit> {
        let (maps, _) = self.maps(context);
        self.eye.trace(scene, maps, scratch, eye.ray, sampler, collector).1
    }
}

impl<C: EmitterChoice + Sync> Observable for Shared<VirtualLights<'_, C>> {
    /// The light paths of each pattern; none if every path has its own.
    type Prepared<V: Vertex + Send + Sync> = Vec<VirtualPointLights<V>>;

    fn prepare<'s, S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'s, S, F>,
        index: u64,
    ) -> (Vec<VirtualPointLights<S::Vertex<'s>>>, PassCounts) {
        match self.sharing {
            Sharing::Independent => (Vec::new(), PassCounts::default()),
            Sharing::Interleaved(tile) => {
                let (shared, done) = self.share_patterns(context, index, tile);
                let rays = done.iter().map(|(_, counts)| counts.rays).sum();
                (shared, PassCounts { rays, light_paths: 0 })
            }
        }
    }

    fn observe<'s, S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'s, S, F>,
        prepared: &Vec<VirtualPointLights<S::Vertex<'s>>>,
        scene: &Counting<'s, S>,
        _: &mut Scratch,
        eye: EyeRay,
        sampler: &mut impl Sampler,
        collector: &mut Collector,
    ) -> Option<FirstHit> {
        let own;
        let lights = match self.sharing {
            Sharing::Interleaved(tile) => &prepared[tile.pattern(eye.place) as usize],
            Sharing::Independent => {
                let numbers = self.own_light_paths(context, eye.place, eye.index);
                own = self.estimator.share(scene, numbers, None);
                &own
            }
        };
        self.estimator.trace(scene, lights, eye.ray, sampler, collector).1
    }
}
