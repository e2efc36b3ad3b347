//! One Sobol sequence through the whole image.
use super::{Sampler, SamplerFamily, Split, pixel_of, seeds, shuffle};
use crate::float::f32_from_bits;
use crate::hash::{combine, mix64};
use crate::image::{ImageSequence, SobolImage};
use crate::scramble::laine_karras;
use crate::sequences::SequenceError;
use crate::sobol::{DIMENSIONS, reversed_group, reversed_second, reversed_u32, sobol_bits};

/// One Owen-scrambled Sobol sequence through all the pixels of an image.
///
/// The stream is the pixel, `y * width + x`; the index is the number of the batch ([`SobolImage`]). The first pair of numbers
/// is the place in the pixel, further ones are dimensions 2, 3, .. of the sequence: no padding, so the image as a whole is
/// sampled by one sequence of up to 1024 dimensions and 2^52 points, and errors of neighbouring pixels tend to cancel.
/// The digits that choose the pixel are not scrambled, those below and all other dimensions are.
///
/// Forks, splits and dimensions from 1024 on restart at dimension 0 of a sequence of their pixel, of which the batch counts
/// the points, with the index shuffled and other random digits.
/// Cost: per number eight lookups of four bytes, or per four eight of 16; more for indices above 2^32.
///
/// ```
/// use qmc_sampling::{Sampler, SamplerFamily, sampler::GlobalSobol};
/// # fn main() -> Result<(), qmc_sampling::sequences::SequenceError> {
/// let family = GlobalSobol::new(1920, 1080, 1)?;
/// let mut path = family.sampler(1920 * 200 + 100, 3);
/// let [x, y] = path.next_2d(); // in pixel (100, 200)
/// assert!(x < 1.0 && y < 1.0);
/// # Ok(()) }
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GlobalSobol {
    image: SobolImage,
    seed: u64,
}

impl GlobalSobol {
    /// The sequence through an image of `width` times `height` pixels, in one of 2^64 randomisations.
    ///
    /// # Errors
    /// If a side is zero or more than 65536 pixels.
    pub fn new(width: u32, height: u32, seed: u64) -> Result<Self, SequenceError> {
        Ok(Self { image: SobolImage::new(width, height)?, seed })
    }

    /// The map between pixels and indices.
    #[must_use]
    pub fn image(&self) -> &SobolImage {
        &self.image
    }

    /// The sampler of a point of the sequence, whichever pixel that falls into.
    #[inline]
    #[must_use]
    pub fn at(&self, index: u64) -> GlobalSobolSampler {
        GlobalSobolSampler { pattern: combine(0, self.seed), index, dimension: 0, pixel_digits: self.image.log2_side() }
    }
}

impl SamplerFamily for GlobalSobol {
    type Sampler = GlobalSobolSampler;

    /// Streams beyond the pixels of the image are randomisations of their own, of which the index counts the points.
    /// After 2^52 points the sequence starts again.
    #[inline]
    fn sampler(&self, stream: u64, index: u64) -> GlobalSobolSampler {
        let Some(pixel) = pixel_of(stream, self.image.size()) else {
            let pattern = combine(combine(0, self.seed), stream);
            return GlobalSobolSampler { pattern, index, dimension: 0, pixel_digits: 0 };
        };
        self.at(self.image.index(pixel, index % self.image.batches()))
    }
}

/// The sampler of [`GlobalSobol`], 24 bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GlobalSobolSampler {
    /// Hash of the seed and the forks.
    pattern: u64,
    index: u64,
    dimension: u32,
    /// How many digits of dimensions 0 and 1 choose the pixel: none in forks.
    pixel_digits: u32,
}

/// The number of groups of four dimensions that there are tables for.
const GROUPS: u32 = 64;

impl GlobalSobolSampler {
    /// The random number of a group of four dimensions.
    #[inline]
    fn key(&self, group: u32) -> u64 {
        mix64(self.pattern.wrapping_add(u64::from(group).wrapping_mul(0x9e37_79b9_7f4a_7c15)))
    }

    /// A coordinate of the point.
    #[inline]
    fn draw(&self, dimension: u32) -> f32 {
        let seed = seeds(self.key(dimension / 4))[(dimension % 4) as usize];
        let bits = match dimension {
            0 | 1 => self.place(dimension, seed),
            _ => laine_karras(reversed_u32(self.index, dimension), seed).reverse_bits(),
        };
        f32_from_bits(bits)
    }

    /// A coordinate within the pixel: scrambles the digits below those that choose the pixel, of which the scramble depends.
    #[inline]
    fn place(&self, dimension: u32, seed: u32) -> u32 {
        let reversed = if dimension == 0 { self.index } else { reversed_second(self.index) };
        let digits = self.pixel_digits;
        let seed = if digits == 0 {
            seed
        } else {
            let pixel = reversed & ((1 << digits) - 1);
            mix64((pixel << 32) | u64::from(seed)) as u32
        };
        laine_karras((reversed >> digits) as u32, seed).reverse_bits()
    }

    /// Four coordinates of the point, of a group below [`GROUPS`].
    #[inline]
    fn group(&self, group: u32) -> [f32; 4] {
        let digit_seeds = seeds(self.key(group));
        let mut point = reversed_group(self.index as u32, group);
        let high = self.index >> 32;
        if high != 0 {
            for (dimension, p) in (4 * group..).zip(&mut point) {
                *p ^= ((sobol_bits(high << 32, dimension) >> 32) as u32).reverse_bits();
            }
        }
        let mut scrambled = [0; 4];
        for ((s, p), seed) in scrambled.iter_mut().zip(point).zip(digit_seeds) {
            *s = laine_karras(p, seed).reverse_bits();
        }
        if group == 0 && self.pixel_digits > 0 {
            for (k, s) in (0..2).zip(&mut scrambled) {
                *s = self.place(k, digit_seeds[k as usize]);
            }
        }
        scrambled.map(f32_from_bits)
    }

    /// The next four numbers. They start at a multiple of four dimensions, leaving out what is before.
    #[inline]
    pub fn next_4d(&mut self) -> [f32; 4] {
        let group = self.dimension.div_ceil(4);
        if group >= GROUPS {
            let [a, b] = self.next_2d();
            let [c, d] = self.next_2d();
            return [a, b, c, d];
        }
        self.dimension = 4 * (group + 1);
        self.group(group)
    }

    /// Makes room for `n` more dimensions.
    #[inline]
    fn reserve(&mut self, n: u32) {
        if self.dimension + n > DIMENSIONS {
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
        let digits = self.pixel_digits;
        let low = |reversed: u64| reversed & ((1 << digits) - 1);
        let (pattern, batch) = if digits == 0 {
            (pattern, self.index)
        } else {
            let pixel = low(self.index) | (low(reversed_second(self.index)) << 32);
            (combine(pattern, pixel), self.index >> (2 * digits))
        };
        let index = batch.wrapping_mul(children).wrapping_add(child);
        Self { pattern, index: shuffle(index, mix64(!pattern)), dimension: 0, pixel_digits: 0 }
    }
}

impl Sampler for GlobalSobolSampler {
    #[inline]
    fn next_1d(&mut self) -> f32 {
        self.reserve(1);
        let x = self.draw(self.dimension);
        self.dimension += 1;
        x
    }

    #[inline]
    fn next_2d(&mut self) -> [f32; 2] {
        self.reserve(2);
        let (group, first) = (self.dimension / 4, (self.dimension % 4) as usize);
        self.dimension += 2;
        // Four at once are cheaper than two single ones, but for the first pair.
        if 0 < group && group < GROUPS && first < 3 {
            let four = self.group(group);
            return [four[first], four[first + 1]];
        }
        [self.draw(self.dimension - 2), self.draw(self.dimension - 1)]
    }

    #[inline]
    fn fork(&self, domain: u32) -> Self {
        self.branch(combine(self.pattern, u64::from(domain)), 1, 0)
    }
}

impl Split for GlobalSobolSampler {
    #[inline]
    fn split(&self, domain: u32, children: u32, child: u32) -> Self {
        let pattern = combine(combine(self.pattern, u64::from(domain)), u64::from(children));
        self.branch(pattern, u64::from(children), u64::from(child))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_at_once_are_the_same_numbers() {
        let family = GlobalSobol::new(100, 100, 5).unwrap();
        for sampler in [family.sampler(77, 3), family.sampler(77, 1 << 30), family.sampler(77, 3).fork(1)] {
            let mut at_once = sampler.clone();
            let mut single = sampler.clone();
            for _ in 0..70 {
                assert_eq!(at_once.next_4d(), [0; 4].map(|_| single.next_1d()));
            }
            for skipped in 0..4 {
                let (mut pairs, mut single) = (sampler.clone(), sampler.clone());
                for _ in 0..skipped {
                    assert_eq!(pairs.next_1d(), single.next_1d());
                }
                for _ in 0..400 {
                    assert_eq!(pairs.next_2d(), [0; 2].map(|_| single.next_1d()));
                }
            }
        }
    }

    /// The place in the pixel is the place of the point of the sequence: one per cell of the pixel, with 4^k paths.
    #[test]
    fn pixels_are_stratified() {
        let family = GlobalSobol::new(64, 64, 5).unwrap();
        for pixel in [0, 63, 1000, 4095] {
            // Each pixel is an elementary interval, so what falls into it is a (0,2)-sequence of its own.
            let mut hit = [false; 16];
            for i in 0..16 {
                let [x, y] = family.sampler(pixel, i).next_2d();
                hit[(4.0 * x) as usize + 4 * (4.0 * y) as usize] = true;
            }
            assert!(hit.iter().all(|&h| h), "{pixel}");
        }
    }
}
