//! Film: what samples are added to, and the images that come of it.
//!
//! - [`Filter`]: where in (and around) a pixel to sample, by filter importance sampling.
//! - [`Film`]: exact sums of radiance, its squares, and auxiliary quantities per [`Pixel`]. Threads own disjoint
//!   [`FilmTile`]s, so there is nothing to lock and the result does not depend on the number of threads.
//! - [`SplatBuffer`]: contributions of light paths, which arrive anywhere on the film.
//! - [`LayeredImage`]: named channels and settings in f32; what [`Film::develop`] returns, and what is read from and
//!   written to OpenEXR and PNG (feature `image-files`).
//!
//! ```
//! use scene_core::film::{Film, Filter};
//!
//! let mut film = Film::new(64, 48)?;
//! let filter = Filter::gaussian(0.5)?;
//! for mut tile in film.tiles_mut(16) {
//!     for ([x, y], pixel) in tile.pixels_mut() {
//!         let [dx, dy] = filter.sample([0.25, 0.75]);
//!         let raster = [x as f32 + 0.5 + dx, y as f32 + 0.5 + dy];
//!         pixel.add([raster[0] / 64.0, raster[1] / 48.0, 0.5]);
//!     }
//! }
//! let image = film.develop(0);
//! assert_eq!(image.channel("B").map(|b| b[0]), Some(0.5));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod accumulation;
mod develop;
mod filter;
mod gaussian;
mod layered_image;
mod merge;
mod pixel;
mod splat;
mod state;
mod sum;
mod tile;

#[cfg(feature = "image-files")]
mod exr_decode;
#[cfg(feature = "image-files")]
mod exr_encode;
#[cfg(feature = "image-files")]
mod exr_header;
#[cfg(feature = "image-files")]
mod file_error;
#[cfg(feature = "image-files")]
mod png;

pub use accumulation::{Film, FilmError, MAX_PIXELS};
#[cfg(feature = "image-files")]
pub use file_error::ImageFileError;
pub use filter::{Filter, FilterError};
pub use layered_image::{Attribute, LayeredImage, LayeredImageError};
pub use merge::SAMPLES_PER_PIXEL;
pub use pixel::Pixel;
#[cfg(feature = "image-files")]
pub use png::srgb_from_linear;
pub use splat::SplatBuffer;
pub use state::FilmStateError;
pub use tile::FilmTile;
