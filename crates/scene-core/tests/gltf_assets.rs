//! The importer for glTF on real assets. Skipped with a message where they have not been downloaded.
#![cfg(feature = "gltf")]
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod gltf_support;

use gltf_support::{assets, mesh};
use scene_core::material::Material;
use scene_core::reference::{Light, SceneDescription};
use scene_core::texture::Texture;
use scene_core::{ReferenceScene, Scene, Sensor, gltf};

fn load(name: &str) -> Option<SceneDescription> {
    let Some(assets) = assets() else {
        println!("skipped: there is no ../shared/assets");
        return None;
    };
    let scene = gltf::load(&assets.join(name)).unwrap_or_else(|error| panic!("{error}"));
    println!("{name}: {:#?}", scene.warnings);
    Some(scene)
}

fn warns(scene: &SceneDescription, of: &str) -> bool {
    scene.warnings.iter().any(|warning| warning.contains(of))
}

/// The share of rays through the image that hit something.
fn seen(scene: &ReferenceScene) -> f32 {
    let [width, height] = scene.sensor().resolution();
    let n = 40;
    let hits = (0..n * n).filter(|i| {
        let raster = [(i % n) as f32 + 0.5, (i / n) as f32 + 0.5].map(|x| x / n as f32);
        let raster = [raster[0] * width as f32, raster[1] * height as f32];
        scene.intersect(&scene.sensor().sample_ray(raster, [0.0; 2]).ray).is_some()
    });
    hits.count() as f32 / (n * n) as f32
}

#[test]
fn toy_car() {
    let Some(scene) = load("toy-car/ToyCar.gltf") else { return };
    assert!(warns(&scene, "KHR_materials_clearcoat") && warns(&scene, "KHR_materials_sheen"));
    assert!(warns(&scene, "cameras[0] `Camera001`: of 8 cameras this one is taken"));
    assert_eq!(scene.materials.len(), 3);
    // The fabric's maps are repeated three times.
    let Material::TangentNormalMap { normals: Texture::Image(normals), .. } = &scene.materials[1] else { panic!() };
    assert_eq!(normals.uv_transform[0], 3.0);
    assert!(matches!(scene.materials[2], Material::ThinDielectric { .. }));
    // Few of the car's triangles emit.
    let (mut emitting, mut all) = (0, 0);
    for instance in &scene.instances {
        let count = mesh(&scene, instance.shape.0 as usize).len();
        all += count;
        emitting += if instance.radiance.is_some() { count } else { 0 };
    }
    assert!(all > 105_000 && emitting > 0 && emitting < all / 20, "{emitting} of {all}");
    let scene = ReferenceScene::new(scene).unwrap();
    assert!(seen(&scene) > 0.5, "{}", seen(&scene));
}

#[test]
fn glass_candle_holder() {
    let Some(scene) = load("glass-candle-holder/GlassHurricaneCandleHolder.gltf") else { return };
    assert_eq!((scene.shapes.len(), scene.instances.len(), scene.materials.len()), (2, 2, 2));
    let Material::Filled { medium, .. } = &scene.materials[1] else { panic!("{:?}", scene.materials[1]) };
    let left = medium.transmittance(0.001).to_array();
    assert!((left[0] - 0.8).abs() < 1e-5 && (left[1] - 0.95).abs() < 1e-5 && left[2] == 1.0, "{left:?}");
    assert!(matches!(scene.lights[..], [Light::Constant { .. }]));
    let scene = ReferenceScene::new(scene).unwrap();
    assert!(scene.has_media() && scene.triangle_count() == 4126);
    assert!(seen(&scene) > 0.1, "{}", seen(&scene));
}

#[test]
fn hotel_room() {
    let Some(scene) = load("hotel-room/hotel-room.glb") else { return };
    assert_eq!(scene.materials.len(), 11);
    assert!(warns(&scene, "left out: a primitive of Lines"));
    let scene = ReferenceScene::new(scene).unwrap();
    assert!(scene.triangle_count() > 98_000, "{}", scene.triangle_count());
    assert!(seen(&scene) > 0.1, "{}", seen(&scene));
}
