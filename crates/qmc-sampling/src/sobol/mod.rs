//! The Sobol sequence with the direction numbers of Joe and Kuo.
//!
//! Source: S. Joe and F. Y. Kuo, "Constructing Sobol sequences with better two-dimensional projections" (2008).
mod directions;
mod sequence;
mod tables;

pub use directions::{DIMENSIONS, INDEX_BITS};
pub use sequence::{Randomisation, Sobol};

pub(crate) use tables::{reversed_4d, reversed_group};

/// Coordinate `dimension` of point `index` as a binary fraction: the first digit is the highest bit, 52 digits count.
///
/// The product of generator matrix and index. Index bits from 52 on are ignored.
///
/// # Panics
/// If `dimension` is 1024 or more.
///
/// ```
/// use qmc_sampling::sobol::sobol_bits;
/// assert_eq!(sobol_bits(3, 1), 1 << 62); // 0.25
/// ```
#[inline]
#[must_use]
pub fn sobol_bits(index: u64, dimension: u32) -> u64 {
    let columns = &directions::COLUMNS[dimension as usize];
    let mut rest = index & ((1 << INDEX_BITS) - 1);
    let mut bits = 0;
    while rest != 0 {
        bits ^= columns[rest.trailing_zeros() as usize];
        rest &= rest - 1;
    }
    bits
}

/// Coordinate `dimension` of point `index` as 32 binary digits; faster than [`sobol_bits`] in the first 256 dimensions.
///
/// # Panics
/// If `dimension` is 1024 or more.
#[inline]
#[must_use]
pub fn sobol_bits_u32(index: u64, dimension: u32) -> u32 {
    reversed_u32(index, dimension).reverse_bits()
}

/// The digits of [`sobol_bits_u32`] in reverse order, the first one in the lowest bit.
#[inline]
pub(crate) fn reversed_u32(index: u64, dimension: u32) -> u32 {
    let (low, high) = (index as u32, index >> 32);
    if dimension >= tables::DIMENSIONS {
        return ((sobol_bits(index, dimension) >> 32) as u32).reverse_bits();
    }
    let digits = tables::reversed_product(low, dimension);
    if high == 0 { digits } else { digits ^ ((sobol_bits(high << 32, dimension) >> 32) as u32).reverse_bits() }
}

/// The generator matrix of a dimension: column `i` is what bit `i` of the index contributes, first digit in bit 63.
///
/// # Panics
/// If `dimension` is 1024 or more.
#[must_use]
pub fn generator_matrix(dimension: u32) -> &'static [u64; INDEX_BITS as usize] {
    &directions::COLUMNS[dimension as usize]
}

/// The second coordinate of point `index` with its digits reversed: the first digit is the lowest bit, 64 digits count.
///
/// The generator matrix is Pascal's triangle modulo 2, in which entry `(j, i)` is one if the bits of `j` are among those
/// of `i` (Lucas): so digit `j` is the sum of the bits `i` of the index over all supersets `i` of `j`, one step for each
/// of the six bits that the position of a bit has. The first coordinate, reversed, is the index itself.
#[inline]
pub(crate) const fn reversed_second(index: u64) -> u64 {
    let mut digits = index;
    digits ^= (digits >> 1) & 0x5555_5555_5555_5555;
    digits ^= (digits >> 2) & 0x3333_3333_3333_3333;
    digits ^= (digits >> 4) & 0x0f0f_0f0f_0f0f_0f0f;
    digits ^= (digits >> 8) & 0x00ff_00ff_00ff_00ff;
    digits ^= (digits >> 16) & 0x0000_ffff_0000_ffff;
    digits ^ (digits >> 32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From SciPy 1.15.3, `Sobol(1024, scramble=False, bits=52)`, which lists the points in Gray code order.
    #[test]
    fn points_are_those_of_scipy() {
        let dimensions = [0, 1, 4, 39, 255, 511, 1023];
        let expected: [(u64, [f64; 7]); 4] = [
            (5, [0.875, 0.875, 0.875, 0.375, 0.875, 0.875, 0.375]),
            (100, [0.414_062_5, 0.257_812_5, 0.882_812_5, 0.132_812_5, 0.570_312_5, 0.523_437_5, 0.945_312_5]),
            (
                1000,
                [
                    0.219_726_562_5,
                    0.096_679_687_5,
                    0.280_273_437_5,
                    0.479_492_187_5,
                    0.249_023_437_5,
                    0.395_507_812_5,
                    0.713_867_187_5,
                ],
            ),
            (
                4095,
                [
                    0.000_244_140_625,
                    0.941_162_109_375,
                    0.940_185_546_875,
                    0.227_294_921_875,
                    0.613_037_109_375,
                    0.914_794_921_875,
                    0.354_736_328_125,
                ],
            ),
        ];
        for (i, point) in expected {
            for (&dimension, x) in dimensions.iter().zip(point) {
                assert_eq!(
                    crate::f64_from_bits(sobol_bits(i ^ (i >> 1), dimension)),
                    x,
                    "point {i} dimension {dimension}"
                );
            }
        }
    }

    #[test]
    fn the_second_dimension_is_pascals_triangle() {
        for i in 0..500_u64 {
            let index = (i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> (i % 60)) & ((1 << INDEX_BITS) - 1);
            assert_eq!(reversed_second(index).reverse_bits(), sobol_bits(index, 1), "point {index}");
        }
    }

    #[test]
    fn fast_and_plain_products_agree() {
        for dimension in [0, 1, 2, 3, 77, 255, 256, 1023] {
            for i in 0..200_u64 {
                let index = i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> (i % 50);
                assert_eq!(sobol_bits_u32(index, dimension), (sobol_bits(index, dimension) >> 32) as u32);
            }
        }
    }
}
