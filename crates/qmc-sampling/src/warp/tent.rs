//! The tent: a pixel filter in one dimension.
use crate::Real;

/// A number in `(-radius, radius)` with the density of a tent with its tip at zero, by inversion.
///
/// ```
/// use qmc_sampling::warp::sample_tent;
/// assert_eq!(sample_tent(0.5_f32, 1.0), 0.0);
/// assert!(sample_tent(0.1_f32, 2.0) < -1.0);
/// ```
#[inline]
#[must_use]
pub fn sample_tent<F: Real>(u: F, radius: F) -> F {
    let (half, two) = (F::of(0.5), F::of(2.0));
    // The ends are of density zero: stay clear of them.
    let inside = |fraction: F| F::ONE - fraction.max(F::EPSILON * F::EPSILON).sqrt();
    if u < half { -radius * inside(two * u) } else { radius * inside(two * (F::ONE - u)) }
}

/// The density of [`sample_tent`] with respect to length: `(radius - |x|) / radius^2`; zero outside.
#[inline]
#[must_use]
pub fn pdf_tent<F: Real>(x: F, radius: F) -> F {
    if x.abs() < radius { (radius - x.abs()) / (radius * radius) } else { F::ZERO }
}

/// The number that [`sample_tent`] maps to `x`.
#[inline]
#[must_use]
pub fn invert_tent<F: Real>(x: F, radius: F) -> F {
    let rest = (F::ONE - x.abs() / radius).max(F::ZERO);
    let tail = F::of(0.5) * rest * rest;
    (if x < F::ZERO { tail } else { F::ONE - tail }).clamp_unit()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warp::testing::{assert_close, mean, square};

    #[test]
    fn inverts() {
        for [u, _] in square::<f32>() {
            let x = sample_tent(u, 1.5);
            assert!(pdf_tent(x, 1.5) > 0.0, "{u} {x}");
            assert_close(&[invert_tent(x, 1.5)], &[u], 2e-7);
        }
        for [u, _] in square::<f64>() {
            assert_close(&[invert_tent(sample_tent(u, 0.5), 0.5)], &[u], 1e-15);
        }
    }

    #[test]
    fn variance_is_a_sixth() {
        let variance = mean(512, |[u, _]| sample_tent(u, 1.0).powi(2));
        assert!((variance - 1.0 / 6.0).abs() < 1e-4, "{variance}");
        let total = mean(64, |[u, _]| 4.0 * pdf_tent(4.0 * u - 2.0, 1.5));
        assert!((total - 1.0).abs() < 1e-3, "{total}");
    }
}
