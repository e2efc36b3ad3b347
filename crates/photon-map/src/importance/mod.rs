//! Visual importance, and what it decides.

mod deposition;
mod map;
mod scale;

pub use deposition::{AnyDirection, DirectionWeight, ImportonDeposition};
pub use map::ImportanceMap;
pub use scale::{ImportanceScale, ScaleError};
