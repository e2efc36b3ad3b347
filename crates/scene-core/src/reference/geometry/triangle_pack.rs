//! The intersection of a ray and four triangles at once, without gaps between neighbours.

use glam::{Vec3A, Vec4};

use super::collapse::LANES;
use super::traversal::reciprocal;

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

/// Up to four triangles: for each axis and corner the coordinates, one triangle a lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TrianglePack([[Vec4; 3]; 3]);

/// A ray, sheared such that it is the third axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShearedRay {
    /// Which axes become the first, the second and the third.
    axes: [usize; 3],
    origin: [Vec4; 3],
    /// How far the first two coordinates move with the third.
    shear: [Vec4; 2],
    /// Ray parameter per unit of the third coordinate.
    scale: f32,
}

impl ShearedRay {
    /// The direction need not have unit length.
    #[inline(always)]
    pub(crate) fn new(origin: Vec3A, direction: Vec3A) -> Self {
        // The third axis is that along which the direction is longest.
        let [x, y, z] = direction.abs().to_array();
        let third = if x > y {
            if x > z { 0 } else { 2 }
        } else if y > z {
            1
        } else {
            2
        };
        let axes = [NEXT[third], NEXT[NEXT[third]], third];
        // The longest is not so short that its reciprocal would be cut off, unless all are.
        let scale = reciprocal(direction).to_array()[third];
        let (origin, direction) = (origin.to_array(), direction.to_array());
        Self {
            axes,
            origin: axes.map(|axis| Vec4::splat(origin[axis])),
            shear: [axes[0], axes[1]].map(|axis| Vec4::splat(direction[axis] * scale)),
            scale,
        }
    }
}

/// The axis after each.
const NEXT: [usize; 3] = [1, 2, 0];

/// The triangles of a pack that a ray meets.
#[derive(Clone, Copy, Debug)]
struct Met {
    lanes: u32,
    t: Vec4,
    weights: [Vec4; 3],
    /// One over the sum of the weights.
    scale: Vec4,
}

impl TrianglePack {
    /// Of the corners of up to four triangles. Lanes without a triangle are never hit.
    pub(crate) fn new(triangles: &[[Vec3A; 3]]) -> Self {
        let lane = |lane: usize, corner: usize, axis: usize| triangles.get(lane).map_or(f32::NAN, |t| t[corner][axis]);
        Self(
            [0, 1, 2]
                .map(|axis| [0, 1, 2].map(|corner| Vec4::from_array(core::array::from_fn(|i| lane(i, corner, axis))))),
        )
    }

    /// Which triangles are met at ray parameters in `(0, max_t)`.
    ///
    /// Corners are moved to the ray's origin and sheared along its direction, so that the ray is the third axis and the edge
    /// functions are two-dimensional: `p_x q_y - p_y q_x`. A corner has the same sheared coordinates in every triangle that it
    /// belongs to, and the rounded difference of two rounded products never has the wrong sign (rounding is monotonic), at
    /// worst it is zero, which counts as inside. So the test decides exactly for the mesh of sheared corners, whose triangles share
    /// their edges and corners: no ray passes between them.
    ///
    /// Source: Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013.
    #[inline(always)]
    fn meet(&self, ray: &ShearedRay, max_t: f32) -> Met {
        let [first, second, third] = ray.axes.map(|axis| &self.0[axis]);
        let z = [0, 1, 2].map(|corner| third[corner] - ray.origin[2]);
        let x = [0, 1, 2].map(|corner| (first[corner] - ray.origin[0]) - ray.shear[0] * z[corner]);
        let y = [0, 1, 2].map(|corner| (second[corner] - ray.origin[1]) - ray.shear[1] * z[corner]);
        // The function of the edge opposite to a corner is its weight.
        let weights = [(1, 2), (2, 0), (0, 1)].map(|(p, q)| x[p] * y[q] - y[p] * x[q]);
        let lowest = weights[0].min(weights[1]).min(weights[2]);
        let highest = weights[0].max(weights[1]).max(weights[2]);
        let outside = lowest.cmplt(Vec4::ZERO) & highest.cmpgt(Vec4::ZERO);
        let scale = 1.0 / (weights[0] + weights[1] + weights[2]);
        let t = (weights[0] * z[0] + weights[1] * z[1] + weights[2] * z[2]) * scale * ray.scale;
        // NaN (a ray in the triangle's plane, no triangle) compares false.
        let within = t.cmpgt(Vec4::ZERO) & t.cmplt(Vec4::splat(max_t));
        Met { lanes: within.bitmask() & !outside.bitmask(), t, weights, scale }
    }

    /// The closest hit at ray parameters in `(0, max_t)`, with its lane.
    #[inline(always)]
    pub(crate) fn closest(&self, ray: &ShearedRay, max_t: f32) -> Option<(usize, TriangleHit)> {
        let met = self.meet(ray, max_t);
        if met.lanes == 0 {
            return None;
        }
        let t = met.t.to_array();
        let mut lanes = met.lanes;
        let mut best = lanes.trailing_zeros() as usize % LANES;
        lanes &= lanes - 1;
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize % LANES;
            lanes &= lanes - 1;
            if t[lane] < t[best] {
                best = lane;
            }
        }
        let [_, u, v] = met.weights.map(|weight| (weight * met.scale).to_array()[best]);
        Some((best, TriangleHit { t: t[best], u, v }))
    }

    /// Whether there is any hit at ray parameters in `(0, max_t)`.
    #[inline(always)]
    pub(crate) fn any(&self, ray: &ShearedRay, max_t: f32) -> bool {
        self.meet(ray, max_t).lanes != 0
    }
}

#[cfg(test)]
mod tests {
    use super::super::triangle;
    use super::*;
    use proptest::prelude::*;

    fn intersect(origin: Vec3A, direction: Vec3A, max_t: f32, corners: &[Vec3A; 3]) -> Option<TriangleHit> {
        TrianglePack::new(&[*corners]).closest(&ShearedRay::new(origin, direction), max_t).map(|(_, hit)| hit)
    }

    #[test]
    fn hits_and_misses() {
        let triangle = [Vec3A::ZERO, Vec3A::X, Vec3A::Y];
        let hit = intersect(Vec3A::new(0.25, 0.5, 2.0), -Vec3A::Z, f32::INFINITY, &triangle).unwrap();
        assert!((hit.t - 2.0).abs() < 1e-6 && (hit.u - 0.25).abs() < 1e-6 && (hit.v - 0.5).abs() < 1e-6);
        assert!(intersect(Vec3A::new(0.6, 0.6, 2.0), -Vec3A::Z, f32::INFINITY, &triangle).is_none());
        assert!(intersect(Vec3A::new(0.2, 0.2, 2.0), -Vec3A::Z, 2.0, &triangle).is_none(), "behind the end");
        assert!(intersect(Vec3A::new(0.2, 0.2, 2.0), Vec3A::Z, 9.0, &triangle).is_none(), "behind the start");
        assert!(intersect(Vec3A::new(-1.0, 0.2, 0.0), Vec3A::X, 9.0, &triangle).is_none(), "in the plane");
        let nan = Vec3A::NAN;
        assert!(intersect(nan, Vec3A::X, 9.0, &triangle).is_none());
        assert!(intersect(Vec3A::ZERO, nan, 9.0, &triangle).is_none());
        assert!(intersect(Vec3A::ZERO, Vec3A::ZERO, 9.0, &triangle).is_none());
    }

    #[test]
    fn lanes_without_a_triangle_are_never_hit() {
        let pack = TrianglePack::new(&[]);
        assert!(!pack.any(&ShearedRay::new(Vec3A::Z, -Vec3A::Z), f32::INFINITY));
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
            let left = intersect(origin, direction, 1e9, &[a, b, c]);
            let right = intersect(origin, direction, 1e9, &[b, a, d]);
            prop_assert!(left.is_some() || right.is_some());
        }

        /// Rays aimed at the corner that a fan of triangles shares hit at least one of them.
        #[test]
        fn no_ray_passes_a_corner(
            (center, from) in (point(), point()),
            rim in prop::collection::vec(0.1f32..1.0, 3..9),
        ) {
            let n = rim.len();
            let at = |i: usize| {
                let phi = i as f32 / n as f32 * core::f32::consts::TAU;
                center + Vec3A::new(phi.cos(), phi.sin(), 0.3 * rim[i] - 0.2) * rim[i]
            };
            let origin = center + Vec3A::new(0.4 * from.x, 0.4 * from.y, 0.5 * from.z + 0.7);
            let direction = (center - origin).normalize();
            let hit = (0..n).any(|i| intersect(origin, direction, 1e9, &[center, at(i), at((i + 1) % n)]).is_some());
            prop_assert!(hit);
        }

        /// The lanes of a pack find what the plain version finds, but for rays that pass close to an edge.
        #[test]
        fn agrees_with_double_precision(
            corners in prop::collection::vec((point(), point(), point()), 1..=4),
            (origin, target) in (point(), point()),
            length in 0.1f32..3.0,
        ) {
            prop_assume!((target - origin).length() > 0.01);
            let direction = (target - origin).normalize();
            let triangles: Vec<[Vec3A; 3]> = corners.iter().map(|&(a, b, c)| [a, b, c]).collect();
            let plain: Vec<_> = triangles.iter().map(|t| triangle::intersect(origin, direction, length, t)).collect();
            // Leave out what round-off may decide.
            let steep = |t: &[Vec3A; 3]| (t[1] - t[0]).cross(t[2] - t[0]).dot(direction).abs() > 1e-2;
            prop_assume!(triangles.iter().all(steep));
            prop_assume!(plain.iter().flatten().all(|(hit, inside)| {
                inside.abs() > 1e-4 && hit.t > 1e-4 && hit.t < length - 1e-4
            }));
            let nearest = (0..plain.len())
                .filter_map(|lane| plain[lane].filter(|(_, inside)| *inside > 0.0).map(|(hit, _)| (lane, hit)))
                .min_by(|a, b| a.1.t.total_cmp(&b.1.t));
            let sheared = ShearedRay::new(origin, direction);
            let pack = TrianglePack::new(&triangles);
            let found = pack.closest(&sheared, length);
            prop_assert_eq!(pack.any(&sheared, length), nearest.is_some());
            prop_assert_eq!(found.map(|(lane, _)| lane), nearest.map(|(lane, _)| lane));
            if let (Some((_, found)), Some((_, plain))) = (found, nearest) {
                prop_assert!((found.t - plain.t).abs() < 1e-4, "{found:?} {plain:?}");
                prop_assert!((found.u - plain.u).abs() < 1e-3 && (found.v - plain.v).abs() < 1e-3, "{found:?} {plain:?}");
            }
        }
    }
}
