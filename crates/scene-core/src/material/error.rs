//! Why a material cannot be used.

use thiserror::Error;

/// Why a material cannot be used.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MaterialError {
    /// A parameter is out of its range.
    #[error("{parameter} of a {material} material is {value}, but must be {expected}")]
    Parameter {
        /// Which material.
        material: &'static str,
        /// Which parameter.
        parameter: &'static str,
        /// Its value.
        value: f32,
        /// Its range.
        expected: &'static str,
    },
    /// A rough interface between equal indices of refraction: it has no half vectors.
    #[error("int_ior and ext_ior of a {material} material are both {value}, but must differ")]
    EqualIndices {
        /// Which material.
        material: &'static str,
        /// Both indices.
        value: f32,
    },
    /// Diffuse and specular reflectance together reflect more than arrives.
    #[error("diffuse_reflectance and specular_reflectance of a {material} material add up to {value}, more than 1")]
    Energy {
        /// Which material.
        material: &'static str,
        /// The largest component of their sum.
        value: f32,
    },
    /// Materials that cannot be nested like this.
    #[error("a {inner} material cannot be inside a {outer} one{reason}")]
    Nesting {
        /// The outer material.
        outer: &'static str,
        /// The inner material.
        inner: &'static str,
        /// Why, with a leading separator.
        reason: &'static str,
    },
}
