#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod ambient;
mod bidirectional;
mod caustics;
mod discontinuity;
mod lights;
mod observer;
mod partition;
mod robust;
mod shading;
mod shadow_rays;

pub use glam;
pub use mis_heuristics;
pub use qmc_sampling;
pub use scene_core;

pub use ambient::openness;
pub use bidirectional::{
    Bidirectional, Classical, ConnectionTests, EveryConnection, LightPaths, PathHeuristic, PathTechniques, Stratified,
    TechniqueSet,
};
pub use caustics::{CausticMap, NoCaustics};
pub use discontinuity::{DiscontinuityBuffer, PixelFeatures};
pub use lights::{LightKind, LightTracing, VirtualPointLight, VirtualPointLights, geometry_term, photon_cloud};
pub use mis_heuristics::PartitionError;
pub use observer::{Found, Observer};
pub use partition::{Partition, Threshold};
pub use robust::{FinalGathering, Residual, RobustIgi};
pub use shading::unshadowed;
pub use shadow_rays::ShadowRays;
