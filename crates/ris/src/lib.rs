//! Resampled importance sampling: of many cheap candidates one is kept in proportion to what it promises, and only that one is
//! evaluated in full.
//!
//! A **source** proposes candidates, a **target** scores them, a **reservoir** keeps one, and its *contribution weight* makes
//! estimates with it unbiased. The crate knows no scene, and everything random comes in through the arguments.
//!
//! # Where to start
//! | to .. | use |
//! |---|---|
//! | pick one of a stream, in constant memory | [`Reservoir`] |
//! | pick several from the same candidates, or with stratified numbers | [`Batch`] |
//! | estimate an integral with fractional `M` and `N` | [`Ris`], [`Budget`] |
//! | draw candidates from several distributions | [`Mixture`] (one at random), [`resample_sources`] (a number from each) |
//! | reuse what neighbours selected, without bias | [`Pairwise`], [`Combination`], [`balance`] |
//! | know the variance, and the best `M` and `N` | [`VarianceModel`], [`Objective`], [`RatioMap`] |
//! | choose `M` without knowing any of that | [`CostModel::robust`] |
//! | compare with other techniques | [`baselines`] |
//!
//! # Example
//! ```
//! use ris::{Proposal, Reservoir};
//!
//! // Many lights, one shadow ray: closures are targets.
//! struct Candidate { unshadowed: f32 }
//! let candidates = [0.1, 0.7, 0.2].map(|unshadowed| Proposal { sample: Candidate { unshadowed }, density: 1.0 / 3.0 });
//! let picked = Reservoir::stream(candidates, &|c: &Candidate| c.unshadowed, &mut || 0.5);
//! let visible = |_: &Candidate| 1.0_f32;
//! let radiance: f32 = picked.estimate(|c| c.unshadowed * visible(c));
//! assert!((radiance - 1.0).abs() < 1e-6);
//! ```
//!
//! # Concepts
//! `M` is the number of candidates per sample, zero weights included; `N` the number of samples. A *contribution weight* `W`
//! stands for one over the unknown density of a resampled sample. A *confidence* is the `M` that a resampled sample stands for.
//! All densities and targets are in one measure that the caller chooses.
//!
//! # Features
//! `std` adds a clock, [`seconds`](CostModel::measure). Without it: `no_std` with `alloc`. `serde` reads and writes [`Budget`] and
//! [`CostModel`], checked on the way in. The only other dependency is `libm`, for
//! square roots. `f32` and `f64` by the sealed trait [`Float`].
#![cfg_attr(not(feature = "std"), no_std)]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

extern crate alloc;

pub mod baselines;
mod batch;
mod budget;
mod combine;
mod cost;
mod estimator;
mod float;
mod mixture;
mod optimum;
mod ratio_map;
mod resampled;
mod reservoir;
mod select;
mod several_sources;
mod source;
mod stream;
mod target;
mod uniform;
mod variance;

pub use batch::{Batch, Table};
pub use budget::Budget;
pub use combine::{Combination, Pairwise, balance};
#[cfg(feature = "std")]
pub use cost::seconds;
pub use cost::{CostError, CostModel, robust_mean};
pub use estimator::Ris;
pub use float::Float;
pub use mixture::Mixture;
pub use optimum::Objective;
pub use ratio_map::RatioMap;
pub use resampled::{Resampled, Selected};
pub use reservoir::Reservoir;
pub use select::{AliasTable, PrefixSums, Select};
pub use several_sources::{BalanceWeights, Sources, Weights, resample_sources};
pub use source::{FromFn, Proposal, Source, from_fn};
pub use target::Target;
pub use uniform::{OneNumber, Uniform};
pub use variance::{Expectations, VarianceModel};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
