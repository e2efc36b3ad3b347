//! Position, normals and tangents at a point of a surface.

use core::f32::consts::{PI, TAU};

use glam::Vec3A;

use super::world::Object;
use crate::ray::SurfacePoint;

/// Position, normals and tangents at a point of a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalGeometry {
    pub point: SurfacePoint,
    pub shading_normal: Vec3A,
    pub dpdu: Vec3A,
    pub dpdv: Vec3A,
}

impl LocalGeometry {
    pub(super) fn of_sphere(position: Vec3A, center: Vec3A, radius: f32, flip_normals: bool) -> Self {
        let outward = (position - center).normalize_or(Vec3A::Z);
        let normal = if flip_normals { -outward } else { outward };
        let position = center + outward * radius.abs();
        let magnitude = position.abs().max(center.abs()).max_element().max(radius.abs());
        let phi = outward.y.atan2(outward.x);
        let phi = if phi < 0.0 { phi + TAU } else { phi };
        let theta = outward.z.clamp(-1.0, 1.0).acos();
        let uv = [phi / TAU, theta / PI];
        let dpdu = Vec3A::new(-outward.y, outward.x, 0.0) * (TAU * radius);
        let dpdv = Vec3A::new(outward.z * phi.cos(), outward.z * phi.sin(), -theta.sin()) * (PI * radius);
        let point = SurfacePoint { position, normal, uv, error: SurfacePoint::error_of(magnitude) };
        Self { point, shading_normal: normal, dpdu, dpdv }
    }

    pub(super) fn of_disk(position: Vec3A) -> Self {
        let r = position.truncate().length();
        let phi = position.y.atan2(position.x);
        let phi = if phi < 0.0 { phi + TAU } else { phi };
        let uv = [r, phi / TAU];
        let (sin, cos) = phi.sin_cos();
        let position = Vec3A::new(position.x, position.y, 0.0);
        let point = SurfacePoint { position, normal: Vec3A::Z, uv, error: SurfacePoint::error_of(1.0) };
        let dpdu = Vec3A::new(cos, sin, 0.0);
        let dpdv = Vec3A::new(-sin, cos, 0.0) * (TAU * r);
        Self { point, shading_normal: Vec3A::Z, dpdu, dpdv }
    }

    /// From the object's to the world's coordinates; the bound of the round-off grows by that of the transform.
    #[inline]
    pub(super) fn transformed(mut self, object: &Object) -> Self {
        let m = &object.to_world;
        let p = self.point.position;
        let position = m.transform_point3a(p);
        let scale = m.matrix3.x_axis.abs() + m.matrix3.y_axis.abs() + m.matrix3.z_axis.abs();
        let passed = m.matrix3.x_axis.abs() * p.x.abs()
            + m.matrix3.y_axis.abs() * p.y.abs()
            + m.matrix3.z_axis.abs() * p.z.abs()
            + m.translation.abs();
        let magnitude = passed.max(position.abs()).max_element();
        self.point.error = SurfacePoint::error_of(magnitude) + self.point.error * scale.max_element();
        self.point.position = position;
        self.point.normal = (object.normal_matrix * self.point.normal).normalize_or(Vec3A::Z);
        self.shading_normal = (object.normal_matrix * self.shading_normal).normalize_or(self.point.normal);
        self.dpdu = m.transform_vector3a(self.dpdu);
        self.dpdv = m.transform_vector3a(self.dpdv);
        self
    }
}
