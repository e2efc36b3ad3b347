//! Renderer-neutral scene traits, and a reference scene that implements them.

pub mod film;
mod frame;
pub mod ray;
pub mod traits;

pub use frame::Frame;
pub use glam;
pub use ray::{Ray, SurfacePoint};
pub use traits::*;
