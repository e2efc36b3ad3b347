//! The intersection of a ray and a triangle, without gaps between neighbours.

use glam::{DVec3, Vec3A, Vec3Swizzles};

/// Edge functions below this part of the largest one are near zero: some times the round-off of triangles a hundred times as far
/// away as they are large.
const NEAR_CORNER: f32 = 1e-4;

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TriangleHit {
    /// Ray parameter.
    pub t: f32,
    /// Barycentric coordinate of the second corner.
    pub u: f32,
    /// Barycentric coordinate of the third corner.
    pub v: f32,
}

/// A triangle with its corners in lanes: `x` holds the three x coordinates, and so on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TriangleLanes {
    x: Vec3A,
    y: Vec3A,
    z: Vec3A,
}

impl TriangleLanes {
    pub(crate) fn new(&[a, b, c]: &[Vec3A; 3]) -> Self {
        Self { x: Vec3A::new(a.x, b.x, c.x), y: Vec3A::new(a.y, b.y, c.y), z: Vec3A::new(a.z, b.z, c.z) }
    }

    /// Intersects, for ray parameters in `(0, max_t)`.
    ///
    /// The edge functions are Plücker products `((b - a) x (a + b)) . d` of the ray with each edge `a b`, relative to the
    /// ray's origin, all three at once. For the edge shared by two triangles they are computed from the same corners: the
    /// edge vector changes sign, the sum of the corners does not, and floating point negation is exact, so the two triangles
    /// see exactly opposite values, and no ray passes between them (watertight in the sense of Woop, Benthin, Wald 2013).
    /// Around corners, where three and more triangles meet, that alone does not suffice: there they are computed again in double
    /// precision. The ray parameter is interpolated from the corners' projections on the ray.
    ///
    /// Source: Davidovič, Engelhardt, Georgiev, Slusallek, Dachsbacher, "3D rasterization: a bridge between rasterization and
    /// ray casting", Graphics Interface 2012; the form used by Embree's robust mode.
    #[inline(always)]
    pub(crate) fn intersect(&self, ray: &TriangleRay, max_t: f32) -> Option<TriangleHit> {
        let (x, y, z) = (self.x - ray.origin.x, self.y - ray.origin.y, self.z - ray.origin.z);
        let (next_x, next_y, next_z) = (x.yzx(), y.yzx(), z.yzx());
        let (ex, ey, ez) = (next_x - x, next_y - y, next_z - z);
        let (sx, sy, sz) = (next_x + x, next_y + y, next_z + z);
        let d = ray.direction;
        let edges = (ey * sz - ez * sy) * d.x + (ez * sx - ex * sz) * d.y + (ex * sy - ey * sx) * d.z;
        let mixed = (edges.cmplt(Vec3A::ZERO).bitmask() != 0) & (edges.cmpgt(Vec3A::ZERO).bitmask() != 0);
        // The function of the edge opposite to a corner is its weight.
        let weights = edges.yzx();
        let scale = 1.0 / (weights.x + weights.y + weights.z);
        let along = x * d.x + y * d.y + z * d.z;
        let t = weights.dot(along) * scale * ray.inverse_length_squared;
        // One branch, as most triangles are missed in one way or another that the processor cannot guess. NaN (a ray in the
        // triangle's plane, a triangle without area) compares false.
        if !mixed & (t > 0.0) & (t < max_t) {
            Some(TriangleHit { t, u: weights.y * scale, v: weights.z * scale })
        } else if mixed & passes_corner(edges) {
            self.intersect_near_corner(ray, max_t)
        } else {
            None
        }
    }

    /// As [`intersect`](Self::intersect), with the edge functions in double precision. Around a corner, round-off may tell each of
    /// the triangles there that the ray passes beside it.
    #[cold]
    #[inline(never)]
    fn intersect_near_corner(&self, ray: &TriangleRay, max_t: f32) -> Option<TriangleHit> {
        let (x, y, z) = (self.x - ray.origin.x, self.y - ray.origin.y, self.z - ray.origin.z);
        let [a, b, c]: [DVec3; 3] = core::array::from_fn(|i| Vec3A::new(x[i], y[i], z[i]).as_dvec3());
        let d = ray.direction.as_dvec3();
        let edge = |a: DVec3, b: DVec3| (b - a).cross(a + b).dot(d);
        let weights = DVec3::new(edge(b, c), edge(c, a), edge(a, b));
        if weights.cmplt(DVec3::ZERO).any() && weights.cmpgt(DVec3::ZERO).any() {
            return None;
        }
        let scale = 1.0 / (weights.x + weights.y + weights.z);
        let along = DVec3::new(a.dot(d), b.dot(d), c.dot(d));
        let t = (weights.dot(along) * scale) as f32 * ray.inverse_length_squared;
        let (u, v) = ((weights.y * scale) as f32, (weights.z * scale) as f32);
        if t > 0.0 && t < max_t { Some(TriangleHit { t, u, v }) } else { None }
    }
}

/// Whether two edge functions are near zero: the ray passes the corner between the edges.
#[inline(always)]
fn passes_corner(edges: Vec3A) -> bool {
    let size = edges.abs();
    let near = size.cmplt(Vec3A::splat(size.max_element() * NEAR_CORNER)).bitmask();
    near & near.wrapping_sub(1) != 0
}

/// What of a ray the test of triangles needs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TriangleRay {
    origin: Vec3A,
    direction: Vec3A,
    inverse_length_squared: f32,
}

impl TriangleRay {
    /// The direction need not have unit length.
    #[inline(always)]
    pub(crate) fn new(origin: Vec3A, direction: Vec3A) -> Self {
        Self { origin, direction, inverse_length_squared: 1.0 / direction.length_squared() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn intersect_triangle(origin: Vec3A, direction: Vec3A, max_t: f32, corners: &[Vec3A; 3]) -> Option<TriangleHit> {
        TriangleLanes::new(corners).intersect(&TriangleRay::new(origin, direction), max_t)
    }

    #[test]
    fn hits_and_misses() {
        let triangle = [Vec3A::ZERO, Vec3A::X, Vec3A::Y];
        let hit = intersect_triangle(Vec3A::new(0.25, 0.5, 2.0), -Vec3A::Z, f32::INFINITY, &triangle).unwrap();
        assert!((hit.t - 2.0).abs() < 1e-6 && (hit.u - 0.25).abs() < 1e-6 && (hit.v - 0.5).abs() < 1e-6);
        assert!(intersect_triangle(Vec3A::new(0.6, 0.6, 2.0), -Vec3A::Z, f32::INFINITY, &triangle).is_none());
        assert!(intersect_triangle(Vec3A::new(0.2, 0.2, 2.0), -Vec3A::Z, 2.0, &triangle).is_none(), "behind the end");
        assert!(intersect_triangle(Vec3A::new(0.2, 0.2, 2.0), Vec3A::Z, 9.0, &triangle).is_none(), "behind the start");
        assert!(intersect_triangle(Vec3A::new(-1.0, 0.2, 0.0), Vec3A::X, 9.0, &triangle).is_none(), "in the plane");
        let nan = Vec3A::NAN;
        assert!(intersect_triangle(nan, Vec3A::X, 9.0, &triangle).is_none());
        assert!(intersect_triangle(Vec3A::ZERO, nan, 9.0, &triangle).is_none());
    }

    fn point() -> impl Strategy<Value = Vec3A> {
        (-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0).prop_map(|(x, y, z)| Vec3A::new(x, y, z))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4096))]
        /// Rays aimed at the shared edge of two triangles that continue each other hit at least one of them.
        #[test]
        fn no_ray_passes_between_neighbours(
            (a, b, side) in (point(), point(), point()),
            (s, shift) in (0.05f32..0.95, 0.1f32..1.0),
            origin in point(),
        ) {
            let edge = b - a;
            let across = side - a - edge * ((side - a).dot(edge) / edge.length_squared().max(1e-6));
            prop_assume!(edge.length() > 0.05 && across.length() > 0.05);
            let c = a + across + edge * (s - 0.5);
            let d = a - across * shift + edge * 0.3;
            let target = a + edge * s;
            let normal = edge.cross(across).normalize();
            prop_assume!((origin - target).normalize().dot(normal).abs() > 0.05);
            let direction = (target - origin).normalize();
            let left = intersect_triangle(origin, direction, 1e9, &[a, b, c]);
            let right = intersect_triangle(origin, direction, 1e9, &[b, a, d]);
            prop_assert!(left.is_some() || right.is_some());
        }
    }
}
