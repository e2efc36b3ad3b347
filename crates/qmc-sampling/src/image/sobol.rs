//! The Sobol sequence through an image.
use super::ImageSequence;
use crate::float::f64_from_bits;
use crate::sequences::SequenceError;
use crate::sobol::{INDEX_BITS, generator_matrix, sobol_bits, sobol_bits_u32};

/// The Sobol sequence through the pixels of an image, on a square grid with a side of `2^m` pixels.
///
/// A batch is `4^m` points. From pixel to index: the low `2 m` bits of the index solve the linear equations that the `m`
/// leading digits of both coordinates pose; the matrix is inverted once.
///
/// ```
/// use qmc_sampling::image::{ImageSequence, SobolImage};
/// # fn main() -> Result<(), qmc_sampling::sequences::SequenceError> {
/// let image = SobolImage::new(1920, 1080)?;
/// let index = image.index([100, 200], 3); // the fourth sample of that pixel
/// assert_eq!(image.pixel(index), Some([100, 200]));
/// assert_eq!(index / image.batch_len(), 3);
/// # Ok(()) }
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SobolImage {
    size: [u32; 2],
    /// `m`
    log2_side: u32,
    /// For each nibble of the pixel (x, then y) and each value of it, what it contributes to the low bits of the index.
    inverse: [[u32; 16]; Self::MAX_BITS / 4],
}

impl SobolImage {
    const MAX_BITS: usize = 32;

    /// The grid that covers an image.
    ///
    /// # Errors
    /// If a side is zero or more than 65536 pixels.
    pub fn new(width: u32, height: u32) -> Result<Self, SequenceError> {
        if width == 0 || height == 0 {
            return Err(SequenceError::NoPoints);
        }
        if width.max(height) > 1 << (Self::MAX_BITS / 2) {
            return Err(SequenceError::ImageTooLarge { width, height });
        }
        let log2_side = width.max(height).next_power_of_two().ilog2();
        Ok(Self { size: [width, height], log2_side, inverse: inverse(log2_side) })
    }

    /// The binary logarithm of the side of the grid.
    #[must_use]
    pub fn log2_side(&self) -> u32 {
        self.log2_side
    }

    /// The cell of the grid that a point falls into, within the image or not.
    #[inline]
    fn cell(&self, index: u64) -> [u32; 2] {
        [0, 1].map(|d| leading(sobol_bits_u32(index, d), self.log2_side))
    }
}

/// The first `digits` digits of a binary fraction.
#[inline]
fn leading(bits: u32, digits: u32) -> u32 {
    (u64::from(bits) >> (32 - digits)) as u32
}

/// Solves for the low index bits, by elimination over GF(2). The first two dimensions are a (0,2)-sequence, so that the
/// matrix is regular.
fn inverse(log2_side: u32) -> [[u32; 16]; SobolImage::MAX_BITS / 4] {
    let n = 2 * log2_side;
    // Row i: the pixel that index bit i leads to, and the index that has it.
    let mut rows: [(u64, u64); SobolImage::MAX_BITS] = core::array::from_fn(|i| {
        let [x, y] = [0, 1].map(|d| u64::from(leading((generator_matrix(d)[i] >> 32) as u32, log2_side)));
        (x | (y << log2_side), 1 << i)
    });
    for bit in 0..n as usize {
        let pivot = (bit..n as usize).find(|&r| (rows[r].0 >> bit) & 1 == 1);
        rows.swap(bit, pivot.expect("the leading digits of a (0,2)-sequence are independent"));
        let (image, index) = rows[bit];
        for (r, row) in rows.iter_mut().enumerate().take(n as usize) {
            if r != bit && (row.0 >> bit) & 1 == 1 {
                row.0 ^= image;
                row.1 ^= index;
            }
        }
    }
    core::array::from_fn(|nibble| {
        core::array::from_fn(|value| {
            let bits =
                (0..4).map(|b| (4 * nibble + b, (value >> b) & 1 == 1)).filter(|&(i, set)| set && i < n as usize);
            bits.fold(0, |index, (i, _)| index ^ rows[i].1 as u32)
        })
    })
}

impl ImageSequence for SobolImage {
    fn size(&self) -> [u32; 2] {
        self.size
    }

    fn batch_len(&self) -> u64 {
        1 << (2 * self.log2_side)
    }

    fn batches(&self) -> u64 {
        1 << (INDEX_BITS - 2 * self.log2_side)
    }

    #[inline]
    fn pixel(&self, index: u64) -> Option<[u32; 2]> {
        let [x, y] = self.cell(index);
        (x < self.size[0] && y < self.size[1]).then_some([x, y])
    }

    #[inline]
    fn index(&self, pixel: [u32; 2], batch: u64) -> u64 {
        let high = batch << (2 * self.log2_side);
        // What the high bits of the index contribute is known: the low ones make up for the rest.
        let [x, y] = self.cell(high);
        let mut rest = u64::from(pixel[0] ^ x) | (u64::from(pixel[1] ^ y) << self.log2_side);
        let mut low = 0;
        for table in &self.inverse {
            low ^= table[(rest & 15) as usize];
            rest >>= 4;
        }
        high | u64::from(low)
    }

    #[inline]
    fn offset(&self, index: u64) -> [f64; 2] {
        [0, 1].map(|d| f64_from_bits(sobol_bits(index, d) << self.log2_side))
    }
}
