//! The Halton sequence through an image.
use super::ImageSequence;
use crate::sequences::{SequenceError, radical_inverse};

/// The Halton sequence through the pixels of an image, on a grid of `2^i` times `3^j` pixels.
///
/// A batch is `2^i 3^j` points. From pixel to index: the pixel column fixes the index modulo `2^i`, the row fixes it modulo
/// `3^j`, and the Chinese remainder theorem does the rest.
///
/// ```
/// use qmc_sampling::image::{HaltonImage, ImageSequence};
/// # fn main() -> Result<(), qmc_sampling::sequences::SequenceError> {
/// let image = HaltonImage::new(640, 480)?;
/// assert_eq!(image.batch_len(), 1024 * 729);
/// assert_eq!(image.pixel(image.index([12, 345], 67)), Some([12, 345]));
/// # Ok(()) }
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HaltonImage {
    size: [u32; 2],
    /// `i` and `j`
    digits: [u32; 2],
    /// `2^i` and `3^j`
    sides: [u64; 2],
    /// Indices congruent to one modulo one side and to zero modulo the other.
    units: [u64; 2],
}

const BASES: [u32; 2] = [2, 3];

impl HaltonImage {
    /// The grid that covers an image.
    ///
    /// # Errors
    /// If a side is zero or more than 2^24 pixels.
    pub fn new(width: u32, height: u32) -> Result<Self, SequenceError> {
        if width == 0 || height == 0 {
            return Err(SequenceError::NoPoints);
        }
        if width.max(height) > 1 << 24 {
            return Err(SequenceError::ImageTooLarge { width, height });
        }
        let mut digits = [0; 2];
        let mut sides = [1_u64; 2];
        for (k, size) in [width, height].into_iter().enumerate() {
            while sides[k] < u64::from(size) {
                sides[k] *= u64::from(BASES[k]);
                digits[k] += 1;
            }
        }
        let units = [0, 1].map(|k| {
            let (own, other) = (sides[k], sides[1 - k]);
            other * modular_inverse(other % own, own)
        });
        Ok(Self { size: [width, height], digits, sides, units })
    }

    /// The number of digits of the index that choose the pixel: in base 2 for the column, in base 3 for the row.
    #[must_use]
    pub fn digits(&self) -> [u32; 2] {
        self.digits
    }

    /// Width and height of the grid.
    #[must_use]
    pub fn sides(&self) -> [u64; 2] {
        self.sides
    }
}

/// `x` with `a x = 1` modulo `n`, for coprime `a` and `n`; zero for `n = 1`.
fn modular_inverse(a: u64, n: u64) -> u64 {
    let (mut r, mut s) = ((n as i64, a as i64), (0_i64, 1_i64));
    while r.1 != 0 {
        let quotient = r.0 / r.1;
        r = (r.1, r.0 - quotient * r.1);
        s = (s.1, s.0 - quotient * s.1);
    }
    s.0.rem_euclid(n as i64) as u64
}

/// The `digits` low digits of `n` in reverse order.
#[inline]
fn mirror(base: u32, n: u64, digits: u32) -> u64 {
    let (mut rest, mut mirrored) = (n, 0);
    for _ in 0..digits {
        mirrored = mirrored * u64::from(base) + rest % u64::from(base);
        rest /= u64::from(base);
    }
    mirrored
}

impl ImageSequence for HaltonImage {
    fn size(&self) -> [u32; 2] {
        self.size
    }

    fn batch_len(&self) -> u64 {
        self.sides[0] * self.sides[1]
    }

    fn batches(&self) -> u64 {
        u64::MAX / self.batch_len()
    }

    #[inline]
    fn pixel(&self, index: u64) -> Option<[u32; 2]> {
        let [x, y] = [0, 1].map(|k| mirror(BASES[k], index, self.digits[k]));
        (x < u64::from(self.size[0]) && y < u64::from(self.size[1])).then_some([x as u32, y as u32])
    }

    #[inline]
    fn index(&self, pixel: [u32; 2], batch: u64) -> u64 {
        let modulus = u128::from(self.batch_len());
        let residue = |k: usize| {
            let low = mirror(BASES[k], u64::from(pixel[k]), self.digits[k]);
            u128::from(low) * u128::from(self.units[k]) % modulus
        };
        batch * self.batch_len() + ((residue(0) + residue(1)) % modulus) as u64
    }

    #[inline]
    fn offset(&self, index: u64) -> [f64; 2] {
        [0, 1].map(|k| radical_inverse(BASES[k], index / self.sides[k]))
    }
}
