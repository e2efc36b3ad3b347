//! Direct light from many lights: which contribute, and which get shadow rays.

mod contributing;
mod primary;
mod selection;
mod table;

pub use contributing::ContributingLights;
pub use primary::{PrimaryPhotonMap, PrimaryPhotons};
pub use selection::{Allocation, LightSelection, SelectionError, ShadowRay, ShadowRays};
pub use table::{LightTable, LightTableError, OtherLights};
