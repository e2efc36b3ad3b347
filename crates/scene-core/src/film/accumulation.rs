//! The film: all pixels, and the layer of splats.

use thiserror::Error;

use super::splat::{SplatBuffer, SplatLayer};
use super::{FilmTile, Pixel};

/// Films and images with more pixels than this are taken for a mistake.
pub const MAX_PIXELS: u64 = 1 << 28;

/// A film cannot be made, or two do not fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum FilmError {
    /// Width or height is zero.
    #[error("image of {width}x{height} pixels has no pixels")]
    Empty {
        /// Width asked for.
        width: u32,
        /// Height asked for.
        height: u32,
    },
    /// More than [`MAX_PIXELS`], or more than there is memory for.
    #[error("image of {width}x{height} pixels is too large")]
    TooLarge {
        /// Width asked for.
        width: u32,
        /// Height asked for.
        height: u32,
    },
    /// Films to be merged, or a film and a buffer of splats, differ in size.
    #[error("sizes differ: {}x{} and {}x{} pixels", .expected[0], .expected[1], .found[0], .found[1])]
    SizeMismatch {
        /// Width and height of the film.
        expected: [u32; 2],
        /// Width and height of what is added.
        found: [u32; 2],
    },
}

/// Accumulates samples of radiance in f64, per pixel, with auxiliary quantities; and splats of light paths in a layer
/// of their own.
///
/// Threads work on disjoint tiles ([`tiles_mut`](Self::tiles_mut)) or rows ([`rows_mut`](Self::rows_mut)). As each
/// pixel is summed by one thread in one order, the result is the same bit for bit at any number of threads; and as sums keep their rounding errors,
/// also however a rendering is cut into parts that are [merged](Self::merge). Splats go
/// into one [`SplatBuffer`] per batch of light paths; add the buffers in the order of the batches.
///
/// **Memory**: 232 bytes per pixel, and 96 more once there are splats.
///
/// ```
/// use scene_core::film::{Film, FilmError};
///
/// let mut film = Film::new(2, 1)?;
/// film.pixel_mut(0, 0).add([1.0, 2.0, 3.0]);
/// let mut other = film.clone();
/// other.pixel_mut(0, 0).add([3.0, 2.0, 1.0]);
/// film.merge(&other)?; // three samples now: 1, 1, 3
/// assert_eq!(film.pixel(0, 0).mean()[0], 5.0 / 3.0);
/// assert!(matches!(Film::new(640, 0), Err(FilmError::Empty { .. })));
/// # Ok::<(), FilmError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    width: u32,
    height: u32,
    pixels: Vec<Pixel>,
    pub(super) splats: SplatLayer,
}

impl Film {
    /// A film without samples.
    ///
    /// # Errors
    /// If a side is zero, there are more than [`MAX_PIXELS`], or the memory is not to be had.
    pub fn new(width: u32, height: u32) -> Result<Self, FilmError> {
        let count = check_size(width, height)?;
        let mut pixels = Vec::new();
        pixels.try_reserve_exact(count).map_err(|_| FilmError::TooLarge { width, height })?;
        pixels.resize(count, Pixel::default());
        Ok(Self { width, height, pixels, splats: SplatLayer::default() })
    }

    /// From as many pixels as its size needs.
    pub(super) fn from_parts(width: u32, height: u32, pixels: Vec<Pixel>, splats: SplatLayer) -> Self {
        Self { width, height, pixels, splats }
    }

    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All pixels, row by row from the top.
    pub fn pixels(&self) -> &[Pixel] {
        &self.pixels
    }

    /// The pixel in column `x` and row `y`.
    ///
    /// # Panics
    /// If it is outside of the film.
    pub fn pixel(&self, x: u32, y: u32) -> &Pixel {
        &self.pixels[self.index(x, y)]
    }

    /// The pixel in column `x` and row `y`.
    ///
    /// # Panics
    /// If it is outside of the film.
    pub fn pixel_mut(&mut self, x: u32, y: u32) -> &mut Pixel {
        let index = self.index(x, y);
        &mut self.pixels[index]
    }

    /// The rows from the top, each a slice of pixels.
    pub fn rows_mut(&mut self) -> impl ExactSizeIterator<Item = &mut [Pixel]> {
        self.pixels.chunks_exact_mut(self.width as usize)
    }

    /// The film in disjoint squares of `size` pixels (less at the right and lower border), in reading order: hand
    /// them out to threads. A size of zero counts as one.
    pub fn tiles_mut(&mut self, size: u32) -> Vec<FilmTile<'_>> {
        FilmTile::cut(&mut self.pixels, self.width as usize, size.max(1) as usize)
    }

    /// Adds the contributions of a batch of light paths.
    ///
    /// # Errors
    /// [`FilmError::SizeMismatch`] if the buffer is for a film of another size.
    pub fn add_splats(&mut self, buffer: &SplatBuffer) -> Result<(), FilmError> {
        self.check_same_size(buffer.resolution())?;
        self.splats.add(buffer, self.pixels.len());
        Ok(())
    }

    /// Adds everything that another film has accumulated, as if it had been accumulated here: films weigh by their
    /// numbers of samples.
    ///
    /// # Errors
    /// [`FilmError::SizeMismatch`] if the films differ in size.
    pub fn merge(&mut self, other: &Self) -> Result<(), FilmError> {
        self.check_same_size([other.width, other.height])?;
        for (pixel, other) in self.pixels.iter_mut().zip(&other.pixels) {
            pixel.merge(other);
        }
        self.splats.merge(&other.splats);
        Ok(())
    }

    /// Number of samples of radiance in all pixels.
    pub fn samples(&self) -> u64 {
        self.pixels.iter().map(Pixel::samples).sum()
    }

    /// Number of samples and splats that were not finite and count as zero. Anything but zero is a bug in a
    /// material or an estimator: report it.
    pub fn rejected_samples(&self) -> u64 {
        self.pixels.iter().map(Pixel::rejected).sum::<u64>() + self.splats.rejected
    }

    fn index(&self, x: u32, y: u32) -> usize {
        assert!(x < self.width && y < self.height, "pixel ({x}, {y}) is outside of {}x{}", self.width, self.height);
        y as usize * self.width as usize + x as usize
    }

    fn check_same_size(&self, found: [u32; 2]) -> Result<(), FilmError> {
        let expected = [self.width, self.height];
        if found == expected { Ok(()) } else { Err(FilmError::SizeMismatch { expected, found }) }
    }
}

/// Number of pixels of an image of acceptable size.
pub(super) fn check_size(width: u32, height: u32) -> Result<usize, FilmError> {
    match u64::from(width) * u64::from(height) {
        0 => Err(FilmError::Empty { width, height }),
        count if count > MAX_PIXELS => Err(FilmError::TooLarge { width, height }),
        count => usize::try_from(count).map_err(|_| FilmError::TooLarge { width, height }),
    }
}
