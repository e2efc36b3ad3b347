//! Discrepancies in the L2 sense, which have closed forms.
use super::{MeasureError, check};

/// The L2-star discrepancy: the root of the mean squared difference between the fraction of points in a box `[0, x)` and its
/// volume.
///
/// Cost: quadratic in the number of points. Source: Warnock (1972).
///
/// # Errors
/// If the points are not well-formed.
///
/// ```
/// use qmc_sampling::measure::l2_star;
/// let one = l2_star(&[0.5], 1)?; // integral of (1[x > 1/2] - x)^2
/// assert!((one * one - 1.0 / 12.0).abs() < 1e-15);
/// # Ok::<(), qmc_sampling::measure::MeasureError>(())
/// ```
pub fn l2_star(points: &[f64], dimensions: usize) -> Result<f64, MeasureError> {
    let squared =
        closed_form(points, dimensions, 3.0_f64.recip(), 2.0, |x| 0.5 * (1.0 - x * x), |x, y| 1.0 - x.max(y))?;
    Ok(crate::Real::sqrt(crate::Real::max(squared, 0.0)))
}

/// The squared centred L2 discrepancy: boxes with a corner at the nearest vertex of the cube; invariant under reflections.
///
/// Cost: quadratic in the number of points.
/// Source: Hickernell, "A generalized discrepancy and quadrature error bound" (1998), equation 5.
///
/// # Errors
/// If the points are not well-formed.
pub fn centred_l2(points: &[f64], dimensions: usize) -> Result<f64, MeasureError> {
    let from_centre = |x: f64| (x - 0.5).abs();
    closed_form(
        points,
        dimensions,
        13.0 / 12.0,
        2.0,
        |x| {
            let a = from_centre(x);
            1.0 + 0.5 * a - 0.5 * a * a
        },
        |x, y| 1.0 + 0.5 * (from_centre(x) + from_centre(y) - (x - y).abs()),
    )
}

/// The squared wrap-around L2 discrepancy: boxes that may wrap around the cube; invariant under shifts modulo one.
///
/// Cost: quadratic in the number of points. Source: Hickernell, "Lattice rules: how well do they measure up?" (1998).
///
/// # Errors
/// If the points are not well-formed.
pub fn wrap_around_l2(points: &[f64], dimensions: usize) -> Result<f64, MeasureError> {
    closed_form(
        points,
        dimensions,
        4.0 / 3.0,
        // the term with one point is the constant one: -c + 2 c - 2 c
        0.0,
        |_| 0.0,
        |x, y| {
            let difference = (x - y).abs();
            1.5 - difference * (1.0 - difference)
        },
    )
    .map(|squared| squared - 2.0 * power(4.0 / 3.0, dimensions))
}

/// The squared mixture discrepancy: between the centred and the wrap-around one, without the shortcomings of either.
///
/// Cost: quadratic in the number of points. Source: Zhou, Fang and Ning, "Mixture discrepancy for quasi-random point sets"
/// (2013), equation 18.
///
/// # Errors
/// If the points are not well-formed.
///
/// ```
/// use qmc_sampling::measure::mixture;
/// let lined_up = mixture(&[0.1, 0.1, 0.2, 0.2], 2)?;
/// let spread = mixture(&[0.25, 0.75, 0.75, 0.25], 2)?;
/// assert!(spread < lined_up);
/// # Ok::<(), qmc_sampling::measure::MeasureError>(())
/// ```
pub fn mixture(points: &[f64], dimensions: usize) -> Result<f64, MeasureError> {
    let from_centre = |x: f64| (x - 0.5).abs();
    closed_form(
        points,
        dimensions,
        19.0 / 12.0,
        2.0,
        |x| {
            let a = from_centre(x);
            5.0 / 3.0 - 0.25 * a - 0.25 * a * a
        },
        |x, y| {
            let difference = (x - y).abs();
            1.875 - 0.25 * (from_centre(x) + from_centre(y)) - 0.75 * difference + 0.5 * difference * difference
        },
    )
}

/// `c^s - (factor / n) sum_i prod_d one(x_id) + 1 / n^2 sum_ij prod_d two(x_id, x_jd)`
fn closed_form(
    points: &[f64],
    dimensions: usize,
    constant: f64,
    factor: f64,
    one: impl Fn(f64) -> f64,
    two: impl Fn(f64, f64) -> f64,
) -> Result<f64, MeasureError> {
    let n = check(points, dimensions)? as f64;
    let mut singles = 0.0;
    let mut pairs = 0.0;
    for (i, x) in points.chunks_exact(dimensions).enumerate() {
        singles += x.iter().map(|&x| one(x)).product::<f64>();
        let product = |y: &[f64]| x.iter().zip(y).map(|(&x, &y)| two(x, y)).product::<f64>();
        pairs += product(x);
        // The kernel is symmetric.
        pairs += 2.0 * points[(i + 1) * dimensions..].chunks_exact(dimensions).map(product).sum::<f64>();
    }
    Ok(power(constant, dimensions) - factor / n * singles + pairs / (n * n))
}

fn power(base: f64, exponent: usize) -> f64 {
    (0..exponent).fold(1.0, |product, _| product * base)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::testing::points;
    use crate::sequences::Random;
    use crate::sobol::Sobol;
    use std::vec::Vec;

    /// The example of SciPy's documentation, with the values of SciPy 1.15.3.
    #[test]
    fn equal_those_of_scipy() {
        let grid = [[1, 3], [2, 6], [3, 2], [4, 5], [5, 1], [6, 4]];
        let x: Vec<f64> = grid.iter().flatten().map(|&g| (f64::from(g) - 0.5) / 6.0).collect();
        let close = |ours: Result<f64, MeasureError>, theirs: f64| {
            let ours = ours.unwrap();
            assert!((ours - theirs).abs() < 1e-14, "{ours} {theirs}");
        };
        close(centred_l2(&x, 2), 0.008_142_039_609_053_464);
        close(wrap_around_l2(&x, 2), 0.016_846_707_818_928_94);
        close(mixture(&x, 2), 0.014_895_592_206_789_487);
        close(l2_star(&x, 2), 0.068_336_062_125_580_91);
    }

    #[test]
    fn sobol_points_are_more_even_than_random_ones() {
        for measure in [l2_star, centred_l2, wrap_around_l2, mixture] {
            let sobol = measure(&points(Sobol::default(), 256, 4), 4).unwrap();
            let random = measure(&points(Random::new(1), 256, 4), 4).unwrap();
            assert!(sobol < 0.5 * random, "{sobol} {random}");
        }
    }

    #[test]
    fn refuse_what_is_no_set_of_points() {
        assert_eq!(l2_star(&[], 2), Err(MeasureError::Shape { len: 0, dimensions: 2 }));
        assert!(l2_star(&[0.1, 0.2, 0.3], 2).is_err() && l2_star(&[0.5], 0).is_err());
        assert_eq!(mixture(&[0.5, 1.0], 2), Err(MeasureError::Outside { index: 1 }));
        assert_eq!(mixture(&[f64::NAN], 1), Err(MeasureError::Outside { index: 0 }));
    }
}
