//! PNG out.

use std::path::Path;

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

use super::{ImageFileError, LayeredImage};

/// The transfer function of sRGB (IEC 61966-2-1): from linear to encoded, both in `[0, 1]`.
///
/// Values outside are clamped; not-a-number becomes zero.
///
/// ```
/// use scene_core::film::srgb_from_linear;
///
/// assert_eq!(srgb_from_linear(0.0), 0.0);
/// assert!((srgb_from_linear(0.214041) - 0.5).abs() < 1e-6);
/// assert_eq!(srgb_from_linear(f32::INFINITY), 1.0);
/// ```
pub fn srgb_from_linear(linear: f32) -> f32 {
    let linear = if linear > 0.0 { linear.min(1.0) } else { 0.0 };
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

impl LayeredImage {
    /// The main image as 8-bit sRGB triples, row by row, brightened by `exposure` stops (a factor of
    /// `2^exposure`) and clamped.
    ///
    /// # Errors
    /// [`ImageFileError::Encode`] if there are no colour channels.
    pub fn to_srgb8(&self, exposure: f32) -> Result<Vec<u8>, ImageFileError> {
        let pixels = self.rgb().map_err(|error| ImageFileError::Encode(error.to_string()))?;
        let factor = exposure.exp2();
        let encode = |linear: f32| (255.0 * srgb_from_linear(factor * linear)).round() as u8;
        Ok(pixels.into_iter().flatten().map(encode).collect())
    }

    /// The bytes of a PNG file of the main image, see [`to_srgb8`](Self::to_srgb8).
    ///
    /// # Errors
    /// [`ImageFileError::Encode`] if there are no colour channels.
    pub fn encode_png(&self, exposure: f32) -> Result<Vec<u8>, ImageFileError> {
        let pixels = self.to_srgb8(exposure)?;
        let mut bytes = Vec::new();
        PngEncoder::new(&mut bytes)
            .write_image(&pixels, self.width(), self.height(), ExtendedColorType::Rgb8)
            .map_err(|error| ImageFileError::Encode(error.to_string()))?;
        Ok(bytes)
    }

    /// Writes a PNG file, see [`encode_png`](Self::encode_png). An existing file is overwritten in place.
    ///
    /// # Errors
    /// As for encoding, and [`ImageFileError::Io`] with the path if it cannot be written.
    pub fn write_png(&self, path: &Path, exposure: f32) -> Result<(), ImageFileError> {
        std::fs::write(path, self.encode_png(exposure)?).map_err(|error| ImageFileError::io(path, error))
    }
}
