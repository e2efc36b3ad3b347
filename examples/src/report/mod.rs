//! Pages that show what was measured: one HTML file each, with style, script and data in it.
//!
//! - [`Page`]: the file.
//! - [`Viewer`], [`Picture`], [`Shown`]: images as numbers (half floats), which the page's script exposes, colours and compares.
//! - [`Plot`], [`Series`]: convergence in logarithmic axes, with fitted slopes ([`PowerLaw`]).
//! - [`Table`], [`Column`]: measurements with intervals ([`Estimate`]), the best one of a column [marked](mark()).
//! - [`Overview`]: what experiments found.
//!
//! HTML is made by [maud](https://maud.lambda.xyz), which escapes all text; style and script are in `style.css` and `viewer.js`.

mod axis;
mod claims;
mod markdown;
mod number;
mod overview;
mod page;
mod pixels;
mod plot;
mod statistics;
mod table;
mod thumbnails;
mod viewer;

pub use overview::Overview;
pub use page::Page;
pub use plot::{Plot, Series};
pub use statistics::{Estimate, PowerLaw};
pub use table::{Better, Column, Mark, Table, mark};
pub use viewer::{Colours, Picture, PictureError, Shown, Viewer};
