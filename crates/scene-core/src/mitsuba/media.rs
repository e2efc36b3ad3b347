//! Participating media inside shapes.

use super::error::Result;
use super::importer::Importer;
use super::object::{Object, Tag};
use crate::material::Material;
use crate::medium::Medium;
use crate::traits::Rgb;

impl Importer<'_> {
    /// The medium inside a shape with the bsdf `bsdf`, if it is one that can be followed; warns of all others.
    pub(super) fn interior(&mut self, shape: &Object, bsdf: Option<usize>) -> Option<usize> {
        let document = self.document;
        let boundary = bsdf.map(|index| document.objects[index].plugin.as_str());
        let can_hold = matches!(boundary, Some("dielectric" | "roughdielectric" | "null"));
        let mut interior = None;
        for (child, index) in document.children(shape, &[Tag::Medium]) {
            let plugin = &document.objects[index].plugin;
            if child.name == "interior" && plugin == "homogeneous" && can_hold {
                interior = Some(index);
            } else {
                self.warn_at(&child.place, format!("ignored: the {} medium `{plugin}`", child.name));
            }
        }
        interior
    }

    /// `boundary` with the homogeneous medium `object` inside. Light crosses a `null` boundary straight on, as it
    /// does where indices of refraction are equal.
    pub(super) fn filled(&mut self, boundary: Material, object: &Object) -> Result<Material> {
        let albedo = self.color(object, "albedo")?.unwrap_or(Rgb::splat(0.75));
        let sigma_t = self.color(object, "sigma_t")?.unwrap_or(Rgb::ONE) * object.float("scale")?.unwrap_or(1.0);
        object.ignore(&["sample_emitters", "has_spectral_extinction"]);
        let g = self.mean_cosine(object)?;
        self.warn_unused(object);
        let medium = Medium::from_albedo(sigma_t, albedo, g);
        let medium = medium.map_err(|error| object.place.invalid(error.to_string()))?;
        let boundary = match boundary {
            Material::Mask { .. } => Material::glass(1.0),
            dielectric => dielectric,
        };
        Ok(boundary.filled_with(medium))
    }

    /// That of the phase function inside a medium.
    fn mean_cosine(&mut self, medium: &Object) -> Result<f32> {
        let document = self.document;
        let mut phases = document.children(medium, &[Tag::Phase]);
        let Some((_, index)) = phases.next() else { return Ok(0.0) };
        if let Some((second, _)) = phases.next() {
            return Err(second.place.invalid("a medium has at most one phase function"));
        }
        let phase = &document.objects[index];
        let g = match phase.plugin.as_str() {
            "isotropic" => 0.0,
            "hg" => phase.float("g")?.unwrap_or(0.8),
            _ => return Err(Self::unknown(phase)),
        };
        self.warn_unused(phase);
        Ok(g)
    }
}
