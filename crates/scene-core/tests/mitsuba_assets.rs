//! The importer on real scenes. Skipped with a message where they have not been downloaded.
#![cfg(feature = "mitsuba")]
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod mitsuba_support;

use mitsuba_support::assets;
use scene_core::film::Filter;
use scene_core::glam::Vec3A;
use scene_core::mitsuba;
use scene_core::reference::{Light, SceneDescription, Shape};

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

/// Sums over all corners of the triangles of mesh files, in the world: positions, normals, texture coordinates.
fn corner_sums(scene: &SceneDescription) -> (usize, [f64; 8]) {
    let mut result = (0, [0.0; 8]);
    for instance in &scene.instances {
        let Shape::Mesh(mesh) = &scene.shapes[instance.shape.0 as usize] else { continue };
        if matches!(mesh.len(), 2 | 12) && mesh.positions().iter().flatten().all(|x| x.abs() <= 1.0) {
            continue; // a rectangle or cube
        }
        let mesh = mesh.transformed(&instance.to_world);
        result.0 += mesh.len();
        let (positions, normals, uvs) = (mesh.positions(), mesh.normals(), mesh.uvs());
        for &vertex in mesh.triangles().iter().flatten() {
            let vertex = vertex as usize;
            let normal = normals.get(vertex).copied().unwrap_or_default();
            let uv = uvs.get(vertex).copied().unwrap_or_default();
            let values = positions[vertex].into_iter().chain(normal).chain(uv);
            result.1.iter_mut().zip(values).for_each(|(sum, value)| *sum += f64::from(value));
        }
    }
    result
}

/// Compares with the sums that Mitsuba 3.9.1 gives for the triangles with area.
fn check_geometry(scene: &SceneDescription, triangles: usize, expected: [f64; 8]) {
    let (count, sums) = corner_sums(scene);
    assert_eq!(count, triangles);
    let tolerance = 1e-5 * 3.0 * triangles as f64;
    assert!(sums.iter().zip(expected).all(|(a, b)| (a - b).abs() < tolerance), "{sums:?} is not {expected:?}");
}

/// The sum of the radiance of all area lights.
fn check_radiance(scene: &SceneDescription, expected: [f64; 3]) {
    let mut sum = [0.0; 3];
    for radiance in scene.instances.iter().filter_map(|instance| instance.radiance) {
        (0..3).for_each(|i| sum[i] += f64::from(radiance[i]));
    }
    assert!(sum.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-5 * b), "{sum:?} is not {expected:?}");
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
    assert_eq!(scene.filter, Filter::TENT);
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
    check_radiance(&scene, [3_077.635_383_13; 3]);
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
    check_geometry(
        &scene,
        142_973,
        [
            769_574.163_5,
            322_126.057,
            -869_444.664_6,
            5_409.081_3,
            4_151.015_5,
            -1_987.472_9,
            148_479.433_5,
            332_113.971_7,
        ],
    );
    assert_eq!(scene.warnings.len(), 1, "{:?}", scene.warnings);
    assert!(scene.warnings[0].ends_with("dropped 190 triangles without area"));
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
    assert_eq!((triangles + dropped, others), (30_911 + 8 * 2, 5));
    assert_eq!((area_lights(&scene), scene.lights.len(), scene.max_depth), (13, 0, Some(65)));
    check_geometry(
        &scene,
        28_479,
        [-412_809.623_9, 457_948.709_4, 115_494.985_6, -0.028_6, -39_115.940_8, -0.021, 4_145.543_4, 82_425.977_8],
    );
    check_radiance(&scene, [27.514_719_61, 25.546_239_97, 21.464_259_98]);
    assert_eq!(scene.warnings.len(), 1, "{:?}", scene.warnings);
    assert!(scene.warnings[0].ends_with("dropped 2432 triangles without area"));
    check_materials(&scene);
}

#[test]
fn water_caustic() {
    let Some(scene) = load("water-caustic/scene_mi3.xml", &[]) else { return };
    let (triangles, others) = primitives(&scene);
    let dropped: usize = scene.shapes.iter().map(|s| if let Shape::Mesh(m) = s { m.dropped() } else { 0 }).sum();
    assert_eq!((triangles + dropped, others, area_lights(&scene)), (103_451 + 6 * 2 + 2 * 12, 0, 1));
    let meshes: Vec<_> =
        scene.shapes.iter().filter_map(|s| if let Shape::Mesh(m) = s { Some(m) } else { None }).collect();
    let water = meshes.iter().max_by_key(|mesh| mesh.len()).unwrap();
    assert_eq!(water.normals().len(), water.positions().len(), "the water is smooth");
    assert!(meshes.iter().any(|mesh| mesh.normals().is_empty()), "its sides are flat");
    assert_eq!((scene.max_depth, scene.warnings.len()), (Some(9), 0));
    check_materials(&scene);
}
