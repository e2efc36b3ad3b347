//! The product of a generator matrix and an index, several bits at a time and four dimensions at once.
use super::directions::COLUMNS;

/// How the 32 bits of the bit-reversed index are cut into digits, from the lowest: fewer lookups than with nibbles, and
/// 4 KiB instead of the 16 of bytes.
const WIDTHS: [u32; 6] = [6, 6, 5, 5, 5, 5];

/// For each digit of the bit-reversed index and each value of it, what it contributes to four bit-reversed coordinates.
static FIRST_FOUR_TABLE: [[u32; 4]; 256] = {
    let mut table = [[0; 4]; 256];
    let mut dimension = 0;
    while dimension < 4 {
        let columns = &COLUMNS[dimension];
        let (mut start, mut shift, mut digit) = (0, 0, 0);
        while digit < WIDTHS.len() {
            let mut value = 0;
            while value < 1 << WIDTHS[digit] {
                let mut bit = 0;
                while bit < WIDTHS[digit] {
                    if (value >> bit) & 1 == 1 {
                        // bit b of the reversed index is bit 31 - b of the index
                        let column = columns[(31 - shift - bit) as usize];
                        table[start + value][dimension] ^= ((column >> 32) as u32).reverse_bits();
                    }
                    bit += 1;
                }
                value += 1;
            }
            start += 1 << WIDTHS[digit];
            shift += WIDTHS[digit];
            digit += 1;
        }
        dimension += 1;
    }
    table
};

/// The first four coordinates of a point, bit-reversed, from its bit-reversed index.
#[inline]
pub(crate) fn reversed_4d(index_reversed: u32) -> [u32; 4] {
    let mut sum = [0; 4];
    let (mut start, mut rest) = (0, index_reversed);
    for width in WIDTHS {
        let size = 1_u32 << width;
        let entry = &FIRST_FOUR_TABLE[start + (rest & (size - 1)) as usize];
        for (s, e) in sum.iter_mut().zip(entry) {
            *s ^= e;
        }
        start += size as usize;
        rest >>= width;
    }
    sum
}

/// The number of dimensions that have tables.
pub(crate) const DIMENSIONS: u32 = 256;

/// For each nibble of the index and each value of it, what it contributes to four coordinates, bit-reversed.
type NibbleTables = [[[u32; 4]; 16]; 8];

/// The tables of dimensions `4 g` to `4 g + 3`. Nibbles rather than bytes: a path touches many groups, of 2 KiB each.
static GROUPS: [NibbleTables; DIMENSIONS as usize / 4] = {
    let mut groups = [[[[0; 4]; 16]; 8]; DIMENSIONS as usize / 4];
    let mut dimension = 0;
    while dimension < DIMENSIONS as usize {
        let mut nibble = 0;
        while nibble < 8 {
            let mut value = 1_usize;
            while value < 16 {
                // the entry without the lowest bit, and that bit
                let bit = value.trailing_zeros() as usize;
                let column = ((COLUMNS[dimension][4 * nibble + bit] >> 32) as u32).reverse_bits();
                let rest = groups[dimension / 4][nibble][value & (value - 1)][dimension % 4];
                groups[dimension / 4][nibble][value][dimension % 4] = rest ^ column;
                value += 1;
            }
            nibble += 1;
        }
        dimension += 1;
    }
    groups
};

/// Coordinates `4 group` to `4 group + 3` of point `index`, bit-reversed. `group` is below 64.
#[inline]
pub(crate) fn reversed_group(index: u32, group: u32) -> [u32; 4] {
    let mut sum = [0; 4];
    let mut rest = index;
    for table in &GROUPS[group as usize] {
        let entry = &table[(rest & 15) as usize];
        for (s, e) in sum.iter_mut().zip(entry) {
            *s ^= e;
        }
        rest >>= 4;
    }
    sum
}

/// Coordinate `dimension` of point `index`, bit-reversed. `dimension` is below 256.
#[inline]
pub(crate) fn reversed_product(index: u32, dimension: u32) -> u32 {
    let (group, lane) = ((dimension / 4) as usize, (dimension % 4) as usize);
    let mut sum = 0;
    let mut rest = index;
    for table in &GROUPS[group] {
        sum ^= table[(rest & 15) as usize][lane];
        rest >>= 4;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Published by Joe and Kuo with their program: the first points in dimensions 1 to 4.
    #[test]
    fn first_points_are_the_published_ones() {
        let published: [[f64; 4]; 10] = [
            [0.0, 0.0, 0.0, 0.0],
            [0.5, 0.5, 0.5, 0.5],
            [0.75, 0.25, 0.25, 0.25],
            [0.25, 0.75, 0.75, 0.75],
            [0.375, 0.375, 0.625, 0.875],
            [0.875, 0.875, 0.125, 0.375],
            [0.625, 0.125, 0.875, 0.625],
            [0.125, 0.625, 0.375, 0.125],
            [0.1875, 0.3125, 0.9375, 0.4375],
            [0.6875, 0.8125, 0.4375, 0.9375],
        ];
        // They list the points in Gray code order.
        for (i, point) in published.iter().enumerate() {
            let i = i as u32;
            let reversed = reversed_4d((i ^ (i >> 1)).reverse_bits());
            let ours = reversed.map(|x| f64::from(x.reverse_bits()) / 4_294_967_296.0);
            assert_eq!(&ours, point, "point {i}");
        }
    }

    #[test]
    fn groups_agree_with_single_dimensions() {
        for index in [0, 1, 2, 0x1234_5678, u32::MAX] {
            assert_eq!(reversed_group(index, 0), reversed_4d(index.reverse_bits()));
            for group in [0, 1, 17, 63] {
                let single = [0, 1, 2, 3].map(|lane| reversed_product(index, 4 * group + lane));
                assert_eq!(reversed_group(index, group), single);
            }
        }
    }
}
