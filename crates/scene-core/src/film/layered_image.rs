//! Images of named channels.

use std::collections::BTreeMap;
use std::fmt;

use thiserror::Error;

use super::FilmError;
use super::accumulation::check_size;

/// A setting that an image carries along: text or a number.
#[derive(Clone, Debug, PartialEq)]
pub enum Attribute {
    /// Text.
    Text(String),
    /// A number.
    Number(f64),
}

impl Attribute {
    /// The number, also if it is written as text.
    pub fn as_f64(&self) -> Option<f64> {
        match self {
            Self::Text(text) => text.trim().parse().ok(),
            Self::Number(number) => Some(*number),
        }
    }

    /// The whole number, also if it is written as text; nothing if it is negative, has a fraction or is too large.
    pub fn as_u64(&self) -> Option<u64> {
        match self {
            Self::Text(text) => text.trim().parse().ok(),
            // Exactly below 2^53, where f64 still holds every integer.
            Self::Number(number) => {
                (number.fract() == 0.0 && (0.0..=9_007_199_254_740_992.0).contains(number)).then_some(*number as u64)
            }
        }
    }
}

impl fmt::Display for Attribute {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Text(text) => text.fmt(f),
            Self::Number(number) => number.fmt(f),
        }
    }
}

impl From<&str> for Attribute {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Attribute {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<f64> for Attribute {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<u32> for Attribute {
    fn from(number: u32) -> Self {
        Self::Number(f64::from(number))
    }
}

impl From<u64> for Attribute {
    /// A number where f64 holds it exactly (up to 2^53), else text: seeds survive.
    fn from(number: u64) -> Self {
        if number <= 1 << 53 { Self::Number(number as f64) } else { Self::Text(number.to_string()) }
    }
}

/// An image, or the combination of images, makes no sense.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum LayeredImageError {
    /// The size is impossible.
    #[error(transparent)]
    Size(#[from] FilmError),
    /// A channel does not have as many values as the image has pixels.
    #[error("channel '{name}' has {found} values, the image has {expected} pixels")]
    ChannelLength {
        /// The channel.
        name: String,
        /// Number of pixels.
        expected: usize,
        /// Number of values.
        found: usize,
    },
    /// A name is empty, longer than 255 bytes, or has a character beyond Latin-1 or a NUL.
    #[error("'{0}' cannot be the name of a channel or an attribute")]
    Name(String),
    /// The image has neither `R G B` nor `Y`, in any layer.
    #[error("no colour channels among: {0}")]
    NoColour(String),
    /// Images to be merged differ in their channels.
    #[error("channels differ: '{0}' is not in all images")]
    ChannelMismatch(String),
    /// An image to be merged does not say how many samples it has.
    #[error("image {0} has no positive sample count in its attribute 'spp'")]
    NoSampleCount(usize),
    /// Nothing to be merged.
    #[error("no images to merge")]
    NoImages,
}

/// Named channels of f32, all of the same size, and named settings.
///
/// Channels of a layer are called `Layer.R`, `Layer.X` and so on, those of the main image `R`, `G`, `B`. Values are
/// linear, row by row from the top. Values that are not finite are kept as they are.
///
/// ```
/// use scene_core::film::LayeredImage;
///
/// let mut image = LayeredImage::new(2, 1)?;
/// image.set_channel("Y", vec![0.25, 0.5])?;
/// image.set_attribute("estimator", "path")?;
/// assert_eq!(image.rgb()?, [[0.25; 3], [0.5; 3]]);
/// assert!(image.set_channel("Z", vec![1.0]).is_err());
/// # Ok::<(), scene_core::film::LayeredImageError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LayeredImage {
    width: u32,
    height: u32,
    channels: BTreeMap<String, Vec<f32>>,
    attributes: BTreeMap<String, Attribute>,
}

impl LayeredImage {
    /// An image without channels.
    ///
    /// # Errors
    /// [`LayeredImageError::Size`] if a side is zero or there are more than [`MAX_PIXELS`](super::MAX_PIXELS).
    pub fn new(width: u32, height: u32) -> Result<Self, LayeredImageError> {
        check_size(width, height)?;
        Ok(Self::of_film(width, height))
    }

    /// For sizes that have been checked already.
    pub(super) fn of_film(width: u32, height: u32) -> Self {
        Self { width, height, channels: BTreeMap::new(), attributes: BTreeMap::new() }
    }

    /// Channels whose names and lengths are right by construction.
    pub(super) fn put_planes<const N: usize>(&mut self, names: [&str; N], planes: [Vec<f32>; N]) {
        for (name, plane) in names.into_iter().zip(planes) {
            debug_assert_eq!(plane.len(), self.pixel_count(), "{name}");
            self.channels.insert(name.to_owned(), plane);
        }
    }

    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Number of pixels.
    pub fn pixel_count(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Sets or replaces a channel.
    ///
    /// # Errors
    /// [`LayeredImageError::ChannelLength`] unless there is one value per pixel, [`LayeredImageError::Name`] for names
    /// that files cannot hold.
    pub fn set_channel(&mut self, name: &str, values: Vec<f32>) -> Result<(), LayeredImageError> {
        check_name(name)?;
        if values.len() != self.pixel_count() {
            let (expected, found) = (self.pixel_count(), values.len());
            return Err(LayeredImageError::ChannelLength { name: name.to_owned(), expected, found });
        }
        self.channels.insert(name.to_owned(), values);
        Ok(())
    }

    /// Sets or replaces the main image `R G B`.
    ///
    /// # Errors
    /// [`LayeredImageError::ChannelLength`] unless there is one colour per pixel.
    pub fn set_rgb(&mut self, pixels: &[[f32; 3]]) -> Result<(), LayeredImageError> {
        ["R", "G", "B"]
            .into_iter()
            .enumerate()
            .try_for_each(|(channel, name)| self.set_channel(name, pixels.iter().map(|pixel| pixel[channel]).collect()))
    }

    /// The values of a channel, row by row.
    pub fn channel(&self, name: &str) -> Option<&[f32]> {
        self.channels.get(name).map(Vec::as_slice)
    }

    /// All channels in alphabetical order.
    pub fn channels(&self) -> impl ExactSizeIterator<Item = (&str, &[f32])> {
        self.channels.iter().map(|(name, values)| (name.as_str(), values.as_slice()))
    }

    /// The main image in linear RGB: `R G B`, or `Y` for grey ones, or else the first layer that has `.R .G .B`.
    ///
    /// # Errors
    /// [`LayeredImageError::NoColour`] if there is no such thing.
    pub fn rgb(&self) -> Result<Vec<[f32; 3]>, LayeredImageError> {
        let main = self.planes("").or_else(|| self.channel("Y").map(|y| [y; 3]));
        let layer = || self.channels.keys().find_map(|name| self.planes(name.strip_suffix('R')?));
        match main.or_else(layer) {
            Some([r, g, b]) => Ok(r.iter().zip(g).zip(b).map(|((&r, &g), &b)| [r, g, b]).collect()),
            None => Err(LayeredImageError::NoColour(self.channels.keys().cloned().collect::<Vec<_>>().join(", "))),
        }
    }

    fn planes(&self, prefix: &str) -> Option<[&[f32]; 3]> {
        let plane = |suffix| self.channel(&format!("{prefix}{suffix}"));
        Some([plane("R")?, plane("G")?, plane("B")?])
    }

    /// Sets or replaces a setting.
    ///
    /// # Errors
    /// [`LayeredImageError::Name`] for names that files cannot hold.
    pub fn set_attribute(&mut self, name: &str, value: impl Into<Attribute>) -> Result<(), LayeredImageError> {
        check_name(name)?;
        self.attributes.insert(name.to_owned(), value.into());
        Ok(())
    }

    /// A setting.
    pub fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.get(name)
    }

    /// All settings in alphabetical order.
    pub fn attributes(&self) -> impl ExactSizeIterator<Item = (&str, &Attribute)> {
        self.attributes.iter().map(|(name, value)| (name.as_str(), value))
    }
}

/// OpenEXR stores names as at most 255 bytes ended by NUL, one byte per character.
fn check_name(name: &str) -> Result<(), LayeredImageError> {
    let is_fine = (1..=255).contains(&name.len()) && name.chars().all(|c| c != '\0' && u32::from(c) < 256);
    if is_fine { Ok(()) } else { Err(LayeredImageError::Name(name.to_owned())) }
}
