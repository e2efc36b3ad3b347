//! A real scene in LuxCore's format, where it has been downloaded. Skipped with a message where it has not.
#![cfg(feature = "luxcore")]
#![allow(clippy::print_stdout, clippy::unwrap_used)]

use std::f32::consts::PI;
use std::path::Path;

use scene_core::{Emitter, ReferenceScene, Rgb, Scene, Sensor, Vertex, luxcore};

#[test]
fn thousands_of_emitters_share_a_mesh() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/assets/many-lights/scene.scn");
    if !path.exists() {
        println!("skipped: there is no {}", path.display());
        return;
    }
    let description = luxcore::load(&path).unwrap();
    assert!(description.warnings.is_empty(), "{:?}", description.warnings);
    assert_eq!((description.shapes.len(), description.instances.len(), description.materials.len()), (3, 4502, 2));
    let camera = &description.camera;
    assert!((camera.width, camera.height) == (640, 360) && (camera.fov_x.to_degrees() - 83.97443).abs() < 1e-3);

    let emitting = description.instances.iter().filter(|instance| instance.radiance.is_some());
    let scales: Vec<f32> = emitting.map(|instance| instance.to_world.matrix3.x_axis.length()).collect();
    let scene = ReferenceScene::new(description).unwrap();
    assert_eq!(scene.warnings(), &[] as &[String]);
    // The hall, a ball, and 4500 balls that share its triangles.
    assert_eq!(scene.triangle_count(), 4501 * 3968 + 56);
    assert_eq!(scene.emitters().len(), 4501);
    // Balls of a radius of about one before they are scaled, and of radiance 0.2: 4 pi s^2 pi 0.2.
    assert_eq!(scales.len(), 4501);
    for (emitter, scale) in scene.emitters().iter().zip(scales) {
        let of_ball = 0.8 * PI * PI * scale * scale;
        assert!((emitter.power()[0] / of_ball - 1.0).abs() < 0.04, "{} {of_ball}", emitter.power()[0]);
    }
    // Rays through the upper edge of the image end on emitters.
    let [width, _] = scene.sensor().resolution();
    let emitted = (0..width).filter(|&x| {
        let ray = scene.sensor().sample_ray([x as f32 + 0.5, 0.5], [0.0; 2]).ray;
        scene.intersect(&ray).is_some_and(|vertex| vertex.emitted() == Rgb::splat(0.2))
    });
    assert!(emitted.count() > width as usize / 2);
}
