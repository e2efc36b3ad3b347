//! Ranges of parameters.

use super::{Material, MaterialError};
use crate::texture::Texture;
use crate::traits::{Rgb, Spectrum};

impl Material {
    /// Checks all parameters, of nested materials too. Images are not searched for values out of range.
    ///
    /// # Errors
    /// Names the material, the parameter and its value.
    pub fn validate(&self) -> Result<(), MaterialError> {
        let check = Check { material: self.name() };
        match self {
            Self::Diffuse { reflectance } => check.share("reflectance", reflectance),
            Self::Conductor { eta, k, specular_reflectance } => check.metal(*eta, *k, specular_reflectance),
            Self::RoughConductor { eta, k, specular_reflectance, alpha, .. } => {
                check.metal(*eta, *k, specular_reflectance)?;
                check.roughness(alpha)
            }
            Self::Dielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance }
            | Self::ThinDielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance } => {
                check.interface([*int_ior, *ext_ior], false, [specular_reflectance, specular_transmittance])
            }
            Self::RoughDielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance, alpha, .. } => {
                check.interface([*int_ior, *ext_ior], true, [specular_reflectance, specular_transmittance])?;
                check.roughness(alpha)
            }
            Self::Plastic { int_ior, ext_ior, diffuse_reflectance, specular_reflectance, .. } => {
                check.interface([*int_ior, *ext_ior], false, [specular_reflectance, specular_reflectance])?;
                check.share("diffuse_reflectance", diffuse_reflectance)
            }
            Self::RoughPlastic { int_ior, ext_ior, diffuse_reflectance, specular_reflectance, alpha, .. } => {
                check.interface([*int_ior, *ext_ior], true, [specular_reflectance, specular_reflectance])?;
                check.share("diffuse_reflectance", diffuse_reflectance)?;
                check.roughness(&[*alpha])
            }
            Self::Phong { diffuse_reflectance, specular_reflectance, exponent } => {
                check.lobes(diffuse_reflectance, specular_reflectance)?;
                check.number("exponent", *exponent, "finite and at least 0", |x| x >= 0.0)
            }
            Self::CookTorrance { diffuse_reflectance, specular_reflectance, ior, alpha } => {
                check.lobes(diffuse_reflectance, specular_reflectance)?;
                check.number("ior", *ior, "finite and positive", |x| x > 0.0)?;
                check.roughness(&[*alpha])
            }
            Self::MetallicRoughness {
                base_color,
                metallic_roughness,
                metallic,
                roughness,
                ior,
                specular,
                specular_color,
            } => {
                check.share("base_color", base_color)?;
                check.share("metallic_roughness", metallic_roughness)?;
                for (name, value) in [("metallic", metallic), ("roughness", roughness), ("specular", specular)] {
                    check.number(name, *value, "in [0, 1]", |x| (0.0..=1.0).contains(&x))?;
                }
                check.number("ior", *ior, "finite and at least 1", |x| x >= 1.0)?;
                check.colour("specular_color", *specular_color, "finite and at least 0", |x| x >= 0.0)
            }
            Self::Mask { opacity, inner } => {
                check.finite("opacity", opacity)?;
                inner.validate()
            }
            Self::TwoSided { front, back } => {
                front.validate()?;
                back.as_ref().map_or(Ok(()), |back| back.validate())
            }
            Self::BumpMap { height, scale, inner } => {
                check.finite("height", height)?;
                check.number("scale", *scale, "finite", |_| true)?;
                inner.validate()
            }
            Self::NormalMap { normals, inner } => {
                check.finite("normals", normals)?;
                inner.validate()
            }
            Self::TangentNormalMap { normals, scale, inner } => {
                check.finite("normals", normals)?;
                check.number("scale", *scale, "finite", |_| true)?;
                inner.validate()
            }
            // Media are valid by construction.
            Self::EvaluateOnly(inner) | Self::Filled { boundary: inner, .. } => inner.validate(),
        }
    }
}

/// Checks the parameters of one material.
struct Check {
    material: &'static str,
}

impl Check {
    fn number(
        &self,
        parameter: &'static str,
        value: f32,
        expected: &'static str,
        valid: impl Fn(f32) -> bool,
    ) -> Result<(), MaterialError> {
        if value.is_finite() && valid(value) {
            return Ok(());
        }
        Err(MaterialError::Parameter { material: self.material, parameter, value, expected })
    }

    fn colour(
        &self,
        parameter: &'static str,
        value: Rgb,
        expected: &'static str,
        valid: impl Fn(f32) -> bool + Copy,
    ) -> Result<(), MaterialError> {
        value.to_array().into_iter().try_for_each(|c| self.number(parameter, c, expected, valid))
    }

    /// The constants of a texture; images are finite by construction.
    fn each(
        &self,
        parameter: &'static str,
        texture: &Texture,
        expected: &'static str,
        valid: impl Fn(f32) -> bool + Copy,
    ) -> Result<(), MaterialError> {
        match texture {
            Texture::Constant(value) => self.colour(parameter, *value, expected, valid),
            Texture::Checkerboard { color0, color1, .. } => {
                self.colour(parameter, *color0, expected, valid)?;
                self.colour(parameter, *color1, expected, valid)
            }
            Texture::Image(image) => self.number(parameter, image.scale, "of finite scale", |_| true),
        }
    }

    fn finite(&self, parameter: &'static str, texture: &Texture) -> Result<(), MaterialError> {
        self.each(parameter, texture, "finite", |_| true)
    }

    fn share(&self, parameter: &'static str, texture: &Texture) -> Result<(), MaterialError> {
        self.each(parameter, texture, "in [0, 1]", |x| (0.0..=1.0).contains(&x))
    }

    fn metal(&self, eta: Rgb, k: Rgb, specular: &Texture) -> Result<(), MaterialError> {
        self.colour("eta", eta, "finite and at least 0", |x| x >= 0.0)?;
        self.colour("k", k, "finite and at least 0", |x| x >= 0.0)?;
        self.share("specular_reflectance", specular)
    }

    fn roughness(&self, alpha: &[f32]) -> Result<(), MaterialError> {
        alpha.iter().try_for_each(|a| self.number("alpha", *a, "finite and at least 0", |x| x >= 0.0))
    }

    fn interface(&self, ior: [f32; 2], must_differ: bool, tint: [&Texture; 2]) -> Result<(), MaterialError> {
        self.number("int_ior", ior[0], "finite and positive", |x| x > 0.0)?;
        self.number("ext_ior", ior[1], "finite and positive", |x| x > 0.0)?;
        if must_differ && ior[0] == ior[1] {
            return Err(MaterialError::EqualIndices { material: self.material, value: ior[0] });
        }
        self.share("specular_reflectance", tint[0])?;
        self.share("specular_transmittance", tint[1])
    }

    fn lobes(&self, diffuse: &Texture, specular: &Texture) -> Result<(), MaterialError> {
        self.share("diffuse_reflectance", diffuse)?;
        self.share("specular_reflectance", specular)?;
        let sum = diffuse.constant().zip(specular.constant()).map(|(d, s)| (d + s).max_component());
        match sum {
            Some(value) if value > 1.0 + 1e-5 => Err(MaterialError::Energy { material: self.material, value }),
            _ => Ok(()),
        }
    }
}
