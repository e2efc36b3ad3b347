//! Why an image cannot be used.

use std::path::PathBuf;

use thiserror::Error;

/// Why an image cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum TextureError {
    /// The number of pixels is not width times height.
    #[error("an image of {width} x {height} pixels needs {expected} of them, but there are {found}")]
    PixelCount {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
        /// Width times height.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// An image without pixels.
    #[error("an image of {width} x {height} pixels is empty")]
    Empty {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
    },
    /// A pixel is infinite or not a number.
    #[error("pixel ({x}, {y}) is not finite")]
    NotFinite {
        /// Column.
        x: u32,
        /// Row.
        y: u32,
    },
    /// Encoded bytes that are no image.
    #[error("cannot decode the image: {reason}")]
    Encoded {
        /// What the decoder says.
        reason: String,
    },
    /// A file cannot be read.
    #[error("cannot read the image {}: {reason}", path.display())]
    File {
        /// Which file.
        path: PathBuf,
        /// What the decoder says.
        reason: String,
    },
}
