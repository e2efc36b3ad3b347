//! How far an image is from a reference.
//!
//! [`diff`] compares two OpenEXR files by all of these; each is also a function of an [`ImagePair`]:
//!
//! | metric | mean over pixels and channels of |
//! |---|---|
//! | [`mse`] | `(x - r)^2` |
//! | [`relative_mse`] | `(x - r)^2 / (r^2 + 0.01)` |
//! | [`mrse`] | `(x - r)^2 / (Y(r)^2 + 0.01)` without the 0.1 % worst pixels, `Y` the luminance |
//! | [`flip_ldr`], [`flip_hdr`] | the perceived difference, between 0 and 1 |
//! | [`mean_ratio`] | ratio of the means: a bias shows here long before it shows in the noise |
//!
//! Pixels that are not finite in one of the two images take part in none of them, and are counted.

mod diff;
mod flip;
mod pair;
mod squared_error;

pub use diff::{DiffReport, diff};
pub use flip::{exposures, flip_hdr, flip_ldr, flip_ldr_map};
pub use pair::{ImagePair, MetricError};
pub use squared_error::{MRSE_TRIMMED, RELATIVE_EPSILON, mean_ratio, mrse, mse, relative_mse};
