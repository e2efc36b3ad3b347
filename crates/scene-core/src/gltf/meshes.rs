//! Meshes: from the attributes of primitives to triangles.

use std::sync::Arc;

use ::gltf::mesh::Mode;
use ::gltf::{Mesh, Semantic};

use super::error::{Place, Result};
use super::importer::Importer;
use crate::reference::TriangleMesh;

/// The triangles of a primitive.
#[derive(Debug)]
pub(super) struct Primitive {
    pub(super) mesh: Arc<TriangleMesh>,
    /// Index of its material; nothing for the specification's default.
    pub(super) material: Option<usize>,
}

impl<'s> Importer<'s> {
    /// The primitives of a mesh that are triangles; others are left out with a warning.
    pub(super) fn mesh(&mut self, mesh: &Mesh<'s>) -> Result<Vec<Primitive>> {
        let whole = self.source.place("meshes", mesh.index(), mesh.name());
        let mut primitives = Vec::new();
        for primitive in mesh.primitives() {
            let place = whole.part(format!("primitives[{}]", primitive.index()));
            if let Some(mesh) = self.triangles(&primitive, &place)? {
                primitives.push(Primitive { mesh: Arc::new(mesh), material: primitive.material().index() });
            }
        }
        Ok(primitives)
    }

    fn triangles(&mut self, primitive: &::gltf::Primitive<'s>, place: &Place) -> Result<Option<TriangleMesh>> {
        let mode = primitive.mode();
        if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            self.warn(place, format!("left out: a primitive of {mode:?}"));
            return Ok(None);
        }
        if primitive.morph_targets().len() > 0 {
            self.warn(place, "ignored: morph targets");
        }
        let Some(accessor) = primitive.get(&Semantic::Positions) else {
            self.warn(place, "left out: a primitive without positions");
            return Ok(None);
        };
        let (source, buffers) = (self.source, self.buffers);
        let positions = buffers.floats::<3>(source, &accessor)?;
        let normals = primitive.get(&Semantic::Normals);
        let normals = normals.map_or(Ok(Vec::new()), |accessor| buffers.floats::<3>(source, &accessor))?;
        let set = self.texture_coordinates_of(&primitive.material());
        let uvs = match (primitive.get(&Semantic::TexCoords(set.unwrap_or(0))), set) {
            (Some(accessor), _) => buffers.floats::<2>(source, &accessor)?,
            (None, Some(set)) => {
                self.warn(place, format!("has a textured material, but no TEXCOORD_{set}: (0, 0) is taken"));
                vec![[0.0; 2]; positions.len()]
            }
            (None, None) => Vec::new(),
        };
        if primitive.get(&Semantic::Colors(0)).is_some() {
            self.warn(place, "ignored: COLOR_0");
        }
        let indices = match primitive.indices() {
            Some(accessor) => buffers.indices(source, &accessor)?,
            None => (0..u32::try_from(positions.len()).unwrap_or(u32::MAX)).collect(),
        };
        if mode == Mode::Triangles && indices.len() % 3 != 0 {
            self.warn(place, format!("{} indices are no whole number of triangles", indices.len()));
        }
        for (attribute, found) in [("normals", normals.len()), ("texture coordinates", uvs.len())] {
            if found != 0 && found != positions.len() {
                return Err(place.invalid(format!("there are {found} {attribute} for {} vertices", positions.len())));
            }
        }
        let used = used(positions, normals, uvs, assembled(mode, &indices));
        let (positions, normals, uvs, triangles) = used
            .map_err(|vertex| place.invalid(format!("an index names vertex {vertex}, and there are not that many")))?;
        let mesh =
            TriangleMesh::new(positions, normals, uvs, triangles).map_err(|error| place.invalid(error.to_string()))?;
        if mesh.dropped() > 0 {
            let message = "triangles are dropped, whose vertices are not finite or which have no area";
            self.warn(place, format!("{} {message}", mesh.dropped()));
        }
        Ok(Some(mesh))
    }
}

/// Triangles of a list, a strip or a fan (section 3.7.2.1), all of the same orientation.
fn assembled(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    let triples = indices.windows(3).map(|t| [t[0], t[1], t[2]]);
    match mode {
        Mode::TriangleStrip => {
            let turned = |(i, [a, b, c]): (usize, [u32; 3])| if i % 2 == 0 { [a, b, c] } else { [a, c, b] };
            triples.enumerate().map(turned).collect()
        }
        Mode::TriangleFan => triples.map(|[_, b, c]| [b, c, indices[0]]).collect(),
        _ => indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
    }
}

type Attributes = (Vec<[f32; 3]>, Vec<[f32; 3]>, Vec<[f32; 2]>, Vec<[u32; 3]>);

/// Keeps the vertices that triangles use: primitives often share one long list. Normals and texture coordinates are as many as positions,
/// or none. The error is an index out of range.
fn used(
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    mut triangles: Vec<[u32; 3]>,
) -> std::result::Result<Attributes, u32> {
    const UNUSED: u32 = u32::MAX;
    let mut new_index = vec![UNUSED; positions.len()];
    let mut kept = Vec::new();
    for index in triangles.iter_mut().flatten() {
        let new = new_index.get_mut(*index as usize).ok_or(*index)?;
        if *new == UNUSED {
            *new = kept.len() as u32;
            kept.push(*index as usize);
        }
        *index = *new;
    }
    fn pick<T: Copy>(all: &[T], kept: &[usize]) -> Vec<T> {
        if all.is_empty() { Vec::new() } else { kept.iter().map(|&i| all[i]).collect() }
    }
    Ok((pick(&positions, &kept), pick(&normals, &kept), pick(&uvs, &kept), triangles))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_their_orientation() {
        let indices = [4, 5, 6, 7, 8];
        assert_eq!(assembled(Mode::TriangleStrip, &indices), [[4, 5, 6], [5, 7, 6], [6, 7, 8]]);
        assert_eq!(assembled(Mode::TriangleFan, &indices), [[5, 6, 4], [6, 7, 4], [7, 8, 4]]);
        assert_eq!(assembled(Mode::Triangles, &indices), [[4, 5, 6]]);
        assert!(assembled(Mode::TriangleFan, &indices[..2]).is_empty());
    }

    #[test]
    fn unused_vertices_are_left_out() {
        let positions = (0..5).map(|i| [i as f32; 3]).collect();
        let uvs = (0..5).map(|i| [i as f32; 2]).collect();
        let (positions, normals, uvs, triangles) = used(positions, vec![], uvs, vec![[4, 1, 2], [2, 1, 4]]).unwrap();
        assert!(normals.is_empty() && positions == [[4.0; 3], [1.0; 3], [2.0; 3]]);
        assert_eq!((uvs, triangles), (vec![[4.0; 2], [1.0; 2], [2.0; 2]], vec![[0, 1, 2], [2, 1, 0]]));
        assert_eq!(used(vec![[0.0; 3]], vec![], vec![], vec![[0, 0, 7]]).unwrap_err(), 7);
    }
}
