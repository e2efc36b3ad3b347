//! Triangles in a compressed wide bounding volume hierarchy.

use core::time::Duration;
use std::collections::HashSet;

use glam::{UVec2, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh;
use obvhs::ray::{Ray as BvhRay, safe_inverse};
use obvhs::{BvhBuildParams, traverse};

use super::triangle::{TriangleHit, intersect_triangle};
use crate::ray::Ray;

/// A hierarchy of obvhs, with what its rays need.
///
/// obvhs ignores boxes that a ray enters and leaves before the parameter 1e-4, whatever the unit of length. So rays are
/// handed to it in a unit so small (a power of two, hence exact) that this lies far below the scene's round-off.
#[derive(Clone, Debug)]
pub(crate) struct Hierarchy {
    pub(super) bvh: CwBvh,
    /// Hierarchy's units per unit of length.
    scale: f32,
}

impl Hierarchy {
    /// A ray as obvhs wants it.
    #[inline(always)]
    pub(super) fn ray(&self, ray: &Ray) -> BvhRay {
        // Adding zero turns negative zeros, on whose sign obvhs does not agree with itself, into positive ones.
        let d = ray.direction + Vec3A::ZERO;
        BvhRay {
            origin: ray.origin,
            direction: d,
            inv_direction: Vec3A::new(safe_inverse(d.x), safe_inverse(d.y), safe_inverse(d.z)) * self.scale,
            tmin: 0.0,
            tmax: ray.max_distance * self.scale,
        }
    }

    /// A ray parameter in the hierarchy's unit.
    #[inline(always)]
    pub(super) fn parameter(&self, t: f32) -> f32 {
        t * self.scale
    }
}

/// Whether the ray can be traced at all.
#[inline(always)]
pub(crate) fn is_traceable(ray: &Ray) -> bool {
    ray.origin.is_finite() && ray.direction.is_finite() && ray.max_distance > 0.0
}

/// Builds the hierarchy over boxes. Boxes are widened by a few units in the last place of the largest coordinate, so that
/// the rounding of the slab test never loses what the exact test of the primitive would hit, and no box is flat.
pub(crate) fn build(mut boxes: Vec<Aabb>) -> Hierarchy {
    if boxes.is_empty() {
        return Hierarchy { bvh: CwBvh::default(), scale: 1.0 };
    }
    let magnitude = boxes.iter().map(|b| b.min.abs().max(b.max.abs()).max_element()).fold(1e-20, f32::max);
    let margin = Vec3A::splat(magnitude * (2.0 * f32::EPSILON));
    for b in &mut boxes {
        b.min -= margin;
        b.max += margin;
    }
    // Reinsertion is superlinear: large scenes take the cheaper preset.
    let parameters =
        if boxes.len() > 500_000 { BvhBuildParams::fast_build() } else { BvhBuildParams::medium_build() };
    let bvh = build_cwbvh(&boxes, parameters, &mut Duration::default());
    // 2^22 units per largest coordinate: 1e-4 of one is 2.4e-11 of it.
    let scale = (22.0 - magnitude.log2().ceil()).clamp(-100.0, 100.0).exp2();
    Hierarchy { bvh, scale }
}

/// A hit of a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BvhHit {
    /// Index of the triangle as it was given to [`TriangleBvh::new`].
    pub triangle: u32,
    pub hit: TriangleHit,
}

/// Triangles, laid out in the order in which the hierarchy's leaves refer to them.
#[derive(Clone, Debug)]
pub(crate) struct TriangleBvh {
    hierarchy: Hierarchy,
    /// In the order of the hierarchy's leaves.
    corners: Vec<[Vec3A; 3]>,
    /// Index as given to [`TriangleBvh::new`], in the same order.
    originals: Vec<u32>,
}

impl TriangleBvh {
    /// Of triangles that coincide exactly only the first is kept: no ray tells them apart, and thousands of them take the
    /// builder quadratic time.
    pub(crate) fn new(triangles: &[[Vec3A; 3]]) -> Self {
        let mut seen = HashSet::with_capacity(triangles.len());
        let bits = |corners: &[Vec3A; 3]| corners.map(|p| p.to_array().map(f32::to_bits));
        let distinct: Vec<u32> =
            (0..triangles.len() as u32).filter(|&i| seen.insert(bits(&triangles[i as usize]))).collect();
        drop(seen);
        let boxes = distinct.iter().map(|&i| Aabb::from_points(&triangles[i as usize])).collect();
        let hierarchy = build(boxes);
        let originals: Vec<u32> = hierarchy.bvh.primitive_indices.iter().map(|&i| distinct[i as usize]).collect();
        let corners = originals.iter().map(|&i| triangles[i as usize]).collect();
        Self { hierarchy, corners, originals }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// Bounds of all triangles.
    pub(crate) fn bounds(&self) -> Aabb {
        self.hierarchy.bvh.total_aabb
    }

    /// The closest hit before `ray.max_distance`.
    #[inline]
    pub(crate) fn closest(&self, ray: &Ray) -> Option<BvhHit> {
        let bvh = &self.hierarchy.bvh;
        let mut bvh_ray = self.hierarchy.ray(ray);
        let mut limit = ray.max_distance;
        let mut best = None;
        let mut state = bvh.new_traversal(ray.direction);
        let mut node;
        traverse!(bvh, node, state, node.intersect_ray(&bvh_ray, state.oct_inv4), {
            let slot = state.primitive_id as usize;
            if let Some(hit) = intersect_triangle(ray.origin, ray.direction, limit, &self.corners[slot]) {
                limit = hit.t;
                bvh_ray.tmax = self.hierarchy.parameter(limit);
                best = Some((slot, hit));
            }
        });
        best.map(|(slot, hit)| BvhHit { triangle: self.originals[slot], hit })
    }

    /// Whether there is any hit before `ray.max_distance`.
    #[inline]
    pub(crate) fn any(&self, ray: &Ray) -> bool {
        let bvh = &self.hierarchy.bvh;
        let bvh_ray = self.hierarchy.ray(ray);
        let mut state = bvh.new_traversal(ray.direction);
        let mut node;
        let mut found = false;
        traverse!(bvh, node, state, node.intersect_ray(&bvh_ray, state.oct_inv4), {
            let corners = &self.corners[state.primitive_id as usize];
            if intersect_triangle(ray.origin, ray.direction, ray.max_distance, corners).is_some() {
                found = true;
                break;
            }
        });
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn brute_force(triangles: &[[Vec3A; 3]], ray: &Ray) -> Option<f32> {
        let hits = triangles.iter().filter_map(|t| intersect_triangle(ray.origin, ray.direction, ray.max_distance, t));
        hits.map(|hit| hit.t).min_by(f32::total_cmp)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]
        #[test]
        fn agrees_with_brute_force(
            seeds in prop::collection::vec((prop::array::uniform3(-1.0f32..1.0), prop::array::uniform3(-0.3f32..0.3), prop::array::uniform3(-0.3f32..0.3)), 0..60),
            origin in prop::array::uniform3(-2.0f32..2.0),
            target in prop::array::uniform3(-1.0f32..1.0),
            length in 0.1f32..10.0,
        ) {
            let triangles: Vec<[Vec3A; 3]> = seeds.iter()
                .map(|&(p, e, f)| { let p = Vec3A::from(p); [p, p + Vec3A::from(e), p + Vec3A::from(f)] }).collect();
            let direction = (Vec3A::from(target) - Vec3A::from(origin)).normalize_or(Vec3A::X);
            let ray = Ray::new(origin.into(), direction).up_to(length);
            let bvh = TriangleBvh::new(&triangles);
            let expected = brute_force(&triangles, &ray);
            prop_assert_eq!(bvh.closest(&ray).map(|h| h.hit.t), expected);
            prop_assert_eq!(bvh.any(&ray), expected.is_some());
        }
    }

    #[test]
    fn coincident_triangles_by_the_thousand_are_no_problem() {
        let triangles = vec![[Vec3A::ZERO, Vec3A::X, Vec3A::Y]; 20_000];
        let bvh = TriangleBvh::new(&triangles);
        let ray = Ray::new(Vec3A::new(0.2, 0.2, 1.0), -Vec3A::Z);
        assert!((bvh.closest(&ray).unwrap().hit.t - 1.0).abs() < 1e-6);
        assert!(bvh.any(&ray) && !bvh.any(&ray.up_to(0.5)));
    }

    /// Geometry of any size, hit from close by: no unit of length is special.
    #[test]
    fn tiny_and_huge_scenes_are_hit_alike() {
        for size in [1e-9f32, 1e-4, 1.0, 1e5, 1e9] {
            let triangles = [[Vec3A::ZERO, Vec3A::X * size, Vec3A::Y * size], [Vec3A::Z * size; 3]];
            let bvh = TriangleBvh::new(&triangles);
            for height in [1e-5, 0.5] {
                let ray = Ray::new(Vec3A::new(0.2, 0.3, height) * size, -Vec3A::Z);
                let t = bvh.closest(&ray).map(|h| h.hit.t / size);
                assert!(t.is_some_and(|t| (t / height - 1.0).abs() < 1e-3), "{size} {height} {t:?}");
                assert!(bvh.any(&ray));
            }
        }
    }

    #[test]
    fn nothing_is_in_an_empty_hierarchy() {
        let bvh = TriangleBvh::new(&[]);
        let ray = Ray::new(Vec3A::ZERO, Vec3A::X);
        assert!(bvh.is_empty() && bvh.closest(&ray).is_none() && !bvh.any(&ray));
    }
}
