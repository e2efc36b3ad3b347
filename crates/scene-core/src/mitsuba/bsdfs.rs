//! Materials.

use super::error::Result;
use super::importer::Importer;
use super::object::{Object, Tag, Value};
use crate::material::{Distribution, Material, conductors, dielectrics};
use crate::reference::MaterialId;
use crate::texture::Texture;
use crate::traits::Rgb;

/// Deepest nesting of materials. Each level may have two children.
const DEEPEST: usize = 12;

impl Importer<'_> {
    /// The material of a shape: its `<bsdf>`, or the default.
    pub(super) fn shape_material(&mut self, shape: &Object) -> Result<MaterialId> {
        let document = self.document;
        let mut bsdfs = document.children(shape, &[Tag::Bsdf]);
        let index = bsdfs.next().map(|(_, index)| index);
        if let Some((second, _)) = bsdfs.next() {
            return Err(second.place.invalid("a shape has at most one bsdf"));
        }
        let medium = self.interior(shape, index);
        if let Some(&id) = self.material_ids.get(&(index, medium)) {
            return Ok(id);
        }
        let material = match index {
            Some(index) => self.bsdf(&document.objects[index], 0)?,
            None => Material::Diffuse { reflectance: 0.5.into() },
        };
        let material = match medium {
            Some(medium) => self.filled(material, &document.objects[medium])?,
            None => material,
        };
        self.materials.push(material);
        let id = MaterialId((self.materials.len() - 1) as u32);
        self.material_ids.insert((index, medium), id);
        self.used_bsdfs.extend(index);
        Ok(id)
    }

    /// The material of a `<bsdf>`, `depth` levels inside others.
    pub(super) fn bsdf(&mut self, object: &Object, depth: usize) -> Result<Material> {
        if depth > DEEPEST {
            return Err(object.place.invalid(format!("materials are nested more than {DEEPEST} deep")));
        }
        let material = match object.plugin.as_str() {
            "diffuse" => Material::Diffuse { reflectance: self.texture_or(object, "reflectance", 0.5)? },
            "conductor" => {
                let (eta, k) = self.conductor(object)?;
                Material::Conductor { eta, k, specular_reflectance: self.specular(object)? }
            }
            "roughconductor" => {
                let (eta, k) = self.conductor(object)?;
                let (distribution, alpha) = self.microfacets(object)?;
                let specular_reflectance = self.specular(object)?;
                Material::RoughConductor { eta, k, specular_reflectance, distribution, alpha }
            }
            "dielectric" | "thindielectric" | "roughdielectric" => self.dielectric(object)?,
            "plastic" | "roughplastic" => self.plastic(object)?,
            "phong" => Material::Phong {
                diffuse_reflectance: self.texture_or(object, "diffuse_reflectance", 0.5)?,
                specular_reflectance: self.texture_or(object, "specular_reflectance", 0.2)?,
                exponent: self.scalar(object, "exponent")?.unwrap_or(30.0),
            },
            "mask" => Material::Mask {
                opacity: self.texture_or(object, "opacity", 0.5)?,
                inner: self.only_inner(object, depth)?,
            },
            "null" => {
                let inner = Box::new(Material::Diffuse { reflectance: 0.0.into() });
                Material::Mask { opacity: 0.0.into(), inner }
            }
            "twosided" => self.twosided(object, depth)?,
            "bumpmap" => Material::BumpMap {
                height: self.inner_texture(object)?,
                scale: self.scalar(object, "scale")?.unwrap_or(1.0),
                inner: self.only_inner(object, depth)?,
            },
            "normalmap" => {
                Material::NormalMap { normals: self.inner_texture(object)?, inner: self.only_inner(object, depth)? }
            }
            _ => return Err(Self::unknown(object)),
        };
        // Names are for people.
        object.ignore(&["id"]);
        self.warn_unused(object);
        material.validate().map_err(|error| object.place.invalid(error.to_string()))?;
        Ok(material)
    }

    fn texture_or(&mut self, object: &Object, name: &str, default: f32) -> Result<Texture> {
        Ok(self.texture(object, name)?.unwrap_or_else(|| default.into()))
    }

    fn specular(&mut self, object: &Object) -> Result<Texture> {
        self.texture_or(object, "specular_reflectance", 1.0)
    }

    /// The materials inside another.
    fn inner(&mut self, object: &Object, depth: usize) -> Result<Vec<Material>> {
        let document = self.document;
        let mut inner = Vec::new();
        for (_, index) in document.children(object, &[Tag::Bsdf]).take(3) {
            inner.push(self.bsdf(&document.objects[index], depth + 1)?);
        }
        Ok(inner)
    }

    fn only_inner(&mut self, object: &Object, depth: usize) -> Result<Box<Material>> {
        let mut inner = self.inner(object, depth)?;
        match (inner.pop(), inner.is_empty()) {
            (Some(material), true) => Ok(Box::new(material)),
            _ => Err(object.place.invalid(format!("the bsdf `{}` needs exactly one bsdf inside", object.plugin))),
        }
    }

    fn twosided(&mut self, object: &Object, depth: usize) -> Result<Material> {
        let mut inner = self.inner(object, depth)?.into_iter();
        match (inner.next(), inner.next(), inner.next()) {
            (Some(front), back, None) => Ok(Material::TwoSided { front: Box::new(front), back: back.map(Box::new) }),
            _ => Err(object.place.invalid("the bsdf `twosided` needs one or two bsdfs inside")),
        }
    }

    /// The only texture inside, whatever its name.
    fn inner_texture(&mut self, object: &Object) -> Result<Texture> {
        let document = self.document;
        let mut textures = document.children(object, &[Tag::Texture]);
        let (Some((_, index)), None) = (textures.next(), textures.next()) else {
            let message = format!("the bsdf `{}` needs exactly one texture inside", object.plugin);
            return Err(object.place.invalid(message));
        };
        self.texture_object(&document.objects[index])
    }

    /// `eta` and `k`, given as such or by the name of a `material`.
    fn conductor(&mut self, object: &Object) -> Result<(Rgb, Rgb)> {
        let name = object.string("material")?.unwrap_or("none").to_owned();
        let (eta, k) = (self.color(object, "eta")?, self.color(object, "k")?);
        if name == "none" {
            // Without any of the three, this is a perfect mirror.
            return Ok((eta.unwrap_or(Rgb::ZERO), k.unwrap_or(Rgb::ONE)));
        }
        if eta.is_some() || k.is_some() {
            return Err(object.place.invalid("`material` and `eta`, `k` exclude each other"));
        }
        conductors::named(&name).ok_or_else(|| object.place.invalid(format!("no conductor is called `{name}`")))
    }

    /// Distribution and roughness along both tangents.
    fn microfacets(&mut self, object: &Object) -> Result<(Distribution, [f32; 2])> {
        let distribution = match object.string("distribution")? {
            None | Some("beckmann") => Distribution::Beckmann,
            Some("ggx") => Distribution::Ggx,
            Some(other) => return Err(object.place.unsupported(format!("the distribution `{other}`"))),
        };
        object.ignore(&["sample_visible"]);
        let isotropic = self.scalar(object, "alpha")?;
        let alpha = match (isotropic, self.scalar(object, "alpha_u")?, self.scalar(object, "alpha_v")?) {
            (None, Some(u), Some(v)) => [u, v],
            (alpha, None, None) => [alpha.unwrap_or(0.1); 2],
            _ => return Err(object.place.invalid("either `alpha`, or both `alpha_u` and `alpha_v`")),
        };
        Ok((distribution, alpha))
    }

    fn dielectric(&mut self, object: &Object) -> Result<Material> {
        let (int_ior, ext_ior) = (ior(object, "int_ior", 1.5046)?, ior(object, "ext_ior", 1.000_277)?);
        let specular_reflectance = self.specular(object)?;
        let specular_transmittance = self.texture_or(object, "specular_transmittance", 1.0)?;
        Ok(match object.plugin.as_str() {
            "dielectric" => Material::Dielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance },
            "thindielectric" => {
                Material::ThinDielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance }
            }
            _ => {
                let (distribution, alpha) = self.microfacets(object)?;
                Material::RoughDielectric {
                    int_ior,
                    ext_ior,
                    specular_reflectance,
                    specular_transmittance,
                    distribution,
                    alpha,
                }
            }
        })
    }

    fn plastic(&mut self, object: &Object) -> Result<Material> {
        let (int_ior, ext_ior) = (ior(object, "int_ior", 1.49)?, ior(object, "ext_ior", 1.000_277)?);
        let diffuse_reflectance = self.texture_or(object, "diffuse_reflectance", 0.5)?;
        let specular_reflectance = self.specular(object)?;
        let nonlinear = object.boolean("nonlinear")?.unwrap_or(false);
        if object.plugin == "plastic" {
            return Ok(Material::Plastic { int_ior, ext_ior, diffuse_reflectance, specular_reflectance, nonlinear });
        }
        let (distribution, [alpha, alpha_v]) = self.microfacets(object)?;
        if alpha != alpha_v {
            return Err(object.place.unsupported("an anisotropic `roughplastic`"));
        }
        Ok(Material::RoughPlastic {
            int_ior,
            ext_ior,
            diffuse_reflectance,
            specular_reflectance,
            nonlinear,
            distribution,
            alpha,
        })
    }
}

/// A number, or the name of a substance.
fn ior(object: &Object, name: &str, default: f32) -> Result<f32> {
    match object.property(name) {
        Some(property) if matches!(property.value, Value::String(_)) => {
            let substance = object.string(name)?.unwrap_or_default();
            let unknown = || property.place.invalid(format!("the index of refraction of `{substance}` is not known"));
            dielectrics::named(substance).ok_or_else(unknown)
        }
        _ => Ok(object.float(name)?.unwrap_or(default)),
    }
}
