//! Images to files.

use std::path::Path;

use scene_core::film::LayeredImage;

use super::{OutputError, write_atomically};

/// Formats that images are written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageFormat {
    /// OpenEXR: all channels in f32, with settings as attributes.
    Exr,
    /// PNG: the main image in 8-bit sRGB.
    Png,
}

impl ImageFormat {
    /// The format that a file's name ends in, in any case.
    ///
    /// # Errors
    /// [`OutputError::Format`] if it is neither `.exr` nor `.png`. Ask before rendering.
    pub fn of(path: &Path) -> Result<Self, OutputError> {
        let extension = path.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase);
        match extension.as_deref() {
            Some("exr") => Ok(Self::Exr),
            Some("png") => Ok(Self::Png),
            _ => Err(OutputError::Format { path: path.to_owned() }),
        }
    }
}

/// Writes an image [atomically](write_atomically), in the format of the file's name. A PNG is brightened by `exposure`
/// stops, an EXR is written as it is. The same image is the same bytes: no time and no name of a machine is in them, and attributes
/// are in the order of their names.
///
/// # Errors
/// [`OutputError`], which names the file.
pub fn save_image(path: &Path, image: &LayeredImage, exposure: f32) -> Result<(), OutputError> {
    let bytes = match ImageFormat::of(path)? {
        ImageFormat::Exr => image.encode_exr(),
        ImageFormat::Png => image.encode_png(exposure),
    }
    .map_err(|error| OutputError::encode(path, error))?;
    write_atomically(path, |file| file.write_all(&bytes))
}
