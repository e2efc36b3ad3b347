//! Two images of the same size.

use scene_core::film::{ImageFileError, LayeredImage, LayeredImageError};
use thiserror::Error;

/// Two images cannot be compared.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum MetricError {
    /// They differ in size.
    #[error("sizes differ: {}x{} and {}x{} pixels", .test[0], .test[1], .reference[0], .reference[1])]
    SizeMismatch {
        /// Width and height of the image under test.
        test: [u32; 2],
        /// Width and height of the reference.
        reference: [u32; 2],
    },
    /// No pixel is finite in both.
    #[error("no pixel is finite in both images")]
    NothingFinite,
    /// One of them has no colours.
    #[error(transparent)]
    Colour(#[from] LayeredImageError),
    /// One of them cannot be read.
    #[error(transparent)]
    File(#[from] ImageFileError),
}

/// An image under test and its reference, in linear RGB.
///
/// ```
/// use lichtwerk::metrics::{ImagePair, mse};
///
/// let pair = ImagePair::new([3, 1], vec![[1.0; 3], [f32::NAN; 3], [0.0; 3]], vec![[1.5; 3]; 3])?;
/// assert_eq!(pair.non_finite(), [1, 0]);
/// assert_eq!(mse(&pair), (0.25 + 2.25) / 2.0); // over the two pixels that are left
/// # Ok::<(), lichtwerk::metrics::MetricError>(())
/// ```
#[derive(Clone, Debug)]
pub struct ImagePair {
    size: [u32; 2],
    test: Vec<[f32; 3]>,
    reference: Vec<[f32; 3]>,
    compared: Vec<bool>,
    non_finite: [usize; 2],
}

impl ImagePair {
    /// Pairs the pixels of two images of `size`, width and height.
    ///
    /// # Errors
    /// [`MetricError::SizeMismatch`] if one has not that many pixels, [`MetricError::NothingFinite`] if nothing is
    /// left to compare (as in empty images).
    pub fn new(size: [u32; 2], test: Vec<[f32; 3]>, reference: Vec<[f32; 3]>) -> Result<Self, MetricError> {
        let count = size[0] as usize * size[1] as usize;
        if test.len() != count || reference.len() != count {
            let rows = |pixels: &[_]| [size[0], (pixels.len() / size[0].max(1) as usize) as u32];
            return Err(MetricError::SizeMismatch { test: rows(&test), reference: rows(&reference) });
        }
        let is_bad = |pixel: &[f32; 3]| pixel.iter().any(|value| !value.is_finite());
        let non_finite = [&test, &reference].map(|pixels| pixels.iter().filter(|pixel| is_bad(pixel)).count());
        let mut pair = Self { size, test, reference, compared: vec![true; count], non_finite };
        for index in 0..count {
            if is_bad(&pair.test[index]) || is_bad(&pair.reference[index]) {
                pair.compared[index] = false;
                (pair.test[index], pair.reference[index]) = ([0.0; 3], [0.0; 3]);
            }
        }
        if pair.compared.contains(&true) { Ok(pair) } else { Err(MetricError::NothingFinite) }
    }

    /// Pairs the main images of two files' contents.
    ///
    /// # Errors
    /// [`MetricError::SizeMismatch`] if the sizes differ, [`MetricError::Colour`] if one has no colours, and as for
    /// [`new`](Self::new).
    pub fn of_images(test: &LayeredImage, reference: &LayeredImage) -> Result<Self, MetricError> {
        let [size, expected] = [test, reference].map(|image| [image.width(), image.height()]);
        if size != expected {
            return Err(MetricError::SizeMismatch { test: size, reference: expected });
        }
        Self::new(size, test.rgb()?, reference.rgb()?)
    }

    /// Width and height.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Number of pixels that are not finite, in the image under test and in the reference.
    pub fn non_finite(&self) -> [usize; 2] {
        self.non_finite
    }

    /// All pixels of the image under test. Those left out are black.
    pub(super) fn test(&self) -> &[[f32; 3]] {
        &self.test
    }

    /// All pixels of the reference. Those left out are black.
    pub(super) fn reference(&self) -> &[[f32; 3]] {
        &self.reference
    }

    /// Whether each pixel takes part.
    pub(super) fn compared(&self) -> &[bool] {
        &self.compared
    }

    /// The pixels that take part, under test and of the reference.
    pub(super) fn pixels(&self) -> impl Iterator<Item = ([f64; 3], [f64; 3])> {
        let pixels = self.test.iter().zip(&self.reference).zip(&self.compared);
        pixels
            .filter(|(_, compared)| **compared)
            .map(|((test, reference), _)| (test.map(f64::from), reference.map(f64::from)))
    }
}
