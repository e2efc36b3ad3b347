//! Renderers composed from the Lichtwerk crates, and the program that drives them.
//!
//! - [`estimators`]: what adds up paths, written against `scene-core`'s traits alone.
//! - [`render`]: the loop over pixels, passes and threads.
//! - [`distributed`]: processes that render together.
//! - [`choices`]: heuristics and light selection by name.
//! - [`filtering`]: path space filtering of estimators; [`filters`]: filters by name.
//! - [`light_paths`]: light paths by name.
//! - [`light_photons`]: light selection by photons.
//! - [`photons`]: photon maps by name.
//! - [`resampling`]: resampling by name.
//! - [`samplers`]: samplers by name.
//! - [`metrics`]: how far an image is from another.
//! - [`experiments`]: figures and claims of papers, measured.
//! - [`output`]: files, the viewer, the terminal.
//! - [`report`]: pages that show what was measured.
//! - [`program`]: the subcommands of `lichtwerk`.

pub mod choices;
pub mod distributed;
pub mod estimators;
pub mod experiments;
pub mod filtering;
pub mod filters;
pub mod light_paths;
pub mod light_photons;
pub mod metrics;
pub mod output;
pub mod photons;
pub mod program;
pub mod render;
pub mod report;
pub mod resampling;
pub mod samplers;
mod values;
