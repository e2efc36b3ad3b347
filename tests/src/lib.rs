//! What the tests of the whole workspace share.
//!
//! - [`shares`]: how the statistical suites of all packages share out one false-positive rate.
//! - [`block_means`]: renders a scene several times, to means over blocks of pixels that can be compared.
//! - [`Truth`]: an image that is known to be right, for others to be compared with; [`both_forms`]: tests in a quick and a long form.
//! - [`assets`]: scene files, where they are.
//! - [`scenes`]: small scenes, each of which exercises one part of light transport.
//! - [`planted`]: bugs that the tests must find.
//!
//! The quick forms run with `cargo test`; the long ones, with 25 times the samples, by
//! `cargo test --release --workspace -- --ignored`.

pub mod assets;
mod block_means;
pub mod planted;
pub mod scenes;
pub mod shares;
mod truth;

pub use block_means::{Effort, block_means, blocks_of, means_of, render_by, render_through};
pub use truth::Truth;
