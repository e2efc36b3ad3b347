//! The plain version of ray traversal.

use scene_core::Ray;
use scene_core::glam::Vec3A;

/// The smallest distance in `(0, ray.max_distance)` at which `ray` meets one of the triangles: every one is tested.
///
/// Source: T. Möller, B. Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", Journal of Graphics Tools 2(1), 1997.
pub fn brute_force(triangles: &[[Vec3A; 3]], ray: &Ray) -> Option<f32> {
    let hits = triangles.iter().filter_map(|corners| intersect(corners, ray));
    hits.min_by(f32::total_cmp)
}

fn intersect(&[a, b, c]: &[Vec3A; 3], ray: &Ray) -> Option<f32> {
    let (ab, ac) = (b - a, c - a);
    let p = ray.direction.cross(ac);
    let determinant = ab.dot(p);
    let from_a = ray.origin - a;
    let u = from_a.dot(p) / determinant;
    let q = from_a.cross(ab);
    let v = ray.direction.dot(q) / determinant;
    let t = ac.dot(q) / determinant;
    // NaN, from a ray in the triangle's plane, is inside of nothing.
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 && t < ray.max_distance).then_some(t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_closest_of_two_triangles_is_found() {
        let at = |z: f32| [Vec3A::new(0.0, 0.0, z), Vec3A::new(1.0, 0.0, z), Vec3A::new(0.0, 1.0, z)];
        let ray = Ray::new(Vec3A::new(0.25, 0.25, 0.0), Vec3A::Z);
        assert_eq!(brute_force(&[at(3.0), at(2.0), at(-1.0)], &ray), Some(2.0));
        assert_eq!(brute_force(&[at(3.0), at(2.0)], &ray.up_to(1.5)), None);
        assert_eq!(brute_force(&[at(1.0)], &Ray::new(Vec3A::ZERO, Vec3A::X)), None);
        assert_eq!(brute_force(&[], &ray), None);
    }
}
