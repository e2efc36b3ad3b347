//! Ambient occlusion.

use qmc_sampling::{Sampler, warp::sample_cosine_hemisphere};
use scene_core::{Frame, Ray, Scene, Spectrum, Vertex};
use vpl_gi::{Found, Observer};

use super::{CameraEstimator, FirstHit};

/// The part of the hemisphere that is free up to a distance, weighted by the cosine:
/// ```text
/// A = 1/pi integral over the hemisphere of V(x, w, distance) cos dw
/// ```
/// estimated by one cosine-distributed ray. 1 is unoccluded; what the camera does not hit is 0. Unbiased.
/// Cost: one closest hit and one visibility ray.
///
/// Source: Zhukov, Iones, Kronin 1998; Landis 2002.
#[derive(Clone, Copy, Debug)]
pub struct AmbientOcclusion {
    /// Occluders beyond this distance do not count.
    pub distance: f32,
}

impl CameraEstimator for AmbientOcclusion {
    /// The occluder is the second vertex. It takes a closest hit in place of the visibility ray.
    fn trace<'s, S: Scene, O: Observer<S::Vertex<'s>>>(
        &self,
        scene: &'s S,
        ray: Ray,
        sampler: &mut impl Sampler,
        observer: &mut O,
    ) -> (S::Spectrum, Option<FirstHit>) {
        let Some(vertex) = scene.intersect(&ray) else { return (S::Spectrum::ZERO, None) };
        let all = S::Spectrum::splat(1.0);
        observer.vertex(1, &vertex, all);
        let occluder = scene.intersect(&self.occlusion_ray(&vertex, sampler));
        let value = if occluder.is_some() { S::Spectrum::ZERO } else { all };
        observer.contribution(1, Found::Connection { light: 0 }, value);
        if let Some(occluder) = &occluder {
            // Nothing of it reaches the camera.
            observer.vertex(2, occluder, S::Spectrum::ZERO);
        }
        (value, Some(FirstHit::new(&ray, &vertex)))
    }

    fn radiance<S: Scene>(&self, scene: &S, ray: Ray, sampler: &mut impl Sampler) -> (S::Spectrum, Option<FirstHit>) {
        let Some(vertex) = scene.intersect(&ray) else { return (S::Spectrum::ZERO, None) };
        let occluded = scene.occluded(&self.occlusion_ray(&vertex, sampler));
        (S::Spectrum::splat(if occluded { 0.0 } else { 1.0 }), Some(FirstHit::new(&ray, &vertex)))
    }
}

impl AmbientOcclusion {
    fn occlusion_ray<V: Vertex>(&self, vertex: &V, sampler: &mut impl Sampler) -> Ray {
        let normal = vertex.shading_normal();
        let facing = normal * 1.0f32.copysign(normal.dot(vertex.wo()));
        let wi = Frame::from_z(facing).to_world(sample_cosine_hemisphere(sampler.next_2d()).into());
        vertex.spawn_ray(wi).up_to(self.distance)
    }
}
