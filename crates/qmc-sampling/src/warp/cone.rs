//! Square to cone of directions.
use super::{circle, turn};
use crate::Real;
use core::f64::consts::FRAC_1_PI;

/// A direction uniform over the cone of half angle `theta_max` around `(0, 0, 1)`.
///
/// The cone is given by `1 - cos(theta_max)`, in `(0, 2]`, which keeps small cones precise: for a sphere of radius `r` at
/// distance `d`, with `s = (r / d)^2`, it is `s / (1 + sqrt(1 - s))`.
///
/// ```
/// use qmc_sampling::warp::{pdf_uniform_cone, sample_uniform_cone};
/// let sun = 1.08e-5_f32; // about a quarter of a degree
/// let w = sample_uniform_cone([0.99, 0.1], sun);
/// assert!(w[2] < 1.0 && pdf_uniform_cone(w, sun) > 0.0);
/// ```
#[inline]
#[must_use]
pub fn sample_uniform_cone<F: Real>(u: [F; 2], one_minus_cos_theta_max: F) -> [F; 3] {
    let one_minus_cos = u[0] * one_minus_cos_theta_max;
    let sin = (one_minus_cos * (F::of(2.0) - one_minus_cos)).max(F::ZERO).sqrt();
    let [x, y] = circle(u[1]);
    [sin * x, sin * y, F::ONE - one_minus_cos]
}

/// The density of [`sample_uniform_cone`] with respect to solid angle; zero outside of the cone.
#[inline]
#[must_use]
pub fn pdf_uniform_cone<F: Real>(direction: [F; 3], one_minus_cos_theta_max: F) -> F {
    if one_minus_cos(direction) <= one_minus_cos_theta_max * (F::ONE + F::of(8.0) * F::EPSILON) {
        F::of(0.5 * FRAC_1_PI) / one_minus_cos_theta_max
    } else {
        F::ZERO
    }
}

/// The point of the square that [`sample_uniform_cone`] maps to `direction`.
#[inline]
#[must_use]
pub fn invert_uniform_cone<F: Real>(direction: [F; 3], one_minus_cos_theta_max: F) -> [F; 2] {
    [(one_minus_cos(direction) / one_minus_cos_theta_max).clamp_unit(), turn(direction[0], direction[1])]
}

/// One minus the cosine with the pole, without cancellation near it.
#[inline]
fn one_minus_cos<F: Real>([x, y, z]: [F; 3]) -> F {
    if z > F::ZERO { (x * x + y * y) / (F::ONE + z) } else { F::ONE - z }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warp::testing::{assert_close, square};

    #[test]
    fn inverts_wide_and_narrow_cones() {
        for cone in [1e-9_f32, 1e-5, 0.1, 1.0, 1.9] {
            for u in square::<f32>() {
                let w = sample_uniform_cone(u, cone);
                assert!(pdf_uniform_cone(w, cone) > 0.0, "{u:?} {cone}");
                let inverse = invert_uniform_cone(w, cone);
                assert_close(&[inverse[0]], &[u[0]], 1e-6);
                if u[0] > 0.0 {
                    assert_close(&inverse, &u, 1e-6);
                }
            }
        }
    }

    #[test]
    fn density_is_the_inverse_of_the_solid_angle() {
        let whole: f64 = pdf_uniform_cone([0.0, 0.0, 1.0], 2.0);
        assert!((whole - crate::warp::pdf_uniform_sphere::<f64>()).abs() < 1e-15);
        assert_eq!(pdf_uniform_cone([1.0, 0.0, 0.0], 0.5_f64), 0.0);
    }
}
