//! Gauss-Legendre quadrature, for tables.

/// Nodes in `(0, 1)` and weights that sum to one.
///
/// The nodes are the roots of the Legendre polynomial `P_n`, found by Newton's method from Tricomi's approximation;
/// the weights `2 / ((1 - x^2) P_n'(x)^2)`. Source: Abramowitz and Stegun 1964, 25.4.29.
pub(super) fn gauss_legendre(order: usize) -> Vec<(f64, f64)> {
    let n = order as f64;
    (0..order)
        .map(|i| {
            let mut x = -((i as f64 + 0.75) / (n + 0.5) * core::f64::consts::PI).cos();
            let mut derivative = 1.0;
            for _ in 0..20 {
                let (mut p0, mut p1) = (1.0, x);
                for k in 2..=order {
                    let k = k as f64;
                    (p0, p1) = (p1, ((2.0 * k - 1.0) * x * p1 - (k - 1.0) * p0) / k);
                }
                derivative = n * (x * p1 - p0) / (x * x - 1.0);
                let step = p1 / derivative;
                x -= step;
                if step.abs() < 1e-15 {
                    break;
                }
            }
            (0.5 * (x + 1.0), 1.0 / ((1.0 - x * x) * derivative * derivative))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    #[test]
    fn polynomials_are_integrated_exactly() {
        for order in [2, 5, 16, 64] {
            let rule = super::gauss_legendre(order);
            for power in 0..(2 * order).min(20) as i32 {
                let integral: f64 = rule.iter().map(|(x, w)| w * x.powi(power)).sum();
                assert!((integral - 1.0 / f64::from(power + 1)).abs() < 1e-12, "{order} {power}");
            }
        }
    }
}
