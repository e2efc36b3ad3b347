//! Renderers composed from the Lichtwerk crates.

pub mod metrics;
pub mod output;
