//! The reference scene.

mod description;
mod mesh;

pub use description::{
    CameraDescription, FilterDescription, Instance, Light, MaterialId, SceneDescription, Shape, ShapeId,
};
pub use mesh::{MeshError, TriangleMesh};
