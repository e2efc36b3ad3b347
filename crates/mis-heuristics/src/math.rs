//! Elementary functions, which `core` lacks.
//!
//! `core` offers no logarithm, power or square root on the minimum Rust version of this crate, and a dependency (or
//! a `std` feature that changes results) is not worth the three places that need them. The functions here are plain
//! series in `f64`, tested against `std`; they are not used by any heuristic with a whole exponent.

use crate::{Densities, Float};

/// `other / own` for positive `own`; two infinite densities are equal.
#[inline(always)]
pub(crate) fn ratio<F: Float>(other: F, own: F) -> F {
    let quotient = other / own;
    if quotient.partial_cmp(&quotient).is_some() { quotient } else { F::ONE }
}

/// `1 / sum_j power(d_j / d_i)`: a ratio that overflows stands for a weight of zero, so nothing else can go wrong.
///
/// Asks for every density once, for the own one first, and for no other if that is zero.
#[inline]
pub(crate) fn ratio_weight<F: Float>(
    technique: usize,
    densities: &(impl Densities<F> + ?Sized),
    power: impl Fn(F) -> F,
) -> F {
    let own = densities.density(technique).positive_part();
    if own <= F::ZERO {
        return F::ZERO;
    }
    let others = (0..densities.len()).filter(|&other| other != technique);
    let reciprocal = F::ONE / own;
    let sum = if reciprocal >= F::SMALLEST && reciprocal < F::INFINITY {
        // The usual case: one division for all.
        others.fold(F::ONE, |sum, other| sum + power(densities.density(other).positive_part() * reciprocal))
    } else {
        // The reciprocal is subnormal, zero or infinite.
        others.fold(F::ONE, |sum, other| sum + power(ratio(densities.density(other).positive_part(), own)))
    };
    F::ONE / sum
}

/// `x^n` for `n >= 1` by repeated squaring.
#[inline]
pub(crate) fn powi<F: Float>(x: F, mut n: u32) -> F {
    let (mut result, mut square) = (F::ONE, x);
    loop {
        if n & 1 == 1 {
            result = result * square;
        }
        n >>= 1;
        if n == 0 {
            return result;
        }
        square = square * square;
    }
}

/// `x^exponent` for `x` in `[0, inf]` and a finite exponent above zero.
pub(crate) fn pow(x: f64, exponent: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    if x == f64::INFINITY {
        return f64::INFINITY;
    }
    exp2(exponent * log2(x))
}

/// Square root of `x` in `[0, inf]`; zero for a negative number or NaN.
pub(crate) fn sqrt(x: f64) -> f64 {
    let root = pow(x.positive_part(), 0.5);
    // One step of Newton's method, for the last bits.
    if root > 0.0 && root < f64::INFINITY { 0.5 * (root + x / root) } else { root }
}

/// Logarithm to base 2 of a positive, finite number.
fn log2(x: f64) -> f64 {
    // Bring subnormal numbers into the normal range.
    let (x, shift) = if x < f64::MIN_POSITIVE { (x * (1_u64 << 54) as f64, -54) } else { (x, 0) };
    // Split into 2^exponent times a mantissa in [1, 2), then in [sqrt(1/2), sqrt(2)).
    let bits = x.to_bits();
    let mut exponent = ((bits >> 52) as i32) - 1023 + shift;
    let mut mantissa = f64::from_bits((bits & ((1 << 52) - 1)) | (1023 << 52));
    if mantissa > core::f64::consts::SQRT_2 {
        mantissa *= 0.5;
        exponent += 1;
    }
    // ln m = 2 artanh s = 2 (s + s^3/3 + s^5/5 + ..), |s| < 0.172.
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let square = s * s;
    let mut series = 0.0;
    for &coefficient in ARTANH.iter().rev() {
        series = series * square + coefficient;
    }
    f64::from(exponent) + 2.0 * s * series * core::f64::consts::LOG2_E
}

/// `2^x` for any finite or infinite `x`.
fn exp2(x: f64) -> f64 {
    if x > 1024.0 {
        return f64::INFINITY;
    }
    if x < -1080.0 {
        return 0.0;
    }
    // Split into a whole number and a rest in [-1/2, 1/2], e^rest by its Taylor series.
    let whole = (if x < 0.0 { x - 0.5 } else { x + 0.5 }) as i32;
    let rest = (x - f64::from(whole)) * core::f64::consts::LN_2;
    let mut series = 0.0;
    for &coefficient in EXPONENTIAL.iter().rev() {
        series = series * rest + coefficient;
    }
    // In two factors, because the power of two alone may be out of range.
    let half = whole / 2;
    series * power_of_two(half) * power_of_two(whole - half)
}

/// Taylor coefficients of `artanh(s) / s` in `s^2`: the first left out is below `2^-60` for `|s| < 0.172`.
const ARTANH: [f64; 11] = {
    let mut coefficients = [0.0; 11];
    let mut k = 0;
    while k < 11 {
        coefficients[k] = 1.0 / (2 * k + 1) as f64;
        k += 1;
    }
    coefficients
};

/// Taylor coefficients of `e^x`: the first left out is below `2^-57` for `|x| < 0.347`.
const EXPONENTIAL: [f64; 14] = {
    let mut coefficients = [1.0; 14];
    let mut k = 1;
    while k < 14 {
        coefficients[k] = coefficients[k - 1] / k as f64;
        k += 1;
    }
    coefficients
};

/// `2^exponent` for `|exponent| <= 1022`.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

/// Solves `matrix x = vector` for a symmetric positive semidefinite matrix, with the vector in its range.
///
/// Gauss-Jordan elimination, pivots chosen on the diagonal relative to its original entries, so that the scales of
/// the unknowns do not matter; unknowns that depend linearly on others are set to zero.
pub(crate) fn solve_semidefinite<const N: usize>(mut matrix: [[f64; N]; N], mut vector: [f64; N]) -> [f64; N] {
    let diagonal: [f64; N] = core::array::from_fn(|i| matrix[i][i]);
    let mut eliminated = [false; N];
    for _ in 0..N {
        // The pivot that has kept most of its original value.
        let mut pivot = None;
        let mut kept = SINGULAR;
        for i in 0..N {
            if !eliminated[i] && diagonal[i] > 0.0 && matrix[i][i] / diagonal[i] > kept {
                kept = matrix[i][i] / diagonal[i];
                pivot = Some(i);
            }
        }
        let Some(pivot) = pivot else { break };
        eliminated[pivot] = true;
        let pivot_row = matrix[pivot];
        for row in 0..N {
            if row != pivot {
                let factor = matrix[row][pivot] / pivot_row[pivot];
                for (entry, pivot_entry) in matrix[row].iter_mut().zip(pivot_row) {
                    *entry -= factor * pivot_entry;
                }
                vector[row] -= factor * vector[pivot];
            }
        }
    }
    core::array::from_fn(|i| if eliminated[i] { vector[i] / matrix[i][i] } else { 0.0 })
}

/// A pivot that has lost all but this fraction of its value is rounding error.
const SINGULAR: f64 = 1e-12;

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    #[test]
    fn pow_agrees_with_std() {
        let mut worst = 0.0_f64;
        for a in -300..=300 {
            for beta in [0.5, 1.0, 1.25, 2.0, 3.7, 31.0] {
                let x = 1.37 * 10_f64.powi(a);
                let (ours, std) = (pow(x, beta), x.powf(beta));
                if std == 0.0 || std == f64::INFINITY {
                    assert_eq!(ours, std, "{x}^{beta}");
                } else if std > 1e-290 {
                    // The rounding of the logarithm is amplified by the exponent of the result.
                    worst = worst.max((ours / std - 1.0).abs() / (1.0 + std.ln().abs()));
                }
            }
        }
        assert!(worst < 4.0 * f64::EPSILON, "{worst}");
        assert_eq!(pow(0.0, 2.5), 0.0);
        assert_eq!(pow(f64::INFINITY, 2.5), f64::INFINITY);
        assert_eq!(pow(5e-324, 1.0), 5e-324);
        assert_eq!(pow(10.0, 400.0), f64::INFINITY);
        assert_eq!(pow(0.1, 400.0), 0.0);
    }

    #[test]
    fn sqrt_agrees_with_std() {
        for a in -300..=300 {
            let x = 1.37 * 10_f64.powi(a);
            assert!((sqrt(x) / x.sqrt() - 1.0).abs() <= f64::EPSILON, "{x}");
        }
        assert_eq!(sqrt(0.0), 0.0);
        assert_eq!(sqrt(f64::INFINITY), f64::INFINITY);
        assert_eq!(sqrt(-1.0), 0.0);
        assert_eq!(sqrt(f64::NAN), 0.0);
    }

    #[test]
    fn powi_multiplies_out() {
        for n in 1..=16 {
            assert_eq!(powi(3.0_f64, n), 3.0_f64.powi(n as i32));
        }
    }

    #[test]
    fn linear_systems() {
        // Well conditioned, with scales far apart: A = S B S, x = S^-1 y.
        let (b, y, scale) = ([[4.0, 1.0, 0.5], [1.0, 3.0, 1.0], [0.5, 1.0, 2.0]], [1.0, -2.0, 3.0], [1e-20, 1.0, 1e15]);
        let a = core::array::from_fn(|i| core::array::from_fn(|k| scale[i] * b[i][k] * scale[k]));
        let right = core::array::from_fn(|i| (0..3).map(|k| scale[i] * b[i][k] * y[k]).sum());
        let x: [f64; 3] = solve_semidefinite(a, right);
        for i in 0..3 {
            assert!((x[i] * scale[i] - y[i]).abs() < 1e-12);
        }
        // Singular: two equal unknowns, and one that does not occur.
        let x = solve_semidefinite([[2.0, 2.0, 0.0], [2.0, 2.0, 0.0], [0.0, 0.0, 0.0]], [6.0, 6.0, 0.0]);
        assert_eq!((x[0] + x[1], x[2]), (3.0, 0.0));
        assert_eq!(solve_semidefinite([[0.0]], [0.0]), [0.0]);
    }
}
