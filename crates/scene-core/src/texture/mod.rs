//! Textures: quantities that vary over a surface.
//!
//! A [`Texture`] maps surface parameters to linear RGB. It is a constant, a checkerboard or an [`ImageTexture`]; the
//! pixels of an [`Image`] are shared, so that several textures can show the same file with other wrapping or scale.
//!
//! Row 0 of an image is its upper edge and has `v = 0`, as in Mitsuba 3 and glTF.

mod error;
mod image;
mod image_texture;
#[cfg(feature = "image-files")]
mod open;

pub use error::TextureError;
pub use image::{ColorSpace, Image};
pub use image_texture::{ImageTexture, Interpolation, Wrap};

use std::sync::Arc;

use crate::traits::Rgb;

/// The identity of the affine map from surface parameters to texture coordinates.
pub const UV_IDENTITY: [f32; 6] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0];

/// Maps surface parameters: `[a, b, c, d, e, f]` are the rows `(a b c), (d e f)` of a matrix that multiplies `(u, v, 1)`.
#[inline]
pub(crate) fn transform_uv(m: &[f32; 6], [u, v]: [f32; 2]) -> [f32; 2] {
    [m[0] * u + m[1] * v + m[2], m[3] * u + m[4] * v + m[5]]
}

/// A quantity over a surface, in linear RGB.
///
/// # Example
/// ```
/// use scene_core::{Rgb, texture::{Texture, UV_IDENTITY}};
/// let board = Texture::Checkerboard { color0: Rgb::ONE, color1: Rgb::ZERO, uv_transform: UV_IDENTITY };
/// assert_eq!(board.eval([0.1, 0.1]), Rgb::ONE);
/// assert_eq!(board.eval([0.6, 0.1]), Rgb::ZERO);
/// assert_eq!(board.mean(), Rgb::splat(0.5));
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Texture {
    /// The same value everywhere.
    Constant(Rgb),
    /// Squares with sides of half a unit of the transformed parameters, as Mitsuba's `checkerboard`.
    Checkerboard {
        /// Where both coordinates, or none, lie in the upper half of their unit interval.
        color0: Rgb,
        /// Elsewhere.
        color1: Rgb,
        /// Affine map of the surface parameters, the two rows of a 2 x 3 matrix.
        uv_transform: [f32; 6],
    },
    /// An image.
    Image(Arc<ImageTexture>),
}

impl Texture {
    /// The value at surface parameters `uv`. Parameters that are not finite count as zero.
    #[inline(always)]
    pub fn eval(&self, uv: [f32; 2]) -> Rgb {
        // Most textures are constants.
        if let Self::Constant(value) = self { *value } else { self.eval_varying(uv) }
    }

    fn eval_varying(&self, uv: [f32; 2]) -> Rgb {
        match self {
            Self::Constant(value) => *value,
            Self::Checkerboard { color0, color1, uv_transform } => {
                let [u, v] = transform_uv(uv_transform, uv).map(|x| x - x.floor() > 0.5);
                if u == v { *color0 } else { *color1 }
            }
            Self::Image(image) => image.eval(uv),
        }
    }

    /// The mean over the unit square of texture coordinates (of the image or the checkerboard, before its map).
    pub fn mean(&self) -> Rgb {
        match self {
            Self::Constant(value) => *value,
            Self::Checkerboard { color0, color1, .. } => (*color0 + *color1) * 0.5,
            Self::Image(image) => image.image.mean() * image.scale,
        }
    }

    /// The derivatives of the luminance by `u` and by `v`, for bump maps: that of the bilinear interpolation.
    /// Zero for constants, checkerboards and nearest-neighbour lookups, as in Mitsuba 3.
    pub fn gradient(&self, uv: [f32; 2]) -> [f32; 2] {
        match self {
            Self::Constant(_) | Self::Checkerboard { .. } => [0.0; 2],
            Self::Image(image) => image.gradient(uv),
        }
    }

    /// The value, if it is the same everywhere.
    pub fn constant(&self) -> Option<Rgb> {
        match self {
            Self::Constant(value) => Some(*value),
            _ => None,
        }
    }
}

impl From<Rgb> for Texture {
    fn from(value: Rgb) -> Self {
        Self::Constant(value)
    }
}

impl From<f32> for Texture {
    fn from(value: f32) -> Self {
        Self::Constant(Rgb::splat(value))
    }
}

impl From<ImageTexture> for Texture {
    fn from(image: ImageTexture) -> Self {
        Self::Image(Arc::new(image))
    }
}
