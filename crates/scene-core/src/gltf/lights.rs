//! Punctual lights (`KHR_lights_punctual`).

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

use ::gltf::json::extensions::scene::khr_lights_punctual::{Light as Document, Type};
use ::gltf::json::validation::Checked;
use glam::Vec3A;

use super::error::Result;
use super::importer::Importer;
use super::nodes::Placed;
use crate::reference::Light;
use crate::traits::Rgb;

impl Importer<'_> {
    /// The lights that nodes place. They shine along -z of their nodes; a scale has no effect.
    pub(super) fn lights(&mut self, placed: &[Placed<'_>]) -> Result<()> {
        let root = self.source.document.as_json();
        let lights = root.extensions.as_ref().and_then(|all| all.khr_lights_punctual.as_ref());
        for node in placed {
            let document = root.nodes.get(node.node.index()).and_then(|node| node.extensions.as_ref());
            let named = document.and_then(|extensions| extensions.khr_lights_punctual.as_ref());
            let Some(index) = named.map(|named| named.light.value()) else { continue };
            if let Some(light) = lights.and_then(|all| all.lights.get(index)) {
                self.light(index, light, node)?;
            }
        }
        Ok(())
    }

    fn light(&mut self, index: usize, light: &Document, node: &Placed<'_>) -> Result<()> {
        let place = self.source.place("lights", index, light.name.as_deref());
        let value = Rgb::from(light.color) * light.intensity;
        if !value.to_array().iter().all(|x| *x >= 0.0 && x.is_finite()) {
            let message = format!("color {:?} times intensity {}", light.color, light.intensity);
            return Err(place.invalid(message + " is negative or not finite"));
        }
        if light.range.is_some() {
            self.warn(&place, "ignored: the range, beyond which it would not shine");
        }
        let position = node.to_world.translation;
        let direction = (node.to_world.matrix3 * Vec3A::NEG_Z).try_normalize();
        let direction = || direction.ok_or_else(|| node.place.invalid("its light points nowhere: its scale is zero"));
        let light = match &light.type_ {
            Checked::Valid(Type::Point) => Light::Point { position, intensity: value },
            Checked::Valid(Type::Directional) => Light::Directional { direction: direction()?, irradiance: value },
            Checked::Valid(Type::Spot) => {
                let cone = light.spot.as_ref();
                let beam_width = cone.map_or(0.0, |cone| cone.inner_cone_angle);
                let cutoff = cone.map_or(FRAC_PI_4, |cone| cone.outer_cone_angle);
                if !(beam_width >= 0.0 && beam_width < cutoff && cutoff <= FRAC_PI_2 + 1e-5) {
                    let message = format!("a spot from {beam_width} to {cutoff} radians");
                    return Err(place.invalid(message + " is none: 0 <= inner < outer <= pi / 2"));
                }
                Light::Spot { position, direction: direction()?, intensity: value, beam_width, cutoff }
            }
            Checked::Invalid => return Err(place.invalid("its type is unknown")),
        };
        self.add_light(light);
        Ok(())
    }
}
