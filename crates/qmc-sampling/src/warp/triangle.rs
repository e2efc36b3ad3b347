//! Square to triangle.
use crate::Real;

/// The barycentric coordinates of a uniform point of a triangle. They are at least zero and sum to one up to rounding.
///
/// The low-distortion map: the square is folded along its diagonal.
/// Source: Heitz, "A low-distortion map between triangle and square" (2019).
///
/// ```
/// use qmc_sampling::warp::{invert_triangle, sample_triangle};
/// let b = sample_triangle([0.25_f32, 0.75]);
/// assert_eq!(b, [0.125, 0.625, 0.25]);
/// assert_eq!(invert_triangle(b), [0.25, 0.75]);
/// ```
#[inline]
#[must_use]
pub fn sample_triangle<F: Real>(u: [F; 2]) -> [F; 3] {
    let half = F::of(0.5);
    let [b0, b1] = if u[1] > u[0] {
        let b0 = half * u[0];
        [b0, u[1] - b0]
    } else {
        let b1 = half * u[1];
        [u[0] - b1, b1]
    };
    [b0, b1, (F::ONE - b0 - b1).max(F::ZERO)]
}

/// The density of [`sample_triangle`] with respect to area, for a triangle of area `area`: `1 / area`.
///
/// Zero if the area is zero, negative or NaN.
#[inline]
#[must_use]
pub fn pdf_triangle<F: Real>(area: F) -> F {
    if area > F::ZERO { F::ONE / area } else { F::ZERO }
}

/// The point of the square that [`sample_triangle`] maps to `barycentrics`.
#[inline]
#[must_use]
pub fn invert_triangle<F: Real>(barycentrics: [F; 3]) -> [F; 2] {
    let [b0, b1, _] = barycentrics;
    let two = F::of(2.0);
    let u = if b1 > b0 { [two * b0, b0 + b1] } else { [b0 + b1, two * b1] };
    u.map(Real::clamp_unit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warp::testing::{assert_close, mean, square};

    #[test]
    fn inverts() {
        for u in square::<f32>() {
            let b = sample_triangle(u);
            assert!(b.iter().all(|&b| (0.0..=1.0).contains(&b)), "{u:?} {b:?}");
            assert_close(&[b[0] + b[1] + b[2]], &[1.0], 1e-6);
            assert_close(&invert_triangle(b), &u, 1e-7);
        }
    }

    #[test]
    fn has_the_moments_of_the_uniform_density() {
        for k in 0..3 {
            let first = mean(256, |u| sample_triangle(u)[k]);
            let second = mean(256, |u| sample_triangle(u)[k].powi(2));
            assert!((first - 1.0 / 3.0).abs() < 1e-4 && (second - 1.0 / 6.0).abs() < 1e-4, "{first} {second}");
        }
        assert_eq!(pdf_triangle(0.5_f32), 2.0);
        assert_eq!((pdf_triangle(0.0_f32), pdf_triangle(f32::NAN)), (0.0, 0.0));
    }
}
