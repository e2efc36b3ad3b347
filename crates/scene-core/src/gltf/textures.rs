//! Textures: images, samplers, and where their coordinates go.

use std::path::Path;
use std::sync::Arc;

use ::gltf::json::{self, extensions::texture::TextureTransform};
use ::gltf::material::NormalTexture;
use ::gltf::texture::{Info, MagFilter, WrappingMode};

use super::error::{ImportError, Place, Result};
use super::importer::Importer;
use super::uri;
use crate::texture::{ColorSpace, Image, ImageTexture, Interpolation, Texture, TextureError, UV_IDENTITY, Wrap};
use crate::traits::Rgb;

/// What of an image is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Look {
    /// Its colours.
    Color(ColorSpace),
    /// Its alpha times a factor, as grey; the factor's bits.
    Alpha(u32),
    /// White where its alpha times the first is at least the second, black elsewhere; their bits.
    Cutout(u32, u32),
}

/// An image of the document, and what of it is wanted.
pub(super) type ImageKey = (usize, Look);

/// A texture as a material names it.
#[derive(Clone)]
pub(super) struct TextureRef<'s> {
    pub(super) texture: ::gltf::Texture<'s>,
    /// Number of the set of coordinates.
    pub(super) set: u32,
    uv_transform: [f32; 6],
}

impl<'s> TextureRef<'s> {
    pub(super) fn new(info: &Info<'s>) -> Self {
        let Some(transform) = info.texture_transform() else {
            return Self { texture: info.texture(), set: info.tex_coord(), uv_transform: UV_IDENTITY };
        };
        let set = transform.tex_coord().unwrap_or(info.tex_coord());
        let uv_transform = uv_transform(transform.offset(), transform.rotation(), transform.scale());
        Self { texture: info.texture(), set, uv_transform }
    }

    pub(super) fn of_normals(info: &NormalTexture<'s>) -> Self {
        let found = info.extension_value("KHR_texture_transform").cloned();
        let transform = found.and_then(|value| json::deserialize::from_value::<TextureTransform>(value).ok());
        let Some(transform) = transform else {
            return Self { texture: info.texture(), set: info.tex_coord(), uv_transform: UV_IDENTITY };
        };
        let set = transform.tex_coord.unwrap_or(info.tex_coord());
        let uv_transform = uv_transform(transform.offset.0, transform.rotation.0, transform.scale.0);
        Self { texture: info.texture(), set, uv_transform }
    }
}

/// Scale, then counterclockwise rotation as seen with `v` pointing down, then offset.
fn uv_transform(offset: [f32; 2], rotation: f32, scale: [f32; 2]) -> [f32; 6] {
    let (sin, cos) = rotation.sin_cos();
    [cos * scale[0], sin * scale[1], offset[0], -sin * scale[0], cos * scale[1], offset[1]]
}

impl<'s> Importer<'s> {
    /// A texture of colours or numbers, times a factor.
    pub(super) fn texture(
        &mut self,
        named: &TextureRef<'s>,
        color_space: ColorSpace,
        factor: Rgb,
        place: &Place,
    ) -> Result<Texture> {
        let [r, g, b] = factor.to_array();
        let mut texture = self.image_texture(named, Look::Color(color_space), place)?;
        if r == g && g == b {
            texture.scale = r;
        } else {
            texture.image = Arc::new(tinted(&texture.image, factor));
        }
        Ok(texture.into())
    }

    /// An image with its sampler.
    pub(super) fn image_texture(&mut self, named: &TextureRef<'s>, look: Look, place: &Place) -> Result<ImageTexture> {
        let texture = &named.texture;
        let place = place.part(format!("textures[{}]", texture.index()));
        let Some(image) = texture.source() else {
            return Err(place.unsupported("a texture without `source`, whose image is that of an extension,"));
        };
        let sampler = texture.sampler();
        let wrap = |mode: WrappingMode| match mode {
            WrappingMode::Repeat => Wrap::Repeat,
            WrappingMode::ClampToEdge => Wrap::Clamp,
            WrappingMode::MirroredRepeat => Wrap::Mirror,
        };
        if sampler.wrap_s() != sampler.wrap_t() {
            self.warn(&place, format!("wraps by {:?} along v too, not by {:?}", sampler.wrap_s(), sampler.wrap_t()));
        }
        let nearest = sampler.mag_filter() == Some(MagFilter::Nearest);
        Ok(ImageTexture {
            wrap: wrap(sampler.wrap_s()),
            interpolation: if nearest { Interpolation::Nearest } else { Interpolation::Bilinear },
            uv_transform: named.uv_transform,
            ..ImageTexture::new(self.image(image.index(), look)?)
        })
    }

    /// An image, decoded once for each look.
    fn image(&mut self, index: usize, look: Look) -> Result<Arc<Image>> {
        if let Some(known) = self.images.get(&(index, look)) {
            return Ok(known.clone());
        }
        let failed = |error: TextureError, place: &Place, file: Option<&Path>| match file {
            Some(file) => place.data(file, error),
            None => place.invalid(error.to_string()),
        };
        let image = match look {
            Look::Color(color_space) => {
                let (bytes, file, place) = self.image_bytes(index)?;
                Image::decode(&bytes, color_space).map_err(|error| failed(error, &place, file.as_deref()))?
            }
            Look::Alpha(factor) => {
                let factor = f32::from_bits(factor);
                grey(&*self.image(index, Look::Color(ColorSpace::Srgb))?, |alpha| alpha * factor)
            }
            Look::Cutout(factor, cutoff) => {
                let (factor, cutoff) = (f32::from_bits(factor), f32::from_bits(cutoff));
                let opaque = |alpha: f32| if alpha * factor >= cutoff { 1.0 } else { 0.0 };
                grey(&*self.image(index, Look::Color(ColorSpace::Srgb))?, opaque)
            }
        };
        let image = Arc::new(image);
        self.images.insert((index, look), image.clone());
        Ok(image)
    }

    /// The encoded bytes of an image, and the file that they are from.
    fn image_bytes(&self, index: usize) -> Result<(Vec<u8>, Option<std::path::PathBuf>, Place)> {
        let images = &self.source.document.as_json().images;
        let image = images.get(index);
        let place = self.source.place("images", index, image.and_then(|image| image.name.as_deref()));
        match image.map(|image| (image.buffer_view, image.uri.as_deref())) {
            Some((Some(view), _)) => {
                let bytes = self.buffers.view(self.source, view.value())?.to_vec();
                Ok((bytes, None, place))
            }
            Some((None, Some(uri))) => {
                let (bytes, file) = uri::read(uri, self.directory, &place)?;
                Ok((bytes, file, place))
            }
            _ => Err(ImportError::Invalid { place, message: "it has neither `uri` nor `bufferView`".to_owned() }),
        }
    }
}

/// An image of the same size, from the alpha of another.
fn grey(image: &Image, value: impl Fn(f32) -> f32) -> Image {
    let pixels = (0..image.height()).flat_map(|y| (0..image.width()).map(move |x| (x, y)));
    let bytes = pixels.map(|(x, y)| {
        let byte = (value(image.alpha(x, y)).clamp(0.0, 1.0) * 255.0).round() as u8;
        [byte, byte, byte, 255]
    });
    rebuilt(image, Image::from_rgba8(image.width(), image.height(), bytes.collect(), ColorSpace::Linear))
}

/// An image times a colour.
fn tinted(image: &Image, factor: Rgb) -> Image {
    let pixels = (0..image.height()).flat_map(|y| (0..image.width()).map(move |x| (x, y)));
    let rgb = pixels.map(|(x, y)| (image.pixel(x, y) * factor).to_array()).collect();
    rebuilt(image, Image::from_rgb(image.width(), image.height(), rgb))
}

/// Images of the size of another that is valid, of finite pixels, are valid: the other one stands in should that ever be wrong.
fn rebuilt(image: &Image, new: std::result::Result<Image, TextureError>) -> Image {
    new.unwrap_or_else(|_| image.clone())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::transform_uv;

    /// The offset moves the origin; a quarter turn takes the u axis to where v decreases.
    #[test]
    fn coordinates_are_scaled_turned_and_moved() {
        let m = uv_transform([0.1, 0.2], std::f32::consts::FRAC_PI_2, [2.0, 3.0]);
        for (from, to) in [([0.0, 0.0], [0.1, 0.2]), ([1.0, 0.0], [0.1, -1.8]), ([0.0, 1.0], [3.1, 0.2])] {
            let [u, v] = transform_uv(&m, from);
            assert!((u - to[0]).abs() < 1e-5 && (v - to[1]).abs() < 1e-5, "{from:?}: {u} {v}");
        }
    }
}
