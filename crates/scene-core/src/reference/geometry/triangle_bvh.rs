//! Triangles in a hierarchy.

use std::collections::HashSet;

use arrayvec::ArrayVec;
use glam::Vec3A;
use obvhs::aabb::Aabb;

use super::collapse::LANES;
use super::hierarchy::Hierarchy;
use super::triangle_pack::{ShearedRay, TriangleHit, TrianglePack};
use crate::ray::Ray;

/// Whether the ray can be traced at all.
#[inline(always)]
pub(crate) fn is_traceable(ray: &Ray) -> bool {
    ray.origin.is_finite() && ray.direction.is_finite() && ray.max_distance > 0.0
}

/// A hit of a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BvhHit {
    /// Where the triangle is: four times its pack, plus its lane.
    pub slot: u32,
    pub hit: TriangleHit,
}

/// Triangles, in packs that are the hierarchy's leaves.
#[derive(Clone, Debug)]
pub(crate) struct TriangleBvh {
    hierarchy: Hierarchy,
    packs: Vec<TrianglePack>,
}

impl TriangleBvh {
    /// Of triangles that coincide exactly only the first is kept: no ray tells them apart, and thousands of them take the
    /// builder quadratic time.
    ///
    /// Also returns, for each slot, the index of its triangle; nothing for lanes that are empty.
    pub(crate) fn new(triangles: &[[Vec3A; 3]]) -> (Self, Vec<Option<u32>>) {
        let mut seen = HashSet::with_capacity(triangles.len());
        let bits = |corners: &[Vec3A; 3]| corners.map(|p| p.to_array().map(f32::to_bits));
        let distinct: Vec<u32> =
            (0..triangles.len() as u32).filter(|&i| seen.insert(bits(&triangles[i as usize]))).collect();
        drop(seen);
        let boxes: Vec<Aabb> = distinct.iter().map(|&i| Aabb::from_points(&triangles[i as usize])).collect();
        let hierarchy = Hierarchy::new(&boxes);
        let (mut packs, mut slots) = (Vec::new(), Vec::new());
        for pack in hierarchy.packs() {
            let of_pack: ArrayVec<u32, LANES> = pack.iter().map(|&i| distinct[i as usize]).collect();
            let corners: ArrayVec<[Vec3A; 3], LANES> = of_pack.iter().map(|&i| triangles[i as usize]).collect();
            packs.push(TrianglePack::new(&corners));
            slots.extend((0..LANES).map(|lane| of_pack.get(lane).copied()));
        }
        (Self { hierarchy, packs }, slots)
    }

    /// Bounds of all triangles; nothing if there are none.
    pub(crate) fn bounds(&self) -> Option<Aabb> {
        self.hierarchy.bounds()
    }

    /// The closest hit before `ray.max_distance`.
    #[inline]
    pub(crate) fn closest(&self, ray: &Ray) -> Option<BvhHit> {
        let sheared = ShearedRay::new(ray.origin, ray.direction);
        let mut best = None;
        self.hierarchy.traverse(ray, ray.max_distance, |pack, mut limit| {
            if let Some((lane, hit)) = self.packs[pack].closest(&sheared, limit) {
                limit = hit.t;
                best = Some(BvhHit { slot: (LANES * pack + lane) as u32, hit });
            }
            limit
        });
        best
    }

    /// Whether there is any hit before `ray.max_distance`.
    #[inline]
    pub(crate) fn any(&self, ray: &Ray) -> bool {
        let sheared = ShearedRay::new(ray.origin, ray.direction);
        self.hierarchy.any(ray, ray.max_distance, |pack| self.packs[pack].any(&sheared, ray.max_distance))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn brute_force(triangles: &[[Vec3A; 3]], ray: &Ray) -> Option<f32> {
        let sheared = ShearedRay::new(ray.origin, ray.direction);
        let hits = triangles.iter().filter_map(|t| TrianglePack::new(&[*t]).closest(&sheared, ray.max_distance));
        hits.map(|(_, hit)| hit.t).min_by(f32::total_cmp)
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
            let (bvh, _) = TriangleBvh::new(&triangles);
            let expected = brute_force(&triangles, &ray);
            prop_assert_eq!(bvh.closest(&ray).map(|h| h.hit.t), expected);
            prop_assert_eq!(bvh.any(&ray), expected.is_some());
        }
    }

    #[test]
    fn coincident_triangles_by_the_thousand_are_no_problem() {
        let triangles = vec![[Vec3A::ZERO, Vec3A::X, Vec3A::Y]; 20_000];
        let (bvh, _) = TriangleBvh::new(&triangles);
        let ray = Ray::new(Vec3A::new(0.2, 0.2, 1.0), -Vec3A::Z);
        assert!((bvh.closest(&ray).unwrap().hit.t - 1.0).abs() < 1e-6);
        assert!(bvh.any(&ray) && !bvh.any(&ray.up_to(0.5)));
    }

    /// Geometry of any size, hit from close by: no unit of length is special.
    #[test]
    fn tiny_and_huge_scenes_are_hit_alike() {
        for size in [1e-9f32, 1e-4, 1.0, 1e5, 1e9] {
            let triangles = [[Vec3A::ZERO, Vec3A::X * size, Vec3A::Y * size], [Vec3A::Z * size; 3]];
            let (bvh, _) = TriangleBvh::new(&triangles);
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
        let (bvh, _) = TriangleBvh::new(&[]);
        let ray = Ray::new(Vec3A::ZERO, Vec3A::X);
        assert!(bvh.bounds().is_none() && bvh.closest(&ray).is_none() && !bvh.any(&ray));
    }
}
