//! Textures, and parameters that are a number, a colour or a texture.

use std::sync::Arc;

use super::document::{Object, Tag, Value};
use super::error::{Place, Result};
use super::importer::Importer;
use super::spectra;
use crate::texture::{ColorSpace, Image, ImageTexture, Interpolation, Texture, Wrap};
use crate::traits::Rgb;

impl Importer<'_> {
    /// A parameter that may vary over the surface.
    pub(super) fn texture(&mut self, object: &Object, name: &str) -> Result<Option<Texture>> {
        if let Some(index) = self.document.child(object, name) {
            let document = self.document;
            return self.texture_object(&document.objects[index]).map(Some);
        }
        Ok(self.property_color(object, name)?.map(Texture::from))
    }

    /// A parameter that is the same everywhere.
    pub(super) fn color(&mut self, object: &Object, name: &str) -> Result<Option<Rgb>> {
        let Some(texture) = self.texture(object, name)? else { return Ok(None) };
        let (plugin, kind) = (&object.plugin, object.tag.name());
        let unsupported = || object.place.unsupported(format!("a textured `{name}` of the {kind} `{plugin}`"));
        texture.constant().map(Some).ok_or_else(unsupported)
    }

    /// A number, or the same number in all components.
    pub(super) fn scalar(&mut self, object: &Object, name: &str) -> Result<Option<f32>> {
        Ok(self.color(object, name)?.map(Rgb::mean))
    }

    fn property_color(&mut self, object: &Object, name: &str) -> Result<Option<Rgb>> {
        let Some(property) = object.property(name) else { return Ok(None) };
        let emits = object.tag == Tag::Emitter;
        let color = match &property.value {
            Value::Float(value) => Rgb::splat(*value as f32),
            Value::Integer(value) => Rgb::splat(*value as f32),
            Value::Rgb(rgb) => Rgb::from(*rgb),
            // Equal energy has the colour of white paper, but light of equal energy is reddish.
            Value::Uniform(value) if emits => {
                Rgb::from(spectra::emission_to_rgb(&[(0.0, 1.0), (1e4, 1.0)])) * *value as f32
            }
            Value::Uniform(value) => Rgb::splat(*value as f32),
            Value::Spectrum(pairs) => {
                self.warn_at(&property.place, format!("the spectrum `{name}` is reduced to RGB"));
                Rgb::from(if emits { spectra::emission_to_rgb(pairs) } else { spectra::reflectance_to_rgb(pairs) })
            }
            _ => return Err(property.place.invalid(format!("`{name}` must be a number, a colour or a texture"))),
        };
        if color.0.is_finite() {
            Ok(Some(color))
        } else {
            Err(property.place.invalid(format!("`{name}` exceeds single precision")))
        }
    }

    /// The texture of a `<texture>` or `<spectrum>`.
    pub(super) fn texture_object(&mut self, object: &Object) -> Result<Texture> {
        if !matches!(object.tag, Tag::Texture | Tag::Spectrum) {
            let kind = object.tag.name();
            return Err(object.place.invalid(format!("a {kind} stands where a texture is expected")));
        }
        let texture = match object.plugin.as_str() {
            "bitmap" => self.bitmap(object)?,
            "checkerboard" => Texture::Checkerboard {
                color0: self.color(object, "color0")?.unwrap_or(Rgb::splat(0.4)),
                color1: self.color(object, "color1")?.unwrap_or(Rgb::splat(0.2)),
                uv_transform: uv_transform(object)?,
            },
            "uniform" => self.color(object, "value")?.unwrap_or(Rgb::ONE).into(),
            "srgb" => self.color(object, "color")?.unwrap_or(Rgb::splat(0.5)).into(),
            // White, where colours are RGB.
            "d65" => {
                let color = self.color(object, "color")?.unwrap_or(Rgb::ONE);
                (color * object.float("scale")?.unwrap_or(1.0)).into()
            }
            _ => return Err(Self::unknown(object)),
        };
        self.warn_unused(object);
        Ok(texture)
    }

    fn bitmap(&mut self, object: &Object) -> Result<Texture> {
        let (path, place) = self.filename(object)?;
        let color_space = if object.boolean("raw")?.unwrap_or(false) { ColorSpace::Linear } else { ColorSpace::Srgb };
        let image = self.image(path, color_space, &place)?;
        let wrap = match object.string("wrap_mode")? {
            None | Some("repeat") => Wrap::Repeat,
            Some("clamp") => Wrap::Clamp,
            Some("mirror") => Wrap::Mirror,
            Some(other) => return Err(object.place.invalid(format!("unknown `wrap_mode` `{other}`"))),
        };
        let interpolation = match object.string("filter_type")? {
            None | Some("bilinear") => Interpolation::Bilinear,
            Some("nearest") => Interpolation::Nearest,
            // Of older versions; bilinear is what Mitsuba 3 has.
            Some("trilinear" | "ewa") => Interpolation::Bilinear,
            Some(other) => return Err(object.place.invalid(format!("unknown `filter_type` `{other}`"))),
        };
        object.ignore(&["format", "accel"]);
        let uv_transform = uv_transform(object)?;
        Ok(ImageTexture { wrap, interpolation, uv_transform, ..ImageTexture::new(image) }.into())
    }

    /// An image file, read once.
    pub(super) fn image(
        &mut self,
        path: std::path::PathBuf,
        color_space: ColorSpace,
        place: &Place,
    ) -> Result<Arc<Image>> {
        let key = (path, color_space);
        if let Some(image) = self.images.get(&key) {
            return Ok(image.clone());
        }
        let image = Image::open(&key.0, color_space).map_err(|error| place.data(&key.0, error.to_string()))?;
        let image = Arc::new(image);
        self.images.insert(key, image.clone());
        Ok(image)
    }
}

/// `to_uv`: the part of a transform that moves `(u, v)`.
fn uv_transform(object: &Object) -> Result<[f32; 6]> {
    let m = object.transform("to_uv")?.unwrap_or_default();
    let (x, y, t) = (m.matrix3.x_axis, m.matrix3.y_axis, m.translation);
    let rows = [x.x, y.x, t.x, x.y, y.y, t.y].map(|value| value as f32);
    if rows.iter().all(|value| value.is_finite()) {
        Ok(rows)
    } else {
        Err(object.place.invalid("`to_uv` exceeds single precision"))
    }
}
