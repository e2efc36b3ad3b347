//! Triangle meshes, checked.

use glam::{Affine3A, Vec3A};
use thiserror::Error;

/// Why a mesh cannot be used.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} refers to vertex {vertex}, but there are only {count}")]
    IndexOutOfRange {
        /// Which triangle.
        triangle: usize,
        /// The index it names.
        vertex: u32,
        /// Number of vertices.
        count: usize,
    },
    /// An attribute has another number of elements than there are vertices.
    #[error("there are {found} {attribute} for {expected} vertices")]
    AttributeCount {
        /// Which attribute.
        attribute: &'static str,
        /// How many there are.
        found: usize,
        /// How many there should be.
        expected: usize,
    },
    /// More vertices than indices can name.
    #[error("{0} vertices are more than 32 bit indices can name")]
    TooManyVertices(usize),
}

/// A triangle mesh whose triangles all have finite vertices and a positive area.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    triangles: Vec<[u32; 3]>,
    dropped: usize,
}

impl TriangleMesh {
    /// Checks and keeps the usable triangles: those with vertices that are not finite and those without area
    /// are dropped and counted. `normals` and `uvs` may be empty.
    ///
    /// # Errors
    /// An index out of range, or attributes that do not match the vertices.
    pub fn new(
        positions: Vec<[f32; 3]>,
        normals: Vec<[f32; 3]>,
        uvs: Vec<[f32; 2]>,
        triangles: Vec<[u32; 3]>,
    ) -> Result<Self, MeshError> {
        let count = positions.len();
        if u32::try_from(count).is_err() {
            return Err(MeshError::TooManyVertices(count));
        }
        for (attribute, found) in [("normals", normals.len()), ("texture coordinates", uvs.len())] {
            if found != 0 && found != count {
                return Err(MeshError::AttributeCount { attribute, found, expected: count });
            }
        }
        for (triangle, indices) in triangles.iter().enumerate() {
            if let Some(&vertex) = indices.iter().find(|&&i| i as usize >= count) {
                return Err(MeshError::IndexOutOfRange { triangle, vertex, count });
            }
        }
        let before = triangles.len();
        let mut mesh = Self { positions, normals, uvs, triangles: Vec::new(), dropped: 0 };
        mesh.triangles = triangles;
        mesh.triangles.retain(|&[a, b, c]| {
            let [a, b, c] = [a, b, c].map(|i| Vec3A::from(mesh.positions[i as usize]));
            let area = (b - a).cross(c - a).length();
            area.is_finite() && area > 0.0
        });
        mesh.dropped = before - mesh.triangles.len();
        mesh.repair_attributes();
        Ok(mesh)
    }

    /// Normals or texture coordinates that are not finite are replaced by zero: a zero normal means 'use the
    /// triangle's'.
    fn repair_attributes(&mut self) {
        for normal in &mut self.normals {
            *normal = Vec3A::from(*normal).try_normalize().unwrap_or(Vec3A::ZERO).to_array();
        }
        for uv in &mut self.uvs {
            if !uv.iter().all(|x| x.is_finite()) {
                *uv = [0.0; 2];
            }
        }
    }

    /// Number of triangles.
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Whether there are no triangles.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// How many triangles were dropped because a vertex is not finite or the area is zero.
    pub fn dropped(&self) -> usize {
        self.dropped
    }

    /// Vertex positions.
    pub fn positions(&self) -> &[[f32; 3]] {
        &self.positions
    }

    /// Unit vertex normals; empty if the mesh has none.
    pub fn normals(&self) -> &[[f32; 3]] {
        &self.normals
    }

    /// Texture coordinates; empty if the mesh has none.
    pub fn uvs(&self) -> &[[f32; 2]] {
        &self.uvs
    }

    /// Vertex indices, three a triangle.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The corners of a triangle.
    #[inline]
    pub fn corners(&self, triangle: usize) -> [Vec3A; 3] {
        self.triangles[triangle].map(|i| Vec3A::from(self.positions[i as usize]))
    }

    /// The mesh in other coordinates. Triangles that lose their area there are dropped and counted.
    #[must_use]
    pub fn transformed(&self, transform: &Affine3A) -> Self {
        let normal_matrix = transform.matrix3.inverse().transpose();
        let flip = transform.matrix3.determinant() < 0.0;
        let positions = self.positions.iter().map(|&p| transform.transform_point3a(p.into()).to_array()).collect();
        let normals = self.normals.iter().map(|&n| (normal_matrix * Vec3A::from(n)).to_array()).collect();
        let triangles = self.triangles.iter().map(|&[a, b, c]| if flip { [a, c, b] } else { [a, b, c] }).collect();
        match Self::new(positions, normals, self.uvs.clone(), triangles) {
            Ok(mut mesh) => {
                mesh.dropped += self.dropped;
                mesh
            }
            // The same vertices and indices were checked when `self` was made.
            Err(_) => Self { dropped: self.dropped + self.triangles.len(), ..Self::default() },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

    #[test]
    fn drops_and_counts_what_cannot_be_hit() {
        let mut positions = SQUARE.to_vec();
        positions.push([f32::NAN, 0.0, 0.0]);
        let mesh =
            TriangleMesh::new(positions, vec![], vec![], vec![[0, 1, 2], [0, 0, 1], [0, 1, 4], [0, 2, 3]]).unwrap();
        assert_eq!((mesh.len(), mesh.dropped()), (2, 2));
    }

    #[test]
    fn rejects_what_does_not_fit() {
        let error = TriangleMesh::new(SQUARE.to_vec(), vec![], vec![], vec![[0, 1, 9]]).unwrap_err();
        assert_eq!(error, MeshError::IndexOutOfRange { triangle: 0, vertex: 9, count: 4 });
        let error = TriangleMesh::new(SQUARE.to_vec(), vec![[0.0; 3]], vec![], vec![[0, 1, 2]]).unwrap_err();
        assert!(error.to_string().contains("1 normals for 4 vertices"), "{error}");
    }

    #[test]
    fn mirroring_keeps_the_outside_outside() {
        let mesh = TriangleMesh::new(SQUARE.to_vec(), vec![[0.0, 0.0, 1.0]; 4], vec![], vec![[0, 1, 2]]).unwrap();
        let mirrored = mesh.transformed(&Affine3A::from_scale(glam::Vec3::new(-1.0, 1.0, 1.0)));
        let [a, b, c] = mirrored.corners(0);
        assert!((b - a).cross(c - a).z > 0.0);
        assert_eq!(mirrored.normals()[0], [0.0, 0.0, 1.0]);
        let flat = mesh.transformed(&Affine3A::from_scale(glam::Vec3::new(0.0, 1.0, 1.0)));
        assert_eq!((flat.len(), flat.dropped()), (0, 1));
    }
}
