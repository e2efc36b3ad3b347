//! Ambient occlusion by strata.

use qmc_sampling::{Sampler, warp::sample_cosine_hemisphere};
use scene_core::{Frame, Scene, Vertex};

use crate::lights::{facing_normal, geometry_term};
use crate::partition::Partition;

/// The part of the hemisphere over `vertex` that connections take:
/// ```text
/// A(x) = 1/pi integral over the hemisphere of  s(x, h(x, w)) cos dw,    h(x, w): what x sees in direction w
/// ```
/// by one cosine-distributed ray. With the hard partition this is ambient occlusion whose range follows from the geometry term:
/// `1 - A` is what the scattered rays of [`RobustIgi`](crate::RobustIgi) have to look at. Near geometry alone is looked at, since the ray ends at the
/// partition's reach.
///
/// **Unbiased.** In `[0, 1]`; 1 is open. **Cost.** One closest-hit ray of bounded length. **Source.** Kollig and Keller 2004, section 4.
pub fn openness<S: Scene>(scene: &S, vertex: &S::Vertex<'_>, partition: &Partition, sampler: &mut impl Sampler) -> f32 {
    let (point, normal) = (vertex.point(), facing_normal(vertex));
    let wi = Frame::from_z(normal).to_world(sample_cosine_hemisphere(sampler.next_2d()).into());
    let reach = partition.reach(normal.dot(wi).max(0.0)) * 1.0001 + 2.0 * point.error;
    match scene.intersect(&vertex.spawn_ray(wi).up_to(reach)) {
        None => partition.share_at_infinity(),
        Some(hit) => {
            let at = hit.point();
            let g = geometry_term(point.position, point.normal, at.position, at.normal);
            partition.share(g, point.position.distance_squared(at.position))
        }
    }
}
