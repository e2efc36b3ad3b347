//! From primitive polynomials to generator matrices.
use super::Parameters;

/// The columns of the generator matrix: column `i` is what bit `i` of the index contributes, as a 64-digit binary
/// fraction with the first digit in the highest bit.
///
/// Joe and Kuo (2008), equations 2 and 3.
pub(crate) const fn columns<const N: usize>(parameters: &Parameters<'_>) -> [u64; N] {
    let mut columns = [0; N];
    let degree = parameters.degree;
    let mut i = 0;
    while i < N {
        columns[i] = if degree == 0 {
            1 << (63 - i)
        } else if i < degree {
            (parameters.initial[i] as u64) << (63 - i)
        } else {
            let mut column = columns[i - degree] ^ (columns[i - degree] >> degree);
            let mut k = 1;
            while k < degree {
                if (parameters.coefficients >> (degree - 1 - k)) & 1 == 1 {
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
