//! The star discrepancy.
use super::{MeasureError, check};
use alloc::vec;
use alloc::vec::Vec;

/// How many steps are still worth while.
const LIMIT: f64 = 1e10;

/// The star discrepancy: the largest difference between the fraction of points in a box `[0, x)` and its volume.
///
/// Exact: the supremum is reached at a box whose corner has coordinates of points, or one; closed and open boxes are told
/// apart. Cost: about `n^dimensions`, so for few points or dimensions. Source: Niederreiter (1972).
///
/// # Errors
/// If the points are not well-formed, or it would take more than 10^10 steps.
///
/// ```
/// use qmc_sampling::measure::star_exact;
/// assert_eq!(star_exact(&[0.125, 0.375, 0.625, 0.875], 1), Ok(0.125)); // 1 / (2 n): the best there is
/// ```
pub fn star_exact(points: &[f64], dimensions: usize) -> Result<f64, MeasureError> {
    let n = check(points, dimensions)?;
    let axes: Vec<Vec<f64>> = (0..dimensions)
        .map(|d| {
            let mut axis: Vec<f64> = points.iter().skip(d).step_by(dimensions).copied().collect();
            axis.push(1.0);
            axis.sort_by(f64::total_cmp);
            axis.dedup();
            axis
        })
        .collect();
    if axes.iter().map(|axis| axis.len() as f64).product::<f64>() > LIMIT {
        return Err(MeasureError::TooExpensive);
    }
    let rows: Vec<&[f64]> = points.chunks_exact(dimensions).collect();
    let mut worst = 0.0;
    sweep(&axes, &rows, &rows, 1.0, n as f64, &mut worst);
    Ok(worst)
}

/// Goes through the corners along the first axis; `open` and `closed` are the points that are in the open and the closed box
/// as far as the axes before are concerned.
fn sweep(axes: &[Vec<f64>], open: &[&[f64]], closed: &[&[f64]], volume: f64, n: f64, worst: &mut f64) {
    let Some((axis, rest)) = axes.split_first() else { return };
    let d = open.first().or(closed.first()).map_or(0, |row| row.len() - axes.len());
    let by = |a: &&[f64], b: &&[f64]| a[d].total_cmp(&b[d]);
    let (mut open, mut closed) = (open.to_vec(), closed.to_vec());
    open.sort_by(by);
    closed.sort_by(by);
    for &corner in axis {
        let inside = open.partition_point(|row| row[d] < corner);
        let on_or_inside = closed.partition_point(|row| row[d] <= corner);
        let volume = volume * corner;
        if rest.is_empty() {
            *worst = worst.max(volume - inside as f64 / n).max(on_or_inside as f64 / n - volume);
        } else {
            sweep(rest, &open[..inside], &closed[..on_or_inside], volume, n, worst);
        }
    }
}

/// A lower and an upper bound of the star discrepancy, for more points and dimensions than [`star_exact`] can do.
///
/// The boxes are compared on a grid of `cells` intervals per dimension: the lower bound is the worst grid box; the upper one
/// compares the count of each grid box with the volume of its neighbours, so it is at most `dimensions / cells` above.
/// Cost: `n + dimensions cells^dimensions`. Source: Niederreiter, "Random number generation and quasi-Monte Carlo methods"
/// (1992), chapter 2.
///
/// # Errors
/// If the points are not well-formed, `cells` is zero, or it would take more than 10^8 cells.
///
/// ```
/// use qmc_sampling::measure::star_bounds;
/// let [low, high] = star_bounds(&[0.125, 0.375, 0.625, 0.875], 1, 1000)?;
/// assert!(low <= 0.125 && 0.125 <= high && high - low <= 0.002);
/// # Ok::<(), qmc_sampling::measure::MeasureError>(())
/// ```
pub fn star_bounds(points: &[f64], dimensions: usize, cells: usize) -> Result<[f64; 2], MeasureError> {
    let n = check(points, dimensions)? as f64;
    if cells == 0 {
        return Err(MeasureError::Shape { len: 0, dimensions });
    }
    // Corners 0 to `cells` in each dimension.
    let side = cells + 1;
    let total = (0..dimensions).try_fold(1_usize, |product, _| product.checked_mul(side).filter(|&p| p <= 100_000_000));
    let total = total.ok_or(MeasureError::TooExpensive)?;
    // Count the points in each cell, at its upper corner; then sum along each dimension: points in the box up to a corner.
    let mut counts = vec![0_u32; total];
    for row in points.chunks_exact(dimensions) {
        let corner =
            row.iter().rev().fold(0, |index, x| index * side + 1 + ((x * cells as f64) as usize).min(cells - 1));
        counts[corner] += 1;
    }
    let mut stride = 1;
    for _ in 0..dimensions {
        for i in 0..total {
            if (i / stride) % side > 0 {
                counts[i] += counts[i - stride];
            }
        }
        stride *= side;
    }
    let (mut low, mut high) = (0.0_f64, 0.0_f64);
    for (corner, &count) in counts.iter().enumerate() {
        let (mut volume, mut below, mut rest) = (1.0, 1.0, corner);
        let mut diagonal = Some(0);
        let mut stride = 1;
        for _ in 0..dimensions {
            let c = rest % side;
            volume *= c as f64 / cells as f64;
            below *= c.saturating_sub(1) as f64 / cells as f64;
            diagonal = if c == 0 { None } else { diagonal.map(|index| index + (c - 1) * stride) };
            rest /= side;
            stride *= side;
        }
        let fraction = f64::from(count) / n;
        low = low.max((fraction - volume).abs());
        // Boxes between this corner and the one diagonally below have counts and volumes between theirs.
        let fraction_below = diagonal.map_or(0.0, |index| f64::from(counts[index]) / n);
        if diagonal.is_some() {
            high = high.max(fraction - below).max(volume - fraction_below);
        }
    }
    Ok([low, high.max(low)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::testing::points;
    use crate::sequences::{Halton, Hammersley, Random};
    use crate::sobol::Sobol;

    /// All boxes with corners at coordinates of points, one by one.
    fn brute_force(points: &[f64], dimensions: usize) -> f64 {
        let n = points.len() / dimensions;
        let mut worst: f64 = 0.0;
        for choice in 0..(n + 1).pow(dimensions as u32) {
            let corner: Vec<f64> = (0..dimensions)
                .map(|d| {
                    let k = choice / (n + 1).pow(d as u32) % (n + 1);
                    if k == n { 1.0 } else { points[k * dimensions + d] }
                })
                .collect();
            let volume: f64 = corner.iter().product();
            let count = |inside: fn(&f64, &f64) -> bool| {
                points.chunks(dimensions).filter(|p| p.iter().zip(&corner).all(|(x, c)| inside(x, c))).count() as f64
            };
            worst = worst.max(volume - count(|x, c| x < c) / n as f64).max(count(|x, c| x <= c) / n as f64 - volume);
        }
        worst
    }

    #[test]
    fn exact_equals_brute_force_and_lies_between_the_bounds() {
        for dimensions in 1..=3 {
            for set in [
                points(Sobol::default(), 16, dimensions),
                points(Halton::default(), 13, dimensions),
                points(Random::new(5), 17, dimensions),
                std::vec![0.0; 2 * dimensions as usize],
            ] {
                let dimensions = dimensions as usize;
                let exact = star_exact(&set, dimensions).unwrap();
                assert!((exact - brute_force(&set, dimensions)).abs() < 1e-14);
                for cells in [1, 4, 37] {
                    let [low, high] = star_bounds(&set, dimensions, cells).unwrap();
                    assert!(low <= exact + 1e-14 && exact <= high + 1e-14, "{low} {exact} {high}");
                    assert!(high - low <= 2.0 * dimensions as f64 / cells as f64);
                }
            }
        }
    }

    #[test]
    fn known_values() {
        // n points at (2 i - 1) / (2 n) in one dimension: 1 / (2 n); the origin alone: 1.
        assert_eq!(star_exact(&[0.0], 1), Ok(1.0));
        let hammersley = star_exact(&points(Hammersley::new(1024).unwrap(), 1024, 2), 2).unwrap();
        // Halton and Zaremba (1969): n D* = m / 3 + 13 / 9 - (-1)^m 4 / (9 2^m)
        let expected = (10.0 / 3.0 + 13.0 / 9.0 - 4.0 / (9.0 * 1024.0)) / 1024.0;
        assert!((hammersley - expected).abs() < 1e-12, "{hammersley} {expected}");
    }

    #[test]
    fn refuse_what_takes_too_long() {
        let many = points(Random::new(1), 200, 6);
        assert_eq!(star_exact(&many, 6), Err(MeasureError::TooExpensive));
        assert_eq!(star_bounds(&many, 6, 100), Err(MeasureError::TooExpensive));
        assert!(star_bounds(&many, 6, 0).is_err());
    }
}
