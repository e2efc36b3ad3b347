//! Densities of vertices.

use glam::Vec3A;
use scene_core::SurfacePoint;

/// What leaves `from` with density `pdf` by solid angle arrives at `to` with this density by area: `pdf |cos| / d^2`.
#[inline]
pub(super) fn by_area(pdf: f32, from: Vec3A, to: &SurfacePoint) -> f64 {
    let between = to.position - from;
    let inverse = 1.0 / between.length_squared();
    let cos = between.dot(to.normal).abs() * inverse.sqrt();
    f64::from(pdf) * f64::from(cos) * f64::from(inverse)
}

/// What comes from infinity through a disk with density `pdf_area` arrives at `to` with this density by area.
#[inline]
pub(super) fn through_disk(pdf_area: f32, direction: Vec3A, to: &SurfacePoint) -> f64 {
    f64::from(pdf_area) * f64::from(direction.dot(to.normal).abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn projected_solid_angle_over_distance() {
        let to = SurfacePoint::new(Vec3A::new(0.0, 0.0, 2.0), Vec3A::new(0.6, 0.0, 0.8));
        assert!((by_area(3.0, Vec3A::ZERO, &to) - 3.0 * 0.8 / 4.0).abs() < 1e-6);
        assert!((through_disk(3.0, Vec3A::X, &to) - 1.8).abs() < 1e-6);
        assert!(!by_area(1.0, to.position, &to).is_normal());
    }
}
