//! Why an index cannot be built.

use core::fmt;

/// Why an index cannot be built.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum BuildError {
    /// The size of the cells is not positive and finite.
    CellSize(f32),
    /// More points than ids: those have 32 bits.
    TooManyPoints(usize),
}

impl fmt::Display for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::CellSize(size) => write!(f, "cells of size {size}, which is not positive and finite"),
            Self::TooManyPoints(count) => write!(f, "{count} points, more than {MAX_POINTS}"),
        }
    }
}

impl core::error::Error for BuildError {}

/// Slots have 32 bits, with those in the last block that stay empty.
pub(crate) const MAX_POINTS: usize = u32::MAX as usize - crate::lanes::WIDTH;

pub(crate) fn check_count(count: usize) -> Result<(), BuildError> {
    if count > MAX_POINTS { Err(BuildError::TooManyPoints(count)) } else { Ok(()) }
}
