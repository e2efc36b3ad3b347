//! Surfaces and rays.

mod analytic;
mod collapse;
mod hierarchy;
mod local_geometry;
mod mesh;
mod shading_triangle;
mod traversal;
#[cfg(test)]
mod triangle;
mod triangle_bvh;
mod triangle_pack;
mod world;

pub(crate) use local_geometry::LocalGeometry;
pub use mesh::{MeshError, TriangleMesh};
pub(crate) use shading_triangle::Triangles;
pub(crate) use world::{Object, ObjectShape, World, WorldMesh};
