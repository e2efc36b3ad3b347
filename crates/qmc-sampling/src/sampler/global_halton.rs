//! One Halton sequence through the whole image.
use super::{Sampler, SamplerFamily, Split, pixel_of, shuffle};
use crate::float::f32_from_bits;
use crate::hash::{combine, mix64};
use crate::image::{HaltonImage, ImageSequence};
use crate::scramble::laine_karras;
use crate::sequences::{Base, PRIMES, SequenceError};

/// One Owen-scrambled Halton sequence through all the pixels of an image.
///
/// As [`GlobalSobol`](super::GlobalSobol), with any number of batches a good one, and slower: per number a hash and a few
/// multiplications for each digit, of which single precision has 16 in base 3, 5 in bases from 29 on, 2 in those from 4099
/// on. The digits that choose the pixel are not scrambled.
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

    /// Streams beyond the pixels of the image are randomisations of their own, of which the index counts the points.
    /// After 2^64 points the sequence starts again.
    #[inline]
    fn sampler(&self, stream: u64, index: u64) -> GlobalHaltonSampler {
        let Some(pixel) = pixel_of(stream, self.image.size()) else {
            let pattern = combine(combine(0, self.seed), stream);
            return GlobalHaltonSampler { pattern, index, dimension: 0, pixel_digits: [0; 2] };
        };
        GlobalHaltonSampler {
            pattern: combine(0, self.seed),
            index: self.image.index(pixel, index % self.image.batches()),
            dimension: 0,
            pixel_digits: self.image.digits().map(|d| d as u8),
        }
    }
}

/// The sampler of [`GlobalHalton`], 24 bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
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
        let (mut index, mut key) = (self.index, combine(self.pattern, u64::from(dimension)));
        if let Some(&digits) = self.pixel_digits.get(dimension as usize) {
            // The digits that choose the pixel also choose the random numbers in it.
            let side = BASES[dimension as usize].pow(u32::from(digits));
            key = combine(key, index % side);
            index /= side;
        }
        if dimension == 0 {
            // In base 2 by hashing all digits at once.
            return f32_from_bits(laine_karras(index as u32, key as u32).reverse_bits());
        }
        Base::of(dimension).scrambled_inverse(index, key)
    }

    /// Makes room for `n` more dimensions.
    #[inline]
    fn reserve(&mut self, n: u32) {
        if self.dimension + n > PRIMES {
            *self = self.fork(u32::MAX);
        }
    }

    /// The sampler of the `child`th of `children` points of each point, in a pattern of its own.
    ///
    /// Samplers of pixels leave the sequence of the image for one of their pixel, of which the batch counts the points: those
    /// of one pixel are far from each other in the sequence of the image, and would be no better than random ones after
    /// another shuffle.
    #[inline]
    fn branch(&self, pattern: u64, children: u64, child: u64) -> Self {
        let [columns, rows] = [0, 1].map(|k| BASES[k].pow(u32::from(self.pixel_digits[k])));
        let (pattern, batch) = if columns * rows == 1 {
            (pattern, self.index)
        } else {
            let pixel = (self.index % columns) | ((self.index % rows) << 32);
            (combine(pattern, pixel), self.index / (columns * rows))
        };
        let index = batch.wrapping_mul(children).wrapping_add(child);
        Self { pattern, index: shuffle(index, mix64(!pattern)), dimension: 0, pixel_digits: [0; 2] }
    }
}

/// Of the dimensions that choose the pixel.
const BASES: [u64; 2] = [2, 3];

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
        self.branch(combine(self.pattern, u64::from(domain)), 1, 0)
    }
}

impl Split for GlobalHaltonSampler {
    #[inline]
    fn split(&self, domain: u32, children: u32, child: u32) -> Self {
        let pattern = combine(combine(self.pattern, u64::from(domain)), u64::from(children));
        self.branch(pattern, u64::from(children), u64::from(child))
    }
}
