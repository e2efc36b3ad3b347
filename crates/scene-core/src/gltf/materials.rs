//! Materials: the metallic-roughness model and what is wrapped around it.

use ::gltf::Material as Document;
use ::gltf::material::AlphaMode;

use super::emission::{self, Emission};
use super::error::{Place, Result};
use super::importer::Importer;
use super::meshes::Primitive;
use super::textures::{Look, TextureRef};
use crate::material::Material;
use crate::texture::{ColorSpace, Texture};
use crate::traits::Rgb;

/// Index of refraction that stands for `KHR_materials_ior`'s zero: reflects everything.
const MIRROR_IOR: f32 = 1e4;

/// Parameters that both models share.
pub(super) struct Pbr {
    pub(super) base_color: Texture,
    pub(super) metallic_roughness: Texture,
    pub(super) metallic: f32,
    pub(super) roughness: f32,
    pub(super) ior: f32,
}

impl<'s> Importer<'s> {
    /// The set of texture coordinates that a material's first texture uses. Meshes have one here.
    pub(super) fn texture_coordinates_of(&self, material: &Document<'s>) -> Option<u32> {
        textures_of(material).first().map(|named| named.set)
    }

    /// A material, and what it emits. `users` are the surfaces that have it.
    pub(super) fn material(
        &mut self,
        index: Option<usize>,
        users: &[&Primitive],
    ) -> Result<(Material, Option<Emission>)> {
        let Some(material) = index.and_then(|index| self.source.document.materials().nth(index)) else {
            // Section 3.7.2.1: a material of all defaults.
            return Ok((opaque(Pbr::default(), [1.0; 4]).two_sided(), None));
        };
        let place = self.source.place("materials", index.unwrap_or_default(), material.name());
        let sets: Vec<u32> = textures_of(&material).iter().map(|named| named.set).collect();
        if let Some(other) = sets.iter().find(|&&set| set != sets[0]) {
            self.warn(&place, format!("TEXCOORD_{} is taken for all textures, for TEXCOORD_{other} too", sets[0]));
        }
        let surface = self.surface(&material, users, &place)?;
        let emission = self.emission(&material, &place)?;
        if emission.is_some() && material.double_sided() {
            self.warn(&place, "emits on its front only, although it has two sides");
        }
        let surface = self.tilted(&material, surface, &place)?;
        Ok((self.masked(&material, surface, &place)?, emission))
    }

    /// Glass if it is transmissive, else the metallic-roughness model. That has two sides, whatever `doubleSided` says: whoever culls
    /// sees through the back of a wall, but light must not, and black would swallow it.
    fn surface(&mut self, material: &Document<'s>, users: &[&Primitive], place: &Place) -> Result<Material> {
        let pbr = self.pbr(material, place)?;
        if let Some(glass) = self.transmissive(material, &pbr, users, place)? {
            return Ok(glass);
        }
        let specular = material.specular();
        let textured =
            |s: &::gltf::material::Specular<'_>| s.specular_texture().is_some() || s.specular_color_texture().is_some();
        if specular.as_ref().is_some_and(textured) {
            self.warn(place, "ignored: the textures of KHR_materials_specular");
        }
        let [r, g, b] = specular.as_ref().map_or([1.0; 3], |specular| specular.specular_color_factor());
        let weight = specular.as_ref().map_or(1.0, |specular| specular.specular_factor());
        Ok(opaque(pbr, [r, g, b, weight]).two_sided())
    }

    fn pbr(&mut self, material: &Document<'s>, place: &Place) -> Result<Pbr> {
        let pbr = material.pbr_metallic_roughness();
        let [r, g, b, _] = pbr.base_color_factor();
        let (metallic, roughness) = (pbr.metallic_factor(), pbr.roughness_factor());
        let ior = material.ior().unwrap_or(1.5);
        for (name, value) in [
            ("baseColorFactor", r),
            ("baseColorFactor", g),
            ("baseColorFactor", b),
            ("metallicFactor", metallic),
            ("roughnessFactor", roughness),
        ] {
            if !(0.0..=1.0).contains(&value) {
                return Err(place.invalid(format!("its {name} is {value}, but must be in [0, 1]")));
            }
        }
        if !(ior == 0.0 || (ior >= 1.0 && ior.is_finite())) {
            return Err(place.invalid(format!("its ior is {ior}, but must be 0 or at least 1")));
        }
        let factor = Rgb::new(r, g, b);
        let base_color = match pbr.base_color_texture() {
            Some(info) => self.texture(&TextureRef::new(&info), ColorSpace::Srgb, factor, place)?,
            None => factor.into(),
        };
        let metallic_roughness = match pbr.metallic_roughness_texture() {
            Some(info) => self.texture(&TextureRef::new(&info), ColorSpace::Linear, Rgb::ONE, place)?,
            None => 1.0.into(),
        };
        let ior = if ior == 0.0 { MIRROR_IOR } else { ior };
        Ok(Pbr { base_color, metallic_roughness, metallic, roughness, ior })
    }

    fn emission(&mut self, material: &Document<'s>, place: &Place) -> Result<Option<Emission>> {
        let strength = material.emissive_strength().unwrap_or(1.0);
        let factor = Rgb::from(material.emissive_factor()) * strength;
        if !factor.to_array().iter().all(|x| *x >= 0.0 && x.is_finite()) {
            return Err(
                place.invalid(format!("it emits {:?}, but light must be finite and not negative", factor.to_array()))
            );
        }
        if factor == Rgb::ZERO {
            return Ok(None);
        }
        let texture = match material.emissive_texture() {
            Some(info) => Some(self.texture(&TextureRef::new(&info), ColorSpace::Srgb, Rgb::ONE, place)?),
            None => None,
        };
        if texture.is_some() {
            self.warn(place, "its emissive texture becomes a constant for each triangle");
        }
        Ok(Some(Emission { factor, texture }))
    }

    /// With its normal texture.
    fn tilted(&mut self, material: &Document<'s>, inner: Material, place: &Place) -> Result<Material> {
        let Some(info) = material.normal_texture() else { return Ok(inner) };
        let normals = self.texture(&TextureRef::of_normals(&info), ColorSpace::Linear, Rgb::ONE, place)?;
        let scale = info.scale();
        if !scale.is_finite() {
            return Err(place.invalid(format!("the scale of its normal texture is {scale}")));
        }
        Ok(Material::TangentNormalMap { normals, scale, inner: Box::new(inner) })
    }

    /// With its alpha: as opacity, or cut off to opaque and transparent.
    fn masked(&mut self, material: &Document<'s>, inner: Material, place: &Place) -> Result<Material> {
        let pbr = material.pbr_metallic_roughness();
        let factor = pbr.base_color_factor()[3];
        let cutoff = material.alpha_cutoff().unwrap_or(0.5);
        if !(factor.is_finite() && cutoff.is_finite()) {
            return Err(place.invalid(format!("its alpha is {factor} and the cutoff {cutoff}")));
        }
        let (look, constant) = match material.alpha_mode() {
            AlphaMode::Opaque => return Ok(inner),
            AlphaMode::Blend => (Look::Alpha(factor.to_bits()), factor.clamp(0.0, 1.0)),
            AlphaMode::Mask => {
                (Look::Cutout(factor.to_bits(), cutoff.to_bits()), if factor >= cutoff { 1.0 } else { 0.0 })
            }
        };
        let opacity = match pbr.base_color_texture() {
            Some(info) => self.image_texture(&TextureRef::new(&info), look, place)?.into(),
            None if constant == 1.0 => return Ok(inner),
            None => Texture::from(constant),
        };
        // Much of what could be transparent is opaque everywhere, and cheaper without a mask.
        let is_opaque = opacity.mean() == Rgb::ONE;
        Ok(if is_opaque { inner } else { Material::Mask { opacity, inner: Box::new(inner) } })
    }

    /// The mean of a parameter over the surfaces that have it, where only a constant will do.
    pub(super) fn averaged(&mut self, texture: &Texture, users: &[&Primitive], what: &str, place: &Place) -> Rgb {
        if texture.constant().is_none() {
            self.warn(place, format!("the texture of its {what} becomes its mean"));
        }
        emission::mean(users, texture)
    }
}

impl Default for Pbr {
    fn default() -> Self {
        Self { base_color: 1.0.into(), metallic_roughness: 1.0.into(), metallic: 1.0, roughness: 1.0, ior: 1.5 }
    }
}

/// The metallic-roughness model; `specular` is the colour and the weight of the dielectric's reflection.
fn opaque(pbr: Pbr, [r, g, b, weight]: [f32; 4]) -> Material {
    let Pbr { base_color, metallic_roughness, metallic, roughness, ior } = pbr;
    let (specular, specular_color) = (weight, Rgb::new(r, g, b));
    Material::MetallicRoughness { base_color, metallic_roughness, metallic, roughness, ior, specular, specular_color }
}

/// The textures of a material that are looked up.
fn textures_of<'s>(material: &Document<'s>) -> Vec<TextureRef<'s>> {
    let pbr = material.pbr_metallic_roughness();
    let transmission = material.transmission().and_then(|transmission| transmission.transmission_texture());
    let first = [pbr.base_color_texture(), pbr.metallic_roughness_texture()];
    let last = [material.emissive_texture(), transmission];
    let normals = material.normal_texture().map(|info| TextureRef::of_normals(&info));
    let named =
        |infos: [Option<::gltf::texture::Info<'s>>; 2]| infos.into_iter().flatten().map(|info| TextureRef::new(&info));
    named(first).chain(normals).chain(named(last)).collect()
}
