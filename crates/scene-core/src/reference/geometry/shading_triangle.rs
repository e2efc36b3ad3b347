//! What shading asks of triangles, gathered for the hit that asks.

use glam::{Vec3A, Vec4};

use super::local_geometry::LocalGeometry;
use super::mesh::TriangleMesh;
use super::triangle_bvh::TriangleBvh;
use crate::ray::SurfacePoint;

/// Triangles in a hierarchy, with what shading needs of them.
#[derive(Clone, Debug)]
pub(crate) struct Triangles {
    bvh: TriangleBvh,
    /// One for each slot of the hierarchy.
    shading: Vec<ShadingTriangle>,
}

/// One triangle: two cache lines. The mesh that it comes from would take ten: its indices, and three vertices in up to three
/// arrays.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct ShadingTriangle {
    /// The corners; the fourth component of the first is the bound of the round-off.
    corners: [Vec4; 3],
    /// The unit geometric normal, outside if that does not depend on the place; the fourth component is one if the normals
    /// at the corners are the same (or there are none), zero if they have to be interpolated.
    normal: Vec4,
    /// At the corners: unit, or zero for 'use the triangle's'.
    normals: [[f32; 3]; 3],
    uvs: [[f32; 2]; 3],
    /// Index of the surface in the scene.
    surface: u32,
}

impl ShadingTriangle {
    /// What empty lanes hold. Never hit.
    const NONE: Self = Self {
        corners: [Vec4::ZERO; 3],
        normal: Vec4::Z,
        normals: [[0.0; 3]; 3],
        uvs: [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
        surface: 0,
    };

    fn new(mesh: &TriangleMesh, triangle: usize, surface: u32) -> Self {
        let indices = mesh.triangles()[triangle].map(|i| i as usize);
        let corners = mesh.corners(triangle);
        let [a, b, c] = corners;
        let magnitude = a.abs().max(b.abs()).max(c.abs()).max_element();
        let fourth = [SurfacePoint::error_of(magnitude), 0.0, 0.0];
        let mut normal = (b - a).cross(c - a).normalize_or(Vec3A::Z);
        let mut normals = Self::NONE.normals;
        if let [Some(na), Some(nb), Some(nc)] = indices.map(|i| mesh.normals().get(i).copied()) {
            normals = [na, nb, nc];
        }
        let is_flat = normals[0] == normals[1] && normals[1] == normals[2];
        if is_flat {
            match Vec3A::from(normals[0]).try_normalize() {
                // The outside is where the vertex normals point, whatever the winding.
                Some(n) => {
                    normal *= 1.0f32.copysign(normal.dot(n));
                    normals = [n.to_array(); 3];
                }
                None => normals = [normal.to_array(); 3],
            }
        }
        let mut uvs = Self::NONE.uvs;
        if let [Some(ta), Some(tb), Some(tc)] = indices.map(|i| mesh.uvs().get(i).copied()) {
            uvs = [ta, tb, tc];
        }
        let corners = core::array::from_fn(|i| corners[i].extend(fourth[i]));
        Self { corners, normal: normal.extend(f32::from(is_flat)), normals, uvs, surface }
    }

    /// The point with barycentric coordinates `u` and `v` of the second and third corner. Without `with_tangents`, the derivatives are
    /// any two edges. Without texture coordinates the barycentric ones take their place.
    #[inline(always)]
    fn geometry(&self, u: f32, v: f32, with_tangents: bool) -> LocalGeometry {
        let w = 1.0 - u - v;
        let error = self.corners[0].w;
        let [a, b, c] = self.corners.map(Vec3A::from_vec4);
        let position = a * w + b * u + c * v;
        let mut normal = Vec3A::from_vec4(self.normal);
        let mut shading_normal = Vec3A::from(self.normals[0]);
        if self.normal.w == 0.0 {
            let [na, nb, nc] = self.normals.map(Vec3A::from);
            shading_normal = match (na * w + nb * u + nc * v).try_normalize() {
                Some(n) => {
                    normal *= 1.0f32.copysign(normal.dot(n));
                    n
                }
                None => normal,
            };
        }
        let [ta, tb, tc] = self.uvs;
        let uv = core::array::from_fn(|i| ta[i] * w + tb[i] * u + tc[i] * v);
        let point = SurfacePoint { position, normal, uv, error };
        let (e1, e2) = (b - a, c - a);
        if !with_tangents {
            return LocalGeometry { point, shading_normal, dpdu: e1, dpdv: e2 };
        }
        let (d1, d2) = ([tb[0] - ta[0], tb[1] - ta[1]], [tc[0] - ta[0], tc[1] - ta[1]]);
        let determinant = d1[0] * d2[1] - d1[1] * d2[0];
        if determinant == 0.0 {
            return LocalGeometry { point, shading_normal, dpdu: e1, dpdv: e2 };
        }
        let inverse = 1.0 / determinant;
        let dpdu = (e1 * d2[1] - e2 * d1[1]) * inverse;
        let dpdv = (e2 * d1[0] - e1 * d2[0]) * inverse;
        LocalGeometry { point, shading_normal, dpdu, dpdv }
    }
}

impl Triangles {
    /// Of meshes, each with the index of its surface in the scene.
    pub(crate) fn new<'m>(meshes: impl Iterator<Item = (&'m TriangleMesh, u32)> + Clone) -> Self {
        let each = meshes.flat_map(|(mesh, surface)| (0..mesh.len()).map(move |i| (mesh, i, surface)));
        let corners: Vec<_> = each.clone().map(|(mesh, i, _)| mesh.corners(i)).collect();
        let (bvh, slots) = TriangleBvh::new(&corners);
        let sources: Vec<_> = each.collect();
        let shading = |slot: &Option<u32>| {
            slot.map_or(ShadingTriangle::NONE, |index| {
                let (mesh, triangle, surface) = sources[index as usize];
                ShadingTriangle::new(mesh, triangle, surface)
            })
        };
        Self { bvh, shading: slots.iter().map(shading).collect() }
    }

    /// The hierarchy.
    #[inline(always)]
    pub(crate) fn bvh(&self) -> &TriangleBvh {
        &self.bvh
    }

    /// The surface of the triangle in a slot.
    #[inline(always)]
    pub(crate) fn surface(&self, slot: u32) -> u32 {
        self.shading[slot as usize].surface
    }

    /// The geometry at a hit of the triangle in a slot.
    #[inline(always)]
    pub(crate) fn geometry(&self, slot: u32, u: f32, v: f32, with_tangents: bool) -> LocalGeometry {
        self.shading[slot as usize].geometry(u, v, with_tangents)
    }
}
