//! A row of spheres in uniform light.

use super::SceneBuilder;
use super::finish::metal;
use super::form::v;
use crate::material::Material;
use crate::reference::{Light, SceneDescription};
use crate::traits::Rgb;

/// Distance between the centres of neighbours, whose radius is 1.
const DISTANCE: f32 = 2.6;

/// Four spheres of radius 1 in a row along x, in uniform radiance 1 and nothing else: from the left diffuse with
/// albedo 0.5, Cook and Torrance's model with roughness 0.3, rough gold with roughness 0.1, and the modified Phong model with
/// exponent 40.
///
/// What faces away from the others sees uniform light only. So the left half of the diffuse sphere has
/// radiance 0.5 exactly, and the right half of the last one the directional albedo of its material; [`furnace`](super::furnace)
/// shows a single material all around.
///
/// Source: Talbot, Cline, Egbert 2005, "Importance Resampling for Global Illumination", figure 5.
pub fn sphere_row() -> SceneDescription {
    let mut b = SceneBuilder::new("sphere-row");
    let materials = [
        Material::diffuse(0.5),
        Material::CookTorrance {
            diffuse_reflectance: Rgb::new(0.30, 0.06, 0.04).into(),
            specular_reflectance: 0.6.into(),
            ior: 1.8,
            alpha: 0.3,
        },
        metal("Au", 0.1),
        Material::Phong {
            diffuse_reflectance: Rgb::new(0.05, 0.12, 0.30).into(),
            specular_reflectance: 0.5.into(),
            exponent: 40.0,
        },
    ];
    for (i, material) in materials.into_iter().enumerate() {
        let material = b.material(material);
        b.sphere(material, v(DISTANCE * (i as f32 - 1.5), 0.0, 0.0), 1.0);
    }
    b.light(Light::Constant { radiance: Rgb::ONE });
    b.look(v(0.0, 0.0, 14.0), v(0.0, 0.0, 0.0), 43.0, 640, 200);
    b.finish()
}
