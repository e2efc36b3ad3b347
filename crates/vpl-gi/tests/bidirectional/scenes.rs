//! Small scenes with one kind of transport each. Light from large sources, moderate roughness: means need a small variance.

use std::sync::Arc;

use scene_core::builtin::{self, SceneBuilder};
use scene_core::glam::{Affine3A, Vec3A};
use scene_core::material::{Distribution, Material};
use scene_core::reference::Light;
use scene_core::texture::Image;
use scene_core::{ReferenceScene, Rgb, SceneDescription};

/// Width and height of the images.
pub(crate) const SIZE: u32 = 16;

fn build(description: SceneDescription) -> ReferenceScene {
    let scene = ReferenceScene::new(description).unwrap();
    assert!(scene.warnings().is_empty(), "{:?}", scene.warnings());
    scene
}

fn v(x: f32, y: f32, z: f32) -> Vec3A {
    Vec3A::new(x, y, z)
}

fn stage(name: &str) -> SceneBuilder {
    let mut b = SceneBuilder::new(name);
    let ground = b.diffuse(0.5, 0.5, 0.6);
    b.quad(ground, v(-4.0, 0.0, -4.0), Vec3A::Z * 8.0, Vec3A::X * 8.0);
    b.quad(ground, v(-4.0, 0.0, -2.0), Vec3A::X * 8.0, Vec3A::Y * 4.0);
    b.look(v(0.0, 2.0, 5.0), v(0.0, 0.5, 0.0), 42.0, SIZE, SIZE);
    b
}

fn panel(b: &mut SceneBuilder, radiance: f32) {
    let dark = b.diffuse(0.0, 0.0, 0.0);
    b.quad(dark, v(-1.2, 3.5, -0.8), Vec3A::X * 2.4, Vec3A::Z * 2.4).emit(Rgb::splat(radiance));
}

fn rough_metal(alpha: f32) -> Material {
    Material::RoughConductor {
        eta: Rgb::new(0.2, 0.92, 1.1),
        k: Rgb::new(3.9, 2.45, 2.14),
        specular_reflectance: 1.0.into(),
        distribution: Distribution::Ggx,
        alpha: [alpha; 2],
    }
}

fn plastic() -> Material {
    Material::Plastic {
        int_ior: 1.5,
        ext_ior: 1.0,
        diffuse_reflectance: Rgb::new(0.2, 0.3, 0.7).into(),
        specular_reflectance: 1.0.into(),
        nonlinear: true,
    }
}

fn mirror() -> Material {
    Material::Conductor {
        eta: Rgb::new(0.2, 0.92, 1.1),
        k: Rgb::new(3.9, 2.45, 2.14),
        specular_reflectance: 0.9.into(),
    }
}

/// The Cornell box: diffuse.
pub(crate) fn diffuse() -> ReferenceScene {
    let mut description = builtin::cornell_box();
    (description.camera.width, description.camera.height) = (SIZE, SIZE);
    build(description)
}

/// Rough metal, rough plastic and Phong, through a lens.
pub(crate) fn glossy() -> ReferenceScene {
    let mut b = stage("glossy");
    let plate = b.material(rough_metal(0.3).two_sided());
    b.quad(plate, v(-1.8, 0.05, 0.6), Vec3A::Z * 1.6, Vec3A::X * 3.6);
    let phong = b.material(Material::Phong {
        diffuse_reflectance: Rgb::new(0.2, 0.4, 0.2).into(),
        specular_reflectance: 0.4.into(),
        exponent: 20.0,
    });
    b.sphere(phong, v(-0.8, 0.7, 0.0), 0.6);
    let coat = b.material(Material::RoughPlastic {
        int_ior: 1.5,
        ext_ior: 1.0,
        diffuse_reflectance: Rgb::new(0.7, 0.3, 0.2).into(),
        specular_reflectance: 1.0.into(),
        nonlinear: false,
        distribution: Distribution::Beckmann,
        alpha: 0.25,
    });
    b.sphere(coat, v(0.8, 0.7, 0.0), 0.6);
    panel(&mut b, 6.0);
    let camera = &mut b.description().camera;
    (camera.aperture_radius, camera.focus_distance) = (0.1, 5.0);
    build(b.finish())
}

/// A glass ball under a spherical lamp, beside a coated box and a mirror.
pub(crate) fn glass_ball() -> ReferenceScene {
    let mut b = stage("glass ball");
    let glass = b.material(Material::glass(1.5));
    b.sphere(glass, v(0.6, 0.9, 0.4), 0.7);
    let coated = b.material(plastic());
    b.cuboid(coated, v(-1.0, 0.5, 0.3), v(0.5, 0.5, 0.5), 0.5);
    let mirror = b.material(mirror().two_sided());
    b.quad(mirror, v(-2.2, 0.3, -1.4), Vec3A::X * 2.0, Vec3A::Y * 1.5);
    let lamp = b.diffuse(0.0, 0.0, 0.0);
    b.sphere(lamp, v(0.8, 3.6, 0.3), 0.9).emit(Rgb::new(6.0, 5.0, 4.0));
    build(b.finish())
}

/// An environment map with a bright patch, and a panel.
pub(crate) fn environment() -> ReferenceScene {
    let mut b = stage("environment");
    let red = b.diffuse(0.7, 0.2, 0.1);
    b.sphere(red, v(-0.8, 0.7, 0.2), 0.7);
    let metal = b.material(rough_metal(0.3));
    b.sphere(metal, v(0.9, 0.6, 0.3), 0.6);
    let pixels = (0..16 * 8)
        .map(|i| {
            let (u, v) = ((i % 16) as f32 / 16.0, (i / 16) as f32 / 8.0);
            let sun = (0.1..0.4).contains(&u) && (0.1..0.4).contains(&v);
            if sun { [4.0, 3.5, 3.0] } else { [0.3 + 0.2 * v, 0.4, 0.6 - 0.3 * v] }
        })
        .collect();
    let image = Arc::new(Image::from_rgb(16, 8, pixels).unwrap());
    b.light(Light::Environment { image, scale: 0.8, to_world: Affine3A::IDENTITY });
    panel(&mut b, 2.0);
    build(b.finish())
}

/// Point, spot and parallel light, without anything specular: a path tracer finds all of it.
pub(crate) fn delta_lights() -> ReferenceScene {
    let mut b = stage("delta lights");
    still_life(&mut b);
    build(b.finish())
}

/// The same with a mirror and a coated floor plate: only light paths find their caustics.
pub(crate) fn delta_caustics() -> ReferenceScene {
    let mut b = stage("delta caustics");
    still_life(&mut b);
    let mirror = b.material(mirror().two_sided());
    b.quad(mirror, v(-2.0, 0.3, -1.0), Vec3A::X * 1.8, Vec3A::Y * 1.2);
    let coated = b.material(plastic());
    b.quad(coated, v(-1.0, 0.05, 0.9), Vec3A::Z * 1.2, Vec3A::X * 2.0);
    build(b.finish())
}

fn still_life(b: &mut SceneBuilder) {
    let (red, blue) = (b.diffuse(0.7, 0.2, 0.1), b.diffuse(0.2, 0.3, 0.7));
    b.sphere(red, v(-0.8, 0.7, 0.2), 0.7);
    b.cuboid(blue, v(0.9, 0.5, 0.3), v(0.5, 0.5, 0.5), 0.5);
    b.light(Light::Point { position: v(-1.5, 2.5, 2.0), intensity: Rgb::new(4.0, 3.0, 2.0) });
    let (position, intensity) = (v(1.5, 3.0, 1.5), Rgb::new(2.0, 8.0, 4.0));
    let direction = (v(0.5, 0.3, 0.0) - position).normalize();
    b.light(Light::Spot { position, direction, intensity, beam_width: 0.3, cutoff: 0.6 });
    b.light(Light::Directional { direction: v(0.4, -1.0, -0.5).normalize(), irradiance: Rgb::new(0.3, 0.4, 0.8) });
}

/// A spot that shines on the floor by a mirror beside the picture. Nothing specular is seen.
pub(crate) fn mirrored_spot() -> ReferenceScene {
    let mut b = stage("mirrored spot");
    let red = b.diffuse(0.7, 0.2, 0.1);
    b.sphere(red, v(-0.8, 0.7, 0.2), 0.7);
    let mirror = b.material(mirror().two_sided());
    b.quad(mirror, v(3.0, 0.0, -2.0), Vec3A::Y * 4.0, Vec3A::Z * 6.0);
    let (position, target) = (v(0.5, 3.0, 1.5), v(3.0, 1.5, 0.5));
    let (direction, intensity) = ((target - position).normalize(), Rgb::new(20.0, 15.0, 10.0));
    b.light(Light::Spot { position, direction, intensity, beam_width: 0.3, cutoff: 0.6 });
    b.light(Light::Point { position: v(-1.5, 2.5, 2.0), intensity: Rgb::new(2.0, 2.0, 2.0) });
    build(b.finish())
}
