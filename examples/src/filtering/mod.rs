//! Path space filtering of the estimators: what eye paths leave behind is collected, averaged by `path-space-filter`, and only then becomes pixels.
//!
//! - [`Selection`]: at which vertices.
//! - [`Collector`]: looks on while an estimator traces a path, and takes it apart.
//! - [`Observable`]: estimators that can be looked at.
//! - [`Traced`]: what a batch of paths left behind, [`trace_rays`] for any rays.
//! - [`AnyFilter`], [`Alike`]: filters that are put together at run time.
//! - [`Filtered`]: passes over the image, [`render_views`] over several at once, [`bake`] for probes and textures.

mod bake;
mod collector;
mod filter;
mod observable;
mod pass;
mod selection;
mod traced;
mod views;

pub use bake::bake;
pub use collector::{Collected, Collector};
pub use filter::{Alike, AlikeKey, AnyFilter, AnyModulation, Looks};
pub use observable::{EyeRay, Observable};
pub use pass::{Filtered, samples_in_memory};
pub use selection::{Selection, SelectionError};
pub use traced::{Path, Queries, Traced, Tracing, trace_rays};
pub use views::{View, render_views};

/// A vertex as the filter sees it.
pub type FilterVertex = path_space_filter::Vertex<[f32; 3]>;
