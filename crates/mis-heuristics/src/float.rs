//! The two number types of the crate.

use core::fmt::{Debug, Display};
use core::ops::{Add, Div, Mul, Sub};

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

/// `f32` or `f64`.
///
/// The trait is sealed: it holds just what the heuristics need of a number, so that each of them is written once.
/// Code that uses this crate with one number type never has to name it.
pub trait Float:
    sealed::Sealed
    + Copy
    + PartialOrd
    + Debug
    + Display
    + Default
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
{
    /// `0`.
    const ZERO: Self;
    /// `1`.
    const ONE: Self;
    /// Positive infinity.
    const INFINITY: Self;
    /// Difference between 1 and the next larger number.
    const EPSILON: Self;
    /// Smallest positive number of full precision.
    #[doc(hidden)]
    const SMALLEST: Self;
    /// Sums of squares from here to the largest number lose nothing to underflow that a weight could show:
    /// the smallest normal number over [`EPSILON`](Self::EPSILON) squared.
    #[doc(hidden)]
    const SAFE_SQUARE: Self;

    /// Converts to `f64` (exactly).
    fn to_f64(self) -> f64;
    /// Converts from `f64` (rounding).
    fn from_f64(value: f64) -> Self;
    /// Converts from `u32` (rounding).
    fn from_u32(value: u32) -> Self;

    /// The number itself if it is positive, else zero; NaN becomes zero. One instruction.
    #[inline(always)]
    #[must_use]
    fn positive_part(self) -> Self {
        if self > Self::ZERO { self } else { Self::ZERO }
    }
}

impl Float for f32 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const INFINITY: Self = f32::INFINITY;
    const EPSILON: Self = f32::EPSILON;
    const SMALLEST: Self = f32::MIN_POSITIVE;
    const SAFE_SQUARE: Self = f32::MIN_POSITIVE / f32::EPSILON / f32::EPSILON;

    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        value as f32
    }
    #[inline(always)]
    fn from_u32(value: u32) -> Self {
        value as f32
    }
}

impl Float for f64 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const INFINITY: Self = f64::INFINITY;
    const EPSILON: Self = f64::EPSILON;
    const SMALLEST: Self = f64::MIN_POSITIVE;
    const SAFE_SQUARE: Self = f64::MIN_POSITIVE / f64::EPSILON / f64::EPSILON;

    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn from_u32(value: u32) -> Self {
        f64::from(value)
    }
}
