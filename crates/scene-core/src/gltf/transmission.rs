//! Transmissive materials: panes, and solid glass with what it absorbs.

use ::gltf::Material as Document;

use super::error::{Place, Result};
use super::importer::Importer;
use super::materials::Pbr;
use super::meshes::Primitive;
use super::textures::TextureRef;
use crate::material::{Distribution, Material};
use crate::medium::Medium;
use crate::texture::ColorSpace;
use crate::traits::Rgb;

/// From this share of transmission on a material is glass.
const GLASS: f32 = 0.5;

/// Below it microfacets scatter less than a pixel's width: the interface is taken as smooth.
const SMOOTH_ALPHA: f32 = 1e-3;

/// Smallest component of the attenuation's colour: black would be absorbed in no distance.
const DARKEST: f32 = 1e-6;

impl<'s> Importer<'s> {
    /// The dielectric that a material of `KHR_materials_transmission` is; nothing if it is opaque.
    ///
    /// Without thickness a surface is a pane. With it (`KHR_materials_volume`) it bounds a solid, which absorbs by
    /// `T(x) = c^(x / d)`, `c` being the attenuation's colour and `d` its distance: `sigma_a = -ln(c) / d`.
    pub(super) fn transmissive(
        &mut self,
        material: &Document<'s>,
        pbr: &Pbr,
        users: &[&Primitive],
        place: &Place,
    ) -> Result<Option<Material>> {
        let Some(transmission) = material.transmission() else { return Ok(None) };
        let mut share = transmission.transmission_factor();
        if share > 0.0
            && let Some(info) = transmission.transmission_texture()
        {
            let texture = self.texture(&TextureRef::new(&info), ColorSpace::Linear, Rgb::ONE, place)?;
            share *= self.averaged(&texture, users, "transmission", place)[0];
        }
        if !(0.0..=1.0).contains(&share) {
            return Err(place.invalid(format!("it transmits {share}, but that must be in [0, 1]")));
        }
        let surface = if share > 0.0 && (pbr.metallic > 0.0 || pbr.roughness > 0.0) {
            self.averaged(&pbr.metallic_roughness, users, "roughness and metalness", place)
        } else {
            Rgb::ZERO
        };
        // Metals transmit nothing.
        let share = share * (1.0 - surface[2] * pbr.metallic);
        if share > 0.0 && share < 1.0 - 1e-2 {
            let taken = if share < GLASS { "opaque" } else { "clear" };
            self.warn(place, format!("transmits only a part of the light, and is taken as {taken}"));
        }
        if share < GLASS {
            return Ok(None);
        }
        let roughness = (surface[1] * pbr.roughness).clamp(0.0, 1.0);
        let volume = material.volume().filter(|volume| volume.thickness_factor() > 0.0);
        let Some(volume) = volume else { return Ok(Some(self.pane(pbr, roughness, place))) };
        let solid = solid(pbr, roughness * roughness);
        let (color, distance) = (volume.attenuation_color(), volume.attenuation_distance());
        if distance.is_nan() || distance <= 0.0 || !color.iter().all(|c| (0.0..=1.0).contains(c)) {
            let message = format!("attenuation to {color:?} over a distance of {distance} is impossible");
            return Err(place.invalid(message));
        }
        let absorption = color.map(|c| -c.max(DARKEST).ln().min(0.0) / distance);
        if absorption == [0.0; 3] {
            return Ok(Some(solid));
        }
        let medium = Medium::new(Rgb::from(absorption), Rgb::ZERO, 0.0);
        Ok(Some(solid.filled_with(medium.map_err(|error| place.invalid(error.to_string()))?)))
    }

    fn pane(&mut self, pbr: &Pbr, roughness: f32, place: &Place) -> Material {
        if roughness * roughness >= SMOOTH_ALPHA {
            self.warn(place, "its roughness is ignored: without thickness it is a smooth pane");
        }
        Material::ThinDielectric {
            int_ior: pbr.ior,
            ext_ior: 1.0,
            specular_reflectance: 1.0.into(),
            specular_transmittance: pbr.base_color.clone(),
        }
    }
}

fn solid(pbr: &Pbr, alpha: f32) -> Material {
    let (int_ior, ext_ior) = (pbr.ior, 1.0);
    let (specular_reflectance, specular_transmittance) = (1.0.into(), pbr.base_color.clone());
    // A rough interface of equal indices has no half vectors.
    if alpha < SMOOTH_ALPHA || int_ior == ext_ior {
        return Material::Dielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance };
    }
    let (distribution, alpha) = (Distribution::Ggx, [alpha; 2]);
    Material::RoughDielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance, distribution, alpha }
}
