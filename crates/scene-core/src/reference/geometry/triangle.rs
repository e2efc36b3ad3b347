//! The intersection of a ray and one triangle in double precision: the plain version that packs are compared with.

use glam::{DVec3, Vec3A};

use super::triangle_pack::TriangleHit;

/// The hit at ray parameters in `(0, max_t)`, and how far inside it is: the smallest barycentric coordinate, negative outside.
///
/// The weights are Plücker products `((b - a) x (a + b)) . d` of the ray with each edge `a b`, relative to the ray's origin.
pub(super) fn intersect(
    origin: Vec3A,
    direction: Vec3A,
    max_t: f32,
    corners: &[Vec3A; 3],
) -> Option<(TriangleHit, f64)> {
    let d = direction.as_dvec3();
    let [a, b, c] = corners.map(|corner| corner.as_dvec3() - origin.as_dvec3());
    let edge = |a: DVec3, b: DVec3| (b - a).cross(a + b).dot(d);
    let weights = DVec3::new(edge(b, c), edge(c, a), edge(a, b));
    let weights = weights / (weights.x + weights.y + weights.z);
    let t = (a * weights.x + b * weights.y + c * weights.z).dot(d) / d.length_squared();
    let hit = TriangleHit { t: t as f32, u: weights.y as f32, v: weights.z as f32 };
    (hit.t > 0.0 && hit.t < max_t).then_some((hit, weights.min_element()))
}
