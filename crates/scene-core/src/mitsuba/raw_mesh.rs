//! Meshes as they stand in files, and what Mitsuba makes of them.

use glam::{Affine3A, Vec3A};
use thiserror::Error;

use crate::reference::{MeshError, TriangleMesh};

/// Why a mesh file cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{}{message}", line.map(|line| format!("line {line}: ")).unwrap_or_default())]
pub(crate) struct MeshFileError {
    line: Option<usize>,
    message: String,
}

impl MeshFileError {
    pub(crate) fn new(message: impl Into<String>) -> Self {
        Self { line: None, message: message.into() }
    }

    pub(crate) fn at_line(line: usize, message: impl Into<String>) -> Self {
        Self { line: Some(line), message: message.into() }
    }
}

/// The content of a mesh file. `normals` and `uvs` may be empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct RawMesh {
    pub(crate) positions: Vec<[f32; 3]>,
    pub(crate) normals: Vec<[f32; 3]>,
    pub(crate) uvs: Vec<[f32; 2]>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Whether the file asks for flat shading.
    pub(crate) face_normals: bool,
}

/// How a mesh is to be read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct MeshOptions {
    /// Flat shading, whatever normals there are.
    pub(crate) face_normals: bool,
    /// Turns all normals round.
    pub(crate) flip_normals: bool,
    /// `v` becomes `1 - v`.
    pub(crate) flip_tex_coords: bool,
}

impl RawMesh {
    /// How many triangles have vertices that are not finite.
    pub(crate) fn count_not_finite(&self) -> usize {
        let is_finite =
            |&vertex: &u32| self.positions.get(vertex as usize).is_none_or(|p| p.iter().all(|x| x.is_finite()));
        self.triangles.iter().filter(|triangle| !triangle.iter().all(is_finite)).count()
    }

    /// The mesh in its own coordinates, such that it looks in the world (after `to_world`) as Mitsuba shows it.
    ///
    /// Mitsuba moves vertices to the world before anything else. Two things depend on that: smooth normals, which it
    /// computes where a file has none, and the side to which flat triangles of a mirrored mesh face.
    pub(crate) fn finish(mut self, options: MeshOptions, to_world: &Affine3A) -> Result<TriangleMesh, MeshError> {
        let is_flat = options.face_normals || self.face_normals;
        let has_own_normals = !self.normals.is_empty() && !is_flat;
        let mut reverse = options.flip_normals;
        if is_flat {
            self.normals = Vec::new();
        }
        if !has_own_normals {
            reverse ^= to_world.matrix3.determinant() < 0.0;
        }
        if !has_own_normals && !is_flat {
            // Checks the indices.
            let checked = TriangleMesh::new(self.positions.clone(), vec![], vec![], self.triangles.clone())?;
            self.normals = smooth_normals(checked.positions(), checked.triangles(), to_world);
        }
        if options.flip_normals {
            self.normals.iter_mut().for_each(|normal| *normal = normal.map(|x| -x));
        }
        if reverse {
            self.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
        if options.flip_tex_coords {
            self.uvs.iter_mut().for_each(|uv| uv[1] = 1.0 - uv[1]);
        }
        TriangleMesh::new(self.positions, self.normals, self.uvs, self.triangles)
    }
}

/// The mean of the normals of the triangles around a vertex, weighted by their angles there, as seen in the world, in the
/// mesh's coordinates.
///
/// Source: Thürmer and Wüthrich, "Computing Vertex Normals from Polygonal Facets", Journal of Graphics Tools 3(1),
/// 1998.
fn smooth_normals(positions: &[[f32; 3]], triangles: &[[u32; 3]], to_world: &Affine3A) -> Vec<[f32; 3]> {
    let world: Vec<Vec3A> = positions.iter().map(|&p| to_world.transform_point3a(p.into())).collect();
    let mut sums = vec![Vec3A::ZERO; positions.len()];
    for &triangle in triangles {
        let corners = triangle.map(|i| world[i as usize]);
        let Some(normal) = (corners[1] - corners[0]).cross(corners[2] - corners[0]).try_normalize() else { continue };
        for i in 0..3 {
            let (to_next, to_last) = (corners[(i + 1) % 3] - corners[i], corners[(i + 2) % 3] - corners[i]);
            sums[triangle[i] as usize] += normal * to_next.angle_between(to_last);
        }
    }
    // Normals n of the world are the normalised (M^-1)^T m of local ones, so m = M^T n.
    let to_local = to_world.matrix3.transpose();
    sums.iter().map(|&sum| (to_local * sum).try_normalize().unwrap_or(Vec3A::ZERO).to_array()).collect()
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    /// Two triangles that share an edge, at an angle.
    fn bent() -> RawMesh {
        RawMesh {
            positions: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.5]],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..RawMesh::default()
        }
    }

    /// Values of Mitsuba 3.9.1 for the same mesh.
    #[test]
    fn missing_normals_are_those_of_mitsuba() {
        let mesh = bent().finish(MeshOptions::default(), &Affine3A::IDENTITY).unwrap();
        let expected = [
            [0.227_046, -0.227_046, 0.947_048],
            [0.0, 0.0, 1.0],
            [0.227_046, -0.227_046, 0.947_048],
            [0.408_248, -0.408_248, 0.816_497],
        ];
        for (normal, expected) in mesh.normals().iter().zip(expected) {
            assert!((Vec3A::from(*normal) - Vec3A::from(expected)).length() < 1e-5, "{normal:?}");
        }
    }

    /// Smoothing happens in the world, whatever the transform stretches or mirrors.
    #[test]
    fn normals_are_computed_in_the_world() {
        for scale in [Vec3::new(1.0, 3.0, 0.5), Vec3::new(-1.0, 3.0, 0.5)] {
            let to_world = Affine3A::from_scale(scale);
            let placed = bent().finish(MeshOptions::default(), &to_world).unwrap().transformed(&to_world);
            let mut world = bent();
            world.positions.iter_mut().for_each(|p| *p = to_world.transform_point3((*p).into()).to_array());
            let direct = world.finish(MeshOptions::default(), &Affine3A::IDENTITY).unwrap();
            assert_eq!(placed.triangles(), direct.triangles());
            for (a, b) in placed.normals().iter().zip(direct.normals()) {
                assert!((Vec3A::from(*a) - Vec3A::from(*b)).length() < 1e-5, "{a:?} {b:?}");
            }
        }
    }

    /// Which way a triangle and its normal face in the world; Mitsuba 3.9.1 says the same.
    #[test]
    fn facing() {
        let mirror = Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0));
        let facing = |own: bool, face_normals: bool, flip_normals: bool, to_world: Affine3A| {
            let raw = RawMesh {
                positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
                normals: if own { vec![[0.0, 0.0, 1.0]; 3] } else { vec![] },
                triangles: vec![[0, 1, 2]],
                ..RawMesh::default()
            };
            let options = MeshOptions { face_normals, flip_normals, ..MeshOptions::default() };
            let mesh = raw.finish(options, &to_world).unwrap().transformed(&to_world);
            let [a, b, c] = mesh.corners(0);
            let geometric = (b - a).cross(c - a).z.signum();
            if let Some(normal) = mesh.normals().first() {
                assert_eq!(normal[2].signum(), geometric);
            }
            geometric
        };
        for (own, face_normals, mirrored) in
            [(false, true, -1.0), (false, false, -1.0), (true, true, -1.0), (true, false, 1.0)]
        {
            assert_eq!(facing(own, face_normals, false, Affine3A::IDENTITY), 1.0);
            assert_eq!(facing(own, face_normals, true, Affine3A::IDENTITY), -1.0);
            assert_eq!(facing(own, face_normals, false, mirror), mirrored, "{own} {face_normals}");
            assert_eq!(facing(own, face_normals, true, mirror), -mirrored, "{own} {face_normals}");
        }
    }

    #[test]
    fn indices_are_checked_and_nan_is_dropped() {
        let mut mesh = bent();
        mesh.triangles.push([0, 1, 9]);
        assert!(mesh.finish(MeshOptions::default(), &Affine3A::IDENTITY).is_err());
        let mut mesh = bent();
        mesh.positions[3][1] = f32::NAN;
        let mesh = mesh.finish(MeshOptions::default(), &Affine3A::IDENTITY).unwrap();
        assert_eq!((mesh.len(), mesh.dropped()), (1, 1));
        assert!(mesh.normals().iter().flatten().all(|x| x.is_finite()));
    }
}
