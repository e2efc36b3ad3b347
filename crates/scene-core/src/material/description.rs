//! Materials as data.

use crate::medium::Medium;
use crate::texture::Texture;
use crate::traits::Rgb;

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
/// The models agree with the plugins of Mitsuba 3 of the same names, where it has them. One-sided materials are black from behind.
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
    /// The metallic-roughness model of glTF 2.0: a mixture of a rough metal and of a rough dielectric coat over a diffuse base.
    MetallicRoughness {
        /// Albedo of the base; reflectance of the metal at normal incidence.
        base_color: Texture,
        /// Roughness in the green and metalness in the blue component; images must be read as [`Linear`](crate::texture::ColorSpace::Linear).
        metallic_roughness: Texture,
        /// Factor for the metalness.
        metallic: f32,
        /// Factor for the roughness, whose square is the microfacets' alpha; at least 0.0001 is taken for that.
        roughness: f32,
        /// Index of refraction of the dielectric, 1.5 without the extension `KHR_materials_ior`.
        ior: f32,
        /// Weight of the dielectric's reflection, 1 without the extension `KHR_materials_specular`.
        specular: f32,
        /// Factor for the dielectric's reflectance at normal incidence, 1 without that extension.
        specular_color: Rgb,
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
    /// Replaces the shading normal, as glTF means it: x lies along `dp/du`, y points to where `v` decreases, which on mirrored texture
    /// coordinates is the other side of the frame than [`NormalMap`](Self::NormalMap)'s.
    TangentNormalMap {
        /// Normals, `(n + 1) / 2`; images must be read as [`Linear`](crate::texture::ColorSpace::Linear).
        normals: Texture,
        /// Factor for x and y.
        scale: f32,
        /// What is tilted.
        inner: Box<Material>,
    },
    /// Keeps only the values of a reflecting material and samples the hemisphere uniformly: a material about which a
    /// sampling technique knows nothing. Dirac components and transmission are lost.
    EvaluateOnly(Box<Material>),
    /// The boundary of a participating medium: a smooth or rough dielectric, on a closed surface.
    Filled {
        /// What is inside, opposite to the normal.
        medium: Medium<Rgb>,
        /// The interface.
        boundary: Box<Material>,
    },
}

impl Material {
    /// A diffuse material.
    pub fn diffuse(reflectance: impl Into<Texture>) -> Self {
        Self::Diffuse { reflectance: reflectance.into() }
    }

    /// Clear glass (or water, or diamond) of this index of refraction, in a vacuum: a smooth [`Dielectric`](Self::Dielectric) that takes no light.
    pub fn glass(int_ior: f32) -> Self {
        let (specular_reflectance, specular_transmittance) = (1.0.into(), 1.0.into());
        Self::Dielectric { int_ior, ext_ior: 1.0, specular_reflectance, specular_transmittance }
    }

    /// This material on both sides.
    #[must_use]
    pub fn two_sided(self) -> Self {
        Self::TwoSided { front: Box::new(self), back: None }
    }

    /// This dielectric as the boundary of `medium`.
    #[must_use]
    pub fn filled_with(self, medium: Medium<Rgb>) -> Self {
        Self::Filled { medium, boundary: Box::new(self) }
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
            Self::MetallicRoughness { .. } => "metallicroughness",
            Self::Mask { .. } => "mask",
            Self::TwoSided { .. } => "twosided",
            Self::BumpMap { .. } => "bumpmap",
            Self::NormalMap { .. } => "normalmap",
            Self::TangentNormalMap { .. } => "tangentnormalmap",
            Self::EvaluateOnly(_) => "evaluate-only",
            Self::Filled { .. } => "filled",
        }
    }
}
