//! The error function and its inverse, in single precision.

use core::f32::consts::FRAC_2_SQRT_PI;

/// `1 / sqrt(pi)`.
pub(super) const FRAC_1_SQRT_PI: f32 = 0.5 * FRAC_2_SQRT_PI;

/// `erf(x)` and `exp(-x^2)`. The absolute error of the former is below 3e-7.
///
/// Source: Abramowitz and Stegun 1964, "Handbook of Mathematical Functions", 7.1.26.
#[inline]
pub(super) fn erf_and_gaussian(x: f32) -> (f32, f32) {
    let gaussian = (-x * x).exp();
    let t = 1.0 / (1.0 + 0.327_591_1 * x.abs());
    let series = t * (0.254_829_6 + t * (-0.284_496_74 + t * (1.421_413_7 + t * (-1.453_152 + t * 1.061_405_4))));
    ((1.0 - series * gaussian).copysign(x), gaussian)
}

/// The inverse of the error function; finite for all `x`: arguments are clamped to what `f32` resolves.
///
/// Source: Giles 2012, "Approximating the erfinv function", GPU Computing Gems Jade Edition, chapter 10 (single precision).
#[inline]
pub(super) fn erf_inverse(x: f32) -> f32 {
    let x = x.clamp(-1.0 + f32::EPSILON, 1.0 - f32::EPSILON);
    let w = -((1.0 - x) * (1.0 + x)).ln();
    let horner = |w: f32, coefficients: [f32; 9]| coefficients.iter().fold(0.0, |sum, c| sum * w + c);
    let factor = if w < 5.0 {
        horner(
            w - 2.5,
            [
                2.810_226_4e-8,
                3.432_739_4e-7,
                -3.523_388e-6,
                -4.391_506_5e-6,
                2.185_808_7e-4,
                -1.253_725e-3,
                -4.177_681_6e-3,
                2.466_407_3e-1,
                1.501_409_4,
            ],
        )
    } else {
        horner(
            w.sqrt() - 3.0,
            [
                -2.002_142_6e-4,
                1.009_505_6e-4,
                1.349_343_2e-3,
                -3.673_428_4e-3,
                5.739_507_7e-3,
                -7.622_461_3e-3,
                9.438_870_5e-3,
                1.001_674_06,
                2.832_976_8,
            ],
        )
    };
    factor * x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values() {
        for (x, y) in [(0.0, 0.0), (0.5, 0.520_499_88), (1.0, 0.842_700_8), (2.0, 0.995_322_26), (-1.0, -0.842_700_8)] {
            assert!((erf_and_gaussian(x).0 - y).abs() < 4e-7, "erf({x})");
        }
    }

    #[test]
    fn inverse_inverts() {
        for i in -999..=999 {
            let y = i as f32 / 1000.0;
            assert!((erf_and_gaussian(erf_inverse(y)).0 - y).abs() < 1e-6, "{y}");
        }
        assert!(erf_inverse(1.0).is_finite() && erf_inverse(-1.0).is_finite());
    }
}
