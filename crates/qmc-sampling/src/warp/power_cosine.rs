//! Square to hemisphere, for lobes.
use super::{circle, turn};
use crate::Real;
use core::f64::consts::FRAC_1_PI;

/// A direction of the hemisphere around `(0, 0, 1)` with density proportional to a power of the cosine with the pole.
///
/// The exponent is at least zero: 0 is uniform, 1 the cosine. The cosine of a sample is kept above zero, so that its density
/// is, as long as that is a number the float can hold.
///
/// ```
/// use qmc_sampling::warp::{pdf_power_cosine_hemisphere, sample_power_cosine_hemisphere};
/// let w = sample_power_cosine_hemisphere([0.5_f32, 0.5], 100.0);
/// assert!(w[2] > 0.98 && pdf_power_cosine_hemisphere(w, 100.0) > 1.0);
/// ```
#[inline]
#[must_use]
pub fn sample_power_cosine_hemisphere<F: Real>(u: [F; 2], exponent: F) -> [F; 3] {
    let z = (F::ONE - u[0]).powf(F::ONE / (exponent + F::ONE)).max(F::EPSILON);
    let radius = ((F::ONE - z) * (F::ONE + z)).max(F::ZERO).sqrt();
    let [x, y] = circle(u[1]);
    [radius * x, radius * y, z]
}

/// The density of [`sample_power_cosine_hemisphere`] with respect to solid angle: `(n + 1) / (2 pi) cos^n`; zero below the
/// horizon.
#[inline]
#[must_use]
pub fn pdf_power_cosine_hemisphere<F: Real>(direction: [F; 3], exponent: F) -> F {
    if direction[2] < F::ZERO {
        return F::ZERO;
    }
    F::of(0.5 * FRAC_1_PI) * (exponent + F::ONE) * direction[2].powf(exponent)
}

/// The point of the square that [`sample_power_cosine_hemisphere`] maps to `direction`.
#[inline]
#[must_use]
pub fn invert_power_cosine_hemisphere<F: Real>(direction: [F; 3], exponent: F) -> [F; 2] {
    let [x, y, z] = direction;
    // 1 - z^(n + 1); the logarithm of z from 1 - z^2, which is precise near the pole
    let log = if z > F::of(0.5) { F::of(0.5) * (-(x * x + y * y)).max(-F::ONE).ln_1p() } else { z.max(F::ZERO).ln() };
    [(-((exponent + F::ONE) * log).exp_m1()).clamp_unit(), turn(x, y)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warp::testing::{assert_close, mean, square};
    use crate::warp::{pdf_cosine_hemisphere, pdf_uniform_hemisphere, sample_uniform_hemisphere};

    #[test]
    fn inverts() {
        for exponent in [0.0_f32, 1.0, 7.5, 50.0] {
            for u in square::<f32>() {
                let w = sample_power_cosine_hemisphere(u, exponent);
                assert!(pdf_power_cosine_hemisphere(w, exponent) > 0.0, "{u:?} {exponent}");
                let inverse = invert_power_cosine_hemisphere(w, exponent);
                if u[0] > 1e-6 {
                    assert_close(&inverse, &u, 2e-5);
                }
            }
        }
        for u in square::<f64>() {
            if u[0] > 1e-14 {
                let inverse = invert_power_cosine_hemisphere(sample_power_cosine_hemisphere(u, 20.0), 20.0);
                assert_close(&inverse, &u, 1e-11);
            }
        }
    }

    #[test]
    fn densities_integrate_to_one_and_include_the_known_ones() {
        for exponent in [0.0, 1.0, 7.5] {
            let total = mean(256, |u| {
                pdf_power_cosine_hemisphere(sample_uniform_hemisphere(u), exponent) * 2.0 * core::f64::consts::PI
            });
            assert!((total - 1.0).abs() < 1e-3, "{total}");
        }
        let w = [0.6_f64, 0.0, 0.8];
        assert!((pdf_power_cosine_hemisphere(w, 0.0) - pdf_uniform_hemisphere(w)).abs() < 1e-15);
        assert!((pdf_power_cosine_hemisphere(w, 1.0) - pdf_cosine_hemisphere(w)).abs() < 1e-15);
    }
}
