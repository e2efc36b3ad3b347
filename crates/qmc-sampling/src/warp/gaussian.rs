//! The Gaussian in two dimensions: a pixel filter.
use super::{circle, turn};
use crate::Real;
use core::f64::consts::FRAC_1_PI;

/// A point with the isotropic Gaussian density of standard deviation `sigma` (per axis), by the inverse of the radial
/// distribution (Box and Muller 1958).
///
/// ```
/// use qmc_sampling::warp::{pdf_gaussian, sample_gaussian};
/// let p = sample_gaussian([0.999_999_94_f32, 0.5], 0.5);
/// assert!(p[0].is_finite() && pdf_gaussian(p, 0.5) > 0.0);
/// ```
#[inline]
#[must_use]
pub fn sample_gaussian<F: Real>(u: [F; 2], sigma: F) -> [F; 2] {
    let radius = sigma * (F::of(-2.0) * (-u[0]).ln_1p()).max(F::ZERO).sqrt();
    let [x, y] = circle(u[1]);
    [radius * x, radius * y]
}

/// The density of [`sample_gaussian`] with respect to area.
#[inline]
#[must_use]
pub fn pdf_gaussian<F: Real>(p: [F; 2], sigma: F) -> F {
    let scale = F::ONE / (sigma * sigma);
    F::of(0.5 * FRAC_1_PI) * scale * (F::of(-0.5) * scale * (p[0] * p[0] + p[1] * p[1])).exp()
}

/// The point of the square that [`sample_gaussian`] maps to `p`.
#[inline]
#[must_use]
pub fn invert_gaussian<F: Real>(p: [F; 2], sigma: F) -> [F; 2] {
    let exponent = F::of(-0.5) * (p[0] * p[0] + p[1] * p[1]) / (sigma * sigma);
    [(-exponent.exp_m1()).clamp_unit(), turn(p[0], p[1])]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warp::testing::{assert_close, mean, square};

    #[test]
    fn inverts() {
        for u in square::<f32>() {
            let p = sample_gaussian(u, 0.7);
            assert!(pdf_gaussian(p, 0.7) > 0.0);
            if u[0] > 0.0 {
                assert_close(&invert_gaussian(p, 0.7), &u, 1e-6);
            }
        }
    }

    #[test]
    fn variance_is_sigma_squared() {
        let variance = mean(512, |u| sample_gaussian(u, 0.5)[0].powi(2));
        assert!((variance - 0.25).abs() < 1e-3, "{variance}");
        let total = mean(128, |u| 64.0 * pdf_gaussian([8.0 * u[0] - 4.0, 8.0 * u[1] - 4.0], 0.5));
        assert!((total - 1.0).abs() < 1e-9, "{total}");
    }
}
