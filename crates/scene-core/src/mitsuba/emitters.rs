//! Light sources.

use glam::{DVec3, Vec3A};

use super::document::{Object, Tag};
use super::error::Result;
use super::importer::Importer;
use super::transforms;
use crate::reference::Light;
use crate::texture::ColorSpace;
use crate::traits::Rgb;

impl Importer<'_> {
    /// A light that is not part of a shape.
    pub(super) fn light(&mut self, object: &Object) -> Result<()> {
        // Weights of selection change the noise, not the picture.
        object.ignore(&["sampling_weight"]);
        let light = match object.plugin.as_str() {
            "point" => self.point(object)?,
            "spot" => self.spot(object)?,
            "directional" => self.directional(object)?,
            "constant" => Light::Constant { radiance: self.emission(object, "radiance")? },
            "envmap" => self.envmap(object)?,
            "area" => return Err(object.place.invalid("the emitter `area` belongs inside a shape")),
            _ => return Err(Self::unknown(object)),
        };
        for (child, _) in self.document.children(object, &[Tag::Medium]) {
            self.warn_at(&child.place, "ignored: a medium");
        }
        let is_environment = |light: &Light| matches!(light, Light::Constant { .. } | Light::Environment { .. });
        if is_environment(&light) && self.lights.iter().any(is_environment) {
            return Err(object.place.invalid("there is more than one environment emitter"));
        }
        self.warn_unused(object);
        self.lights.push(light);
        Ok(())
    }

    /// The radiance of the emitter inside a shape, if there is one.
    pub(super) fn area_light(&mut self, shape: &Object) -> Result<Option<Rgb>> {
        let document = self.document;
        let mut emitters = document.children(shape, &[Tag::Emitter]);
        let Some((_, index)) = emitters.next() else { return Ok(None) };
        if let Some((second, _)) = emitters.next() {
            return Err(second.place.invalid("a shape has at most one emitter"));
        }
        let emitter = &document.objects[index];
        match emitter.plugin.as_str() {
            "area" => {}
            "point" | "spot" | "directional" | "constant" | "envmap" => {
                return Err(emitter.place.unsupported(format!("an emitter `{}` inside a shape", emitter.plugin)));
            }
            _ => return Err(Self::unknown(emitter)),
        }
        emitter.ignore(&["sampling_weight"]);
        let radiance = self.emission(emitter, "radiance")?;
        self.warn_unused(emitter);
        Ok(Some(radiance))
    }

    /// A quantity of light; one if it is not given.
    fn emission(&mut self, object: &Object, name: &str) -> Result<Rgb> {
        let color = self.color(object, name)?.unwrap_or(Rgb::ONE);
        if color.0.min_element() < 0.0 {
            return Err(object.place.invalid(format!("`{name}` is negative")));
        }
        Ok(color)
    }

    fn point(&mut self, object: &Object) -> Result<Light> {
        let position = match (object.vector("position")?, object.transform("to_world")?) {
            (Some(_), Some(_)) => return Err(object.place.invalid("`position` and `to_world` exclude each other")),
            (Some(position), None) => position.into(),
            (None, to_world) => to_world.unwrap_or_default().translation,
        };
        Ok(Light::Point { position: single(object, position)?, intensity: self.emission(object, "intensity")? })
    }

    fn spot(&mut self, object: &Object) -> Result<Light> {
        let document = self.document;
        if let Some(texture) = document.child(object, "texture") {
            return Err(document.objects[texture].place.unsupported("a textured spot light"));
        }
        let to_world = object.transform("to_world")?.unwrap_or_default();
        let cutoff = object.float("cutoff_angle")?.unwrap_or(20.0);
        let beam_width = object.float("beam_width")?.unwrap_or(cutoff * 0.75);
        if !(0.0 < cutoff && cutoff <= 180.0 && 0.0 <= beam_width && beam_width <= cutoff) {
            let message =
                format!("a `beam_width` of {beam_width} and a `cutoff_angle` of {cutoff} degrees make no cone");
            return Err(object.place.invalid(message));
        }
        Ok(Light::Spot {
            position: single(object, to_world.translation)?,
            direction: direction(object, to_world.transform_vector3(DVec3::Z))?,
            intensity: self.emission(object, "intensity")?,
            beam_width: beam_width.to_radians(),
            cutoff: cutoff.to_radians(),
        })
    }

    fn directional(&mut self, object: &Object) -> Result<Light> {
        let towards = match (object.vector("direction")?, object.transform("to_world")?) {
            (Some(_), Some(_)) => return Err(object.place.invalid("`direction` and `to_world` exclude each other")),
            (Some(direction), None) => direction.into(),
            (None, to_world) => to_world.unwrap_or_default().transform_vector3(DVec3::Z),
        };
        let irradiance = self.emission(object, "irradiance")?;
        Ok(Light::Directional { direction: direction(object, towards)?, irradiance })
    }

    fn envmap(&mut self, object: &Object) -> Result<Light> {
        let (path, place) = self.filename(object)?;
        let scale = object.float("scale")?.unwrap_or(1.0);
        if scale < 0.0 {
            return Err(object.place.invalid(format!("`scale` is {scale}, which is negative")));
        }
        let to_world = transforms::invertible(&object.transform("to_world")?.unwrap_or_default());
        let to_world = to_world.ok_or_else(|| object.place.invalid("`to_world` has no inverse"))?;
        object.ignore(&["mis_compensation"]);
        Ok(Light::Environment { image: self.image(path, ColorSpace::Srgb, &place)?, scale, to_world })
    }
}

fn single(object: &Object, position: DVec3) -> Result<Vec3A> {
    let position = position.as_vec3a();
    if position.is_finite() { Ok(position) } else { Err(object.place.invalid("the position exceeds single precision")) }
}

fn direction(object: &Object, direction: DVec3) -> Result<Vec3A> {
    let unit = direction.try_normalize().ok_or_else(|| object.place.invalid("the direction has no length"))?;
    Ok(unit.as_vec3a())
}
