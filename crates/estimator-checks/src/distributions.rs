//! Tail probabilities, from `statrs`, with the ends of their domains filled in.

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal, StudentsT};

/// Above these degrees of freedom, Student's t and the normal distribution agree to 4 digits down to 1e-12.
const NORMAL_FROM: f64 = 1e7;

/// `P(|Z| >= |z|)`, `Z` standard normal.
pub(crate) fn normal_two_sided(z: f64) -> f64 {
    if z.is_nan() {
        return f64::NAN;
    }
    (2.0 * Normal::standard().sf(z.abs())).min(1.0)
}

/// `P(T >= t)`, `T` Student-distributed with `dof` degrees of freedom; NaN if there are none.
pub(crate) fn student_upper(t: f64, dof: f64) -> f64 {
    if t.is_infinite() {
        return if t > 0.0 { 0.0 } else { 1.0 };
    }
    if dof > NORMAL_FROM {
        return Normal::standard().sf(t);
    }
    match StudentsT::new(0.0, 1.0, dof) {
        Ok(student) if !t.is_nan() => student.sf(t),
        _ => f64::NAN,
    }
}

/// `P(|T| >= |t|)`.
pub(crate) fn student_two_sided(t: f64, dof: f64) -> f64 {
    (2.0 * student_upper(t.abs(), dof)).min(1.0)
}

/// `P(X >= x)`, `X` chi-square-distributed; the degrees of freedom need not be whole.
pub(crate) fn chi_square_upper(x: f64, dof: f64) -> f64 {
    match ChiSquared::new(dof) {
        Ok(chi_square) if !x.is_nan() => chi_square.sf(x),
        _ => f64::NAN,
    }
}

/// The Kolmogorov distribution `Q(l) = 2 sum_{k>=1} (-1)^(k-1) exp(-2 k^2 l^2)`.
pub(crate) fn kolmogorov_upper(lambda: f64) -> f64 {
    use std::f64::consts::PI;
    if lambda.is_nan() {
        return f64::NAN;
    }
    if lambda <= 0.0 {
        return 1.0;
    }
    // Jacobi's theta function has a second series, which converges where the first is slow.
    if lambda < 1.0 {
        let sum: f64 = (0..20).map(|k| (-(f64::from(2 * k + 1) * PI / lambda).powi(2) / 8.0).exp()).sum();
        return 1.0 - (2.0 * PI).sqrt() / lambda * sum;
    }
    let term = |k: i32| (-2.0 * (f64::from(k) * lambda).powi(2)).exp() * if k % 2 == 1 { 2.0 } else { -2.0 };
    (1..=20).map(term).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f64, b: f64) {
        assert!((a - b).abs() <= 1e-4 * b.abs(), "{a:e} != {b:e}");
    }

    #[test]
    fn tabulated_tails() {
        close(normal_two_sided(1.959964), 0.05);
        close(normal_two_sided(-4.891638), 1e-6);
        close(student_two_sided(2.262157, 9.0), 0.05);
        close(student_upper(63.65674, 1.0), 0.005);
        close(chi_square_upper(18.30704, 10.0), 0.05);
        close(chi_square_upper(149.449, 100.0), 1e-3);
        close(kolmogorov_upper(1.358099), 0.05);
        close(kolmogorov_upper(0.5), 0.963945);
    }

    #[test]
    fn the_series_meet() {
        assert!((kolmogorov_upper(1.0 - 1e-12) - kolmogorov_upper(1.0)).abs() < 1e-10);
    }

    #[test]
    fn student_approaches_the_normal_without_a_step() {
        for t in [0.1, 1.0, 5.0, 7.0] {
            let (below, above) = (student_upper(t, NORMAL_FROM), student_upper(t, NORMAL_FROM * 1.01));
            assert!((below / above - 1.0).abs() < 1e-3, "{t}: {below:e} {above:e}");
        }
    }

    #[test]
    fn extreme_arguments() {
        assert_eq!(student_two_sided(f64::INFINITY, 3.0), 0.0);
        assert_eq!(chi_square_upper(0.0, 3.0), 1.0);
        assert_eq!(chi_square_upper(f64::INFINITY, 3.0), 0.0);
        assert_eq!(kolmogorov_upper(0.0), 1.0);
        assert!(student_upper(1.0, 0.0).is_nan() && chi_square_upper(f64::NAN, 1.0).is_nan());
        assert!(normal_two_sided(f64::NAN).is_nan() && kolmogorov_upper(f64::NAN).is_nan());
    }
}
