//! Bidirectional path tracing.

use qmc_sampling::Sampler;
use scene_core::{EmitterChoice, Ray, Scene, Vertex};
use vpl_gi::{Bidirectional, LightPaths, PathHeuristic, TechniqueSet};

use super::FirstHit;
use super::connections::ResampledConnections;
use super::virtual_lights::FirstVertex;
use crate::render::SharingEstimator;

/// [`Bidirectional`] path tracing with light paths that samples share.
#[derive(Clone, Copy, Debug)]
pub struct BidirectionalPaths<H, C> {
    /// The estimator.
    pub paths: Bidirectional<H, C>,
    /// Number of light paths that a sample sees.
    pub count: u32,
    /// Shadow rays per eye path, for connections that are chosen by resampling; `None` tests all connections.
    pub resampled: Option<u32>,
}

/// The numbers that choose connections.
const CONNECTIONS_DOMAIN: u32 = 0x636f_6e6e;

impl<H: PathHeuristic + Sync, C: EmitterChoice + Sync> SharingEstimator for BidirectionalPaths<H, C> {
    type Shared<V: Vertex + Send + Sync> = LightPaths<V>;

    fn paths(&self) -> u32 {
        self.count
    }

    fn share<'s, S: Scene, R: Sampler>(
        &self,
        scene: &'s S,
        sampler: impl FnMut(u32) -> R,
        used: Option<LightPaths<S::Vertex<'s>>>,
    ) -> LightPaths<S::Vertex<'s>> {
        let mut lights = used.unwrap_or_else(|| LightPaths::new(scene));
        self.paths.trace_light_paths(scene, &mut lights, self.count, sampler);
        lights
    }

    fn radiance<S, V>(
        &self,
        scene: &S,
        lights: &LightPaths<V>,
        ray: Ray,
        sampler: &mut impl Sampler,
    ) -> (S::Spectrum, Option<FirstHit>)
    where
        S: Scene,
        V: Vertex<Spectrum = S::Spectrum> + Send + Sync,
    {
        let mut first = FirstVertex { ray, hit: None, next: &mut () };
        let radiance = match self.resampled {
            None => self.paths.radiance(scene, lights, ray, sampler, &mut first),
            Some(rays) => {
                let mut tests = ResampledConnections::new(rays, sampler.fork(CONNECTIONS_DOMAIN));
                self.paths.radiance_with(scene, lights, ray, sampler, &mut first, &mut tests)
            }
        };
        (radiance, first.hit)
    }

    fn has_splats(&self) -> bool {
        self.paths.techniques != TechniqueSet::WithoutLens
    }

    fn splats<S, V>(
        &self,
        scene: &S,
        lights: &LightPaths<V>,
        sampler: &mut impl Sampler,
        splat: impl FnMut([f32; 2], S::Spectrum),
    ) where
        S: Scene,
        V: Vertex<Spectrum = S::Spectrum> + Send + Sync,
    {
        self.paths.splats(scene, lights, sampler, splat);
    }
}
