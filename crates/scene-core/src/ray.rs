//! Rays, and the points on surfaces where they start and end.

use glam::Vec3A;

/// A ray of bounded length. Directions are unit vectors, so that the parameter is a distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: Vec3A,
    /// Unit direction.
    pub direction: Vec3A,
    /// Hits count up to this distance, exclusively.
    pub max_distance: f32,
}

impl Ray {
    /// An unbounded ray.
    #[inline]
    pub const fn new(origin: Vec3A, direction: Vec3A) -> Self {
        Self { origin, direction, max_distance: f32::INFINITY }
    }

    /// The same ray, ending at `max_distance`.
    #[inline]
    #[must_use]
    pub const fn up_to(self, max_distance: f32) -> Self {
        Self { max_distance, ..self }
    }

    /// The point at `distance`.
    #[inline]
    pub fn at(&self, distance: f32) -> Vec3A {
        self.origin + self.direction * distance
    }
}

/// A point on a surface (or, with a zero normal, in space), with a bound of its round-off.
///
/// Rays that start here are moved off the surface along the geometric normal, to the side into which they leave,
/// by the bound `error`: the scheme of Wächter and Binder, "A Fast and Robust Method for Avoiding
/// Self-Intersection", Ray Tracing Gems (2019), chapter 6, with their 256 units in the last place of the largest
/// coordinate, and the bound stored with the point, so that instances and analytic shapes, whose coordinates
/// pass through larger numbers than the result, can widen it (as the error bounds of Pharr, Jakob, Humphreys,
/// "Physically Based Rendering", 4th edition, section 6.8, do). Segments between two points are shortened at both ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// World position.
    pub position: Vec3A,
    /// Unit geometric normal; its side is the surface's outside. Zero for points in space.
    pub normal: Vec3A,
    /// Surface parameters.
    pub uv: [f32; 2],
    /// How far from the surface rays start, in units of length.
    pub error: f32,
}

/// 256 units in the last place: the relative distance from the surface at which rays start.
const RELATIVE_OFFSET: f32 = 256.0 * f32::EPSILON * 0.5;

impl SurfacePoint {
    /// A point on a surface with the unit normal `normal`.
    #[inline]
    pub fn new(position: Vec3A, normal: Vec3A) -> Self {
        Self { position, normal, uv: [0.0; 2], error: Self::error_of(position.abs().max_element()) }
    }

    /// A point in space: rays from here need no offset.
    #[inline]
    pub fn in_space(position: Vec3A) -> Self {
        Self { position, normal: Vec3A::ZERO, uv: [0.0; 2], error: 0.0 }
    }

    /// The offset for positions that were computed from coordinates up to `magnitude`.
    #[inline]
    pub fn error_of(magnitude: f32) -> f32 {
        magnitude.max(f32::MIN_POSITIVE) * RELATIVE_OFFSET
    }

    /// The position moved off the surface to the side of `direction`.
    #[inline]
    pub fn offset_towards(&self, direction: Vec3A) -> Vec3A {
        self.position + self.normal * self.error.copysign(self.normal.dot(direction))
    }

    /// The ray that leaves in the unit direction `direction`.
    #[inline]
    pub fn ray_along(&self, direction: Vec3A) -> Ray {
        Ray::new(self.offset_towards(direction), direction)
    }

    /// The ray to `other` that ends just before it. Coincident points give a ray of length zero.
    #[inline]
    pub fn ray_to(&self, other: &SurfacePoint) -> Ray {
        let between = other.position - self.position;
        let origin = self.offset_towards(between);
        let target = other.offset_towards(-between);
        let segment = target - origin;
        let length = segment.length();
        if length.is_nan() || length <= 0.0 {
            return Ray::new(origin, Vec3A::Z).up_to(0.0);
        }
        Ray::new(origin, segment / length).up_to(length * (1.0 - 4.0 * f32::EPSILON))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_leave_on_the_side_they_point_to() {
        let point = SurfacePoint::new(Vec3A::new(100.0, -3.0, 2.0), Vec3A::Y);
        assert!(point.ray_along(Vec3A::Y).origin.y > -3.0);
        assert!(point.ray_along(-Vec3A::Y).origin.y < -3.0);
        assert!((point.ray_along(Vec3A::Y).origin.y + 3.0) < 0.01);
    }

    #[test]
    fn segments_end_before_their_target() {
        let a = SurfacePoint::new(Vec3A::ZERO, Vec3A::Z);
        let b = SurfacePoint::new(Vec3A::new(0.0, 0.0, 2.0), -Vec3A::Z);
        let ray = a.ray_to(&b);
        assert!(ray.origin.z > 0.0 && ray.at(ray.max_distance).z < 2.0);
        assert_eq!(a.ray_to(&a).max_distance.min(1e-3), a.ray_to(&a).max_distance);
        let s = SurfacePoint::in_space(Vec3A::ONE);
        assert_eq!(s.ray_to(&s).max_distance, 0.0);
    }
}
