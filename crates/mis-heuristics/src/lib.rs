//! Multiple importance sampling weights, evaluated lazily.
//!
//! Several sampling techniques can generate the same sample, each with its own density; a **heuristic** gives every
//! technique a weight such that the weighted estimates add up to the integral once. Here a heuristic is handed
//! something that *can* compute densities ([`Densities`]) and asks only for those it needs: the balance heuristic for
//! all of them, the stratification heuristic for none.
//!
//! # Where to start
//! | to .. | use |
//! |---|---|
//! | weight light and BSDF samples | [`Power::TWO`], [`Balance`] with an array of two densities |
//! | weight the techniques of bidirectional path tracing | the same, [`Maximum`] or [`Cutoff`], with [`Lazy`] or your own [`Densities`] |
//! | let the compiler tell densities by area from those by solid angle | [`measure::Density`] |
//! | decide by geometry instead of densities | [`Stratification`], [`GeometryPartition`]; [`Remainder`] while tracing |
//! | take several samples per technique, or one of a technique chosen at random | [`MultiSample`], [`OneSample`] |
//! | have the least variance | [`ProgressiveOptimal`], [`OptimalMoments`] |
//! | sharpen an environment map's density | [`compensate`] |
//! | compare heuristics | [`Efficiency`], [`Counting`], [`variance_bound`] |
//! | write one | the laws of [`Heuristic`] |
//!
//! # Example
//! ```
//! use mis_heuristics::{Heuristic, Power};
//! const LIGHT: usize = 0;
//! let (p_light, p_bsdf) = (6.0_f32, 2.0); // per solid angle
//! assert_eq!(Power::TWO.weight(LIGHT, &[p_light, p_bsdf]), 0.9);
//! ```
//!
//! # Concepts
//! A *density* is always `n_i p_i`: probability density times number of samples, in a measure common to all
//! techniques. A density of zero
//! means that the technique cannot generate the sample, an infinite one that it is a Dirac delta; NaN and negative
//! numbers count as
//! zero. Densities are asked for at most once per weight, so nothing has to be cached for the crate's sake.
//!
//! # Features
//! `serde`: [`Power`] and [`Cutoff`] as their numbers, [`GeometryPartition`] by the name of its constructor, checked on the
//! way in (JSON knows no infinite exponent, and no infinite threshold). Off by default;
//! without it there is no dependency. `no_std`, no allocation, no unsafe code. `f32` and `f64` by the sealed trait [`Float`].
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod balance;
mod bound;
mod compensation;
mod counting;
mod cutoff;
mod densities;
mod efficiency;
mod float;
mod heuristic;
mod lazy;
mod math;
mod maximum;
pub mod measure;
mod models;
mod optimal;
mod partition;
mod power;
mod progressive;
mod stratification;

pub use balance::Balance;
pub use bound::{Bounded, variance_bound, variance_bound_with_counts};
pub use compensation::{CompensationError, compensate};
pub use counting::Counting;
pub use cutoff::{Cutoff, CutoffError};
pub use densities::Densities;
pub use efficiency::{Efficiency, RunningVariance};
pub use float::Float;
pub use heuristic::{Heuristic, HeuristicExt};
pub use lazy::Lazy;
pub use maximum::Maximum;
pub use models::{ModelError, MultiSample, OneSample};
pub use optimal::{OptimalAt, OptimalError, OptimalMoments, OptimalWeights};
pub use partition::{GeometryPartition, PartitionError};
pub use power::{Power, PowerError};
pub use progressive::ProgressiveOptimal;
pub use stratification::{Remainder, Stratification, Verdict};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
