#![doc = include_str!("../README.md")]
#![cfg_attr(not(feature = "std"), no_std)]
#![forbid(unsafe_code)]
// The tables of the Sobol sequence are computed by the compiler.
#![allow(long_running_const_eval)]

#[cfg(feature = "alloc")]
extern crate alloc;

#[cfg(feature = "serde")]
#[macro_use]
mod read_through;

mod float;
mod hash;
mod interleaved;
mod real;
mod replications;
#[cfg(feature = "rand")]
mod rng;
mod sequence;

pub mod image;
#[cfg(feature = "alloc")]
pub mod measure;
pub mod sampler;
pub mod scramble;
pub mod sequences;
pub mod sobol;
pub mod warp;

pub use float::{f32_from_bits, f64_from_bits};
pub use interleaved::Interleaved;
#[cfg(feature = "rand")]
pub use rand_core;
pub use real::Real;
pub use replications::{Replications, StoppingRule};
#[cfg(feature = "rand")]
pub use rng::{RngSampler, SamplerRng};
pub use sampler::{Independent, IndependentSampler, OwenSobol, OwenSobolSampler, Sampler, SamplerFamily, Split};
pub use sequence::Sequence;
