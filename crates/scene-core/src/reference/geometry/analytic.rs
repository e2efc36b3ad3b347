//! Analytic shapes in their own coordinates: the sphere and the disk.

use glam::Vec3A;

/// Ray parameter in `(0, max_t)` at which `origin + t direction` meets the sphere around the origin.
///
/// Computed in double precision with the discriminant as the squared distance of the ray from the centre, which
/// does not cancel for distant spheres (Haines, Günther, Akenine-Möller, "Precision Improvements for Ray/Sphere
/// Intersection", Ray Tracing Gems 2019, chapter 7). The direction need not be of unit length.
#[inline]
pub(crate) fn intersect_sphere(radius: f32, origin: Vec3A, direction: Vec3A, max_t: f32) -> Option<f32> {
    let o = origin.as_dvec3();
    let d = direction.as_dvec3();
    let a = d.dot(d);
    let b = -o.dot(d);
    let closest = o + d * (b / a);
    let r2 = f64::from(radius) * f64::from(radius);
    let discriminant = r2 - closest.dot(closest);
    if discriminant.is_nan() || discriminant < 0.0 {
        return None;
    }
    let root = (a * discriminant).sqrt();
    let q = if b >= 0.0 { b + root } else { b - root };
    let c = o.dot(o) - r2;
    let (t0, t1) = if b >= 0.0 { (c / q, q / a) } else { (q / a, c / q) };
    [t0 as f32, t1 as f32].into_iter().find(|&t| t > 0.0 && t < max_t)
}

/// Ray parameter in `(0, max_t)` at which the ray meets the unit disk in the plane z = 0.
#[inline]
pub(crate) fn intersect_disk(origin: Vec3A, direction: Vec3A, max_t: f32) -> Option<f32> {
    let t = -origin.z / direction.z;
    if !(t > 0.0 && t < max_t) {
        return None;
    }
    let (x, y) = (origin.x + direction.x * t, origin.y + direction.y * t);
    (x * x + y * y <= 1.0).then_some(t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spheres_are_hit_from_outside_and_inside() {
        let t = intersect_sphere(1.0, Vec3A::new(0.0, 0.0, 5.0), -Vec3A::Z, 1e9).unwrap();
        assert!((t - 4.0).abs() < 1e-6);
        let t = intersect_sphere(1.0, Vec3A::ZERO, Vec3A::X, 1e9).unwrap();
        assert!((t - 1.0).abs() < 1e-6);
        assert!(intersect_sphere(1.0, Vec3A::new(0.0, 0.0, 5.0), Vec3A::Z, 1e9).is_none());
        assert!(intersect_sphere(1.0, Vec3A::new(0.0, 2.0, 5.0), -Vec3A::Z, 1e9).is_none());
        assert!(intersect_sphere(1.0, Vec3A::NAN, -Vec3A::Z, 1e9).is_none());
        // A distant sphere keeps its precision.
        let t = intersect_sphere(0.01, Vec3A::new(0.0, 0.0, 1000.0), -Vec3A::Z, 1e9).unwrap();
        assert!((t - 999.99).abs() < 1e-3);
    }

    #[test]
    fn disks_end_at_radius_one() {
        assert_eq!(intersect_disk(Vec3A::new(0.9, 0.0, 2.0), -Vec3A::Z, 1e9), Some(2.0));
        assert_eq!(intersect_disk(Vec3A::new(1.1, 0.0, 2.0), -Vec3A::Z, 1e9), None);
        assert_eq!(intersect_disk(Vec3A::new(0.0, 0.0, 2.0), Vec3A::X, 1e9), None);
        assert_eq!(intersect_disk(Vec3A::ZERO, Vec3A::X, 1e9), None);
    }
}
