//! The Sobol sequence with the direction numbers of Joe and Kuo.
//!
//! Source: S. Joe and F. Y. Kuo, "Constructing Sobol sequences with better two-dimensional projections" (2008).
mod directions;
mod tables;

pub(crate) use tables::reversed_4d;

/// Parameters of one dimension: degree and coefficients of the primitive polynomial, initial direction numbers.
pub(crate) struct Parameters<'a> {
    pub(crate) degree: usize,
    pub(crate) coefficients: u32,
    pub(crate) initial: &'a [u32],
}
