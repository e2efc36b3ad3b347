//! Virtual point lights: robust instant global illumination, and instant radiosity.

use qmc_sampling::Sampler;
use scene_core::{EmitterChoice, Ray, ScatterSample, Scene, Vertex};
use vpl_gi::{CausticMap, Found, LightTracing, Observer, RobustIgi, VirtualPointLights};

use super::{FirstHit, PhotonCaustics};
use crate::render::SharingEstimator;

/// [`RobustIgi`] with light paths that samples share.
///
/// With threshold infinity and the residual dropped or not it is instant radiosity.
#[derive(Clone, Copy, Debug)]
pub struct VirtualLights<'a, C> {
    /// The eye paths.
    pub eye: RobustIgi,
    /// The light paths.
    pub light: LightTracing<C>,
    /// Number of light paths that a sample sees.
    pub paths: u32,
    /// Caustics, if rays do not look for them.
    pub caustics: Option<&'a PhotonCaustics>,
}

impl<C: EmitterChoice + Sync> SharingEstimator for VirtualLights<'_, C> {
    type Shared<V: Vertex + Send + Sync> = VirtualPointLights<V>;

    fn paths(&self) -> u32 {
        self.paths
    }

    fn share<'s, S: Scene, R: Sampler>(
        &self,
        scene: &'s S,
        sampler: impl FnMut(u32) -> R,
        used: Option<VirtualPointLights<S::Vertex<'s>>>,
    ) -> VirtualPointLights<S::Vertex<'s>> {
        let mut lights = used.unwrap_or_default();
        lights.retrace(scene, &self.light, self.paths, sampler);
        lights
    }

    fn radiance<S, V>(
        &self,
        scene: &S,
        lights: &VirtualPointLights<V>,
        ray: Ray,
        sampler: &mut impl Sampler,
    ) -> (S::Spectrum, Option<FirstHit>)
    where
        S: Scene,
        V: Vertex<Spectrum = S::Spectrum> + Send + Sync,
    {
        self.trace(scene, lights, ray, sampler, &mut ())
    }
}

impl<C> VirtualLights<'_, C> {
    /// An estimate of the radiance that arrives along `ray`, and what the ray hit first; `observer` looks on.
    pub fn trace<'s, S, V, O>(
        &self,
        scene: &'s S,
        lights: &VirtualPointLights<V>,
        ray: Ray,
        sampler: &mut impl Sampler,
        observer: &mut O,
    ) -> (S::Spectrum, Option<FirstHit>)
    where
        S: Scene,
        V: Vertex<Spectrum = S::Spectrum> + Send + Sync,
        O: Observer<S::Vertex<'s>>,
    {
        let mut first = FirstVertex { ray, hit: None, next: observer };
        let caustics = self.caustics.map(|caustics| caustics as &dyn CausticMap<_>);
        let radiance = self.eye.trace(scene, lights, caustics, ray, sampler, &mut first);
        (radiance, first.hit)
    }
}

/// Keeps what the camera sees, and lets another one look on.
pub(super) struct FirstVertex<'a, O> {
    pub(super) ray: Ray,
    pub(super) hit: Option<FirstHit>,
    pub(super) next: &'a mut O,
}

impl<X: Vertex, O: Observer<X>> Observer<X> for FirstVertex<'_, O> {
    #[inline]
    fn vertex(&mut self, length: u32, vertex: &X, throughput: X::Spectrum) {
        if length == 1 {
            self.hit = Some(FirstHit::new(&self.ray, vertex));
        }
        self.next.vertex(length, vertex, throughput);
    }

    #[inline]
    fn scattered(&mut self, length: u32, vertex: &X, sample: &ScatterSample<X::Spectrum>) {
        self.next.scattered(length, vertex, sample);
    }

    #[inline]
    fn contribution(&mut self, eye: u32, found: Found, value: X::Spectrum) {
        self.next.contribution(eye, found, value);
    }
}
