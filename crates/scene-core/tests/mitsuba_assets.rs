//! The importer on real scenes. Skipped with a message where they have not been downloaded.
#![cfg(feature = "mitsuba")]

mod mitsuba_support;

use mitsuba_support::assets;
use scene_core::glam::Vec3A;
use scene_core::mitsuba;
use scene_core::reference::{FilterDescription, Light, SceneDescription, Shape};

fn load(name: &str, parameters: &[(&str, &str)]) -> Option<SceneDescription> {
    let Some(assets) = assets() else {
        println!("skipped: there is no ../shared/assets");
        return None;
    };
    let parameters: Vec<_> = parameters.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect();
    let scene = mitsuba::load(&assets.join(name), &parameters).unwrap_or_else(|error| panic!("{error}"));
    println!("{name}: {:#?}", scene.warnings);
    Some(scene)
}

/// Triangles, counting what is instanced as often as it is placed; spheres and disks.
fn primitives(scene: &SceneDescription) -> (usize, usize) {
    let mut counts = (0, 0);
    for instance in &scene.instances {
        match &scene.shapes[instance.shape.0 as usize] {
            Shape::Mesh(mesh) => counts.0 += mesh.len(),
            _ => counts.1 += 1,
        }
    }
    counts
}

fn area_lights(scene: &SceneDescription) -> usize {
    scene.instances.iter().filter(|instance| instance.radiance.is_some()).count()
}

fn check_materials(scene: &SceneDescription) {
    for material in &scene.materials {
        material.clone().compile().unwrap_or_else(|error| panic!("{error}"));
    }
}

#[test]
fn cornell_box() {
    let Some(scene) = load("cornell-box/scene.xml", &[("resx", "64")]) else { return };
    assert_eq!(scene.name, "cornell-box");
    assert_eq!(primitives(&scene), (36, 0));
    assert_eq!((scene.instances.len(), scene.materials.len(), area_lights(&scene)), (8, 8, 1));
    assert_eq!((scene.camera.width, scene.camera.height), (64, 1024));
    assert_eq!((scene.max_depth, scene.samples_per_pixel), (Some(30), Some(64)));
    assert_eq!(scene.filter, FilterDescription::Tent { radius: 1.0 });
    assert!((scene.camera.fov_x.to_degrees() - 19.5).abs() < 1e-4);
    assert!((scene.camera.to_world.transform_point3a(Vec3A::Z) - Vec3A::new(0.0, 1.0, 5.8)).length() < 1e-5);
    assert_eq!(scene.warnings.len(), 1, "{:?}", scene.warnings);
    assert!(scene.warnings[0].contains("of the integrator `path_guiding_integrator` only"));
    let quiet = load("cornell-box/scene.xml", &[("integrator", "path")]).unwrap();
    assert_eq!(quiet.warnings, Vec::<String>::new());
    check_materials(&scene);
}

#[test]
fn veach_mis() {
    let Some(scene) = load("veach-mis/scene.xml", &[("integrator", "path")]) else { return };
    assert_eq!(primitives(&scene), (4 * 12 + 2 * 2, 3));
    assert_eq!((scene.materials.len(), area_lights(&scene)), (6, 3));
    assert_eq!(scene.warnings, Vec::<String>::new());
    check_materials(&scene);
}

#[test]
fn living_room() {
    let Some(scene) = load("living-room/scene_mi3.xml", &[]) else { return };
    let (triangles, others) = primitives(&scene);
    let dropped: usize = scene.shapes.iter().map(|s| if let Shape::Mesh(m) = s { m.dropped() } else { 0 }).sum();
    assert_eq!((triangles + dropped, others, scene.instances.len()), (143_163, 0, 65));
    assert_eq!((scene.lights.len(), area_lights(&scene)), (1, 0));
    assert!(
        matches!(&scene.lights[0], Light::Environment { image, .. } if image.width() == 2048 && image.height() == 1024)
    );
    assert_eq!(scene.max_depth, Some(65));
    check_materials(&scene);
    let plain = load("living-room/scene.xml", &[]).unwrap();
    assert_eq!(plain.warnings.len(), scene.warnings.len() + 1);
    assert!(plain.warnings.iter().any(|w| w.contains("scene.xml:22: ignored: unknown parameter `high_quality_edges`")));
}

#[test]
fn modern_hall() {
    let Some(scene) = load("modern-hall/scene_mi3.xml", &[]) else { return };
    let (triangles, others) = primitives(&scene);
    let dropped: usize = scene.shapes.iter().map(|s| if let Shape::Mesh(m) = s { m.dropped() } else { 0 }).sum();
    assert_eq!((triangles + dropped, others), (30_911, 5));
    assert_eq!((area_lights(&scene), scene.lights.len(), scene.max_depth), (13, 0, Some(65)));
    check_materials(&scene);
}

#[test]
fn water_caustic() {
    let Some(scene) = load("water-caustic/scene_mi3.xml", &[]) else { return };
    let (triangles, others) = primitives(&scene);
    let dropped: usize = scene.shapes.iter().map(|s| if let Shape::Mesh(m) = s { m.dropped() } else { 0 }).sum();
    assert_eq!((triangles + dropped, others, area_lights(&scene)), (103_451, 0, 1));
    let meshes: Vec<_> =
        scene.shapes.iter().filter_map(|s| if let Shape::Mesh(m) = s { Some(m) } else { None }).collect();
    let water = meshes.iter().max_by_key(|mesh| mesh.len()).unwrap();
    assert_eq!(water.normals().len(), water.positions().len(), "the water is smooth");
    assert!(meshes.iter().any(|mesh| mesh.normals().is_empty()), "its sides are flat");
    assert_eq!(scene.max_depth, Some(9));
    check_materials(&scene);
}
