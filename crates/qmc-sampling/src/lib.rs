//! Point sequences, samplers and warps for Monte Carlo and quasi-Monte Carlo integration.
#![cfg_attr(not(feature = "std"), no_std)]
#![forbid(unsafe_code)]
// The tables of the Sobol sequence are computed by the compiler.
#![allow(long_running_const_eval)]

#[cfg(feature = "alloc")]
extern crate alloc;

mod float;
mod hash;
mod real;
mod sequence;

pub mod image;
pub mod sampler;
pub mod scramble;
pub mod sequences;
pub mod sobol;
pub mod warp;

pub use float::{f32_from_bits, f64_from_bits};
pub use real::Real;
pub use sampler::{Independent, IndependentSampler, OwenSobol, OwenSobolSampler, Sampler, SamplerFamily, Split};
pub use sequence::Sequence;
