//! Renderer-neutral scene traits, and a reference scene that implements them.

mod frame;
#[cfg(feature = "reference")]
pub mod material;
#[cfg(feature = "mitsuba")]
pub mod mitsuba;
pub mod ray;
#[cfg(feature = "reference")]
pub mod reference;
#[cfg(feature = "reference")]
pub mod texture;
pub mod traits;

pub use frame::Frame;
pub use glam;
pub use ray::{Ray, SurfacePoint};
pub use traits::*;
