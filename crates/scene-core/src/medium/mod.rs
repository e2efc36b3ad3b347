//! Participating media: what fills closed dielectric surfaces and absorbs and scatters light on its way through.
//!
//! A [`Medium`] is homogeneous and scatters by [`HenyeyGreenstein`]'s phase function.
//! [`Vertex::medium`](crate::Vertex::medium) tells which one a ray enters, and [`Medium::walk`] follows it to the
//! next surface.

mod error;
mod henyey_greenstein;
mod homogeneous;
mod walk;

pub use error::MediumError;
pub use henyey_greenstein::HenyeyGreenstein;
pub use homogeneous::Medium;
pub use walk::MediumExit;
