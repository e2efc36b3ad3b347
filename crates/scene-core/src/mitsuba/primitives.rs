//! Shapes that become meshes.

use std::f32::consts::TAU;

use glam::Vec3A;

use super::raw_mesh::RawMesh;
use crate::Frame;

/// Number of segments that a cylinder becomes.
pub(super) const CYLINDER_SEGMENTS: u32 = 128;

/// The square `[-1, 1]^2` in the plane z = 0, normal +z, `(u, v) = (x + 1, y + 1) / 2`.
pub(super) fn rectangle() -> RawMesh {
    let uvs = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    RawMesh {
        positions: uvs.iter().map(|&[u, v]: &[f32; 2]| [2.0 * u - 1.0, 2.0 * v - 1.0, 0.0]).collect(),
        normals: vec![[0.0, 0.0, 1.0]; 4],
        uvs,
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        face_normals: false,
    }
}

/// Normal of each face of the cube, and its corners, whose texture coordinates are (0, 1), (1, 1), (1, 0), (0, 0).
const CUBE: [([f32; 3], [[f32; 3]; 4]); 6] = [
    ([0.0, -1.0, 0.0], [[1.0, -1.0, -1.0], [1.0, -1.0, 1.0], [-1.0, -1.0, 1.0], [-1.0, -1.0, -1.0]]),
    ([0.0, 1.0, 0.0], [[1.0, 1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, 1.0, 1.0], [1.0, 1.0, 1.0]]),
    ([1.0, 0.0, 0.0], [[1.0, -1.0, -1.0], [1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [1.0, -1.0, 1.0]]),
    ([0.0, 0.0, 1.0], [[1.0, -1.0, 1.0], [1.0, 1.0, 1.0], [-1.0, 1.0, 1.0], [-1.0, -1.0, 1.0]]),
    ([-1.0, 0.0, 0.0], [[-1.0, -1.0, 1.0], [-1.0, 1.0, 1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, -1.0]]),
    ([0.0, 0.0, -1.0], [[1.0, 1.0, -1.0], [1.0, -1.0, -1.0], [-1.0, -1.0, -1.0], [-1.0, 1.0, -1.0]]),
];

/// The cube `[-1, 1]^3` with flat faces, each with the unit square of texture coordinates.
pub(super) fn cube() -> RawMesh {
    let mut mesh = RawMesh::default();
    for (face, (normal, corners)) in (0u32..).zip(CUBE) {
        mesh.positions.extend(corners);
        mesh.normals.extend([normal; 4]);
        mesh.uvs.extend([[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]]);
        let [a, b, c, d] = [0, 1, 2, 3].map(|corner| 4 * face + corner);
        mesh.triangles.extend([[a, b, c], [d, a, c]]);
    }
    mesh
}

/// An open cylinder from `p0` to `p1` with normals outwards, `u` around and `v` along the axis.
pub(super) fn cylinder(p0: Vec3A, p1: Vec3A, radius: f32) -> RawMesh {
    let frame = Frame::from_z((p1 - p0).normalize_or_zero());
    let mut mesh = RawMesh::default();
    for i in 0..=CYLINDER_SEGMENTS {
        let u = i as f32 / CYLINDER_SEGMENTS as f32;
        let (sine, cosine) = (u * TAU).sin_cos();
        let normal = frame.x * cosine + frame.y * sine;
        for (v, end) in [(0.0, p0), (1.0, p1)] {
            mesh.positions.push((end + normal * radius).to_array());
            mesh.normals.push(normal.to_array());
            mesh.uvs.push([u, v]);
        }
        if i > 0 {
            let [a, b, c, d] = [2 * i - 2, 2 * i, 2 * i + 1, 2 * i - 1];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::TriangleMesh;

    #[test]
    fn all_faces_look_outwards() {
        let tube = cylinder(Vec3A::new(0.0, 0.0, -1.0), Vec3A::Z, 1.0);
        for (raw, count) in [(rectangle(), 2), (cube(), 12), (tube, 256)] {
            let mesh = TriangleMesh::new(raw.positions, raw.normals, raw.uvs, raw.triangles).unwrap();
            assert_eq!((mesh.len(), mesh.dropped()), (count, 0));
            for (i, triangle) in mesh.triangles().iter().enumerate() {
                let [a, b, c] = mesh.corners(i);
                let normal = (b - a).cross(c - a).normalize();
                assert!(normal.dot(a + b + c) > 0.0 || count == 2);
                for &vertex in triangle {
                    assert!(normal.dot(Vec3A::from(mesh.normals()[vertex as usize])) > 0.99);
                }
            }
        }
    }
}
