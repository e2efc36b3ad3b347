#![cfg_attr(feature = "reference", doc = include_str!("../README.md"))]
#![cfg_attr(
    not(feature = "reference"),
    doc = "The traits that light transport estimators are written against. With the feature `reference`: a scene that implements them."
)]

#[cfg(feature = "reference")]
pub mod builtin;
mod counting;
pub mod film;
mod frame;
#[cfg(feature = "gltf")]
pub mod gltf;
#[cfg(feature = "luxcore")]
pub mod luxcore;
#[cfg(feature = "reference")]
pub mod material;
pub mod medium;
#[cfg(feature = "mitsuba")]
pub mod mitsuba;
mod ray;
#[cfg(feature = "reference")]
pub mod reference;
#[cfg(feature = "reference")]
pub mod texture;
mod traits;
mod walk;
#[cfg(any(feature = "gltf", feature = "luxcore"))]
mod warnings;

pub use counting::{Counting, RayCounts};
pub use frame::Frame;
pub use glam;
pub use qmc_sampling;
pub use ray::{Ray, SurfacePoint};
#[cfg(feature = "reference")]
pub use reference::{PowerChoice, ReferenceScene, SceneDescription, SceneError, UniformChoice};
pub use traits::*;
pub use walk::{Onward, RussianRoulette, WalkStart, WalkVertex, guided_walk, random_walk};
