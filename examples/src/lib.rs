//! Renderers composed from the Lichtwerk crates, and the program that drives them.
//!
//! - [`estimators`]: what adds up paths, written against `scene-core`'s traits alone.
//! - [`render`]: the loop over pixels, passes and threads.

pub mod estimators;
pub mod render;
