//! Small scenes, each of which exercises one part of light transport.
//!
//! All of them have light from large sources and moderate roughness, so that neither camera nor light paths find it
//! with a tiny probability: comparisons of means need a finite variance, and a small one.

use std::f32::consts::{PI, TAU};
use std::sync::Arc;

use scene_core::builtin::{self, SceneBuilder};
use scene_core::glam::{Affine3A, Mat3A, Vec3A};
use scene_core::material::{Distribution, Material};
use scene_core::reference::{Light, MaterialId};
use scene_core::texture::{Image, ImageTexture, Texture, UV_IDENTITY};
use scene_core::{ReferenceScene, Rgb, SceneDescription};

/// Width and height of the images, unless a test chooses another one.
pub const SIZE: u32 = 24;

/// Builds a scene that is known to be right.
///
/// # Panics
/// If it is not, or there are warnings.
pub fn build(description: SceneDescription) -> ReferenceScene {
    let scene = ReferenceScene::new(description).expect("a scene made for tests");
    assert!(scene.warnings().is_empty(), "{:?}", scene.warnings());
    scene
}

/// With another size of the image.
#[must_use]
pub fn resized(mut description: SceneDescription, width: u32, height: u32) -> SceneDescription {
    (description.camera.width, description.camera.height) = (width, height);
    description
}

/// The same scene in another unit of length: everything is `scale` times as large, seen from as many times the distance.
/// Of lights that are no surfaces, environments alone may be in it.
#[must_use]
pub fn scaled(mut description: SceneDescription, scale: f32) -> SceneDescription {
    let larger = Affine3A::from_scale(scene_core::glam::Vec3::splat(scale));
    for instance in &mut description.instances {
        instance.to_world = larger * instance.to_world;
    }
    let camera = &mut description.camera;
    camera.to_world.translation *= scale;
    camera.aperture_radius *= scale;
    camera.focus_distance *= scale;
    description
}

fn v(x: f32, y: f32, z: f32) -> Vec3A {
    Vec3A::new(x, y, z)
}

/// A floor of 8 x 8 around the origin.
fn floor(b: &mut SceneBuilder, material: MaterialId) {
    b.quad(material, v(-4.0, 0.0, -4.0), Vec3A::Z * 8.0, Vec3A::X * 8.0);
}

/// A wall behind the origin.
fn wall(b: &mut SceneBuilder, material: MaterialId) {
    b.quad(material, v(-4.0, 0.0, -2.0), Vec3A::X * 8.0, Vec3A::Y * 4.0);
}

/// A square light that shines down from a height of 3.5.
fn panel(b: &mut SceneBuilder, radiance: Rgb) {
    let dark = b.diffuse(0.0, 0.0, 0.0);
    b.quad(dark, v(-1.2, 3.5, -0.8), Vec3A::X * 2.4, Vec3A::Z * 2.4).emit(radiance);
}

fn view(b: &mut SceneBuilder) {
    b.look(v(0.0, 2.0, 5.0), v(0.0, 0.5, 0.0), 42.0, SIZE, SIZE);
}

fn rough_glass(ior: f32, alpha: f32) -> Material {
    Material::RoughDielectric {
        int_ior: ior,
        ext_ior: 1.0,
        specular_reflectance: 1.0.into(),
        specular_transmittance: 1.0.into(),
        distribution: Distribution::Ggx,
        alpha: [alpha; 2],
    }
}

fn rough_metal(alpha: [f32; 2]) -> Material {
    Material::RoughConductor {
        eta: Rgb::new(0.2, 0.92, 1.1),
        k: Rgb::new(3.9, 2.45, 2.14),
        specular_reflectance: 1.0.into(),
        distribution: Distribution::Ggx,
        alpha,
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

/// The Cornell box.
pub fn cornell_box() -> SceneDescription {
    resized(builtin::cornell_box(), SIZE, SIZE)
}

/// A glass ball under a lamp, and a pane of glass between them and the camera: what the camera sees through glass,
/// and the caustic below the ball.
pub fn glass_ball() -> SceneDescription {
    let mut b = SceneBuilder::new("glass ball");
    let ground = b.diffuse(0.6, 0.5, 0.4);
    floor(&mut b, ground);
    let glass = b.material(Material::glass(1.5));
    b.sphere(glass, v(0.4, 0.9, 0.0), 0.7);
    b.cuboid(glass, v(-0.7, 1.2, 2.0), v(0.5, 0.5, 0.05), 0.3);
    let lamp = b.diffuse(0.0, 0.0, 0.0);
    b.sphere(lamp, v(0.8, 3.6, 0.3), 0.9).emit(Rgb::new(6.0, 5.0, 4.0));
    view(&mut b);
    b.finish()
}

/// Camera and floor below the surface of a medium, the lamp above it: refraction scales radiance once.
/// The surface is rough if there is an `alpha`.
pub fn under_water(alpha: Option<f32>) -> SceneDescription {
    let mut b = SceneBuilder::new("under water");
    let ground = b.diffuse(0.6, 0.5, 0.4);
    floor(&mut b, ground);
    let surface = b.material(alpha.map_or_else(|| Material::glass(1.5), |alpha| rough_glass(1.5, alpha)));
    b.quad(surface, v(-6.0, 1.5, -6.0), Vec3A::Z * 12.0, Vec3A::X * 12.0);
    let lamp = b.diffuse(0.0, 0.0, 0.0);
    b.sphere(lamp, v(0.5, 4.0, 0.0), 1.3).emit(Rgb::new(6.0, 5.0, 4.0));
    b.look(v(0.0, 1.2, 3.0), v(0.0, 0.1, 0.0), 50.0, SIZE, SIZE);
    b.finish()
}

fn image(width: u32, height: u32, value: impl Fn(f32, f32) -> [f32; 3]) -> Arc<Image> {
    let pixels = (0..width * height)
        .map(|i| value((i % width) as f32 / width as f32, (i / width) as f32 / height as f32))
        .collect();
    Arc::new(Image::from_rgb(width, height, pixels).expect("as many pixels as the size says"))
}

/// Shading normals that differ from the geometric ones: a normal map on the floor, a bump map on the wall, a vase of few
/// segments with smooth normals.
pub fn bent_normals() -> SceneDescription {
    let mut b = SceneBuilder::new("bent normals");
    let grey = |value: f32| Box::new(Material::diffuse(value).two_sided());
    let tilts = image(8, 8, |u, v| {
        let n = Vec3A::new(0.45 * (TAU * 2.0 * u).sin(), 0.45 * (TAU * 2.0 * v).cos(), 1.0).normalize();
        (0.5 * n + 0.5).to_array()
    });
    let bricks = b.material(Material::NormalMap { normals: ImageTexture::new(tilts).into(), inner: grey(0.7) });
    floor(&mut b, bricks);
    let heights = image(16, 16, |u, v| [0.25 * (TAU * 2.0 * u).sin() * (TAU * 2.0 * v).sin(); 3]);
    let bumps =
        b.material(Material::BumpMap { height: ImageTexture::new(heights).into(), scale: 1.0, inner: grey(0.6) });
    wall(&mut b, bumps);
    let smooth = b.diffuse(0.7, 0.6, 0.5);
    b.lathe(smooth, v(0.3, 0.0, 0.3), &[[0.0, 0.0], [0.7, 0.2], [0.8, 0.9], [0.4, 1.5], [0.0, 1.6]], 7);
    panel(&mut b, Rgb::new(6.0, 5.5, 5.0));
    view(&mut b);
    b.finish()
}

/// A row of balls of all rough materials.
pub fn rough_materials() -> SceneDescription {
    let mut b = SceneBuilder::new("rough materials");
    let ground = b.diffuse(0.5, 0.5, 0.5);
    floor(&mut b, ground);
    wall(&mut b, ground);
    let materials = [
        rough_metal([0.3, 0.15]).two_sided(),
        rough_glass(1.5, 0.3),
        plastic(),
        Material::RoughPlastic {
            int_ior: 1.5,
            ext_ior: 1.0,
            diffuse_reflectance: Rgb::new(0.7, 0.3, 0.2).into(),
            specular_reflectance: 1.0.into(),
            nonlinear: false,
            distribution: Distribution::Beckmann,
            alpha: 0.2,
        },
        Material::Phong {
            diffuse_reflectance: Rgb::new(0.2, 0.4, 0.2).into(),
            specular_reflectance: 0.4.into(),
            exponent: 30.0,
        },
        Material::CookTorrance {
            diffuse_reflectance: Rgb::new(0.3, 0.2, 0.1).into(),
            specular_reflectance: 0.5.into(),
            ior: 1.5,
            alpha: 0.3,
        },
    ];
    for (i, material) in materials.into_iter().enumerate() {
        let material = b.material(material);
        b.sphere(material, v((i % 3) as f32 * 1.25 - 1.25, 0.6 + 1.15 * (i / 3) as f32, 0.3), 0.55);
    }
    panel(&mut b, Rgb::new(6.0, 5.5, 5.0));
    view(&mut b);
    b.finish()
}

fn still_life(name: &str) -> SceneBuilder {
    let mut b = SceneBuilder::new(name);
    let (ground, red, blue) = (b.diffuse(0.5, 0.5, 0.5), b.diffuse(0.7, 0.2, 0.1), b.diffuse(0.2, 0.3, 0.7));
    floor(&mut b, ground);
    wall(&mut b, ground);
    b.sphere(red, v(-0.8, 0.7, 0.2), 0.7);
    b.cuboid(blue, v(0.9, 0.5, 0.3), v(0.5, 0.5, 0.5), 0.5);
    view(&mut b);
    b
}

/// Point, spot and directional light.
pub fn delta_lights() -> SceneDescription {
    let mut b = still_life("delta lights");
    b.light(Light::Point { position: v(-1.5, 2.5, 2.0), intensity: Rgb::new(4.0, 3.0, 2.0) });
    let (position, intensity) = (v(1.5, 3.0, 1.5), Rgb::new(2.0, 8.0, 4.0));
    let direction = (v(0.5, 0.3, 0.0) - position).normalize();
    b.light(Light::Spot { position, direction, intensity, beam_width: 0.3, cutoff: 0.6 });
    b.light(Light::Directional { direction: v(0.4, -1.0, -0.5).normalize(), irradiance: Rgb::new(0.3, 0.4, 0.8) });
    b.finish()
}

/// A constant environment and an area light.
pub fn constant_environment() -> SceneDescription {
    let mut b = still_life("constant environment");
    panel(&mut b, Rgb::new(3.0, 2.0, 1.0));
    b.light(Light::Constant { radiance: Rgb::new(0.3, 0.4, 0.5) });
    b.finish()
}

/// An environment map with a bright patch, turned.
pub fn environment_map() -> SceneDescription {
    let mut b = still_life("environment map");
    let sky = image(16, 8, |u, v| {
        let sun = (0.2..0.35).contains(&u) && (0.1..0.4).contains(&v);
        if sun { [12.0, 10.0, 7.0] } else { [0.2 + 0.2 * v, 0.3, 0.6 - 0.4 * v] }
    });
    let to_world = Affine3A { matrix3: Mat3A::from_rotation_y(0.7), translation: Vec3A::ZERO };
    b.light(Light::Environment { image: sky, scale: 0.8, to_world });
    b.finish()
}

/// A thin lens, masks in the way of the light, materials that differ on their two sides.
pub fn lens_and_masks() -> SceneDescription {
    let mut b = SceneBuilder::new("lens and masks");
    let ground = b.diffuse(0.5, 0.5, 0.5);
    floor(&mut b, ground);
    wall(&mut b, ground);
    let board = Texture::Checkerboard {
        color0: Rgb::ONE,
        color1: Rgb::splat(0.2),
        uv_transform: [2.0, 0.0, 0.0, 0.0, 2.0, 0.0],
    };
    let red_and_blue = Material::TwoSided {
        front: Box::new(Material::diffuse(Rgb::new(0.7, 0.2, 0.1))),
        back: Some(Box::new(Material::diffuse(Rgb::new(0.1, 0.2, 0.7)))),
    };
    let veil = b.material(Material::Mask { opacity: board, inner: Box::new(red_and_blue.clone()) });
    b.quad(veil, v(-1.5, 2.0, -0.5), Vec3A::Z * 1.6, Vec3A::X * 1.6);
    let sides = b.material(red_and_blue);
    b.quad(sides, v(0.6, 0.0, 1.2), v(0.5, 0.0, -1.5), Vec3A::Y * 1.4);
    let floor_tiles =
        Texture::Checkerboard { color0: Rgb::splat(0.8), color1: Rgb::splat(0.2), uv_transform: UV_IDENTITY };
    let tiles = b.material(Material::diffuse(floor_tiles).two_sided());
    b.cuboid(tiles, v(-0.7, 0.4, 1.0), v(0.4, 0.4, 0.4), 0.3);
    let lamp = b.diffuse(0.0, 0.0, 0.0);
    b.sphere(lamp, v(-0.3, 4.0, 0.5), 1.0).emit(Rgb::new(5.0, 5.0, 4.0));
    view(&mut b);
    let camera = &mut b.description().camera;
    (camera.aperture_radius, camera.focus_distance) = (0.2, 4.0);
    b.finish()
}

/// Light of all kinds on diffuse, glossy and coated things: the choices that an estimator makes matter.
pub fn studio() -> SceneDescription {
    let mut b = still_life("studio");
    let metal = b.material(rough_metal([0.15; 2]).two_sided());
    b.quad(metal, v(-1.8, 0.05, 1.0), Vec3A::Z * 1.2, Vec3A::X * 3.6);
    let plastic = b.material(plastic());
    b.sphere(plastic, v(0.3, 1.6, -0.5), 0.5);
    panel(&mut b, Rgb::new(4.0, 3.0, 2.0));
    b.light(Light::Constant { radiance: Rgb::new(0.2, 0.25, 0.3) });
    b.light(Light::Point { position: v(1.5, 2.5, 1.5), intensity: Rgb::splat(1.5) });
    b.finish()
}

/// The furnace: a ball of albedo 0.8 in radiance 1, seen so closely that it fills the image: every pixel is 0.8.
pub fn furnace_ball() -> SceneDescription {
    let mut description = builtin::furnace(Material::diffuse(0.8));
    description.camera.fov_x = 0.2;
    resized(description, SIZE / 2, SIZE / 2)
}

/// A closed box that emits 1 and reflects half: every pixel is 2.
pub fn furnace_box() -> SceneDescription {
    resized(builtin::furnace_box(0.5, 1.0), SIZE / 2, SIZE / 2)
}

/// Angle of view of [`beside_a_wall`] and [`below_a_ceiling`].
pub const VIEW: f32 = 0.5 * PI;

/// A camera that looks down on a floor, of which it sees `x` from 1 at the left to 0 at the right edge of the image,
/// beside a wall of height 1 at `x = 0`. Beyond the ends of the wall lies `10^-5` of the hemisphere.
pub fn beside_a_wall() -> SceneDescription {
    let mut b = SceneBuilder::new("beside a wall");
    let grey = b.diffuse(0.5, 0.5, 0.5);
    b.quad(grey, v(-1.0, 0.0, -20.0), Vec3A::Z * 40.0, Vec3A::X * 4.0);
    b.quad(grey, v(0.0, 0.0, -20.0), Vec3A::Y, Vec3A::Z * 40.0);
    b.look(v(0.5, 0.5, 0.0), v(0.5, 0.0, 0.0), VIEW.to_degrees(), 8, 8);
    b.finish()
}

/// A camera that looks down from between two planes at a distance of 1, wide enough for rays of length 2.
pub fn below_a_ceiling() -> SceneDescription {
    let mut b = SceneBuilder::new("below a ceiling");
    let grey = b.diffuse(0.5, 0.5, 0.5);
    b.quad(grey, v(-3.0, 0.0, -3.0), Vec3A::Z * 6.0, Vec3A::X * 6.0);
    b.quad(grey, v(-3.0, 1.0, -3.0), Vec3A::X * 6.0, Vec3A::Z * 6.0);
    b.look(v(0.5, 0.5, 0.0), v(0.5, 0.0, 0.0), VIEW.to_degrees(), 8, 8);
    b.finish()
}
