//! One side of a material, prepared for lookups, and what it resolves to at a point.

use glam::Vec3A;

use super::conductor::{Conductor, RoughConductor};
use super::cook_torrance::CookTorrance;
use super::dielectric::{Interface, RoughDielectric};
use super::metallic_roughness::{self, MetallicRoughness};
use super::phong::Phong;
use super::plastic::Plastic;
use super::rough_plastic::RoughPlastic;
use super::{BsdfSample, diffuse};
use crate::medium::Medium;
use crate::texture::Texture;
use crate::traits::{Rgb, Sharpness, TransportMode};

/// A material without its wrappers.
#[derive(Clone, Debug)]
pub(super) enum Surface {
    Diffuse(Texture),
    Conductor(Box<Conductor>),
    RoughConductor(Box<RoughConductor>),
    Dielectric(Box<Interface>),
    ThinDielectric(Box<Interface>),
    RoughDielectric(Box<RoughDielectric>),
    Plastic(Box<Plastic>),
    RoughPlastic(Box<RoughPlastic>),
    Phong(Box<Phong>),
    CookTorrance(Box<CookTorrance>),
    MetallicRoughness(Box<MetallicRoughness>),
}

/// A [`Surface`] at one point: its textures are looked up.
#[derive(Clone, Copy, Debug)]
pub(super) enum Lobe<'m> {
    Diffuse(Rgb),
    Conductor(&'m Conductor, Rgb),
    RoughConductor(&'m RoughConductor, Rgb),
    Dielectric(&'m Interface, [Rgb; 2]),
    ThinDielectric(&'m Interface, [Rgb; 2]),
    RoughDielectric(&'m RoughDielectric, [Rgb; 2]),
    /// With the factor of the diffuse lobe and the specular reflectance.
    Plastic(&'m Plastic, [Rgb; 2]),
    /// As for plastic.
    RoughPlastic(&'m RoughPlastic, [Rgb; 2]),
    /// With the diffuse and the specular reflectance.
    Phong(&'m Phong, [Rgb; 2]),
    /// As for Phong.
    CookTorrance(&'m CookTorrance, [Rgb; 2]),
    /// With the base colour, and the roughness and metalness in green and blue.
    MetallicRoughness(&'m MetallicRoughness, [Rgb; 2]),
}

impl Surface {
    /// Whether light passes to the other side.
    pub(super) fn is_transmissive(&self) -> bool {
        matches!(self, Self::Dielectric(_) | Self::ThinDielectric(_) | Self::RoughDielectric(_))
    }

    /// The medium that it is the boundary of.
    pub(super) fn interior(&self) -> Option<&Medium<Rgb>> {
        match self {
            Self::Dielectric(m) => m.interior.as_ref(),
            Self::RoughDielectric(m) => m.interface.interior.as_ref(),
            _ => None,
        }
    }

    /// Makes it the boundary of a medium; false if it cannot be one.
    pub(super) fn fill(&mut self, medium: Medium<Rgb>) -> bool {
        let interface = match self {
            Self::Dielectric(m) => m,
            Self::RoughDielectric(m) => &mut m.interface,
            _ => return false,
        };
        interface.interior = Some(medium);
        true
    }

    /// Whether it changes when turned about the normal.
    pub(super) fn is_anisotropic(&self) -> bool {
        match self {
            Self::RoughConductor(m) => m.microfacet.is_anisotropic(),
            Self::RoughDielectric(m) => m.microfacet.is_anisotropic(),
            _ => false,
        }
    }

    /// Whether it has a component that is not a Dirac delta.
    #[inline]
    pub(super) fn is_connectible(&self) -> bool {
        !matches!(self, Self::Conductor(_) | Self::Dielectric(_) | Self::ThinDielectric(_))
    }

    /// Of its sharpest component.
    pub(super) fn sharpness(&self) -> Sharpness {
        match self {
            Self::Diffuse(_) => Sharpness::Diffuse,
            Self::Conductor(_) | Self::Dielectric(_) | Self::ThinDielectric(_) | Self::Plastic(_) => {
                Sharpness::Specular
            }
            Self::RoughConductor(_)
            | Self::RoughDielectric(_)
            | Self::RoughPlastic(_)
            | Self::Phong(_)
            | Self::CookTorrance(_)
            | Self::MetallicRoughness(_) => Sharpness::Glossy,
        }
    }

    #[inline]
    pub(super) fn resolve(&self, uv: [f32; 2]) -> Lobe<'_> {
        if let Self::Diffuse(reflectance) = self {
            return Lobe::Diffuse(reflectance.eval(uv));
        }
        self.resolve_by(|texture| texture.eval(uv))
    }

    /// Resolves with any way to look up a texture.
    pub(super) fn resolve_by(&self, look_up: impl Fn(&Texture) -> Rgb) -> Lobe<'_> {
        let tint = |i: &Interface| [look_up(&i.specular_reflectance), look_up(&i.specular_transmittance)];
        match self {
            Self::Diffuse(reflectance) => Lobe::Diffuse(look_up(reflectance)),
            Self::Conductor(m) => Lobe::Conductor(m, look_up(&m.specular_reflectance)),
            Self::RoughConductor(m) => Lobe::RoughConductor(m, look_up(&m.specular_reflectance)),
            Self::Dielectric(m) => Lobe::Dielectric(m, tint(m)),
            Self::ThinDielectric(m) => Lobe::ThinDielectric(m, tint(m)),
            Self::RoughDielectric(m) => Lobe::RoughDielectric(m, tint(&m.interface)),
            Self::Plastic(m) => {
                let diffuse = m.base.diffuse_factor(look_up(&m.base.diffuse_reflectance));
                Lobe::Plastic(m, [diffuse, look_up(&m.base.specular_reflectance)])
            }
            Self::RoughPlastic(m) => {
                let diffuse = m.base.diffuse_factor(look_up(&m.base.diffuse_reflectance));
                Lobe::RoughPlastic(m, [diffuse, look_up(&m.base.specular_reflectance)])
            }
            Self::Phong(m) => Lobe::Phong(m, [look_up(&m.diffuse_reflectance), look_up(&m.specular_reflectance)]),
            Self::CookTorrance(m) => {
                Lobe::CookTorrance(m, [look_up(&m.diffuse_reflectance), look_up(&m.specular_reflectance)])
            }
            Self::MetallicRoughness(m) => {
                Lobe::MetallicRoughness(m, [look_up(&m.base_color), m.scaled(look_up(&m.metallic_roughness))])
            }
        }
    }
}

impl<'m> Lobe<'m> {
    /// The medium that it is the boundary of.
    #[inline]
    pub(super) fn interior(&self) -> Option<&'m Medium<Rgb>> {
        match self {
            Self::Dielectric(m, _) => m.interior.as_ref(),
            Self::RoughDielectric(m, _) => m.interface.interior.as_ref(),
            _ => None,
        }
    }
}

impl Lobe<'_> {
    /// Whether it scatters on the front side only.
    #[inline]
    pub(super) fn is_one_sided(&self) -> bool {
        !matches!(self, Self::Dielectric(..) | Self::ThinDielectric(..) | Self::RoughDielectric(..))
    }

    #[inline]
    pub(super) fn eval_pdf(&self, wo: Vec3A, wi: Vec3A, mode: TransportMode) -> (Rgb, f32) {
        match self {
            Self::Diffuse(reflectance) => diffuse::eval_pdf(*reflectance, wo, wi),
            Self::RoughConductor(m, specular) => m.eval_pdf(*specular, wo, wi),
            Self::RoughDielectric(m, tint) => m.eval_pdf(*tint, wo, wi, mode),
            Self::Plastic(m, [diffuse, _]) => m.eval_pdf(*diffuse, wo, wi),
            Self::RoughPlastic(m, [diffuse, specular]) => m.eval_pdf(*diffuse, *specular, wo, wi),
            Self::Phong(m, [diffuse, specular]) => m.eval_pdf(*diffuse, *specular, wo, wi),
            Self::CookTorrance(m, [diffuse, specular]) => m.eval_pdf(*diffuse, *specular, wo, wi),
            Self::MetallicRoughness(m, [base, surface]) => m.eval_pdf(*base, *surface, wo, wi),
            Self::Conductor(..) | Self::Dielectric(..) | Self::ThinDielectric(..) => (Rgb::ZERO, 0.0),
        }
    }

    #[inline]
    pub(super) fn sample(&self, wo: Vec3A, u: [f32; 3], mode: TransportMode) -> Option<BsdfSample> {
        match self {
            Self::Diffuse(reflectance) => diffuse::sample(*reflectance, wo, [u[1], u[2]]),
            Self::Conductor(m, specular) => m.sample(*specular, wo),
            Self::RoughConductor(m, specular) => m.sample(*specular, wo, [u[1], u[2]]),
            Self::Dielectric(m, tint) => m.sample(*tint, wo, u[0], mode),
            Self::ThinDielectric(m, tint) => m.sample_thin(*tint, wo, u[0]),
            Self::RoughDielectric(m, tint) => m.sample(*tint, wo, u, mode),
            Self::Plastic(m, [diffuse, specular]) => m.sample(*diffuse, *specular, wo, u),
            Self::RoughPlastic(m, [diffuse, specular]) => m.sample(*diffuse, *specular, wo, u),
            Self::Phong(m, [diffuse, specular]) => m.sample(*diffuse, *specular, wo, u),
            Self::CookTorrance(m, [diffuse, specular]) => m.sample(*diffuse, *specular, wo, u),
            Self::MetallicRoughness(m, [base, surface]) => m.sample(*base, *surface, wo, u),
        }
    }

    /// The directional albedo or an estimate of it, not clamped.
    pub(super) fn albedo(&self, wo: Vec3A) -> Rgb {
        let mix = |tint: &[Rgb; 2], reflected: f32| tint[0] * reflected + tint[1] * (1.0 - reflected);
        match self {
            Self::Diffuse(reflectance) => *reflectance,
            Self::Conductor(m, specular) => *specular * m.fresnel.reflectance(wo.z.abs()),
            Self::RoughConductor(m, specular) => *specular * m.fresnel.reflectance(wo.z.abs()),
            Self::Dielectric(m, tint) => mix(tint, m.reflectance(wo)),
            Self::ThinDielectric(m, tint) => mix(tint, m.thin_reflectance(wo.z.abs())),
            Self::RoughDielectric(m, tint) => mix(tint, m.interface.reflectance(wo)),
            Self::Plastic(m, [diffuse, specular]) => m.albedo(*diffuse, *specular, wo),
            Self::RoughPlastic(m, [diffuse, specular]) => m.albedo(*diffuse, *specular, wo),
            Self::Phong(_, [diffuse, specular]) => *diffuse + *specular,
            Self::CookTorrance(m, [diffuse, specular]) => *diffuse + *specular * m.reflectance(wo.z.abs()),
            Self::MetallicRoughness(m, [base, surface]) => m.albedo(*base, *surface, wo),
        }
    }

    /// The smallest roughness among the components that are not Dirac deltas; 0 if there is none.
    pub(super) fn roughness(&self) -> f32 {
        match self {
            Self::Diffuse(_) | Self::Plastic(..) => 1.0,
            Self::Conductor(..) | Self::Dielectric(..) | Self::ThinDielectric(..) => 0.0,
            Self::RoughConductor(m, _) => m.microfacet.roughness(),
            Self::RoughDielectric(m, _) => m.microfacet.roughness(),
            Self::RoughPlastic(m, _) => m.microfacet.roughness(),
            Self::Phong(m, [_, specular]) if *specular != Rgb::ZERO => m.roughness(),
            Self::CookTorrance(m, [_, specular]) if *specular != Rgb::ZERO => m.microfacet.roughness(),
            Self::Phong(..) | Self::CookTorrance(..) => 1.0,
            Self::MetallicRoughness(_, [_, surface]) => metallic_roughness::roughness(*surface),
        }
    }
}
