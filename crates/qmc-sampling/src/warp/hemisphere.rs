//! Square to hemisphere.
use super::{circle, invert_concentric_disk, sample_concentric_disk, turn};
use crate::Real;
use core::f64::consts::FRAC_1_PI;

/// A direction uniform over the hemisphere around `(0, 0, 1)`.
///
/// ```
/// use qmc_sampling::warp::{pdf_uniform_hemisphere, sample_uniform_hemisphere};
/// let w = sample_uniform_hemisphere([0.3_f32, 0.8]);
/// assert!((w[2] - 0.3).abs() < 1e-6 && pdf_uniform_hemisphere(w) > 0.159);
/// ```
#[inline]
#[must_use]
pub fn sample_uniform_hemisphere<F: Real>(u: [F; 2]) -> [F; 3] {
    let z = u[0];
    let radius = (F::ONE - z * z).max(F::ZERO).sqrt();
    let [x, y] = circle(u[1]);
    [radius * x, radius * y, z]
}

/// The density of [`sample_uniform_hemisphere`] with respect to solid angle: `1 / (2 pi)`; zero below the horizon.
#[inline]
#[must_use]
pub fn pdf_uniform_hemisphere<F: Real>(direction: [F; 3]) -> F {
    if direction[2] >= F::ZERO { F::of(0.5 * FRAC_1_PI) } else { F::ZERO }
}

/// The point of the square that [`sample_uniform_hemisphere`] maps to `direction`.
#[inline]
#[must_use]
pub fn invert_uniform_hemisphere<F: Real>(direction: [F; 3]) -> [F; 2] {
    [direction[2].clamp_unit(), turn(direction[0], direction[1])]
}

/// A direction of the hemisphere around `(0, 0, 1)` with density proportional to the cosine with the pole.
///
/// The disk lifted to the hemisphere (Malley). The cosine is at least the root of the machine epsilon, so that the
/// density of a sample is never zero.
///
/// ```
/// use qmc_sampling::warp::{pdf_cosine_hemisphere, sample_cosine_hemisphere};
/// let w = sample_cosine_hemisphere([0.0_f32, 0.0]);
/// assert!(pdf_cosine_hemisphere(w) > 0.0);
/// ```
#[inline]
#[must_use]
pub fn sample_cosine_hemisphere<F: Real>(u: [F; 2]) -> [F; 3] {
    let [x, y] = sample_concentric_disk(u);
    [x, y, (F::ONE - x * x - y * y).max(F::EPSILON).sqrt()]
}

/// The density of [`sample_cosine_hemisphere`] with respect to solid angle: `cos / pi`; zero below the horizon.
#[inline]
#[must_use]
pub fn pdf_cosine_hemisphere<F: Real>(direction: [F; 3]) -> F {
    direction[2].max(F::ZERO) * F::of(FRAC_1_PI)
}

/// The point of the square that [`sample_cosine_hemisphere`] maps to `direction`.
#[inline]
#[must_use]
pub fn invert_cosine_hemisphere<F: Real>(direction: [F; 3]) -> [F; 2] {
    invert_concentric_disk([direction[0], direction[1]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warp::testing::{assert_close, mean, square};

    /// The solid angle of the hemisphere.
    const SOLID_ANGLE: f64 = 2.0 * core::f64::consts::PI;

    fn check<F: Real>(tolerance: f64) {
        for u in square::<F>() {
            let uniform = sample_uniform_hemisphere(u);
            assert!(pdf_uniform_hemisphere(uniform) > F::ZERO);
            assert_close(&invert_uniform_hemisphere(uniform), &u, tolerance);
            let cosine = sample_cosine_hemisphere(u);
            assert!(pdf_cosine_hemisphere(cosine) > F::ZERO);
            assert_close(&invert_cosine_hemisphere(cosine), &u, tolerance);
            for w in [uniform, cosine] {
                assert_close(&[w[0] * w[0] + w[1] * w[1] + w[2] * w[2]], &[F::ONE], tolerance);
            }
        }
    }

    #[test]
    fn inverts() {
        check::<f32>(1e-6);
        check::<f64>(1e-14);
    }

    #[test]
    fn densities_integrate_to_one() {
        let total = mean(64, |u| pdf_cosine_hemisphere(sample_uniform_hemisphere(u)) * SOLID_ANGLE);
        assert!((total - 1.0).abs() < 1e-12, "{total}");
        assert_eq!(pdf_cosine_hemisphere([0.0, 0.0, -1.0_f64]), 0.0);
        assert_eq!(pdf_uniform_hemisphere([0.0, 0.0, -1.0_f64]), 0.0);
        assert!((pdf_uniform_hemisphere([0.0, 0.0, 1.0_f64]) * SOLID_ANGLE - 1.0).abs() < 1e-12);
        let cosine = mean(256, |u| sample_cosine_hemisphere(u)[2]);
        assert!((cosine - 2.0 / 3.0).abs() < 3e-4, "{cosine}");
    }
}
