#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

#[cfg(feature = "serde")]
#[macro_use]
mod by_name;

mod averages;
mod batches;
mod contribution;
mod filter;
mod hash;
mod kernel;
mod modulation;
mod parallel;
mod radius;
mod sample;
mod similarity;
mod spectral;
mod vertex;

pub use range_search;

pub use averages::Averages;
pub use batches::{Batch, BatchError, Batches, SwitchOff};
pub use contribution::Contribution;
pub use filter::{PathFilter, PathSpaceFilter, Screen, ScreenError, Search};
pub use hash::{CellKey, JitteredHash, NoKey};
pub use kernel::{Ball, Epanechnikov, Gaussian, Kernel, Poly6};
pub use modulation::{AsStored, Demodulated, Modulation};
pub use radius::{Radius, RadiusError};
pub use sample::{Attenuate, PathSample};
pub use similarity::{
    AlbedoDifference, AlbedoFalloff, And, CosinePower, Everything, HitDistance, NormalCone, SameObject, SameVisibility,
    SimilarTime, Similarity, SimilarityError, SimilarityExt, ViewCone, Violation, check_similarity,
};
pub use spectral::{Basis, CieXyz};
pub use vertex::{
    HasAlbedo, HasHitDistance, HasNormal, HasObject, HasPixel, HasTime, HasViewDirection, HasVisibility, PathVertex,
    Vertex,
};
