//! Looking up an image.

use std::sync::Arc;

use super::{Image, UV_IDENTITY, transform_uv};
use crate::traits::{Rgb, Spectrum};

/// What lies outside the unit square.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// The image again.
    #[default]
    Repeat,
    /// The pixels of the edge.
    Clamp,
    /// The image, mirrored every other time.
    Mirror,
}

/// What lies between pixel centres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Interpolation {
    /// The bilinear blend of four pixels.
    #[default]
    Bilinear,
    /// The nearest pixel.
    Nearest,
}

/// An image over a surface. No filtering beyond the interpolation, as in Mitsuba's `bitmap`.
#[derive(Clone, Debug)]
pub struct ImageTexture {
    /// The pixels.
    pub image: Arc<Image>,
    /// What lies outside the unit square.
    pub wrap: Wrap,
    /// What lies between pixel centres.
    pub interpolation: Interpolation,
    /// Affine map of the surface parameters, the two rows of a 2 x 3 matrix.
    pub uv_transform: [f32; 6],
    /// Factor for all values.
    pub scale: f32,
}

/// Two neighbouring pixels along one axis and where between them a coordinate lies.
struct Span {
    low: u32,
    high: u32,
    /// Weight of `high`.
    weight: f32,
    /// -1 where the image is mirrored, 1 elsewhere.
    sign: f32,
}

/// `t - floor(t)` in `[0, 1]` without the call that `floor` is where SSE 4.1 is not assumed.
#[inline]
fn fraction(t: f32) -> f32 {
    let rest = t - t as i32 as f32;
    (if rest < 0.0 { rest + 1.0 } else { rest }).clamp(0.0, 1.0)
}

impl ImageTexture {
    /// The image once over the unit square, repeated, bilinear.
    pub fn new(image: Arc<Image>) -> Self {
        Self {
            image,
            wrap: Wrap::Repeat,
            interpolation: Interpolation::Bilinear,
            uv_transform: UV_IDENTITY,
            scale: 1.0,
        }
    }

    /// The value at surface parameters `uv`.
    #[inline]
    pub fn eval(&self, uv: [f32; 2]) -> Rgb {
        let [u, v] = transform_uv(&self.uv_transform, uv);
        let (width, height) = (self.image.width(), self.image.height());
        if self.interpolation == Interpolation::Nearest {
            let (u, _) = self.wrapped(u);
            let (v, _) = self.wrapped(v);
            let x = ((u * width as f32) as u32).min(width - 1);
            let y = ((v * height as f32) as u32).min(height - 1);
            return self.image.pixel(x, y) * self.scale;
        }
        let (x, y) = (self.span(u, width), self.span(v, height));
        let [p00, p10, p01, p11] = self.corners(&x, &y);
        let top = p00 + (p10 - p00) * x.weight;
        let bottom = p01 + (p11 - p01) * x.weight;
        (top + (bottom - top) * y.weight) * self.scale
    }

    /// The derivatives of the luminance by `u` and `v`.
    pub(super) fn gradient(&self, uv: [f32; 2]) -> [f32; 2] {
        if self.interpolation == Interpolation::Nearest {
            return [0.0; 2];
        }
        let m = &self.uv_transform;
        let [u, v] = transform_uv(m, uv);
        let (width, height) = (self.image.width(), self.image.height());
        let (x, y) = (self.span(u, width), self.span(v, height));
        let [p00, p10, p01, p11] = self.corners(&x, &y).map(|p| p.luminance());
        let lerp = |a: f32, b: f32, t: f32| a + (b - a) * t;
        let by_x = lerp(p10 - p00, p11 - p01, y.weight) * width as f32 * x.sign * self.scale;
        let by_y = lerp(p01 - p00, p11 - p10, x.weight) * height as f32 * y.sign * self.scale;
        [m[0] * by_x + m[3] * by_y, m[1] * by_x + m[4] * by_y]
    }

    #[inline]
    fn corners(&self, x: &Span, y: &Span) -> [Rgb; 4] {
        let pixel = |x, y| self.image.pixel(x, y);
        [pixel(x.low, y.low), pixel(x.high, y.low), pixel(x.low, y.high), pixel(x.high, y.high)]
    }

    /// Brings a coordinate into `[0, 1]`; the second value is -1 where that mirrored it.
    #[inline]
    fn wrapped(&self, t: f32) -> (f32, f32) {
        if !t.is_finite() {
            return (0.0, 1.0);
        }
        match self.wrap {
            Wrap::Repeat => (fraction(t), 1.0),
            Wrap::Clamp => (t.clamp(0.0, 1.0), 1.0),
            Wrap::Mirror => {
                let t = 2.0 * fraction(0.5 * t);
                if t > 1.0 { (2.0 - t, -1.0) } else { (t, 1.0) }
            }
        }
    }

    #[inline]
    fn span(&self, t: f32, size: u32) -> Span {
        let (t, sign) = self.wrapped(t);
        let x = t * size as f32 - 0.5;
        // x is at least -1/2: the cast truncates towards the floor of x + 1.
        let low = (x + 1.0) as i32 - 1;
        let high = low + 1;
        let last = size as i32 - 1;
        let unclamped = low;
        let (low, high) = if self.wrap == Wrap::Repeat {
            (if low < 0 { last } else { low.min(last) }, if high > last { 0 } else { high })
        } else {
            (low.clamp(0, last), high.clamp(0, last))
        };
        Span { low: low as u32, high: high as u32, weight: x - unclamped as f32, sign }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(wrap: Wrap, interpolation: Interpolation) -> ImageTexture {
        let image = Image::from_rgb(4, 2, (0..8).map(|i| [i as f32, 0.0, 1.0]).collect()).unwrap();
        ImageTexture { wrap, interpolation, ..ImageTexture::new(Arc::new(image)) }
    }

    #[test]
    fn pixel_centres_are_exact_in_every_mode() {
        for wrap in [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror] {
            for interpolation in [Interpolation::Bilinear, Interpolation::Nearest] {
                let texture = ramp(wrap, interpolation);
                for i in 0..8 {
                    let uv = [(i % 4) as f32 / 4.0 + 0.125, (i / 4) as f32 / 2.0 + 0.25];
                    assert_eq!(texture.eval(uv)[0], i as f32, "{wrap:?} {interpolation:?}");
                }
            }
        }
    }

    #[test]
    fn edges_wrap() {
        let at = |wrap, u| ramp(wrap, Interpolation::Bilinear).eval([u, 0.25])[0];
        assert_eq!(at(Wrap::Repeat, 0.0), 1.5);
        assert_eq!(at(Wrap::Repeat, 1.0), 1.5);
        assert_eq!(at(Wrap::Clamp, -3.0), 0.0);
        assert_eq!(at(Wrap::Clamp, 7.0), 3.0);
        assert_eq!(at(Wrap::Mirror, 1.125), 3.0);
        assert_eq!(at(Wrap::Mirror, -0.375), 1.0);
        assert_eq!(at(Wrap::Repeat, -0.875), 0.0);
    }

    #[test]
    fn gradients_are_those_of_the_interpolation() {
        for wrap in [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror] {
            let mut texture = ramp(wrap, Interpolation::Bilinear);
            texture.uv_transform = [0.7, 0.2, 0.05, -0.3, 0.9, 0.4];
            texture.scale = 2.0;
            for i in 0..50 {
                let uv = [0.137 * i as f32 - 2.0, 0.071 * i as f32 - 1.0];
                let h = 1e-3;
                let f = |u, v| texture.eval([u, v]).luminance();
                let difference = [
                    (f(uv[0] + h, uv[1]) - f(uv[0] - h, uv[1])) / (2.0 * h),
                    (f(uv[0], uv[1] + h) - f(uv[0], uv[1] - h)) / (2.0 * h),
                ];
                let gradient = texture.gradient(uv);
                let error = (0..2).map(|k| (gradient[k] - difference[k]).abs()).fold(0.0, f32::max);
                // A difference across a kink is a mean of both sides.
                assert!(!(0.05..=0.3).contains(&error), "{wrap:?} {uv:?}: {gradient:?} {difference:?}");
            }
        }
        assert_eq!(ramp(Wrap::Repeat, Interpolation::Nearest).gradient([0.3, 0.3]), [0.0; 2]);
    }

    #[test]
    fn coordinates_that_are_no_numbers_do_not_poison() {
        for wrap in [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror] {
            for t in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, -1e30] {
                for interpolation in [Interpolation::Bilinear, Interpolation::Nearest] {
                    assert!(ramp(wrap, interpolation).eval([t, 0.1]).is_finite());
                }
            }
        }
    }
}
