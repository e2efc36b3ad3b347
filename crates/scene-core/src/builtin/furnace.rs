//! Furnaces: scenes whose image is known exactly.

use glam::Vec3A;

use super::SceneBuilder;
use crate::material::Material;
use crate::reference::{Light, SceneDescription};
use crate::traits::Rgb;

/// A sphere in uniform radiance 1: each point of it shows the directional albedo of its material, the background 1.
pub fn furnace(material: Material) -> SceneDescription {
    let mut b = SceneBuilder::new("furnace");
    let material = b.material(material);
    b.sphere(material, Vec3A::ZERO, 1.0);
    b.light(Light::Constant { radiance: Rgb::ONE });
    b.look(Vec3A::new(0.0, 0.0, 4.0), Vec3A::ZERO, 40.0, 128, 128);
    b.finish()
}

/// The inside of a box that emits `emitted` and reflects `albedo` everywhere: the radiance is
/// `emitted / (1 - albedo)` at every point and in every direction.
pub fn furnace_box(albedo: f32, emitted: f32) -> SceneDescription {
    let mut b = SceneBuilder::new("furnace-box");
    let material = b.material(Material::Diffuse { reflectance: Rgb::splat(albedo).into() });
    // The cuboid's faces look outwards; swapping two corners turns them inwards.
    let corner = |i: u32| Vec3A::from([0, 1, 2].map(|bit| if i >> bit & 1 == 0 { -1.0 } else { 1.0 }));
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    b.quads(material, &faces.map(|[p, q, r, s]| [p, s, r, q].map(corner)));
    b.emit(Rgb::splat(emitted));
    b.look(Vec3A::new(0.1, 0.2, -0.3), Vec3A::new(0.3, 0.1, 1.0), 90.0, 64, 64);
    b.finish()
}
