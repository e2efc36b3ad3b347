//! The reference scene: meshes, spheres and disks, materials, emitters and a perspective camera behind the
//! traits of this crate ([`Scene`](crate::Scene) and its like).

mod camera;
mod description;
mod emitters;
mod geometry;
mod light_checks;
mod scene;
mod vertex;

pub use camera::{CameraError, PerspectiveCamera};
pub use description::{CameraDescription, Instance, Light, MaterialId, SceneDescription, Shape, ShapeId};
pub use emitters::{
    DirectionalEmitter, DiskEmitter, EnvironmentEmitter, MeshEmitter, PointEmitter, PowerChoice, ReferenceEmitter,
    SphereEmitter, SpotEmitter, UniformChoice,
};
pub use geometry::{MeshError, TriangleMesh};
pub use scene::{ReferenceScene, SceneError};
pub use vertex::SceneVertex;
