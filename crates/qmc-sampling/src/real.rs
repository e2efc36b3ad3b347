//! The floats that warps accept.
use core::fmt::Debug;
use core::ops::{Add, Div, Mul, Neg, Sub};

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

/// `f32` or `f64`. Sealed: the warps of this crate are written once against it.
pub trait Real:
    sealed::Sealed
    + Copy
    + Debug
    + PartialOrd
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// 0
    const ZERO: Self;
    /// 1
    const ONE: Self;
    /// The distance from 1 to the next larger float.
    const EPSILON: Self;
    /// The last float below 1.
    const ONE_MINUS_EPSILON: Self;
    /// The number of bits of a uniform number in `[0, 1)`: 24 or 53.
    const MANTISSA_BITS: u32;

    /// The float nearest to `x`.
    fn of(x: f64) -> Self;
    /// The same number in double precision.
    fn to_f64(self) -> f64;
    /// Truncation towards zero; NaN and negative numbers give 0.
    fn to_usize(self) -> usize;
    /// Square root.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Sine and cosine of an angle in radians.
    fn sin_cos(self) -> (Self, Self);
    /// `e` to the power `self`.
    #[must_use]
    fn exp(self) -> Self;
    /// `e` to the power `self`, less one, precise near zero.
    #[must_use]
    fn exp_m1(self) -> Self;
    /// Natural logarithm.
    #[must_use]
    fn ln(self) -> Self;
    /// Natural logarithm of `1 + self`, precise near zero.
    #[must_use]
    fn ln_1p(self) -> Self;
    /// `self` to the power `exponent`.
    #[must_use]
    fn powf(self, exponent: Self) -> Self;
    /// Arc cosine; arguments beyond one are clamped.
    #[must_use]
    fn acos(self) -> Self;
    /// Arc sine; arguments beyond one are clamped.
    #[must_use]
    fn asin(self) -> Self;
    /// The angle of the vector `(x, self)` in `(-pi, pi]`.
    #[must_use]
    fn atan2(self, x: Self) -> Self;
    /// Absolute value.
    #[must_use]
    fn abs(self) -> Self;
    /// Whether neither infinite nor NaN.
    fn is_finite(self) -> bool;

    /// The smaller one; `other` if `self` is NaN.
    #[inline]
    #[must_use]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
    /// The larger one; `other` if `self` is NaN.
    #[inline]
    #[must_use]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
    /// Clamped to `[0, 1)`; NaN becomes 0.
    #[inline]
    #[must_use]
    fn clamp_unit(self) -> Self {
        self.max(Self::ZERO).min(Self::ONE_MINUS_EPSILON)
    }
    /// `n` as a float.
    #[inline]
    #[must_use]
    fn of_usize(n: usize) -> Self {
        Self::of(n as f64)
    }
}

macro_rules! real {
    ($float:ident, $bits:expr, $sqrt:ident, $sincos:ident, $exp:ident, $expm1:ident, $log:ident, $log1p:ident, $pow:ident, $acos:ident, $asin:ident, $atan2:ident, $fabs:ident) => {
        impl Real for $float {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const EPSILON: Self = $float::EPSILON;
            const ONE_MINUS_EPSILON: Self = 1.0 - 0.5 * $float::EPSILON;
            const MANTISSA_BITS: u32 = $bits;

            #[inline]
            fn of(x: f64) -> Self {
                x as $float
            }
            #[inline]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            #[inline]
            fn to_usize(self) -> usize {
                self as usize
            }
            real!(@math $float, sqrt, $sqrt);
            real!(@math $float, exp, $exp);
            real!(@math $float, exp_m1, $expm1);
            real!(@math $float, ln, $log);
            real!(@math $float, ln_1p, $log1p);
            real!(@math $float, abs, $fabs);
            real!(@math2 $float, powf, $pow);
            real!(@math2 $float, atan2, $atan2);
            #[inline]
            fn sin_cos(self) -> (Self, Self) {
                #[cfg(feature = "std")]
                return $float::sin_cos(self);
                #[cfg(not(feature = "std"))]
                return libm::$sincos(self);
            }
            #[inline]
            fn acos(self) -> Self {
                let x = $float::clamp(self, -1.0, 1.0);
                #[cfg(feature = "std")]
                return $float::acos(x);
                #[cfg(not(feature = "std"))]
                return libm::$acos(x);
            }
            #[inline]
            fn asin(self) -> Self {
                let x = $float::clamp(self, -1.0, 1.0);
                #[cfg(feature = "std")]
                return $float::asin(x);
                #[cfg(not(feature = "std"))]
                return libm::$asin(x);
            }
            #[inline]
            fn is_finite(self) -> bool {
                $float::is_finite(self)
            }
        }
    };
    (@math $float:ident, $name:ident, $libm:ident) => {
        #[inline]
        fn $name(self) -> Self {
            #[cfg(feature = "std")]
            return $float::$name(self);
            #[cfg(not(feature = "std"))]
            return libm::$libm(self);
        }
    };
    (@math2 $float:ident, $name:ident, $libm:ident) => {
        #[inline]
        fn $name(self, other: Self) -> Self {
            #[cfg(feature = "std")]
            return $float::$name(self, other);
            #[cfg(not(feature = "std"))]
            return libm::$libm(self, other);
        }
    };
}

real!(f32, 24, sqrtf, sincosf, expf, expm1f, logf, log1pf, powf, acosf, asinf, atan2f, fabsf);
real!(f64, 53, sqrt, sincos, exp, expm1, log, log1p, pow, acos, asin, atan2, fabs);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clamps_into_the_unit_interval() {
        for (x, expected) in [(f32::NAN, 0.0), (-1.0, 0.0), (0.25, 0.25), (1.0, f32::ONE_MINUS_EPSILON)] {
            assert_eq!(x.clamp_unit(), expected);
        }
        const { assert!(<f64 as Real>::ONE_MINUS_EPSILON < 1.0 && <f32 as Real>::ONE_MINUS_EPSILON < 1.0) };
    }
}
