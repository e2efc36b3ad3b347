//! Nets: how many points lie in each elementary interval.
use super::{MeasureError, check};
use crate::sobol::generator_matrix;
use alloc::vec;
use alloc::vec::Vec;

/// Whether `base^m` points are a (t,m,s)-net: each elementary interval of volume `base^(t - m)` contains `base^t` of them.
///
/// An elementary interval is a product of intervals `[a b^-k, (a + 1) b^-k)`. Coordinates are compared after adding `2^-40`,
/// which makes up for rounding in bases other than two.
/// Cost: points times the ways to share `m - t` digits among the dimensions.
///
/// # Errors
/// If the points are not well-formed or their number is no power of the base.
///
/// ```
/// use qmc_sampling::{Sequence, measure::is_net, sobol::Sobol};
/// let points: Vec<f64> = (0..64).flat_map(|i| Sobol::default().sample_2d(i)).collect();
/// assert_eq!(is_net(&points, 2, 2, 0), Ok(true));
/// ```
pub fn is_net(points: &[f64], dimensions: usize, base: u32, t: u32) -> Result<bool, MeasureError> {
    let n = check(points, dimensions)?;
    let not_a_power = MeasureError::NotAPower { points: n, base };
    if base < 2 {
        return Err(not_a_power);
    }
    let m = n.ilog(base as usize);
    if (base as usize).pow(m) != n {
        return Err(not_a_power);
    }
    if t >= m {
        return Ok(true);
    }
    let expected = (base as usize).pow(t) as u32;
    let mut counts = vec![0_u32; (base as usize).pow(m - t)];
    let mut holds = true;
    for_each_composition(m - t, dimensions, &mut |digits| {
        if !holds {
            return;
        }
        counts.fill(0);
        for row in points.chunks_exact(dimensions) {
            let cell = row.iter().zip(digits).fold(0, |cell, (x, &k)| {
                let intervals = (base as usize).pow(k);
                let within = ((x + ROUNDING) * intervals as f64) as usize;
                cell * intervals + within.min(intervals - 1)
            });
            counts[cell] += 1;
        }
        holds = counts.iter().all(|&count| count == expected);
    });
    Ok(holds)
}

const ROUNDING: f64 = 1.0 / (1_u64 << 40) as f64;

/// The smallest `t` for which the points are a (t,m,s)-net in this base.
///
/// # Errors
/// As [`is_net`].
pub fn net_t(points: &[f64], dimensions: usize, base: u32) -> Result<u32, MeasureError> {
    let mut t = 0;
    while !is_net(points, dimensions, base, t)? {
        t += 1;
    }
    Ok(t)
}

/// The `t` of the net that the first `2^m` Sobol points are in the given dimensions, from the ranks of the generator
/// matrices, without a look at points: the `m - t` leading rows, however shared among the dimensions, are independent.
///
/// Scrambling does not change it. Source: Niederreiter (1987), "Point sets and sequences with small discrepancy".
///
/// # Panics
/// If a dimension is 1024 or more, or `m` is above 52.
///
/// ```
/// use qmc_sampling::measure::digital_net_t;
/// assert_eq!(digital_net_t(&[0, 1], 20), 0);
/// assert_eq!(digital_net_t(&[0, 1, 2, 3], 8), 3);
/// ```
#[must_use]
pub fn digital_net_t(dimensions: &[u32], m: u32) -> u32 {
    assert!(m <= crate::sobol::INDEX_BITS, "2^{m} points are more than there are");
    // rows[d][r]: digit r of the coordinate as a mask of index bits
    let rows: Vec<Vec<u64>> = dimensions
        .iter()
        .map(|&d| {
            let columns = generator_matrix(d);
            (0..m).map(|r| (0..m).fold(0, |row, c| row | (((columns[c as usize] >> (63 - r)) & 1) << c))).collect()
        })
        .collect();
    (0..m).find(|&t| all_independent(&rows, m - t)).unwrap_or(m)
}

/// Whether each choice of `count` leading rows is linearly independent over GF(2).
fn all_independent(rows: &[Vec<u64>], count: u32) -> bool {
    let mut holds = true;
    for_each_composition(count, rows.len(), &mut |digits| {
        if holds {
            let chosen = rows.iter().zip(digits).flat_map(|(rows, &k)| &rows[..k as usize]);
            holds = independent(chosen.copied());
        }
    });
    holds
}

fn independent(vectors: impl Iterator<Item = u64>) -> bool {
    // basis[b] has its highest bit at b
    let mut basis = [0_u64; 64];
    for mut v in vectors {
        loop {
            if v == 0 {
                return false;
            }
            let high = v.ilog2() as usize;
            if basis[high] == 0 {
                basis[high] = v;
                break;
            }
            v ^= basis[high];
        }
    }
    true
}

/// Calls `visit` with each way to write `total` as a sum of `parts` numbers.
fn for_each_composition(total: u32, parts: usize, visit: &mut impl FnMut(&[u32])) {
    fn place(parts: &mut [u32], at: usize, rest: u32, visit: &mut impl FnMut(&[u32])) {
        if at + 1 == parts.len() {
            parts[at] = rest;
            visit(parts);
            return;
        }
        for k in 0..=rest {
            parts[at] = k;
            place(parts, at + 1, rest - k, visit);
        }
    }
    if parts > 0 {
        place(&mut vec![0; parts], 0, total, visit);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::testing::points;
    use crate::sequences::{DigitScramble, Faure, Hammersley, Random};
    use crate::sobol::{Randomisation, Sobol};

    #[test]
    fn known_nets() {
        assert_eq!(net_t(&points(Sobol::default(), 256, 2), 2, 2), Ok(0));
        assert_eq!(net_t(&points(Hammersley::new(64).unwrap(), 64, 2), 2, 2), Ok(0));
        let faure = Faure::new(3).unwrap().scrambled(DigitScramble::Owen(1));
        assert_eq!(net_t(&points(faure, 81, 3), 3, 3), Ok(0));
        assert!(net_t(&points(Random::new(1), 256, 2), 2, 2).unwrap() > 4);
        assert_eq!(is_net(&[0.1, 0.2], 2, 2, 0), Ok(true));
    }

    /// Two ways to the same number: counting points, plain and scrambled, and ranks of matrices. All pairs of the first
    /// dimensions.
    #[test]
    fn ranks_and_counts_agree_for_all_pairs() {
        for m in [5, 8] {
            for a in 0..10 {
                for b in 0..a {
                    let t = digital_net_t(&[a, b], m);
                    for randomisation in [Randomisation::None, Randomisation::Owen(9), Randomisation::NestedUniform(9)]
                    {
                        let sobol = Sobol::new(randomisation);
                        let pairs: Vec<f64> =
                            (0..1 << m).flat_map(|i| [sobol.sample(i, a), sobol.sample(i, b)]).collect();
                        assert_eq!(net_t(&pairs, 2, 2), Ok(t), "dimensions {a} and {b}, {randomisation:?}");
                    }
                }
            }
        }
    }

    use crate::Sequence;

    /// Sobol (1967): t is at most the sum of the degrees less one.
    #[test]
    fn defects_respect_the_bound_of_the_degrees() {
        assert!(digital_net_t(&[0, 1, 2], 10) <= 1);
        assert!(digital_net_t(&[0, 1, 2, 3], 10) <= 3);
        assert!(digital_net_t(&[0, 1, 2, 3, 4], 10) <= 5);
    }

    #[test]
    fn refuse_what_is_no_net() {
        assert_eq!(is_net(&[0.1; 6], 2, 2, 0), Err(MeasureError::NotAPower { points: 3, base: 2 }));
        assert!(is_net(&[0.1; 4], 2, 1, 0).is_err() && is_net(&[], 2, 2, 0).is_err());
    }
}
