//! Point sequences by random access.
//!
//! | sequence | base | dimensions | good for |
//! |---|---|---|---|
//! | [`Sobol`](crate::sobol::Sobol) | 2 | 1024 | the default: fast, scrambled it is the most precise |
//! | [`Halton`], [`Hammersley`] | primes | 1024 | any number of points; low dimensions |
//! | [`Faure`] | a prime | the base | nets with `t = 0` in more than two dimensions |
//! | [`Lattice`] | | 128 or your own | smooth periodic integrands |
//! | [`Stratified`], [`MultiJittered`] | | any, in pairs | a fixed number of points in two dimensions |
//! | [`Random`] | | any | the baseline |
//!
//! [`CranleyPatterson`] randomises any of them by a random shift.
mod base;
mod digits;
mod error;
mod faure;
mod halton;
mod lattice;
mod primes;
mod random;
mod rotation;
mod stratified;
mod van_der_corput;

pub use digits::{DigitScramble, radical_inverse};
pub use error::SequenceError;
pub use faure::Faure;
pub use halton::{Halton, Hammersley};
pub use lattice::{KUO_VECTOR, Lattice};
pub use primes::{PRIMES, prime};
pub use random::Random;
pub use rotation::CranleyPatterson;
pub use stratified::{MultiJittered, Stratified};
pub use van_der_corput::VanDerCorput;

pub(crate) use base::Base;
pub(crate) use digits::permute;
