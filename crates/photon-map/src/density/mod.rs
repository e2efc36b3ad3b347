//! Density estimation: what photons around a point say about it.

mod gather;
mod map;
mod point;

pub use gather::{Gather, GatherError, Scratch};
pub use map::{DensityEstimation, Estimate, MapError, PhotonMap};
pub use point::GatherPoint;
