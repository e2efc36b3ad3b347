//! Materials as data.

use super::MaterialError;
use crate::texture::Texture;
use crate::traits::{Rgb, Spectrum};

/// A distribution of microfacet normals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Distribution {
    /// Trowbridge and Reitz 1975, known as GGX: long tails.
    Ggx,
    /// Beckmann 1963: Gaussian slopes.
    #[default]
    Beckmann,
}

/// How a surface scatters light: what importers produce and builtin scenes are written in.
///
/// The models agree with the plugins of Mitsuba 3 of the same names. One-sided materials are black from behind.
/// [`compile`](Self::compile) prepares them for rendering.
///
/// # Example
/// ```
/// use scene_core::glam::Vec3A;
/// use scene_core::{TransportMode, material::Material};
/// let material = Material::TwoSided { front: Box::new(Material::diffuse(0.5)), back: None }.compile()?;
/// let bsdf = material.resolve([0.0, 0.0]);
/// let (value, pdf) = bsdf.eval_pdf(-Vec3A::Z, -Vec3A::Z, TransportMode::Radiance);
/// assert!((value[0] - 0.5 / std::f32::consts::PI).abs() < 1e-6 && (pdf - 1.0 / std::f32::consts::PI).abs() < 1e-6);
/// # Ok::<(), scene_core::material::MaterialError>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Material {
    /// Ideal diffuse reflection.
    Diffuse {
        /// Albedo.
        reflectance: Texture,
    },
    /// A smooth metal.
    Conductor {
        /// Real part of the index of refraction.
        eta: Rgb,
        /// Imaginary part.
        k: Rgb,
        /// Factor, 1 in nature.
        specular_reflectance: Texture,
    },
    /// A rough metal.
    RoughConductor {
        /// Real part of the index of refraction.
        eta: Rgb,
        /// Imaginary part.
        k: Rgb,
        /// Factor, 1 in nature.
        specular_reflectance: Texture,
        /// Of the microfacets.
        distribution: Distribution,
        /// Roughness along the tangent and the bitangent; at least 0.0001 is taken.
        alpha: [f32; 2],
    },
    /// A smooth interface of glass, water, ..
    Dielectric {
        /// Index of refraction inside, opposite to the normal.
        int_ior: f32,
        /// Index of refraction outside.
        ext_ior: f32,
        /// Factor, 1 in nature.
        specular_reflectance: Texture,
        /// Factor, 1 in nature.
        specular_transmittance: Texture,
    },
    /// A pane so thin that light passes without deflection.
    ThinDielectric {
        /// Index of refraction of the pane.
        int_ior: f32,
        /// Index of refraction around it.
        ext_ior: f32,
        /// Factor, 1 in nature.
        specular_reflectance: Texture,
        /// Factor, 1 in nature.
        specular_transmittance: Texture,
    },
    /// A rough interface of glass, ..
    RoughDielectric {
        /// Index of refraction inside, opposite to the normal.
        int_ior: f32,
        /// Index of refraction outside.
        ext_ior: f32,
        /// Factor, 1 in nature.
        specular_reflectance: Texture,
        /// Factor, 1 in nature.
        specular_transmittance: Texture,
        /// Of the microfacets.
        distribution: Distribution,
        /// Roughness along the tangent and the bitangent; at least 0.0001 is taken.
        alpha: [f32; 2],
    },
    /// A diffuse base under a smooth dielectric.
    Plastic {
        /// Index of refraction of the coat.
        int_ior: f32,
        /// Index of refraction outside.
        ext_ior: f32,
        /// Albedo of the base.
        diffuse_reflectance: Texture,
        /// Factor, 1 in nature.
        specular_reflectance: Texture,
        /// Whether colours saturate by multiple reflections inside.
        nonlinear: bool,
    },
    /// A diffuse base under a rough dielectric.
    RoughPlastic {
        /// Index of refraction of the coat.
        int_ior: f32,
        /// Index of refraction outside.
        ext_ior: f32,
        /// Albedo of the base.
        diffuse_reflectance: Texture,
        /// Factor, 1 in nature.
        specular_reflectance: Texture,
        /// Whether colours saturate by multiple reflections inside.
        nonlinear: bool,
        /// Of the microfacets.
        distribution: Distribution,
        /// Roughness; at least 0.0001 is taken.
        alpha: f32,
    },
    /// The modified Phong model of Lafortune and Willems 1994.
    Phong {
        /// Albedo of the diffuse lobe.
        diffuse_reflectance: Texture,
        /// Albedo of the glossy lobe at normal incidence.
        specular_reflectance: Texture,
        /// Exponent of the glossy lobe.
        exponent: f32,
    },
    /// The model of Cook and Torrance 1982: diffuse, and a glossy lobe with Beckmann's distribution and V-shaped grooves.
    CookTorrance {
        /// Albedo of the diffuse lobe.
        diffuse_reflectance: Texture,
        /// Factor of the glossy lobe.
        specular_reflectance: Texture,
        /// Index of refraction over the outside's, for Fresnel's reflectance.
        ior: f32,
        /// Root mean square slope.
        alpha: f32,
    },
    /// Lets light through, straight on, where it is not opaque.
    Mask {
        /// Opacity: the luminance, clamped to `[0, 1]`.
        opacity: Texture,
        /// What is there where it is opaque.
        inner: Box<Material>,
    },
    /// Makes a one-sided material scatter on both sides.
    TwoSided {
        /// The side of the normal.
        front: Box<Material>,
        /// The other side, if it differs.
        back: Option<Box<Material>>,
    },
    /// Tilts the shading normal by a height field.
    BumpMap {
        /// Height: the luminance, in units of length.
        height: Texture,
        /// Factor for it.
        scale: f32,
        /// What is tilted.
        inner: Box<Material>,
    },
    /// Replaces the shading normal.
    NormalMap {
        /// Normals in the shading frame, `(n + 1) / 2`; images must be read as [`Linear`](crate::texture::ColorSpace::Linear).
        normals: Texture,
        /// What is tilted.
        inner: Box<Material>,
    },
    /// Keeps only the values of a reflecting material and samples the hemisphere uniformly: a material about which a
    /// sampling technique knows nothing. Dirac components and transmission are lost.
    EvaluateOnly(Box<Material>),
}

impl Material {
    /// A diffuse material.
    pub fn diffuse(reflectance: impl Into<Texture>) -> Self {
        Self::Diffuse { reflectance: reflectance.into() }
    }

    /// This material on both sides.
    #[must_use]
    pub fn two_sided(self) -> Self {
        Self::TwoSided { front: Box::new(self), back: None }
    }

    /// What it is called in files and messages.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Diffuse { .. } => "diffuse",
            Self::Conductor { .. } => "conductor",
            Self::RoughConductor { .. } => "roughconductor",
            Self::Dielectric { .. } => "dielectric",
            Self::ThinDielectric { .. } => "thindielectric",
            Self::RoughDielectric { .. } => "roughdielectric",
            Self::Plastic { .. } => "plastic",
            Self::RoughPlastic { .. } => "roughplastic",
            Self::Phong { .. } => "phong",
            Self::CookTorrance { .. } => "cooktorrance",
            Self::Mask { .. } => "mask",
            Self::TwoSided { .. } => "twosided",
            Self::BumpMap { .. } => "bumpmap",
            Self::NormalMap { .. } => "normalmap",
            Self::EvaluateOnly(_) => "evaluate-only",
        }
    }

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
            Self::EvaluateOnly(inner) => inner.validate(),
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
