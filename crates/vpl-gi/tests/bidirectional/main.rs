//! Bidirectional path tracing: its densities against an oracle, its images against path and light tracing.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod exact;
mod oracle;
mod plain;
mod planted;
mod render;
mod scenes;
mod statistical;
