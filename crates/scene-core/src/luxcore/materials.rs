//! Materials and what they emit.

use super::error::{ImportError, Place, Result, invalid, unsupported};
use super::importer::Importer;
use super::properties::Group;
use crate::material::Material;
use crate::reference::MaterialId;
use crate::traits::Rgb;

/// Emission of a material, per object because power is spread over the area.
#[derive(Clone, Debug)]
pub(super) struct Emission {
    /// Radiance, or its product with the area.
    factor: Rgb,
    /// Whether to divide by the area of the mesh in the world.
    by_area: bool,
    place: Place,
}

impl Emission {
    /// The radiance of a mesh of this area.
    pub(super) fn radiance(&self, area: impl FnOnce() -> f64) -> Result<Rgb> {
        let radiance = if self.by_area { self.factor * (1.0 / area()) as f32 } else { self.factor };
        if radiance.to_array().iter().all(|x| x.is_finite()) {
            Ok(radiance)
        } else {
            Err(invalid(&self.place, "the emitted power is infinite per area"))
        }
    }
}

/// What a scene says of a material that is used.
#[derive(Clone, Debug)]
pub(super) struct ImportedMaterial {
    pub(super) id: MaterialId,
    pub(super) emission: Option<Emission>,
}

/// LuxCore's luminance.
fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.212_671 * r + 0.715_160 * g + 0.072_169 * b
}

fn rgb(value: [f64; 3]) -> Rgb {
    Rgb::from(value.map(|x| x as f32))
}

impl Importer<'_> {
    /// The material of this name, converted once.
    pub(super) fn material(&mut self, name: &str, place: &Place) -> Result<ImportedMaterial> {
        if let Some(known) = self.materials.get(name) {
            return Ok(known.clone());
        }
        let document = self.document;
        let Some(group) = document.group("material", name) else {
            return Err(ImportError::Undefined { place: place.clone(), kind: "material", name: name.to_owned() });
        };
        let material = self.scattering(group)?;
        let emission = emission(group)?;
        group.ignore(&[
            "id",
            "bumpsamplingdistance",
            "photongi.enable",
            "visibility.indirect.diffuse.enable",
            "visibility.indirect.glossy.enable",
            "visibility.indirect.specular.enable",
            "shadowcatcher.onlyinfinitelights",
        ]);
        for feature in ["shadowcatcher.enable", "holdout.enable"] {
            if group.flag(feature, false)? {
                return Err(unsupported(&group.place, format!("`{feature}`")));
            }
        }
        if let Some(shadow) = group.get("transparency.shadow")
            && shadow.color()? != [0.0; 3]
        {
            self.warn_at(&shadow.place, "ignored: `transparency.shadow`");
        }
        self.warn_unused(group);
        self.description.materials.push(material);
        let id = MaterialId(self.description.materials.len() as u32 - 1);
        let imported = ImportedMaterial { id, emission };
        self.materials.insert(name.to_owned(), imported.clone());
        Ok(imported)
    }

    /// How it scatters. LuxCore's matte surfaces and mirrors have two sides.
    fn scattering(&mut self, group: &Group) -> Result<Material> {
        let kind = group.require("type")?;
        match kind.text() {
            "matte" => Ok(Material::diffuse(self.reflectance(group, "kd", 0.75)?).two_sided()),
            "mirror" => {
                let specular_reflectance = self.reflectance(group, "kr", 1.0)?.into();
                Ok(Material::Conductor { eta: Rgb::ZERO, k: Rgb::ONE, specular_reflectance }.two_sided())
            }
            "glass" => {
                let index = |name: &str, default: f64| -> Result<f32> {
                    let value = group.number(name, default)?;
                    if value >= 1.0 {
                        Ok(value as f32)
                    } else {
                        Err(invalid(&group.place, format!("`{name}` is {value}")))
                    }
                };
                Ok(Material::Dielectric {
                    int_ior: index("interiorior", 1.5)?,
                    ext_ior: index("exteriorior", 1.0)?,
                    specular_reflectance: self.reflectance(group, "kr", 1.0)?.into(),
                    specular_transmittance: self.reflectance(group, "kt", 1.0)?.into(),
                })
            }
            other => {
                Err(ImportError::UnknownType { place: kind.place.clone(), kind: "material", name: other.to_owned() })
            }
        }
    }

    /// A constant colour in `[0, 1]`.
    fn reflectance(&mut self, group: &Group, name: &str, default: f64) -> Result<Rgb> {
        let Some(property) = group.get(name) else { return Ok(Rgb::splat(default as f32)) };
        if property.is_name() {
            return Err(unsupported(&property.place, format!("the texture `{}`", property.text())));
        }
        let color = property.color()?;
        if color.iter().any(|c| !(0.0..=1.0).contains(c)) {
            self.warn_at(&property.place, format!("`{name}` is clamped to 0 .. 1"));
        }
        Ok(rgb(color.map(|c| c.clamp(0.0, 1.0))))
    }
}

/// What a material emits; nothing if it is black. See the module's documentation for the formula.
fn emission(group: &Group) -> Result<Option<Emission>> {
    let gain = group.color("emission.gain")?.unwrap_or([1.0; 3]);
    let power = group.number("emission.power", 0.0)?;
    // Files of before 2.6 spell it in their own way.
    let efficiency = group.number("emission.efficency", 0.0)?.max(group.number("emission.efficiency", 0.0)?);
    let by_color = group.flag("emission.normalizebycolor", true)?;
    let gain_by_color = group.flag("emission.gain.normalizebycolor", false)?;
    let (theta, temperature) = (group.number("emission.theta", 90.0)?, group.number("emission.temperature", -1.0)?);
    let two_sided = group.flag("emission.twosided", false)?;
    group.ignore(&["emission.id", "emission.importance", "emission.temperature.normalize"]);
    group.ignore(&["emission.directlightsampling.type"]);
    let Some(property) = group.get("emission") else { return Ok(None) };
    if property.is_name() {
        return Err(unsupported(&property.place, format!("the texture `{}` as emission", property.text())));
    }
    let color = property.color()?;
    let place = property.place.clone();
    if color.iter().chain(&gain).chain([&power, &efficiency]).any(|x| *x < 0.0) {
        return Err(invalid(&place, "emission must not be negative"));
    }
    if color == [0.0; 3] || gain == [0.0; 3] {
        return Ok(None);
    }
    let files = ["emission.mapfile", "emission.iesfile", "emission.iesblob"];
    let unknown = files.into_iter().find(|file| group.get(file).is_some());
    let unknown = unknown.or((theta < 90.0).then_some("an `emission.theta` below 90"));
    let unknown = unknown.or((temperature >= 0.0).then_some("`emission.temperature`"));
    if let Some(what) = unknown.or(two_sided.then_some("`emission.twosided`")) {
        return Err(unsupported(&place, what));
    }
    let per_color = |flag: bool| if flag { 1.0 / luminance(color) } else { 1.0 };
    let watts = power * efficiency * per_color(by_color);
    let by_area = watts > 0.0 && watts.is_finite();
    let scale = if by_area { watts / std::f64::consts::PI } else { per_color(gain_by_color) };
    let factor = rgb([0, 1, 2].map(|c| gain[c] * color[c] * scale));
    Ok(Some(Emission { factor, by_area, place }))
}
