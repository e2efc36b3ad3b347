//! The two number types of the crate.

use core::fmt::{Debug, Display};
use core::iter::Sum;
use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Sub};

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

/// `f32` or `f64`.
///
/// The trait is sealed: it holds just what resampling needs of a number, so that everything is written once. Code that
/// uses this crate with one number type never has to name it.
pub trait Float:
    sealed::Sealed
    + Copy
    + PartialOrd
    + Debug
    + Display
    + Default
    + Add<Output = Self>
    + AddAssign
    + Sub<Output = Self>
    + Mul<Output = Self>
    + MulAssign
    + Div<Output = Self>
    + Sum
{
    /// `0`.
    const ZERO: Self;
    /// `1`.
    const ONE: Self;
    /// The largest finite number.
    const MAX: Self;

    /// Converts to `f64` (exactly).
    fn to_f64(self) -> f64;
    /// Converts from `f64` (rounding).
    fn from_f64(value: f64) -> Self;

    /// The number itself if it is positive and finite, else zero: what counts as a weight.
    #[inline(always)]
    #[must_use]
    fn weight_or_zero(self) -> Self {
        if self > Self::ZERO && self <= Self::MAX { self } else { Self::ZERO }
    }

    /// The smaller of two; the second if the first is NaN.
    #[inline(always)]
    #[must_use]
    fn at_most(self, bound: Self) -> Self {
        if self < bound { self } else { bound }
    }
}

impl Float for f32 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const MAX: Self = f32::MAX;

    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        value as f32
    }
}

impl Float for f64 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const MAX: Self = f64::MAX;

    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        value
    }
}
