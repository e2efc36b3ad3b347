//! Tessellated surfaces, put together, bent and moved before they become a mesh of the scene.

use std::sync::Arc;

use glam::{Affine3A, Mat3A, Quat, Vec3, Vec3A};

use super::SceneBuilder;
use crate::reference::{MaterialId, Shape, TriangleMesh};

/// Triangles with smooth normals and texture coordinates.
#[derive(Clone, Debug, Default)]
pub(crate) struct Form {
    positions: Vec<Vec3A>,
    normals: Vec<Vec3A>,
    uvs: Vec<[f32; 2]>,
    triangles: Vec<[u32; 3]>,
}

impl Form {
    /// Adds a vertex and returns its index. `normal` need not have unit length.
    pub(crate) fn vertex(&mut self, position: Vec3A, normal: Vec3A, uv: [f32; 2]) -> u32 {
        self.positions.push(position);
        self.normals.push(normal.normalize_or(Vec3A::Y));
        self.uvs.push(uv);
        self.len() - 1
    }

    /// The number of vertices.
    pub(crate) fn len(&self) -> u32 {
        self.positions.len() as u32
    }

    /// Whether there are no triangles.
    pub(crate) fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// The position of a vertex.
    pub(crate) fn position(&self, index: u32) -> Vec3A {
        self.positions[index as usize]
    }

    /// Adds the triangle of three vertices, seen counterclockwise from outside, unless it has no area.
    pub(crate) fn triangle(&mut self, corners: [u32; 3]) {
        let [a, b, c] = corners.map(|i| self.positions[i as usize]);
        if (b - a).cross(c - a).length_squared() > 1e-22 {
            self.triangles.push(corners);
        }
    }

    /// Adds the quadrilateral of four vertices, seen counterclockwise from outside.
    pub(crate) fn quadrilateral(&mut self, [a, b, c, d]: [u32; 4]) {
        self.triangle([a, b, c]);
        self.triangle([a, c, d]);
    }

    /// A grid of `columns` times `rows` quadrilaterals over `position(u, v)` on the unit square. Its outside is that of
    /// `dp/du x dp/dv`, and so are the normals (by central differences).
    pub(crate) fn patch(columns: u32, rows: u32, position: impl Fn(f32, f32) -> Vec3A) -> Self {
        let mut form = Self::default();
        let h = 1e-3;
        for j in 0..=rows {
            for i in 0..=columns {
                let (u, v) = (i as f32 / columns as f32, j as f32 / rows as f32);
                // Away from the border, where derivatives may vanish.
                let (x, y) = (u.clamp(h, 1.0 - h), v.clamp(h, 1.0 - h));
                let du = position(x + h, y) - position(x - h, y);
                let dv = position(x, y + h) - position(x, y - h);
                form.vertex(position(u, v), du.cross(dv), [u, v]);
            }
        }
        for j in 0..rows {
            for i in 0..columns {
                let a = j * (columns + 1) + i;
                let d = a + columns + 1;
                form.quadrilateral([a, a + 1, d + 1, d]);
            }
        }
        form
    }

    /// A parallelogram; its outside is that of `a x b`.
    pub(crate) fn parallelogram(corner: Vec3A, a: Vec3A, b: Vec3A) -> Self {
        Self::patch(1, 1, |u, v| corner + u * a + v * b)
    }

    /// A box with sharp edges.
    pub(crate) fn cuboid(center: Vec3A, half: Vec3A) -> Self {
        let axes = [Vec3A::X, Vec3A::Y, Vec3A::Z];
        Self::all((0..3).flat_map(|k| [(k, 1.0), (k, -1.0)]).map(|(k, sign): (usize, f32)| {
            let (a, b) = (2.0 * half * axes[(k + 1) % 3], 2.0 * half * axes[(k + 2) % 3]);
            let corner = center - half + if sign > 0.0 { 2.0 * half * axes[k] } else { Vec3A::ZERO };
            if sign > 0.0 { Self::parallelogram(corner, a, b) } else { Self::parallelogram(corner, b, a) }
        }))
    }

    /// A disk around `center` with the outside `normal`.
    pub(crate) fn disk(center: Vec3A, normal: Vec3A, radius: f32, segments: u32) -> Self {
        let (x, y) = normal.normalize_or(Vec3A::Y).any_orthonormal_pair();
        let mut form = Self::default();
        form.vertex(center, normal, [0.5; 2]);
        for i in 0..=segments {
            let (sin, cos) = (core::f32::consts::TAU * (i % segments) as f32 / segments as f32).sin_cos();
            form.vertex(center + radius * (cos * x + sin * y), normal, [0.5 + 0.5 * cos, 0.5 + 0.5 * sin]);
        }
        for i in 1..=segments {
            form.triangle([0, i, i + 1]);
        }
        form
    }

    /// This form and another one, as one mesh.
    #[must_use]
    pub(crate) fn and(mut self, other: Self) -> Self {
        let offset = self.positions.len() as u32;
        self.positions.extend(other.positions);
        self.normals.extend(other.normals);
        self.uvs.extend(other.uvs);
        self.triangles.extend(other.triangles.iter().map(|triangle| triangle.map(|i| i + offset)));
        self
    }

    /// Several forms as one mesh.
    pub(crate) fn all(parts: impl IntoIterator<Item = Self>) -> Self {
        parts.into_iter().fold(Self::default(), Self::and)
    }

    /// The image under `to`, which keeps orientation.
    #[must_use]
    pub(crate) fn moved(mut self, to: Affine3A) -> Self {
        let normal_matrix = cofactors(to.matrix3);
        for (position, normal) in self.positions.iter_mut().zip(&mut self.normals) {
            *position = to.transform_point3a(*position);
            *normal = (normal_matrix * *normal).normalize_or(*normal);
        }
        self
    }

    /// The image under a smooth map that keeps orientation.
    #[must_use]
    pub(crate) fn warped(mut self, map: impl Fn(Vec3A) -> Vec3A) -> Self {
        let h = 1e-3;
        for (position, normal) in self.positions.iter_mut().zip(&mut self.normals) {
            let p = *position;
            let derivative = |axis: Vec3A| (map(p + h * axis) - map(p - h * axis)) / (2.0 * h);
            let jacobian = Mat3A::from_cols(derivative(Vec3A::X), derivative(Vec3A::Y), derivative(Vec3A::Z));
            *position = map(p);
            *normal = (cofactors(jacobian) * *normal).normalize_or(*normal);
        }
        self
    }

    /// As a mesh.
    fn mesh(&self) -> TriangleMesh {
        let positions = self.positions.iter().map(|p| p.to_array()).collect();
        let normals = self.normals.iter().map(|n| n.to_array()).collect();
        // Indices are below the number of vertices by construction.
        TriangleMesh::new(positions, normals, self.uvs.clone(), self.triangles.clone()).unwrap_or_default()
    }
}

/// The cofactors of `m`, which carry normals where `m` carries points.
fn cofactors(m: Mat3A) -> Mat3A {
    Mat3A::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis))
}

/// A point or a vector.
pub(crate) const fn v(x: f32, y: f32, z: f32) -> Vec3A {
    Vec3A::new(x, y, z)
}

/// The placement at `(x, y, z)`, turned by `degrees` about the vertical: +z turns towards +x.
pub(crate) fn at(x: f32, y: f32, z: f32, degrees: f32) -> Affine3A {
    Affine3A::from_rotation_translation(Quat::from_rotation_y(degrees.to_radians()), Vec3::new(x, y, z))
}

impl SceneBuilder {
    /// Places a form.
    pub(crate) fn form(&mut self, material: MaterialId, form: &Form) -> &mut Self {
        self.place(Shape::Mesh(Arc::new(form.mesh())), material, Affine3A::IDENTITY)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// All triangles face to the side of their vertices' normals.
    pub(crate) fn normals_agree(form: &Form) -> bool {
        form.triangles.iter().all(|triangle| {
            let [a, b, c] = triangle.map(|i| form.positions[i as usize]);
            let geometric = (b - a).cross(c - a).normalize();
            triangle.iter().all(|&i| form.normals[i as usize].dot(geometric) > 0.3)
        })
    }

    /// Flux of the field `p / 3` through the surface: the enclosed volume, if it is closed.
    pub(crate) fn volume(form: &Form) -> f32 {
        let corner = |i: u32| form.positions[i as usize].as_dvec3();
        let six = form.triangles.iter().map(|&[a, b, c]| corner(a).dot(corner(b).cross(corner(c)))).sum::<f64>();
        (six / 6.0) as f32
    }

    #[test]
    fn patches_and_disks_face_as_they_say() {
        let dome = Form::patch(8, 6, |u, v| Vec3A::new(u, v * (1.0 - v) + u * (1.0 - u), -v));
        assert!(normals_agree(&dome) && dome.normals.iter().all(|n| n.y > 0.0));
        assert_eq!(dome.triangles.len(), 2 * 8 * 6);
        let disk = Form::disk(Vec3A::Y, -Vec3A::Y, 0.5, 12);
        assert!(normals_agree(&disk) && disk.normals.iter().all(|n| n.y == -1.0));
    }

    #[test]
    fn moving_and_warping_carry_normals() {
        let square = Form::parallelogram(Vec3A::ZERO, Vec3A::X, Vec3A::Y);
        let moved = square.clone().moved(Affine3A::from_scale(Vec3::new(2.0, 3.0, 1.0)) * at(1.0, 2.0, 3.0, 90.0));
        assert!(normals_agree(&moved) && moved.normals.iter().all(|n| n.abs_diff_eq(Vec3A::X, 1e-6)));
        let bent = square.warped(|p| p + Vec3A::Z * p.x * p.x);
        assert!(normals_agree(&bent.clone().and(moved)));
        assert!(bent.normals[1].abs_diff_eq(Vec3A::new(-2.0, 0.0, 1.0).normalize(), 1e-3), "{:?}", bent.normals);
    }

    #[test]
    fn triangles_without_area_are_left_out() {
        let cone = Form::patch(6, 1, |u, v| v * Vec3A::new(u, 0.0, u - 1.0));
        assert_eq!(cone.triangles.len(), 6);
        assert_eq!(cone.mesh().triangles().len(), 6);
        assert!(volume(&cone).abs() < 1e-6);
    }
}
