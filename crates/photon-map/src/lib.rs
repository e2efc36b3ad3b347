#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

#[cfg(feature = "serde")]
#[macro_use]
mod read_through;

mod bytes;
mod caustics;
pub mod check;
mod density;
mod deposition;
mod direction;
mod flux;
mod guidance;
mod importance;
mod kernel;
mod lights;
mod partition;
mod photon;
mod photons;
mod progressive;
mod projection;
mod sphere;
mod vector;

pub use range_search;

pub use bytes::{FluxWords, PhotonBytesError};
pub use caustics::{CausticRule, CausticRuleError, LastBounce};
pub use density::{DensityEstimation, Estimate, Gather, GatherError, GatherPoint, MapError, PhotonMap, Scratch};
pub use deposition::{Both, Bound, BoundError, Deposition, DepositionExt, KeepAll};
pub use flux::Flux;
pub use guidance::{DirectionalHistogram, GuidanceError, Guide, GuidedDirection};
pub use importance::{AnyDirection, DirectionWeight, ImportanceMap, ImportanceScale, ImportonDeposition, ScaleError};
pub use kernel::{Cone, Kernel, KernelError};
pub use lights::{
    Allocation, ContributingLights, LightSelection, LightTable, LightTableError, OtherLights, PrimaryPhotonMap,
    PrimaryPhotons, SelectionError, ShadowRay, ShadowRays,
};
pub use partition::{MapPartition, PartitionError, PhotonMaps};
pub use photon::{Importon, PackedPhoton, Photon};
pub use photons::Photons;
pub use progressive::{ProgressiveError, ProgressivePoint, ProgressiveRadius};
pub use projection::{Cell, ProjectionError, ProjectionMap};
pub use sphere::{direction as sphere_direction, square as sphere_square};
