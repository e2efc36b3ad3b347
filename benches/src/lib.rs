//! What the benches share: scenes, rays, directions, and plain versions that fast ones are compared with.
//!
//! The benches themselves are in `benches/`, one file per subject: `cargo bench -p lichtwerk-benches`, or with `-- --test`
//! each of them once. They run on one thread. Inputs are fixed by seeds, so that two revisions time the same work.
//! The comparison with other renderers is in `peers/`.

mod brute_force;
mod inputs;
mod kiddo_alone;
mod surface_points;

pub use brute_force::brute_force;
pub use inputs::{blob, camera_rays, directions, segments, sized, triangles_of};
pub use kiddo_alone::{RgbVertex, filter_over_kiddo, kiddo_nearest, kiddo_tree, kiddo_within, vertices};
pub use surface_points::surface_points;

// The examples in the pages that belong to no crate are compiled and run as this package's doctests.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;

#[cfg(doctest)]
#[doc = include_str!("../../docs/scene-core.md")]
struct SceneCorePage;

#[cfg(doctest)]
#[doc = include_str!("../../docs/range-search.md")]
struct RangeSearchPage;

#[cfg(doctest)]
#[doc = include_str!("../../docs/architecture.md")]
struct ArchitecturePage;
