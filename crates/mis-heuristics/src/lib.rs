//! Multiple importance sampling weights, evaluated lazily.
//!
//! Several sampling techniques can generate the same sample, each with its own density; a **heuristic** gives every
//! technique a weight such that the weighted estimates add up to the integral once. Here a heuristic is handed
//! something that *can* compute densities ([`Densities`]) and asks only for those it needs: the balance heuristic for
//! all of them, the stratification heuristic for none.
//!
//! # Features of the crate
//! `no_std`, no allocation, no dependency, no cargo feature, no unsafe code; `f32` and `f64`.
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
