//! Pixels.

use std::fmt;

use super::TextureError;
use crate::traits::Rgb;

/// How the numbers of a file encode light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ColorSpace {
    /// With the transfer function of sRGB (IEC 61966-2-1): photographs, colours.
    Srgb,
    /// As they are: normal maps, heights, masks.
    Linear,
}

impl ColorSpace {
    /// Decodes a number in `[0, 1]` to linear light.
    pub fn decode(self, value: f32) -> f32 {
        match self {
            Self::Linear => value,
            Self::Srgb if value <= 0.04045 => value / 12.92,
            Self::Srgb => ((value + 0.055) / 1.055).powf(2.4),
        }
    }
}

/// An image in linear RGB, with or without alpha.
///
/// Pixels of eight bits are kept as such and decoded by table at each lookup (4 bytes per pixel), in tiles of 4 x 4, each a cache
/// line, so that the four pixels of a bilinear lookup lie in 1.6 lines on average; others are 32-bit floats. Clone it behind an [`Arc`](std::sync::Arc).
#[derive(Clone)]
pub struct Image {
    width: u32,
    height: u32,
    mean: Rgb,
    has_alpha: bool,
    pixels: Pixels,
}

#[derive(Clone)]
enum Pixels {
    Bytes { tiles: Vec<Tile>, decode: Box<[f32; 256]> },
    Floats { rgb: Vec<[f32; 3]>, alpha: Vec<f32> },
}

/// 4 x 4 pixels, row by row.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Tile([[u8; 4]; 16]);

impl Image {
    /// An image of linear RGB values, row by row from the upper left corner.
    ///
    /// # Errors
    /// If there are no pixels, not `width * height` of them, or one is not finite.
    pub fn from_rgb(width: u32, height: u32, rgb: Vec<[f32; 3]>) -> Result<Self, TextureError> {
        Self::from_rgb_and_alpha(width, height, rgb, Vec::new())
    }

    /// An image of linear RGB values and an alpha for each (or none at all).
    ///
    /// # Errors
    /// As [`from_rgb`](Self::from_rgb).
    pub fn from_rgb_and_alpha(
        width: u32,
        height: u32,
        rgb: Vec<[f32; 3]>,
        alpha: Vec<f32>,
    ) -> Result<Self, TextureError> {
        check_size(width, height, rgb.len())?;
        if !alpha.is_empty() {
            check_size(width, height, alpha.len())?;
        }
        let bad_color = rgb.iter().position(|pixel| !pixel.iter().all(|c| c.is_finite()));
        if let Some(i) = bad_color.or_else(|| alpha.iter().position(|a| !a.is_finite())) {
            return Err(TextureError::NotFinite { x: (i % width as usize) as u32, y: (i / width as usize) as u32 });
        }
        Ok(Self { width, height, mean: Rgb::ZERO, has_alpha: !alpha.is_empty(), pixels: Pixels::Floats { rgb, alpha } }
            .with_mean())
    }

    /// An image of red, green, blue and alpha in eight bits each.
    ///
    /// # Errors
    /// If there are no pixels, or not `width * height` of them.
    pub fn from_rgba8(
        width: u32,
        height: u32,
        rgba: Vec<[u8; 4]>,
        color_space: ColorSpace,
    ) -> Result<Self, TextureError> {
        check_size(width, height, rgba.len())?;
        let decode = Box::new(std::array::from_fn(|i| color_space.decode(i as f32 / 255.0)));
        let has_alpha = rgba.iter().any(|pixel| pixel[3] != 255);
        let mut tiles = vec![Tile([[0; 4]; 16]); width.div_ceil(4) as usize * height.div_ceil(4) as usize];
        for (row, y) in rgba.chunks_exact(width as usize).zip(0..) {
            for (pixel, x) in row.iter().zip(0..) {
                let (tile, within) = tiled(width, x, y);
                tiles[tile].0[within] = *pixel;
            }
        }
        Ok(Self { width, height, mean: Rgb::ZERO, has_alpha, pixels: Pixels::Bytes { tiles, decode } }.with_mean())
    }

    /// Width in pixels.
    #[inline]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    #[inline]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The mean of all pixels.
    #[inline]
    pub fn mean(&self) -> Rgb {
        self.mean
    }

    /// Whether any pixel is not opaque.
    pub fn has_alpha(&self) -> bool {
        self.has_alpha
    }

    /// The pixel in column `x` and row `y`, in linear RGB.
    ///
    /// # Panics
    /// Outside the image.
    #[inline]
    pub fn pixel(&self, x: u32, y: u32) -> Rgb {
        match &self.pixels {
            Pixels::Bytes { tiles, decode } => {
                let (tile, within) = tiled(self.width, x, y);
                let [r, g, b, _] = tiles[tile].0[within];
                Rgb::new(decode[r as usize], decode[g as usize], decode[b as usize])
            }
            Pixels::Floats { rgb, .. } => rgb[self.index(x, y)].into(),
        }
    }

    #[inline]
    fn index(&self, x: u32, y: u32) -> usize {
        y as usize * self.width as usize + x as usize
    }

    /// The opacity of the pixel in column `x` and row `y`: 1 if the image has no alpha.
    ///
    /// # Panics
    /// Outside the image.
    pub fn alpha(&self, x: u32, y: u32) -> f32 {
        match &self.pixels {
            Pixels::Bytes { tiles, .. } => {
                let (tile, within) = tiled(self.width, x, y);
                f32::from(tiles[tile].0[within][3]) / 255.0
            }
            Pixels::Floats { alpha, .. } if alpha.is_empty() => 1.0,
            Pixels::Floats { alpha, .. } => alpha[self.index(x, y)],
        }
    }

    /// The alpha channel as a grey image, for [`Material::Mask`](crate::material::Material::Mask).
    #[must_use]
    pub fn alpha_image(&self) -> Self {
        let alphas = (0..self.height).flat_map(|y| (0..self.width).map(move |x| self.alpha(x, y)));
        let pixels = Pixels::Floats { rgb: alphas.map(|a| [a; 3]).collect(), alpha: Vec::new() };
        Self { mean: Rgb::ZERO, has_alpha: false, pixels, ..*self }.with_mean()
    }

    fn with_mean(mut self) -> Self {
        let mut sum = [0.0f64; 3];
        for y in 0..self.height {
            for x in 0..self.width {
                let pixel = self.pixel(x, y);
                sum.iter_mut().enumerate().for_each(|(i, s)| *s += f64::from(pixel[i]));
            }
        }
        let count = f64::from(self.width) * f64::from(self.height);
        self.mean = sum.map(|s| (s / count) as f32).into();
        self
    }
}

/// The tile of a pixel, and which of its 16 it is.
#[inline]
fn tiled(width: u32, x: u32, y: u32) -> (usize, usize) {
    let tile = (y / 4) as usize * width.div_ceil(4) as usize + (x / 4) as usize;
    (tile, (y % 4 * 4 + x % 4) as usize)
}

fn check_size(width: u32, height: u32, found: usize) -> Result<(), TextureError> {
    if width == 0 || height == 0 {
        return Err(TextureError::Empty { width, height });
    }
    let expected = width as usize * height as usize;
    if found != expected {
        return Err(TextureError::PixelCount { width, height, expected, found });
    }
    Ok(())
}

impl fmt::Debug for Image {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Image({} x {}, mean {:?})", self.width, self.height, self.mean.to_array())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_values_are_checked() {
        assert_eq!(Image::from_rgb(0, 2, vec![]).unwrap_err(), TextureError::Empty { width: 0, height: 2 });
        assert!(matches!(Image::from_rgb(2, 2, vec![[0.0; 3]; 3]), Err(TextureError::PixelCount { found: 3, .. })));
        let nan = vec![[0.0; 3], [0.0, f32::NAN, 0.0]];
        assert_eq!(Image::from_rgb(1, 2, nan).unwrap_err(), TextureError::NotFinite { x: 0, y: 1 });
    }

    #[test]
    fn tiles_keep_every_pixel_in_its_place() {
        let (width, height) = (7, 9);
        let bytes = (0..width * height).map(|i| [i as u8, 255 - i as u8, 7, i as u8]).collect();
        let image = Image::from_rgba8(width, height, bytes, ColorSpace::Linear).unwrap();
        for i in 0..width * height {
            let (x, y) = (i % width, i / width);
            assert_eq!(image.pixel(x, y)[0], i as f32 / 255.0);
            assert_eq!(image.alpha(x, y), i as f32 / 255.0);
        }
    }

    #[test]
    fn bytes_decode_as_their_colour_space_says() {
        let bytes = vec![[0, 128, 255, 255], [255, 255, 255, 51]];
        let image = Image::from_rgba8(2, 1, bytes.clone(), ColorSpace::Srgb).unwrap();
        assert!((image.pixel(0, 0)[1] - 0.215_861).abs() < 1e-5);
        assert_eq!(image.pixel(0, 0)[2], 1.0);
        assert!(image.has_alpha() && (image.alpha(1, 0) - 0.2).abs() < 1e-6);
        assert!((image.alpha_image().pixel(1, 0)[2] - 0.2).abs() < 1e-6);
        let image = Image::from_rgba8(2, 1, bytes, ColorSpace::Linear).unwrap();
        assert!((image.mean()[1] - (128.0 / 255.0 + 1.0) / 2.0).abs() < 1e-6);
    }
}
