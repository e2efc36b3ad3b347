//! The product of a generator matrix and an index, a nibble at a time and four dimensions at once.
use super::{Parameters, directions};

/// The first four dimensions of Joe and Kuo.
const FIRST_FOUR: [Parameters<'static>; 4] = [
    Parameters { degree: 0, coefficients: 0, initial: &[] },
    Parameters { degree: 1, coefficients: 0, initial: &[1] },
    Parameters { degree: 2, coefficients: 1, initial: &[1, 3] },
    Parameters { degree: 3, coefficients: 1, initial: &[1, 3, 1] },
];

/// Four dimensions; for each of the eight nibbles of the bit-reversed index and each value of it, what it contributes to
/// the bit-reversed coordinates.
type NibbleTables = [[[u32; 4]; 16]; 8];

static FIRST_FOUR_TABLES: NibbleTables = nibble_tables(&FIRST_FOUR);

const fn nibble_tables(parameters: &[Parameters<'static>; 4]) -> NibbleTables {
    let mut tables = [[[0; 4]; 16]; 8];
    let mut dimension = 0;
    while dimension < 4 {
        let columns: [u64; 32] = directions::columns(&parameters[dimension]);
        let mut entry = 0;
        while entry < 128 {
            let (nibble, value) = (entry / 16, entry % 16);
            let mut bit = 0;
            while bit < 4 {
                if (value >> bit) & 1 == 1 {
                    // bit b of the reversed index is bit 31 - b of the index
                    let column = columns[31 - (4 * nibble + bit)];
                    tables[nibble][value][dimension] ^= ((column >> 32) as u32).reverse_bits();
                }
                bit += 1;
            }
            entry += 1;
        }
        dimension += 1;
    }
    tables
}

/// The first four coordinates of a point, bit-reversed, from its bit-reversed index.
#[inline]
pub(crate) fn reversed_4d(index_reversed: u32) -> [u32; 4] {
    let mut sum = [0; 4];
    let mut rest = index_reversed;
    for table in &FIRST_FOUR_TABLES {
        let entry = &table[(rest & 15) as usize];
        for (s, e) in sum.iter_mut().zip(entry) {
            *s ^= e;
        }
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
}
