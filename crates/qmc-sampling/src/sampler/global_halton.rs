//! One Halton sequence through the whole image.
use super::{Sampler, SamplerFamily, shuffle};
use crate::hash::{combine, mix64};
use crate::image::{HaltonImage, ImageSequence};
use crate::sequence::truncate_to_f32;
use crate::sequences::{DigitScramble, PRIMES, SequenceError, prime};

/// One Owen-scrambled Halton sequence through all the pixels of an image.
///
/// As [`GlobalSobol`](super::GlobalSobol), with any number of batches a good one, and slower: an integer division and a hash
/// per digit. The digits that choose the pixel are not scrambled.
///
/// ```
/// use qmc_sampling::{Sampler, SamplerFamily, sampler::GlobalHalton};
/// # fn main() -> Result<(), qmc_sampling::sequences::SequenceError> {
/// let mut path = GlobalHalton::new(1920, 1080, 1)?.sampler(1920 * 200 + 100, 3);
/// assert!(path.next_1d() < 1.0);
/// # Ok(()) }
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GlobalHalton {
    image: HaltonImage,
    seed: u64,
}

impl GlobalHalton {
    /// The sequence through an image of `width` times `height` pixels, in one of 2^64 randomisations.
    ///
    /// # Errors
    /// If a side is zero or more than 2^24 pixels.
    pub fn new(width: u32, height: u32, seed: u64) -> Result<Self, SequenceError> {
        Ok(Self { image: HaltonImage::new(width, height)?, seed })
    }

    /// The map between pixels and indices.
    #[must_use]
    pub fn image(&self) -> &HaltonImage {
        &self.image
    }
}

impl SamplerFamily for GlobalHalton {
    type Sampler = GlobalHaltonSampler;

    /// Streams beyond the pixels of the image wrap around; so does the index after 2^64 points.
    #[inline]
    fn sampler(&self, stream: u64, index: u64) -> GlobalHaltonSampler {
        let [width, height] = self.image.size().map(u64::from);
        let pixel = [(stream % width) as u32, (stream / width % height) as u32];
        GlobalHaltonSampler {
            pattern: combine(0, self.seed),
            index: self.image.index(pixel, index % self.image.batches()),
            dimension: 0,
            pixel_digits: self.image.digits().map(|d| d as u8),
        }
    }
}

/// The sampler of [`GlobalHalton`], 24 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct GlobalHaltonSampler {
    /// Hash of the seed and the forks.
    pattern: u64,
    index: u64,
    dimension: u32,
    /// How many digits of dimensions 0 and 1 choose the pixel: none in forks.
    pixel_digits: [u8; 2],
}

impl GlobalHaltonSampler {
    #[inline]
    fn draw(&self, dimension: u32) -> f32 {
        let base = prime(dimension);
        let mut index = self.index;
        let mut pattern = self.pattern;
        if let Some(&digits) = self.pixel_digits.get(dimension as usize) {
            // The digits that choose the pixel also choose the random numbers in it.
            let side = u64::from(base).pow(u32::from(digits));
            pattern = combine(pattern, index % side);
            index /= side;
        }
        truncate_to_f32(DigitScramble::Owen(pattern).radical_inverse_short(base, index, dimension))
    }

    /// Makes room for `n` more dimensions.
    #[inline]
    fn reserve(&mut self, n: u32) {
        if self.dimension + n > PRIMES {
            *self = self.fork(u32::MAX);
        }
    }
}

impl Sampler for GlobalHaltonSampler {
    #[inline]
    fn next_1d(&mut self) -> f32 {
        self.reserve(1);
        self.dimension += 1;
        self.draw(self.dimension - 1)
    }

    #[inline]
    fn next_2d(&mut self) -> [f32; 2] {
        self.reserve(2);
        self.dimension += 2;
        [self.draw(self.dimension - 2), self.draw(self.dimension - 1)]
    }

    #[inline]
    fn fork(&self, domain: u32) -> Self {
        let pattern = combine(self.pattern, u64::from(domain));
        Self { pattern, index: shuffle(self.index, mix64(!pattern)), dimension: 0, pixel_digits: [0; 2] }
    }
}
