//! Photon maps: light paths leave photons behind, eye paths ask for them.
//!
//! - [`Sharpness`]: which bounces eye paths follow, and which photons are caustic.
//! - [`PhotonTracing`], [`Storing`]: light paths, and which of their photons are kept.
//! - [`PathGuidance`]: where light paths are sent; [`Unguided`], [`ImportonGuidance`].
//! - [`ImportonTracing`]: paths from the sensor that say where photons are wanted.
//! - [`PhotonView`], [`Maps`]: photons by place, and the radiance that surfaces scatter of them.
//! - [`PhotonEye`]: eye paths.
//! - [`PhotonMapping`], [`ProgressivePhotons`], [`WithCaustics`]: passes over the image that put these together.
//!
//! Photons carry linear RGB: 32 bytes each. Their tag for the light holds the number of segments of their path, so that
//! no sum of an eye path and a light path is longer than it may be.

mod caustics;
mod eye;
mod guidance;
mod importons;
mod mapping;
mod maps;
mod portable;
mod progressive;
mod sharpness;
mod tracing;

pub use caustics::{PhotonCaustics, WithCaustics};
pub use eye::PhotonEye;
pub use guidance::{GuidanceTracing, GuideScratch, ImportonGuidance, PathGuidance, Unguided};
pub use importons::{Importance, ImportonTracing};
pub use mapping::PhotonMapping;
pub use maps::{Maps, PhotonView};
pub use progressive::ProgressivePhotons;
pub use sharpness::Sharpness;
pub use tracing::{MAX_LENGTH, PhotonTracing, Storing};
