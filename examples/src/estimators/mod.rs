//! Estimators of the image: each adds up one kind of paths, against the scene traits alone.

mod ambient_occlusion;
mod bidirectional;
mod connections;
mod direct;
mod light;
mod media;
mod path;
mod photon_lights;
mod photons;
mod resampled;
mod restir;
mod scattering;
mod virtual_lights;

use scene_core::{Ray, Scene, Spectrum, Vertex};

use qmc_sampling::Sampler;
use vpl_gi::Observer;

pub use ambient_occlusion::AmbientOcclusion;
pub use bidirectional::BidirectionalPaths;
pub use connections::ResampledConnections;
pub use direct::{DirectLight, LightAlone, NextEvent, Scattered, ScatteringAlone};
pub use light::LightTracer;
pub use path::{FirstEvent, PathTracer};
pub use photon_lights::PhotonLights;
pub use photons::{
    GuidanceTracing, GuideScratch, Importance, ImportonGuidance, ImportonTracing, MAX_LENGTH, Maps, PathGuidance,
    PhotonCaustics, PhotonEye, PhotonMapping, PhotonTracing, PhotonView, ProgressivePhotons, Sharpness, Storing,
    Unguided, WithCaustics,
};
pub use resampled::{
    EnvironmentSampling, LightCandidate, LightPoint, LightSource, LightTarget, Place, PointTarget, ResampledDirect,
    SourceMix, TargetName, VisibilityProbes, measure_cost, reusable,
};
pub use restir::RestirDirect;
pub use scattering::{Directions, OwnSampling, ResampledScattering, ScatterSampling};
pub use virtual_lights::VirtualLights;

/// What a camera ray hit first, for auxiliary images.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FirstHit {
    /// Albedo, linear RGB.
    pub albedo: [f32; 3],
    /// Unit shading normal.
    pub normal: [f32; 3],
    /// Distance from the sensor.
    pub depth: f32,
}

impl FirstHit {
    /// Of a vertex that `ray` hit.
    pub fn new<V: Vertex>(ray: &Ray, vertex: &V) -> Self {
        Self {
            albedo: vertex.albedo().to_rgb(),
            normal: vertex.shading_normal().to_array(),
            depth: (vertex.point().position - ray.origin).length(),
        }
    }
}

/// An estimator that starts at the sensor: one ray gives one sample of a pixel.
pub trait CameraEstimator: Sync {
    /// An estimate of the radiance that arrives along `ray`, and what the ray hit first; `observer` looks on.
    fn trace<'s, S: Scene, O: Observer<S::Vertex<'s>>>(
        &self,
        scene: &'s S,
        ray: Ray,
        sampler: &mut impl Sampler,
        observer: &mut O,
    ) -> (S::Spectrum, Option<FirstHit>);

    /// [`trace`](Self::trace) with nobody who looks on.
    #[inline]
    fn radiance<S: Scene>(&self, scene: &S, ray: Ray, sampler: &mut impl Sampler) -> (S::Spectrum, Option<FirstHit>) {
        self.trace(scene, ray, sampler, &mut ())
    }
}

/// An estimator that starts at the emitters: one path gives values for any pixels.
pub trait LightEstimator: Sync {
    /// Traces one light path; calls `splat` with raster positions and values. The mean over all paths, times the
    /// reconstruction filter, is the image.
    fn trace<S: Scene>(&self, scene: &S, sampler: &mut impl Sampler, splat: impl FnMut([f32; 2], S::Spectrum));
}

/// No light paths.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoLightPaths;

impl LightEstimator for NoLightPaths {
    fn trace<S: Scene>(&self, _: &S, _: &mut impl Sampler, _: impl FnMut([f32; 2], S::Spectrum)) {}
}
