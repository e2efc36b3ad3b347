//! Ambient occlusion.

use qmc_sampling::{Sampler, warp::sample_cosine_hemisphere};
use scene_core::{Frame, Ray, Scene, Spectrum, Vertex};

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
    fn radiance<S: Scene>(&self, scene: &S, ray: Ray, sampler: &mut impl Sampler) -> (S::Spectrum, Option<FirstHit>) {
        let Some(vertex) = scene.intersect(&ray) else { return (S::Spectrum::ZERO, None) };
        let first_hit = Some(FirstHit::new(&ray, &vertex));
        let normal = vertex.shading_normal();
        let facing = normal * 1.0f32.copysign(normal.dot(vertex.wo()));
        let wi = Frame::from_z(facing).to_world(sample_cosine_hemisphere(sampler.next_2d()).into());
        let occluded = scene.occluded(&vertex.spawn_ray(wi).up_to(self.distance));
        (S::Spectrum::splat(if occluded { 0.0 } else { 1.0 }), first_hit)
    }
}
