//! The renderer's vectors and random numbers.

use std::f64::consts::TAU;
use std::ops::{Add, AddAssign, Mul, MulAssign, Sub};

/// A point, a direction, or a colour.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct V(pub f64, pub f64, pub f64);

impl Add for V {
    type Output = Self;
    fn add(self, v: Self) -> Self {
        Self(self.0 + v.0, self.1 + v.1, self.2 + v.2)
    }
}

impl Sub for V {
    type Output = Self;
    fn sub(self, v: Self) -> Self {
        self + v * -1.0
    }
}

impl Mul<f64> for V {
    type Output = Self;
    fn mul(self, s: f64) -> Self {
        Self(self.0 * s, self.1 * s, self.2 * s)
    }
}

impl Mul for V {
    type Output = Self;
    fn mul(self, v: Self) -> Self {
        Self(self.0 * v.0, self.1 * v.1, self.2 * v.2)
    }
}

impl AddAssign for V {
    fn add_assign(&mut self, v: Self) {
        *self = Self(self.0 + v.0, self.1 + v.1, self.2 + v.2);
    }
}

impl MulAssign for V {
    fn mul_assign(&mut self, v: Self) {
        *self = Self(self.0 * v.0, self.1 * v.1, self.2 * v.2);
    }
}

impl V {
    pub const fn splat(x: f64) -> Self {
        Self(x, x, x)
    }
    pub fn dot(self, v: Self) -> f64 {
        self.0 * v.0 + self.1 * v.1 + self.2 * v.2
    }
    pub fn cross(self, v: Self) -> Self {
        Self(self.1 * v.2 - self.2 * v.1, self.2 * v.0 - self.0 * v.2, self.0 * v.1 - self.1 * v.0)
    }
    pub fn length(self) -> f64 {
        self.dot(self).sqrt()
    }
    pub fn unit(self) -> Self {
        self * (1.0 / self.length())
    }
    /// Brightness of a colour.
    pub fn mean(self) -> f64 {
        (self.0 + self.1 + self.2) / 3.0
    }
    pub fn largest(self) -> f64 {
        self.0.max(self.1).max(self.2)
    }
    /// The direction at this cosine and azimuth `TAU v` to the axis.
    pub fn around(self, cosine: f64, v: f64) -> Self {
        let x = self.cross(if self.0.abs() < 0.5 { Self(1.0, 0.0, 0.0) } else { Self(0.0, 1.0, 0.0) }).unit();
        let (sine, (sin, cos)) = ((1.0 - cosine * cosine).max(0.0).sqrt(), (TAU * v).sin_cos());
        x * (sine * cos) + self.cross(x) * (sine * sin) + self * cosine
    }
}

/// SplitMix64.
pub fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0xD1B5_4A32_D192_ED03);
    move || {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (state ^ (state >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}
