//! Fixed-radius and nearest-neighbour search over points in 3D, exact and deterministic.
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod ball;
mod brute_force;
mod closest;
mod error;
mod grid;
mod index;
mod lanes;
mod neighbor;

pub use ball::distance_squared;
pub use brute_force::BruteForce;
pub use error::BuildError;
pub use grid::{HashGrid, Neighborhood, SelfQuery};
pub use index::RangeIndex;
pub use neighbor::Neighbor;
