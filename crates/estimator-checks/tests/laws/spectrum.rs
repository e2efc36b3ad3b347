//! Spectra.

use std::ops::{Add, AddAssign, Mul, MulAssign, Sub};

use estimator_checks::laws::scene::check_spectrum;
use scene_core::{Rgb, Spectrum};

use crate::broken;

const NOTHING: u8 = 0;
const ZERO_IS_GREY: u8 = 1;
const SPLAT_FORGETS: u8 = 2;
const ADD_FORGETS: u8 = 3;
const SUB_FORGETS: u8 = 4;
const PRODUCT_FORGETS: u8 = 5;
const SCALE_FORGETS: u8 = 6;
const ADD_ASSIGN_REPLACES: u8 = 7;
const MUL_ASSIGN_REPLACES: u8 = 8;
const LUMINANCE_IS_BENT: u8 = 9;
const LUMINANCE_IS_NEGATIVE: u8 = 10;
const MAX_IS_THE_FIRST: u8 = 11;
const BLACK_IS_DIM: u8 = 12;
const FINITE_IS_THE_FIRST: u8 = 13;
const COMPONENTS_ARE_SHIFTED: u8 = 14;

/// Four wavelengths.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Four<const LIE: u8>([f32; 4]);

impl<const LIE: u8> Four<LIE> {
    fn with(self, other: Self, lie: u8, f: fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|i| if LIE == lie && i == 3 { self.0[i] } else { f(self.0[i], other.0[i]) }))
    }
}

impl<const LIE: u8> Add for Four<LIE> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.with(other, ADD_FORGETS, |a, b| a + b)
    }
}

impl<const LIE: u8> Sub for Four<LIE> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.with(other, SUB_FORGETS, |a, b| a - b)
    }
}

impl<const LIE: u8> Mul for Four<LIE> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.with(other, PRODUCT_FORGETS, |a, b| a * b)
    }
}

impl<const LIE: u8> Mul<f32> for Four<LIE> {
    type Output = Self;
    fn mul(self, factor: f32) -> Self {
        self.with(Self([factor; 4]), SCALE_FORGETS, |a, b| a * b)
    }
}

impl<const LIE: u8> AddAssign for Four<LIE> {
    fn add_assign(&mut self, other: Self) {
        *self = if LIE == ADD_ASSIGN_REPLACES { other } else { *self + other };
    }
}

impl<const LIE: u8> MulAssign for Four<LIE> {
    fn mul_assign(&mut self, other: Self) {
        *self = if LIE == MUL_ASSIGN_REPLACES { other } else { *self * other };
    }
}

impl<const LIE: u8> Spectrum for Four<LIE> {
    const ZERO: Self = Self([0.0, if LIE == ZERO_IS_GREY { 1e-9 } else { 0.0 }, 0.0, 0.0]);
    const COMPONENTS: usize = 4;

    fn splat(value: f32) -> Self {
        Self([value, value, value, if LIE == SPLAT_FORGETS { 0.0 } else { value }])
    }

    fn luminance(&self) -> f32 {
        let mean = 0.25 * self.0.iter().sum::<f32>();
        match LIE {
            LUMINANCE_IS_BENT => mean.abs().powf(1.01),
            LUMINANCE_IS_NEGATIVE => mean - 0.5 * self.0[0],
            _ => mean,
        }
    }

    fn max_component(&self) -> f32 {
        if LIE == MAX_IS_THE_FIRST { self.0[0] } else { self.0.into_iter().fold(f32::NEG_INFINITY, f32::max) }
    }

    fn is_finite(&self) -> bool {
        if LIE == FINITE_IS_THE_FIRST { self.0[0].is_finite() } else { self.0.iter().all(|c| c.is_finite()) }
    }

    fn is_black(&self) -> bool {
        if LIE == BLACK_IS_DIM { self.max_component() < 1e-3 } else { self.0 == [0.0; 4] }
    }

    fn to_rgb(&self) -> [f32; 3] {
        [self.0[0], self.0[1], self.0[3]]
    }

    fn from_rgb([r, g, b]: [f32; 3]) -> Self {
        Self([r, g, 0.5 * (g + b), b])
    }

    fn component(&self, index: usize) -> f32 {
        self.0[index]
    }

    fn from_components(mut component: impl FnMut(usize) -> f32) -> Self {
        Self(std::array::from_fn(|i| component(if LIE == COMPONENTS_ARE_SHIFTED { (i + 1) % 4 } else { i })))
    }
}

#[test]
fn spectra_keep_their_laws() {
    check_spectrum("rgb", &[Rgb::new(0.2, 3.0, 1e-4), Rgb::new(0.0, -1.0, f32::NAN)]).expect_pass();
    check_spectrum("f32", &[0.2, 3.0, -1e-4, f32::INFINITY]).expect_pass();
    check_spectrum("four", &samples::<NOTHING>()).expect_pass();
}

fn samples<const LIE: u8>() -> [Four<LIE>; 3] {
    [Four([1.0, 0.5, 0.3, 0.0]), Four([1e-4, 2.0, 7.0, 3.0]), Four([0.5, f32::INFINITY, 0.1, 0.0])]
}

fn law<const LIE: u8>() -> &'static str {
    broken(check_spectrum("liar", &samples::<LIE>()))
}

#[test]
fn spectra_that_lie_are_rejected() {
    assert_eq!(law::<ZERO_IS_GREY>(), "ZERO has no component");
    assert_eq!(law::<SPLAT_FORGETS>(), "splat has the same value in every component");
    assert_eq!(law::<ADD_FORGETS>(), "+ adds every component");
    assert_eq!(law::<SUB_FORGETS>(), "- subtracts every component");
    assert_eq!(law::<PRODUCT_FORGETS>(), "splat(1.0) is one");
    assert_eq!(law::<SCALE_FORGETS>(), "numbers scale every component");
    assert_eq!(law::<ADD_ASSIGN_REPLACES>(), "+= is +");
    assert_eq!(law::<MUL_ASSIGN_REPLACES>(), "*= is *");
    assert_eq!(law::<LUMINANCE_IS_BENT>(), "luminance is linear");
    assert_eq!(law::<LUMINANCE_IS_NEGATIVE>(), "luminance is not negative");
    assert_eq!(law::<MAX_IS_THE_FIRST>(), "max_component is the largest component");
    assert_eq!(law::<BLACK_IS_DIM>(), "is_black holds if all components are zero, and only then");
    assert_eq!(law::<FINITE_IS_THE_FIRST>(), "is_finite holds if all components are, and only then");
    assert_eq!(law::<COMPONENTS_ARE_SHIFTED>(), "from_components takes what component says");
}
