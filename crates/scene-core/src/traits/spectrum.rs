//! What light is measured in: a linear space with a pointwise product.

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Index, Mul, MulAssign, Sub};

use glam::Vec3A;

/// A spectral quantity: radiance, flux, throughput, albedo.
///
/// # Laws
/// - `(+, ZERO)` is a commutative group and `f32` scales it: a spectrum is a vector.
/// - `*` is the pointwise product: commutative, with `splat(1.0)` as one.
/// - `luminance` is linear and non-negative on non-negative spectra;
///   `is_black` holds exactly if every component is zero.
/// - Both operations act on each component alone: `(a * b).component(i)` is `a.component(i) * b.component(i)`.
///
/// Scalar renderers implement it for one number, spectral ones for a bundle of wavelengths.
///
/// Not dyn compatible: it is a number.
pub trait Spectrum:
    Copy
    + Debug
    + PartialEq
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + AddAssign
    + Mul<Output = Self>
    + MulAssign
    + Mul<f32, Output = Self>
    + 'static
{
    /// No light.
    const ZERO: Self;
    /// The same value in every component.
    fn splat(value: f32) -> Self;
    /// A scalar measure of brightness.
    fn luminance(&self) -> f32;
    /// The largest component.
    fn max_component(&self) -> f32;
    /// Whether every component is finite.
    fn is_finite(&self) -> bool;
    /// Linear RGB (BT.709 primaries), for films and displays.
    fn to_rgb(&self) -> [f32; 3];
    /// The nearest spectrum of a linear RGB colour (BT.709 primaries).
    fn from_rgb(rgb: [f32; 3]) -> Self;
    /// Whether every component is zero.
    fn is_black(&self) -> bool {
        *self == Self::ZERO
    }

    /// How many components it has. Participating media attenuate each of them at its own rate, and so ask for them
    /// one by one. The default is right for RGB; spectra of other components override it, with the next two.
    const COMPONENTS: usize = 3;
    /// Component number `index`, below [`COMPONENTS`](Self::COMPONENTS).
    #[inline]
    fn component(&self, index: usize) -> f32 {
        self.to_rgb()[index]
    }
    /// The spectrum whose component number `i` is `component(i)`.
    #[inline]
    fn from_components(component: impl FnMut(usize) -> f32) -> Self {
        Self::from_rgb(core::array::from_fn(component))
    }
}

/// Linear RGB with the primaries of BT.709 (sRGB).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rgb(pub Vec3A);

impl Rgb {
    /// No light.
    pub const ZERO: Self = Self(Vec3A::ZERO);
    /// One in every component.
    pub const ONE: Self = Self(Vec3A::ONE);

    /// A colour of its components.
    #[inline]
    pub const fn new(r: f32, g: f32, b: f32) -> Self {
        Self(Vec3A::new(r, g, b))
    }

    /// The same value in every component.
    #[inline]
    pub const fn splat(value: f32) -> Self {
        Self(Vec3A::splat(value))
    }

    /// The components.
    #[inline]
    pub fn to_array(self) -> [f32; 3] {
        self.0.to_array()
    }

    /// The mean of the components.
    #[inline]
    pub fn mean(self) -> f32 {
        (self.0.x + self.0.y + self.0.z) * (1.0 / 3.0)
    }

    /// Each component mapped.
    #[inline]
    #[must_use]
    pub fn map(self, f: impl Fn(f32) -> f32) -> Self {
        Self::new(f(self.0.x), f(self.0.y), f(self.0.z))
    }

    /// Each component clamped to `[low, high]`.
    #[inline]
    #[must_use]
    pub fn clamp(self, low: f32, high: f32) -> Self {
        Self(self.0.clamp(Vec3A::splat(low), Vec3A::splat(high)))
    }
}

impl From<[f32; 3]> for Rgb {
    #[inline]
    fn from(rgb: [f32; 3]) -> Self {
        Self(rgb.into())
    }
}

impl From<Rgb> for [f32; 3] {
    #[inline]
    fn from(rgb: Rgb) -> Self {
        rgb.0.to_array()
    }
}

impl Index<usize> for Rgb {
    type Output = f32;
    #[inline]
    fn index(&self, index: usize) -> &f32 {
        &self.0[index]
    }
}

impl Add for Rgb {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl Sub for Rgb {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

impl AddAssign for Rgb {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        self.0 += other.0;
    }
}

impl Mul for Rgb {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        Self(self.0 * other.0)
    }
}

impl MulAssign for Rgb {
    #[inline]
    fn mul_assign(&mut self, other: Self) {
        self.0 *= other.0;
    }
}

impl Mul<f32> for Rgb {
    type Output = Self;
    #[inline]
    fn mul(self, factor: f32) -> Self {
        Self(self.0 * factor)
    }
}

impl Mul<Rgb> for f32 {
    type Output = Rgb;
    #[inline]
    fn mul(self, rgb: Rgb) -> Rgb {
        Rgb(rgb.0 * self)
    }
}

impl Div for Rgb {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        Self(self.0 / other.0)
    }
}

impl Div<f32> for Rgb {
    type Output = Self;
    #[inline]
    fn div(self, divisor: f32) -> Self {
        Self(self.0 / divisor)
    }
}

impl Spectrum for Rgb {
    const ZERO: Self = Self(Vec3A::ZERO);
    #[inline]
    fn splat(value: f32) -> Self {
        Self(Vec3A::splat(value))
    }
    #[inline]
    fn luminance(&self) -> f32 {
        self.0.dot(Vec3A::new(0.212671, 0.715160, 0.072169))
    }
    #[inline]
    fn max_component(&self) -> f32 {
        self.0.max_element()
    }
    #[inline]
    fn is_finite(&self) -> bool {
        self.0.is_finite()
    }
    #[inline]
    fn to_rgb(&self) -> [f32; 3] {
        self.0.to_array()
    }
    #[inline]
    fn component(&self, index: usize) -> f32 {
        self.0[index]
    }
    #[inline]
    fn from_rgb(rgb: [f32; 3]) -> Self {
        rgb.into()
    }
}

impl Spectrum for f32 {
    const ZERO: Self = 0.0;
    #[inline]
    fn splat(value: f32) -> Self {
        value
    }
    #[inline]
    fn luminance(&self) -> f32 {
        *self
    }
    #[inline]
    fn max_component(&self) -> f32 {
        *self
    }
    #[inline]
    fn is_finite(&self) -> bool {
        f32::is_finite(*self)
    }
    #[inline]
    fn to_rgb(&self) -> [f32; 3] {
        [*self; 3]
    }
    #[inline]
    fn from_rgb(rgb: [f32; 3]) -> Self {
        Rgb::from(rgb).luminance()
    }
    const COMPONENTS: usize = 1;
    #[inline]
    fn component(&self, _: usize) -> f32 {
        *self
    }
    #[inline]
    fn from_components(mut component: impl FnMut(usize) -> f32) -> Self {
        component(0)
    }
}
