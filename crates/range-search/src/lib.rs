//! Fixed-radius and nearest-neighbour search over points in 3D, exact and deterministic.
//!
//! Points are anywhere in a payload of the caller's; an index knows them by their position in the slice that it was built from. All indices
//! answer by one rule, `distance^2 <= radius^2` in `f32` ([`distance_squared`]), and so agree bit for bit.
//!
//! # Where to start
//! | to .. | use |
//! |---|---|
//! | find points within a radius that hardly varies | [`HashGrid`], [`RangeIndex::for_each_within`] |
//! | find the nearest ones | [`RangeIndex::k_nearest`] of any index |
//! | ask for the neighbours of all points | [`HashGrid::self_query`] |
//! | search where densities vary by orders of magnitude | `KdTree` (feature `kiddo`), `Bvh` (feature `obvhs`) |
//! | answer many queries once, without an index | [`divide_and_conquer`] |
//! | answer many queries with an index | [`batch`] |
//! | test an index of your own | [`check`] |
//!
//! # Example
//! ```
//! use range_search::{HashGrid, RangeIndex};
//! let points = [[0.0_f32, 0.0, 0.0], [0.5, 0.0, 0.0], [2.0, 0.0, 0.0]];
//! let grid = HashGrid::build(&points, |p| *p, 1.0)?;
//! assert_eq!(grid.count_within([0.0, 0.0, 0.0], 1.0), 2);
//! # Ok::<(), range_search::BuildError>(())
//! ```
//!
//! # Concepts
//! An *id* is a position in the input, a *slot* one in the grid's own order. A [`Neighbour`] is an id with a squared distance, ordered by
//! distance and then by id; that is the order of everything sorted. The order of visits is each index's own, documented there, and a function
//! of its input alone, with any number of threads.
//!
//! # Features
//! None by default: no dependency. `rayon`: building, batches and self-queries on all threads, with the same results. `kiddo`: `KdTree`.
//! `obvhs`: `Bvh`. The crate needs the standard library, as those three do.
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
mod neighbour;

pub use ball::distance_squared;
pub use brute_force::BruteForce;
#[cfg(feature = "obvhs")]
pub use bvh::Bvh;
pub use divide_and_conquer::divide_and_conquer;
#[cfg(feature = "rayon")]
pub use divide_and_conquer::par_divide_and_conquer;
pub use error::BuildError;
pub use grid::{HashGrid, Neighbourhood, QueryRadius, SelfQuery};
pub use index::RangeIndex;
#[cfg(feature = "kiddo")]
pub use kd_tree::KdTree;
pub use neighbour::Neighbour;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
