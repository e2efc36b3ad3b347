//! Blue-noise error diffusion along the Z-order curve.
use super::{Sampler, SamplerFamily, Split, pixel_of};
use crate::float::f32_from_bits;
use crate::hash::{combine, mix64};
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
pub struct ZSobol {
    size: [u32; 2],
    /// Of the number of paths per pixel.
    log2_paths: u32,
    /// Of the number of points on the curve.
    log2_points: u32,
    seed: u64,
}

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
            return ZSobolSampler { morton: index & 0xffff_ffff, pattern, dimension: 0, log2_points: 32 };
        };
        let round = index >> self.log2_paths;
        let place = index & ((1 << self.log2_paths) - 1);
        let pixel = spread(x) | (spread(y) << 1);
        ZSobolSampler {
            morton: (pixel << self.log2_paths) | place,
            pattern: combine(combine(0, self.seed), round),
            dimension: 0,
            log2_points: self.log2_points as u8,
        }
    }
}

/// Moves bit `i` to bit `2 i`.
#[inline]
fn spread(x: u32) -> u64 {
    let mut x = u64::from(x);
    for (shift, mask) in [
        (16, 0x0000_ffff_0000_ffff),
        (8, 0x00ff_00ff_00ff_00ff),
        (4, 0x0f0f_0f0f_0f0f_0f0f),
        (2, 0x3333_3333_3333_3333),
        (1, 0x5555_5555_5555_5555),
    ] {
        x = (x | (x << shift)) & mask;
    }
    x
}

/// The sampler of [`ZSobol`], 24 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ZSobolSampler {
    /// Place on the curve and number of the path.
    morton: u64,
    /// Hash of the seed and the forks.
    pattern: u64,
    dimension: u32,
    log2_points: u8,
}

/// The permutations of four things, two bits each.
const PERMUTATIONS: [u8; 24] = {
    let mut all = [0; 24];
    let mut n = 0;
    let mut code = 0_u16;
    while code < 256 {
        let (a, b, c, d) = (code & 3, (code >> 2) & 3, (code >> 4) & 3, code >> 6);
        if (1 << a) | (1 << b) | (1 << c) | (1 << d) == 15 {
            all[n] = code as u8;
            n += 1;
        }
        code += 1;
    }
    all
};

/// Moves a digit in base 4 by one of 24 permutations, which 12 random bits choose.
#[inline]
const fn permuted(random: u64, digit: u64) -> u64 {
    let choice = ((random & 0xfff) * 24) >> 12;
    (PERMUTATIONS[choice as usize] >> (2 * digit)) as u64 & 3
}

impl ZSobolSampler {
    /// The index in the sequence: the permuted digits of the place on the curve, with the random number `key`.
    ///
    /// Each digit in base 4 is moved by a permutation that is hashed from the digits above; a single bit may be left over. One
    /// hash of 64 bits serves two digits: 12 bits of it choose the permutation of the first one, and 12 bits for each
    /// value of the first one that of the second.
    #[inline]
    fn index(&self, key: u64) -> u64 {
        let mut index = 0;
        let mut shift = u32::from(self.log2_points);
        while shift >= 4 {
            let hash = mix64((self.morton >> shift) ^ key);
            shift -= 4;
            let (first, second) = ((self.morton >> (shift + 2)) & 3, (self.morton >> shift) & 3);
            let digits = (permuted(hash >> 48, first) << 2) | permuted(hash >> (12 * first), second);
            index |= digits << shift;
        }
        if shift >= 2 {
            let hash = mix64((self.morton >> shift) ^ key);
            shift -= 2;
            index |= permuted(hash >> 48, (self.morton >> shift) & 3) << shift;
        }
        if shift == 1 {
            index |= (self.morton & 1) ^ (mix64((self.morton >> 1) ^ key) >> 63);
        }
        index
    }

    /// Random numbers of the next dimensions: for the order and for the digits.
    #[inline]
    fn keys(&mut self, dimensions: u32) -> (u64, u64) {
        let key = combine(self.pattern, u64::from(self.dimension));
        self.dimension = self.dimension.wrapping_add(dimensions);
        (key, combine(key, 0))
    }
}

impl Sampler for ZSobolSampler {
    #[inline]
    fn next_1d(&mut self) -> f32 {
        let (order, digits) = self.keys(1);
        f32_from_bits(laine_karras(self.index(order) as u32, digits as u32).reverse_bits())
    }

    #[inline]
    fn next_2d(&mut self) -> [f32; 2] {
        let (order, digits) = self.keys(2);
        let index = self.index(order);
        // The first two coordinates with their digits reversed.
        let (x, y) = (index as u32, reversed_second(index) as u32);
        [laine_karras(x, digits as u32), laine_karras(y, (digits >> 32) as u32)]
            .map(|r| f32_from_bits(r.reverse_bits()))
    }

    #[inline]
    fn fork(&self, domain: u32) -> Self {
        Self { pattern: combine(self.pattern ^ 0x5bd1_e995, u64::from(domain)), dimension: 0, ..*self }
    }
}

impl Split for ZSobolSampler {
    /// The children go on along the curve below their path: stratified against each other, against those of the other
    /// paths of the pixel, and against those of the pixels around. Counted as the next power of two.
    #[inline]
    fn split(&self, domain: u32, children: u32, child: u32) -> Self {
        let bits = children.max(1).checked_next_power_of_two().map_or(31, u32::ilog2);
        Self {
            morton: (self.morton << bits) | (u64::from(child) & ((1 << bits) - 1)),
            pattern: combine(combine(self.pattern ^ 0x5bd1_e995, u64::from(domain)), u64::from(children)),
            dimension: 0,
            log2_points: (u32::from(self.log2_points) + bits).min(63) as u8,
        }
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
        assert_eq!(PERMUTATIONS[23], 0b11_10_01_00);
    }
}
