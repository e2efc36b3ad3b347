//! The techniques that Talbot, Cline and Egbert 2005 compares with, for experiments and as oracles.

mod importance;
mod inversion;
mod rejection;
mod weighted;

pub use importance::ImportanceSampling;
pub use inversion::{Tabulated1d, Tabulated2d, TabulatedError};
pub use rejection::{Accepted, RejectionError, RejectionSampling};
pub use weighted::WeightedImportanceSampling;
