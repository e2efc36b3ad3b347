//! Cameras, films, filters and samplers.

use std::f32::consts::PI;

use super::error::Result;
use super::importer::Importer;
use super::object::{Object, Tag};
use super::transforms;
use crate::film::{Filter, FilterError};
use crate::reference::CameraDescription;

/// Largest width and height of an image.
const LARGEST_SIZE: u32 = 1 << 16;

/// Everything that a sensor says.
pub(super) struct Camera {
    pub(super) description: CameraDescription,
    pub(super) filter: Filter,
    pub(super) samples_per_pixel: Option<u32>,
}

impl Importer<'_> {
    pub(super) fn camera(&mut self, object: &Object) -> Result<Camera> {
        let has_lens = match object.plugin.as_str() {
            "perspective" => false,
            "thinlens" => true,
            _ => return Err(Self::unknown(object)),
        };
        let (width, height, filter) = self.film(object)?;
        let fov_x = horizontal_fov(object, width as f32 / height as f32)?;
        for name in ["principal_point_offset_x", "principal_point_offset_y"] {
            if object.float(name)?.is_some_and(|offset| offset != 0.0) {
                return Err(object.place.unsupported(format!("a `{name}` other than zero")));
            }
        }
        let far_clip = object.float("far_clip")?.unwrap_or(1e4);
        object.ignore(&["near_clip", "shutter_open", "shutter_close"]);
        let focus_distance = object.float("focus_distance")?.unwrap_or(far_clip);
        let aperture_radius = if has_lens {
            object
                .float("aperture_radius")?
                .ok_or_else(|| object.place.invalid("a thin lens needs `aperture_radius`"))?
        } else {
            0.0
        };
        if aperture_radius < 0.0 || focus_distance <= 0.0 {
            let message =
                format!("an `aperture_radius` of {aperture_radius} and a `focus_distance` of {focus_distance}");
            return Err(object.place.invalid(message + " make no lens"));
        }
        let description = CameraDescription {
            to_world: camera_to_world(object)?,
            fov_x,
            aperture_radius,
            focus_distance,
            width,
            height,
        };
        let samples_per_pixel = self.sample_count(object)?;
        for (child, _) in self.document.children(object, &[Tag::Medium]) {
            self.warn_at(&child.place, "ignored: a medium");
        }
        self.warn_unused(object);
        Ok(Camera { description, filter, samples_per_pixel })
    }

    fn film(&mut self, sensor: &Object) -> Result<(u32, u32, Filter)> {
        let document = self.document;
        let Some((_, index)) = document.children(sensor, &[Tag::Film]).next() else {
            return Ok((768, 576, Filter::GAUSSIAN));
        };
        let film = &document.objects[index];
        match film.plugin.as_str() {
            "hdrfilm" => {}
            "ldrfilm" => self.warn_at(&film.place, "the film `ldrfilm` is read as `hdrfilm`"),
            _ => return Err(Self::unknown(film)),
        }
        let width = size(film, "width", 768)?;
        let height = size(film, "height", 576)?;
        let is_cropped = film.integer("crop_width")?.is_some_and(|w| w != i64::from(width))
            || film.integer("crop_height")?.is_some_and(|h| h != i64::from(height))
            || film.integer("crop_offset_x")?.is_some_and(|x| x != 0)
            || film.integer("crop_offset_y")?.is_some_and(|y| y != 0);
        if is_cropped {
            return Err(film.place.unsupported("a crop window"));
        }
        let filter = match document.children(film, &[Tag::Filter]).next() {
            Some((_, index)) => self.filter(&document.objects[index])?,
            None => Filter::GAUSSIAN,
        };
        film.ignore(&["file_format", "pixel_format", "component_format", "banner", "sample_border", "compensate"]);
        if film.plugin == "ldrfilm" {
            film.ignore(&["gamma", "filename"]);
        }
        self.warn_unused(film);
        Ok((width, height, filter))
    }

    fn filter(&mut self, object: &Object) -> Result<Filter> {
        let with = |name: &str, default: Filter, make: fn(f32) -> std::result::Result<Filter, FilterError>| {
            let Some(value) = object.float(name)? else { return Ok(default) };
            make(value).map_err(|error| object.place.invalid(error.to_string()))
        };
        let filter = match object.plugin.as_str() {
            "box" => Filter::BOX,
            "tent" => with("radius", Filter::TENT, Filter::tent)?,
            "gaussian" => with("stddev", Filter::GAUSSIAN, Filter::gaussian)?,
            "mitchell" | "catmullrom" | "lanczos" => {
                self.warn_at(&object.place, format!("the filter `{}` is replaced by `gaussian`", object.plugin));
                object.ignore_all();
                Filter::GAUSSIAN
            }
            _ => return Err(Self::unknown(object)),
        };
        self.warn_unused(object);
        Ok(filter)
    }

    fn sample_count(&mut self, sensor: &Object) -> Result<Option<u32>> {
        let document = self.document;
        let Some((_, index)) = document.children(sensor, &[Tag::Sampler]).next() else { return Ok(None) };
        let sampler = &document.objects[index];
        if !matches!(
            sampler.plugin.as_str(),
            "independent"
                | "stratified"
                | "multijitter"
                | "orthogonal"
                | "ldsampler"
                | "halton"
                | "hammersley"
                | "sobol"
        ) {
            return Err(Self::unknown(sampler));
        }
        let Some(count) = sampler.integer("sample_count")? else { return Ok(None) };
        sampler.ignore(&["seed", "jitter", "strength", "scramble"]);
        self.warn_unused(sampler);
        match u32::try_from(count) {
            Ok(count @ 1..) => Ok(Some(count)),
            _ => Err(sampler.place.invalid(format!("`sample_count` is {count}, which is no count of samples"))),
        }
    }
}

fn size(film: &Object, name: &str, default: u32) -> Result<u32> {
    let Some(value) = film.integer(name)? else { return Ok(default) };
    match u32::try_from(value) {
        Ok(size @ 1..=LARGEST_SIZE) => Ok(size),
        _ => Err(film.place.invalid(format!("`{name}` is {value}, not within 1 and {LARGEST_SIZE}"))),
    }
}

/// A rigid motion, or a reflection.
fn camera_to_world(object: &Object) -> Result<glam::Affine3A> {
    let to_world = transforms::invertible(&object.transform("to_world")?.unwrap_or_default());
    let to_world = to_world.ok_or_else(|| object.place.invalid("`to_world` has no inverse"))?;
    match transforms::similarity_scale(&to_world) {
        Some(scale) if (scale - 1.0).abs() < 1e-3 => Ok(to_world),
        _ => Err(object.place.invalid("the `to_world` of a sensor must not scale")),
    }
}

/// The horizontal angle of view in radians, of `fov` and `fov_axis`, or else of `focal_length`: that of a lens in
/// front of film of 36 x 24 mm, measured along the diagonal.
fn horizontal_fov(object: &Object, aspect: f32) -> Result<f32> {
    let diagonal = (1.0 + 1.0 / (aspect * aspect)).sqrt();
    let (half_tangent, per_half_width) = match (object.float("fov")?, object.string("focal_length")?) {
        (Some(_), Some(_)) => return Err(object.place.invalid("`fov` and `focal_length` exclude each other")),
        (Some(fov), None) => {
            if !(0.0 < fov && fov < 180.0) {
                return Err(object.place.invalid(format!("a `fov` of {fov} degrees is no angle of view")));
            }
            let axis = match object.string("fov_axis")?.unwrap_or("x") {
                "smaller" if aspect > 1.0 => "y",
                "larger" if aspect < 1.0 => "y",
                "smaller" | "larger" => "x",
                axis => axis,
            };
            let per_half_width = match axis {
                "x" => 1.0,
                "y" => 1.0 / aspect,
                "diagonal" => diagonal,
                other => return Err(object.place.invalid(format!("unknown `fov_axis` `{other}`"))),
            };
            ((fov.to_radians() / 2.0).tan(), per_half_width)
        }
        (None, text) => {
            object.ignore(&["fov_axis"]);
            let text = text.unwrap_or("50mm");
            let number = text.trim().trim_end_matches("mm").trim_end().parse::<f32>();
            let Some(length) = number.ok().filter(|&length| length > 0.0 && length.is_finite()) else {
                return Err(object.place.invalid(format!("`{text}` is no focal length such as `50mm`")));
            };
            (36f32.hypot(24.0) / 2.0 / length, diagonal)
        }
    };
    let fov_x = 2.0 * (half_tangent / per_half_width).atan();
    if fov_x > 0.0 && fov_x < PI { Ok(fov_x) } else { Err(object.place.invalid("the angle of view is degenerate")) }
}
