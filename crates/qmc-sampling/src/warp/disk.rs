//! Square to disk.
use crate::Real;
use core::f64::consts::{FRAC_1_PI, FRAC_PI_2, FRAC_PI_4, PI};

/// A uniform point of the unit disk, by the concentric map, which keeps distances better than polar coordinates.
///
/// Source: Shirley and Chiu, "A low distortion map between disk and square" (1997).
///
/// ```
/// use qmc_sampling::warp::{invert_concentric_disk, sample_concentric_disk};
/// let p = sample_concentric_disk([0.5_f32, 0.75]);
/// assert!((p[0].hypot(p[1]) - 0.5).abs() < 1e-6);
/// assert!((invert_concentric_disk(p)[1] - 0.75).abs() < 1e-6);
/// ```
#[inline]
#[must_use]
pub fn sample_concentric_disk<F: Real>(u: [F; 2]) -> [F; 2] {
    let two = F::of(2.0);
    let [a, b] = [two * u[0] - F::ONE, two * u[1] - F::ONE];
    let (radius, angle) = if a.abs() > b.abs() {
        (a, F::of(FRAC_PI_4) * (b / a))
    } else if b.abs() > F::ZERO {
        (b, F::of(FRAC_PI_2) - F::of(FRAC_PI_4) * (a / b))
    } else {
        return [F::ZERO; 2];
    };
    let (sin, cos) = angle.sin_cos();
    [radius * cos, radius * sin]
}

/// The density of [`sample_concentric_disk`] with respect to area: `1 / pi` on the disk.
#[inline]
#[must_use]
pub fn pdf_concentric_disk<F: Real>(p: [F; 2]) -> F {
    // The rim is in, rounding included.
    if p[0] * p[0] + p[1] * p[1] <= F::ONE + F::of(4.0) * F::EPSILON { F::of(FRAC_1_PI) } else { F::ZERO }
}

/// The point of the square that [`sample_concentric_disk`] maps to `p`.
#[inline]
#[must_use]
pub fn invert_concentric_disk<F: Real>(p: [F; 2]) -> [F; 2] {
    let radius = (p[0] * p[0] + p[1] * p[1]).sqrt();
    let mut angle = p[1].atan2(p[0]);
    if angle < F::of(-FRAC_PI_4) {
        angle = angle + F::of(2.0 * PI);
    }
    // The four sectors of the square, counter-clockwise from the right one.
    let across = |centre: f64| radius * (angle - F::of(centre)) * F::of(1.0 / FRAC_PI_4);
    let [a, b] = if angle < F::of(FRAC_PI_4) {
        [radius, across(0.0)]
    } else if angle < F::of(3.0 * FRAC_PI_4) {
        [-across(FRAC_PI_2), radius]
    } else if angle < F::of(5.0 * FRAC_PI_4) {
        [-radius, -across(PI)]
    } else {
        [across(3.0 * FRAC_PI_2), -radius]
    };
    [a, b].map(|c| (F::of(0.5) * (c + F::ONE)).clamp_unit())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warp::testing::{assert_close, mean, square};

    #[test]
    fn inverts() {
        for u in square::<f32>() {
            let p = sample_concentric_disk(u);
            assert!(pdf_concentric_disk(p) > 0.0, "{u:?} {p:?}");
            assert_close(&invert_concentric_disk(p), &u, 4e-7);
        }
        for u in square::<f64>() {
            assert_close(&invert_concentric_disk(sample_concentric_disk(u)), &u, 1e-15);
        }
    }

    #[test]
    fn has_the_moments_of_the_uniform_density() {
        let moment = |f: fn([f64; 2]) -> f64| mean(256, |u| f(sample_concentric_disk(u)));
        assert!((moment(|p| p[0] * p[0]) - 0.25).abs() < 1e-4);
        assert!((moment(|p| p[1] * p[1]) - 0.25).abs() < 1e-4);
        assert!(moment(|p| p[0] * p[1]).abs() < 1e-12 && moment(|p| p[0]).abs() < 1e-12);
        assert_eq!(pdf_concentric_disk([0.8_f32, 0.7]), 0.0);
    }
}
