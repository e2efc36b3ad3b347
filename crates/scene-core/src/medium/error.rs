//! Why there is no such medium.

use thiserror::Error;

/// Why there is no such medium.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MediumError {
    /// A coefficient that is negative or not finite.
    #[error("{name} of a medium is {value}, but must be finite and at least 0")]
    Coefficient {
        /// Which coefficient.
        name: &'static str,
        /// The component that is out of range.
        value: f32,
    },
    /// An albedo outside of `[0, 1]`.
    #[error("the albedo of a medium is {0}, but must be in [0, 1]")]
    Albedo(f32),
    /// A mean cosine outside of `(-1, 1)`.
    #[error("the mean cosine g of a phase function is {0}, but must be in (-1, 1)")]
    MeanCosine(f32),
}
