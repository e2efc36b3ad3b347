//! Square to sphere.
use super::{circle, turn};
use crate::Real;
use core::f64::consts::FRAC_1_PI;

/// A direction uniform over the sphere.
///
/// ```
/// use qmc_sampling::warp::{invert_uniform_sphere, sample_uniform_sphere};
/// let w = sample_uniform_sphere([0.25_f64, 0.5]);
/// assert!((w[2] - 0.5).abs() < 1e-12);
/// assert!((invert_uniform_sphere(w)[1] - 0.5).abs() < 1e-12);
/// ```
#[inline]
#[must_use]
pub fn sample_uniform_sphere<F: Real>(u: [F; 2]) -> [F; 3] {
    let z = F::ONE - F::of(2.0) * u[0];
    // 1 - z^2, without cancellation near the poles
    let radius = F::of(2.0) * (u[0] * (F::ONE - u[0])).sqrt();
    let [x, y] = circle(u[1]);
    [radius * x, radius * y, z]
}

/// The density of [`sample_uniform_sphere`] with respect to solid angle: `1 / (4 pi)`.
#[inline]
#[must_use]
pub fn pdf_uniform_sphere<F: Real>() -> F {
    F::of(0.25 * FRAC_1_PI)
}

/// The point of the square that [`sample_uniform_sphere`] maps to `direction`.
#[inline]
#[must_use]
pub fn invert_uniform_sphere<F: Real>(direction: [F; 3]) -> [F; 2] {
    let [x, y, z] = direction;
    // From the pole that is nearer: sin^2 / (1 + |cos|) = 1 - |cos|.
    let from_pole = F::of(0.5) * (x * x + y * y) / (F::ONE + z.abs());
    let u = if z > F::ZERO { from_pole } else { F::ONE - from_pole };
    [u.clamp_unit(), turn(x, y)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warp::testing::{assert_close, mean, square};

    #[test]
    fn inverts() {
        for u in square::<f32>() {
            let w = sample_uniform_sphere(u);
            assert_close(&[w[0] * w[0] + w[1] * w[1] + w[2] * w[2]], &[1.0], 1e-6);
            // the azimuth is lost at the pole itself
            let inverse = invert_uniform_sphere(w);
            assert_close(&[inverse[0]], &[u[0]], 4e-7);
            if u[0] > 0.0 {
                assert_close(&inverse, &u, 1e-6);
            }
        }
    }

    #[test]
    fn second_moments_are_a_third() {
        for axis in 0..3 {
            let moment = mean(128, |u| sample_uniform_sphere(u)[axis].powi(2));
            assert!((moment - 1.0 / 3.0).abs() < 1e-4);
        }
        assert!((pdf_uniform_sphere::<f64>() * 4.0 * core::f64::consts::PI - 1.0).abs() < 1e-15);
    }
}
