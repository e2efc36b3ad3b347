//! Fixed-radius and nearest-neighbour search over points in 3D, exact and deterministic.
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod ball;
pub mod batch;
mod brute_force;
#[cfg(feature = "obvhs")]
mod bvh;
pub mod check;
mod closest;
mod divide_and_conquer;
mod error;
mod grid;
mod index;
#[cfg(feature = "kiddo")]
mod kd_tree;
mod lanes;
mod neighbor;

pub use ball::distance_squared;
pub use brute_force::BruteForce;
#[cfg(feature = "obvhs")]
pub use bvh::Bvh;
pub use divide_and_conquer::divide_and_conquer;
#[cfg(feature = "rayon")]
pub use divide_and_conquer::par_divide_and_conquer;
pub use error::BuildError;
pub use grid::{HashGrid, Neighborhood, SelfQuery};
pub use index::RangeIndex;
#[cfg(feature = "kiddo")]
pub use kd_tree::KdTree;
pub use neighbor::Neighbor;
