//! Materials: how surfaces scatter light.
//!
//! A [`Material`] is data: a scattering model, its textures, and wrappers (masks, second sides, bump maps).
//! [`Material::compile`] turns it into a [`CompiledMaterial`]; at a hit, [`CompiledMaterial::resolve`] looks up its
//! textures and hands out a [`Bsdf`], a small value that evaluates and samples in the local frame.
//!
//! All models agree with the plugins of the same name of Mitsuba 3.9.1 to about 1e-3 (tested against values of it);
//! `phong` and `cooktorrance` are additions, after their papers.

mod bsdf;
mod compile;
mod conductor;
pub mod conductors;
mod cook_torrance;
mod description;
mod dielectric;
pub mod dielectrics;
mod diffuse;
mod erf;
mod error;
mod fresnel;
mod metallic_roughness;
mod microfacet;
mod normals;
mod phong;
mod plastic;
mod quadrature;
mod rough_plastic;
mod surface;
mod validate;
mod warp;

pub use bsdf::{Bsdf, BsdfSample};
pub use compile::CompiledMaterial;
pub use description::{Distribution, Material};
pub use error::MaterialError;
pub use normals::ShadingInput;
