//! Blue-noise error diffusion along the Z-order curve.
use super::z_order::{permute_base_4, z_order};
use super::{Sampler, SamplerFamily, Split, pixel_of, seeds};
use crate::float::f32_from_bits;
use crate::hash::combine;
use crate::scramble::laine_karras;
use crate::sequences::SequenceError;
use crate::sobol::reversed_second;

/// Owen-scrambled Sobol points handed out along the Z-order (Morton) curve of the image: neighbouring pixels get
/// neighbouring parts of one sequence, so that their errors are of opposite signs and the noise is blue.
///
/// The stream is the pixel, `y * width + x`. The index along the curve is written in base 4 and its digits are permuted at
/// random, each depending on the digits before it; each dimension, or pair of dimensions, has permutations of its own.
/// The error of a single pixel is as that of [`OwenSobol`](super::OwenSobol); what looks better is the image, above all at
/// low numbers of paths. Give the number of paths in advance; it is rounded up to a power of two.
///
/// Source: Ahmed and Wonka, "Screen-space blue-noise diffusion of Monte Carlo sampling error via hierarchical ordering of
/// pixels" (2020); the formulation of pbrt-v4.
///
/// ```
/// use qmc_sampling::{Sampler, SamplerFamily, sampler::ZSobol};
/// # fn main() -> Result<(), qmc_sampling::sequences::SequenceError> {
/// let family = ZSobol::new(640, 480, 16, 1)?;
/// assert!(family.sampler(640 * 3 + 5, 15).next_1d() < 1.0);
/// # Ok(()) }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Unchecked"))]
pub struct ZSobol {
    size: [u32; 2],
    /// Of the number of paths per pixel.
    log2_paths: u32,
    /// Of the number of points on the curve.
    log2_points: u32,
    seed: u64,
}

#[cfg(feature = "serde")]
read_through!(ZSobol { size: [u32; 2], log2_paths: u32, seed: u64 } => {
    let [width, height] = size;
    let paths = 1u32.checked_shl(log2_paths).ok_or(SequenceError::ImageTooLarge { width, height })?;
    Self::new(width, height, paths, seed)
}, SequenceError);

impl ZSobol {
    /// The points for an image of `width` times `height` pixels and `paths` paths through each.
    ///
    /// # Errors
    /// If a side or the number of paths is zero, or there are more than 2^64 points.
    pub fn new(width: u32, height: u32, paths: u32, seed: u64) -> Result<Self, SequenceError> {
        if width == 0 || height == 0 || paths == 0 {
            return Err(SequenceError::NoPoints);
        }
        let too_large = SequenceError::ImageTooLarge { width, height };
        let side = width.max(height).checked_next_power_of_two().ok_or(too_large)?;
        let log2_paths = paths.checked_next_power_of_two().ok_or(too_large)?.ilog2();
        let log2_points = log2_paths + 2 * side.ilog2();
        if log2_points > 63 {
            return Err(too_large);
        }
        Ok(Self { size: [width, height], log2_paths, log2_points, seed })
    }
}

impl SamplerFamily for ZSobol {
    type Sampler = ZSobolSampler;

    /// Indices beyond the number of paths start other, independent points. Streams beyond the pixels of the image are
    /// randomisations of their own, with points in the order of the index, shuffled in base 4.
    #[inline]
    fn sampler(&self, stream: u64, index: u64) -> ZSobolSampler {
        let Some([x, y]) = pixel_of(stream, self.size) else {
            let pattern = combine(combine(combine(0, self.seed), stream), index >> 32);
            return ZSobolSampler::new(index & 0xffff_ffff, 32, pattern);
        };
        let round = index >> self.log2_paths;
        let place = index & ((1 << self.log2_paths) - 1);
        let place = (z_order(x, y) << self.log2_paths) | place;
        ZSobolSampler::new(place, self.log2_points, combine(combine(0, self.seed), round))
    }
}

/// The sampler of [`ZSobol`], 24 bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ZSobolSampler {
    /// Place on the curve and number of the path, with the highest of their bits lowest.
    reversed: u64,
    /// Hash of the seed and the forks.
    pattern: u64,
    dimension: u32,
    log2_points: u8,
}

impl ZSobolSampler {
    /// Point `place` of 2^`log2_points` on the curve.
    #[inline]
    const fn new(place: u64, log2_points: u32, pattern: u64) -> Self {
        Self { reversed: reverse(place, log2_points), pattern, dimension: 0, log2_points: log2_points as u8 }
    }

    /// The index of the point in the Sobol sequence, and random numbers for the digits of two coordinates.
    #[inline]
    fn next(&mut self, dimensions: u32) -> (u64, [u32; 2]) {
        let key = combine(self.pattern, u64::from(self.dimension));
        self.dimension = self.dimension.wrapping_add(dimensions);
        let bits = u32::from(self.log2_points);
        let index = reverse(permute_base_4(self.reversed, bits, key), bits);
        (index, [seeds(key)[3], key as u32])
    }
}

/// The `bits` low bits in reverse order.
#[inline]
const fn reverse(number: u64, bits: u32) -> u64 {
    // In two steps, for there may be no bits.
    number.reverse_bits() >> (63 - bits) >> 1
}

impl Sampler for ZSobolSampler {
    #[inline]
    fn next_1d(&mut self) -> f32 {
        let (index, [seed, _]) = self.next(1);
        f32_from_bits(laine_karras(index as u32, seed).reverse_bits())
    }

    #[inline]
    fn next_2d(&mut self) -> [f32; 2] {
        let (index, seeds) = self.next(2);
        // The first two coordinates with their digits reversed.
        let point = [index as u32, reversed_second(index) as u32];
        [0, 1].map(|k| f32_from_bits(laine_karras(point[k], seeds[k]).reverse_bits()))
    }

    #[inline]
    fn fork(&self, domain: u32) -> Self {
        Self { pattern: combine(self.pattern ^ 0x5bd1_e995, u64::from(domain)), dimension: 0, ..*self }
    }
}

impl Split for ZSobolSampler {
    /// The children go on along the curve below their path: stratified against each other, against those of the other
    /// paths of the pixel, and against those of the pixels around. Counted as the next power of two; what does not fit into
    /// 63 bits with the points of the image is independent.
    #[inline]
    fn split(&self, domain: u32, children: u32, child: u32) -> Self {
        let wanted = children.max(1).checked_next_power_of_two().map_or(32, u32::ilog2);
        let (used, child) = (u32::from(self.log2_points), u64::from(child));
        let bits = wanted.min(63 - used);
        let place = (reverse(self.reversed, used) << bits) | (child & ((1 << bits) - 1));
        let pattern = combine(combine(self.pattern ^ 0x5bd1_e995, u64::from(domain)), u64::from(children));
        Self::new(place, used + bits, combine(pattern, child >> bits))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;

    /// The points of any pixel, and of any aligned square of pixels, are a net.
    #[test]
    fn blocks_of_pixels_are_stratified() {
        for paths in [4, 8] {
            let family = ZSobol::new(16, 16, paths, 3).unwrap();
            for side in [1, 2, 8] {
                let n = paths * side * side;
                for draws in 0..3 {
                    let mut hit = vec![false; n as usize];
                    for pixel in 0..side * side {
                        let (x, y) = (8 + pixel % side, pixel / side);
                        for i in 0..paths {
                            let mut sampler = family.sampler(u64::from(16 * y + x), u64::from(i));
                            for _ in 0..draws {
                                sampler.next_1d();
                            }
                            hit[(sampler.next_2d()[1] * n as f32) as usize] = true;
                        }
                    }
                    assert!(hit.iter().all(|&h| h), "{paths} paths, squares of {side}");
                }
            }
        }
    }

    #[test]
    fn large_images_and_errors() {
        let family = ZSobol::new(3840, 2160, 1 << 16, 0).unwrap();
        assert!(family.sampler(3840 * 2160 - 1, 1 << 40).next_2d()[0] < 1.0);
        assert!(ZSobol::new(0, 1, 1, 0).is_err() && ZSobol::new(1 << 31, 1 << 31, 4, 0).is_err());
        assert!(ZSobol::new(1, 1, 1, 0).unwrap().sampler(0, 0).next_2d()[1] < 1.0);
    }
}
