//! From materials as data to materials for rendering: validated, flattened, with their tables.

use glam::Vec3A;

use super::conductor::{Conductor, RoughConductor};
use super::cook_torrance::CookTorrance;
use super::dielectric::{Interface, RoughDielectric};
use super::fresnel::ConductorFresnel;
use super::metallic_roughness::MetallicRoughness;
use super::microfacet::Microfacet;
use super::normals::{NormalModifier, ShadingInput};
use super::phong::Phong;
use super::plastic::Plastic;
use super::rough_plastic::RoughPlastic;
use super::surface::Surface;
use super::{Bsdf, Material, MaterialError};
use crate::frame::Frame;
use crate::medium::Medium;
use crate::texture::Texture;
use crate::traits::{Rgb, Sharpness, Spectrum};

/// A material that is ready for rendering. See [`Material::compile`].
#[derive(Clone, Debug)]
pub struct CompiledMaterial {
    front: Surface,
    back: Option<Surface>,
    two_sided: bool,
    evaluate_only: bool,
    /// Opacities of nested masks, multiplied.
    opacity: Vec<Texture>,
    /// From the outermost to the innermost.
    normals: Vec<NormalModifier>,
    needs_tangents: bool,
}

impl Material {
    /// Validates the material, computes its tables and flattens its wrappers, so that evaluation neither recurses nor
    /// allocates.
    ///
    /// Wrappers commute here, with these conventions: bump and normal maps tilt the frame once for both sides (a bump seen
    /// from behind is a dent); masks pass light whatever else is wrapped around them.
    ///
    /// # Errors
    /// As [`validate`](Self::validate); and if a transmissive material is inside a two-sided one, two different sides
    /// have wrappers of their own (wrap the two-sided material instead), or a medium is inside anything but one smooth
    /// or rough dielectric.
    pub fn compile(self) -> Result<CompiledMaterial, MaterialError> {
        self.validate()?;
        Wrappers::default().flatten(self)
    }
}

/// What has been unwrapped so far.
#[derive(Default)]
struct Wrappers {
    two_sided: bool,
    evaluate_only: bool,
    opacity: Vec<Texture>,
    normals: Vec<NormalModifier>,
    medium: Option<Medium<Rgb>>,
}

impl Wrappers {
    fn flatten(mut self, mut material: Material) -> Result<CompiledMaterial, MaterialError> {
        loop {
            material = match material {
                Material::Mask { opacity, inner } => {
                    self.opacity.push(opacity);
                    *inner
                }
                Material::BumpMap { height, scale, inner } => {
                    self.normals.push(NormalModifier::Bump { height, scale });
                    *inner
                }
                Material::NormalMap { normals, inner } => {
                    self.normals.push(NormalModifier::Map { normals });
                    *inner
                }
                Material::TangentNormalMap { normals, scale, inner } => {
                    self.normals.push(NormalModifier::TangentMap { normals, scale });
                    *inner
                }
                Material::EvaluateOnly(inner) => {
                    self.evaluate_only = true;
                    *inner
                }
                Material::TwoSided { front, back: None } => {
                    self.two_sided = true;
                    *front
                }
                Material::Filled { boundary, .. } if self.medium.is_some() => {
                    return Err(nesting("filled", boundary.name(), ": it holds a medium already"));
                }
                Material::Filled { medium, boundary } => {
                    self.medium = Some(medium);
                    *boundary
                }
                Material::TwoSided { front, back: Some(_) } if self.medium.is_some() => {
                    return Err(nesting("filled", front.name(), " of two sides: only dielectrics can hold a medium"));
                }
                Material::TwoSided { front, back: Some(back) } => {
                    let (front, back) = (bare_side(*front)?, bare_side(*back)?);
                    self.two_sided = true;
                    return Ok(self.finish(front, Some(back)));
                }
                bare => {
                    let name = bare.name();
                    let mut front = surface(bare)?;
                    if let Some(medium) = self.medium
                        && !front.fill(medium)
                    {
                        return Err(nesting("filled", name, ": only smooth and rough dielectrics can hold a medium"));
                    }
                    if self.two_sided && front.is_transmissive() {
                        return Err(nesting("twosided", name, ": it is transmissive"));
                    }
                    return Ok(self.finish(front, None));
                }
            };
        }
    }

    fn finish(self, front: Surface, back: Option<Surface>) -> CompiledMaterial {
        let Self { two_sided, evaluate_only, opacity, normals, medium: _ } = self;
        let is_anisotropic = front.is_anisotropic() || back.as_ref().is_some_and(Surface::is_anisotropic);
        let needs_tangents = is_anisotropic || !normals.is_empty();
        CompiledMaterial { front, back, two_sided, evaluate_only, opacity, normals, needs_tangents }
    }
}

fn nesting(outer: &'static str, inner: &'static str, reason: &'static str) -> MaterialError {
    MaterialError::Nesting { outer, inner, reason }
}

/// One of two different sides, which must be without wrappers.
fn bare_side(material: Material) -> Result<Surface, MaterialError> {
    let name = material.name();
    let side = surface(material)?;
    if side.is_transmissive() { Err(nesting("twosided", name, ": it is transmissive")) } else { Ok(side) }
}

fn surface(material: Material) -> Result<Surface, MaterialError> {
    Ok(match material {
        Material::Diffuse { reflectance } => Surface::Diffuse(reflectance),
        Material::Conductor { eta, k, specular_reflectance } => {
            Surface::Conductor(Box::new(Conductor { fresnel: ConductorFresnel::new(eta, k), specular_reflectance }))
        }
        Material::RoughConductor { eta, k, specular_reflectance, distribution, alpha } => {
            let microfacet = Microfacet::new(distribution, alpha);
            let fresnel = ConductorFresnel::new(eta, k);
            Surface::RoughConductor(Box::new(RoughConductor { fresnel, specular_reflectance, microfacet }))
        }
        Material::Dielectric { int_ior, ext_ior, specular_reflectance: r, specular_transmittance: t } => {
            Surface::Dielectric(Box::new(Interface::new(int_ior, ext_ior, r, t)))
        }
        Material::ThinDielectric { int_ior, ext_ior, specular_reflectance: r, specular_transmittance: t } => {
            Surface::ThinDielectric(Box::new(Interface::new(int_ior, ext_ior, r, t)))
        }
        Material::RoughDielectric {
            int_ior,
            ext_ior,
            specular_reflectance: r,
            specular_transmittance: t,
            distribution,
            alpha,
        } => {
            let microfacet = Microfacet::new(distribution, alpha);
            let interface = Interface::new(int_ior, ext_ior, r, t);
            Surface::RoughDielectric(Box::new(RoughDielectric { interface, microfacet }))
        }
        Material::Plastic { int_ior, ext_ior, diffuse_reflectance: d, specular_reflectance: s, nonlinear } => {
            Surface::Plastic(Box::new(Plastic::new(int_ior / ext_ior, d, s, nonlinear)))
        }
        Material::RoughPlastic {
            int_ior,
            ext_ior,
            diffuse_reflectance: d,
            specular_reflectance: s,
            nonlinear,
            distribution,
            alpha,
        } => {
            let plastic = RoughPlastic::new(int_ior / ext_ior, d, s, nonlinear, distribution, alpha);
            Surface::RoughPlastic(Box::new(plastic))
        }
        Material::Phong { diffuse_reflectance, specular_reflectance, exponent } => {
            Surface::Phong(Box::new(Phong { diffuse_reflectance, specular_reflectance, exponent }))
        }
        Material::CookTorrance { diffuse_reflectance: d, specular_reflectance: s, ior, alpha } => {
            Surface::CookTorrance(Box::new(CookTorrance::new(d, s, ior, alpha)))
        }
        Material::MetallicRoughness {
            base_color,
            metallic_roughness,
            metallic,
            roughness,
            ior,
            specular,
            specular_color,
        } => {
            let factors = [metallic, roughness];
            let model = MetallicRoughness::new(base_color, metallic_roughness, factors, ior, specular, specular_color);
            Surface::MetallicRoughness(Box::new(model))
        }
        wrapper @ (Material::Mask { .. }
        | Material::TwoSided { .. }
        | Material::BumpMap { .. }
        | Material::NormalMap { .. }
        | Material::TangentNormalMap { .. }
        | Material::EvaluateOnly(_)
        | Material::Filled { .. }) => {
            return Err(nesting("twosided", wrapper.name(), " of two different sides: put it outside"));
        }
    })
}

impl CompiledMaterial {
    /// The scattering function at surface parameters `uv`.
    #[inline]
    pub fn resolve(&self, uv: [f32; 2]) -> Bsdf<'_> {
        let opacity = if self.opacity.is_empty() { 1.0 } else { self.opacity_at(|texture| texture.eval(uv)) };
        Bsdf {
            lobe: self.front.resolve(uv),
            back: self.back.as_ref(),
            uv,
            opacity,
            two_sided: self.two_sided,
            evaluate_only: self.evaluate_only,
        }
    }

    fn opacity_at(&self, look_up: impl Fn(&Texture) -> Rgb) -> f32 {
        self.opacity.iter().map(|texture| look_up(texture).luminance().clamp(0.0, 1.0)).product()
    }

    /// The participating medium behind the surface, opposite to the normal, if it is the boundary of one.
    pub fn interior(&self) -> Option<&Medium<Rgb>> {
        self.front.interior()
    }

    /// Whether [`shading_frame`](Self::shading_frame) makes use of the tangents: for normals that are perturbed, and for
    /// anisotropic materials. Otherwise any frame around the shading normal will do.
    #[inline]
    pub fn needs_tangents(&self) -> bool {
        self.needs_tangents
    }

    /// Whether it scatters on both sides: two-sided or transmissive.
    pub fn is_two_sided(&self) -> bool {
        self.two_sided || self.front.is_transmissive()
    }

    /// The frame in which directions are handed to the [`Bsdf`]: z is the shading normal after bump and normal mapping,
    /// x lies along `dpdu`. It does not depend on any direction, as bidirectional methods need it.
    ///
    /// Where light crosses the original but not the perturbed surface, or the other way around, the frame alone decides. So
    /// does Mitsuba 3 for interpolated normals; its bump and normal maps pass nothing there.
    #[inline]
    pub fn shading_frame(&self, input: &ShadingInput) -> Frame {
        let normal = self.normals.iter().fold(input.shading_normal, |normal, map| map.perturb(normal, input));
        Frame::from_z_and_tangent(normal, input.dpdu)
    }

    /// Whether it has a component that is not a Dirac delta.
    #[inline]
    pub fn is_connectible(&self) -> bool {
        self.front.is_connectible() || self.back.as_ref().is_some_and(Surface::is_connectible)
    }

    /// Of its sharpest component: a mask passes light by a Dirac delta, and what is evaluated only is sampled unlike it scatters.
    pub fn sharpness(&self) -> Sharpness {
        let wrapped = match (self.opacity.is_empty(), self.evaluate_only) {
            (false, _) => Sharpness::Specular,
            (true, true) => Sharpness::Glossy,
            (true, false) => Sharpness::Diffuse,
        };
        let back = self.back.as_ref().map_or(Sharpness::Diffuse, Surface::sharpness);
        wrapped.max(self.front.sharpness()).max(back)
    }

    /// The albedo for mean textures at an angle of 60 degrees, both sides averaged if they differ: an estimate.
    pub fn mean_albedo(&self) -> Rgb {
        let wo = Vec3A::new(0.75f32.sqrt(), 0.0, 0.5);
        let albedo = |side: &Surface| side.resolve_by(Texture::mean).albedo(wo).clamp(0.0, 1.0);
        let opaque = match &self.back {
            Some(back) => (albedo(&self.front) + albedo(back)) * 0.5,
            None => albedo(&self.front),
        };
        let opacity = self.opacity_at(Texture::mean);
        opaque * opacity + Rgb::splat(1.0 - opacity)
    }
}
