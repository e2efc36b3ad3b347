//! Tests of the whole workspace, in one program: each program of its own would compile the renderer once more.
//!
//! `cargo test -p lichtwerk-tests path_filters` runs the tests of one module.

mod assets;
mod bidirectional;
mod determinism;
mod estimators;
mod laws;
mod path_filters;
mod photon_lights;
mod photon_maps;
mod resampling;
mod samplers;
mod shares;
mod virtual_lights;
