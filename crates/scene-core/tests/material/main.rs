//! The materials: against Mitsuba 3.9.1, against their laws, and against quadrature.
#![cfg(feature = "reference")]
// The lint exempts test functions, but not their helpers.
#![allow(clippy::unwrap_used)]

mod cases;
mod chi_square;
mod laws;
mod metallic_roughness;
mod mitsuba;
mod quadrature;
mod robust;
mod wrappers;
