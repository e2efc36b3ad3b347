//! Furniture, each piece in its own coordinates: +y up, the floor (or what it stands on) at y = 0, its front towards +z.
//! Pieces sink a millimetre into what they stand on, so that no surfaces coincide.

mod desks;
mod equipment;
mod fittings;
mod lamps;
mod plants;
mod seating;
mod shelving;
mod tableware;
mod windows;

pub(crate) use desks::*;
pub(crate) use equipment::*;
pub(crate) use fittings::*;
pub(crate) use lamps::*;
pub(crate) use plants::*;
pub(crate) use seating::*;
pub(crate) use shelving::*;
pub(crate) use tableware::*;
pub(crate) use windows::*;
