//! From primitive polynomials to generator matrices.

/// The number of dimensions there are direction numbers for.
pub const DIMENSIONS: u32 = 1024;

/// The number of index bits that count: sequences of up to 2^52 points.
pub const INDEX_BITS: u32 = 52;

/// Dimensions 2 to 1024 of `new-joe-kuo-6.21201`; see `data/README.md` for the format, its source and its licence.
static JOE_KUO: &[u8] = include_bytes!("../../data/joe-kuo-1024.bin");

/// The columns of all generator matrices: column `i` of dimension `d` is what bit `i` of the index contributes to the
/// coordinate, as a 64-digit binary fraction with the first digit in the highest bit.
pub(crate) static COLUMNS: [[u64; INDEX_BITS as usize]; DIMENSIONS as usize] = {
    let mut all = [[0; INDEX_BITS as usize]; DIMENSIONS as usize];
    all[0] = van_der_corput();
    let (mut dimension, mut offset) = (1, 0);
    while dimension < DIMENSIONS as usize {
        all[dimension] = columns(offset);
        offset += 1 + word(offset).ilog2() as usize;
        dimension += 1;
    }
    all
};

/// Word `i` of the table.
const fn word(i: usize) -> u16 {
    u16::from_le_bytes([JOE_KUO[2 * i], JOE_KUO[2 * i + 1]])
}

/// The first dimension: the identity.
const fn van_der_corput() -> [u64; INDEX_BITS as usize] {
    let mut columns = [0; INDEX_BITS as usize];
    let mut i = 0;
    while i < columns.len() {
        columns[i] = 1 << (63 - i);
        i += 1;
    }
    columns
}

/// A dimension from its polynomial and initial numbers, which start at word `offset`.
///
/// Joe and Kuo (2008), equations 2 and 3.
const fn columns(offset: usize) -> [u64; INDEX_BITS as usize] {
    let polynomial = word(offset);
    let degree = polynomial.ilog2() as usize;
    let mut columns = [0; INDEX_BITS as usize];
    let mut i = 0;
    while i < columns.len() {
        columns[i] = if i < degree {
            (word(offset + 1 + i) as u64) << (63 - i)
        } else {
            let mut column = columns[i - degree] ^ (columns[i - degree] >> degree);
            let mut k = 1;
            while k < degree {
                if (polynomial >> (degree - k)) & 1 == 1 {
                    column ^= columns[i - k];
                }
                k += 1;
            }
            column
        };
        i += 1;
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_read_to_its_end_and_matrices_are_regular() {
        let mut offset = 0;
        for _ in 1..DIMENSIONS {
            offset += 1 + word(offset).ilog2() as usize;
        }
        assert_eq!(2 * offset, JOE_KUO.len());
        for columns in &COLUMNS {
            // upper triangular with a unit diagonal
            for (i, column) in columns.iter().enumerate() {
                assert_eq!(column.trailing_zeros() as usize, 63 - i);
            }
        }
    }
}
