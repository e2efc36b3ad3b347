//! Surfaces and rays.

mod analytic;
mod hierarchy;
mod mesh;
mod triangle;
mod triangle_bvh;
mod world;

pub use mesh::{MeshError, TriangleMesh};
pub(crate) use triangle_bvh::TriangleBvh;
pub(crate) use world::{LocalGeometry, Object, ObjectShape, World, WorldMesh};
