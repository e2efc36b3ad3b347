//! The scenes for path space filtering are what they say: thin wires, small leaves, light through a translucent object.
#![cfg(feature = "reference")]

use qmc_sampling::{Independent, Sampler, SamplerFamily};
use scene_core::builtin;
use scene_core::medium::Medium;
use scene_core::{ReferenceScene, Rgb, Scene, SceneDescription, Sensor, TransportMode, Vertex};

fn build(description: SceneDescription) -> ReferenceScene {
    ReferenceScene::new(description).expect("a builtin scene")
}

#[test]
fn scenes_have_their_triangles_and_lights() {
    for (scene, thousands, emitters, has_media) in [
        (builtin::fence(), 101, 1, false),
        (builtin::foliage(), 63, 2, false),
        (builtin::translucent_blob(), 151, 2, true),
    ] {
        let scene = build(scene);
        let found = (scene.triangle_count() + 500) / 1000;
        assert_eq!(
            (found, scene.emitters().len(), scene.has_media()),
            (thousands, emitters, has_media),
            "{}",
            scene.name()
        );
    }
}

/// The share of pixels whose neighbours half a pixel away show something at another distance.
fn edges(scene: &ReferenceScene) -> f32 {
    let [width, height] = scene.sensor().resolution();
    let distance = |raster: [f32; 2]| {
        let ray = scene.sensor().sample_ray(raster, [0.5; 2]).ray;
        scene.intersect(&ray).map_or(1e3, |vertex| (vertex.point().position - ray.origin).length())
    };
    let count = 4000;
    let differ = (0..count).filter(|&i| {
        let [x, y] = Independent::new(3).sampler(0, i).next_2d();
        let at = [x * width as f32, y * height as f32];
        let [here, there] = [distance(at), distance([at[0] + 0.5, at[1] + 0.5])];
        (here - there).abs() > 0.02 * here.min(there)
    });
    differ.count() as f32 / count as f32
}

#[test]
fn the_fence_and_the_leaves_are_full_of_edges() {
    let smooth = edges(&build(builtin::translucent_blob()));
    let (fence, foliage) = (edges(&build(builtin::fence())), edges(&build(builtin::foliage())));
    assert!(smooth < 0.01 && fence > 0.05 && foliage > 0.02, "{smooth} {fence} {foliage}");
}

/// Paths that enter the object where the camera sees it: those that come out do so at many places, some of them far
/// away.
#[test]
fn light_crosses_the_translucent_object() {
    let scene = build(builtin::translucent_blob());
    let [width, height] = scene.sensor().resolution();
    let (mut near, mut far) = (0, 0);
    for i in 0..4000 {
        let mut sampler = Independent::new(4).sampler(0, i);
        let [x, y] = sampler.next_2d();
        let ray = scene.sensor().sample_ray([x * width as f32, y * height as f32], [0.5; 2]).ray;
        let Some(entry) = scene.intersect(&ray) else { continue };
        let Some(sample) = entry.sample([sampler.next_1d(), 0.3, 0.6], TransportMode::Radiance) else { continue };
        let Some(medium): Option<Medium<Rgb>> = entry.medium(sample.wi, None) else { continue };
        let Some(exit) = medium.walk(&scene, entry.spawn_ray(sample.wi), Rgb::ONE, &mut sampler) else { continue };
        let exit = exit.vertex.expect("the blob is closed");
        let way = (exit.point().position - entry.point().position).length();
        if way < 0.15 { near += 1 } else { far += 1 }
    }
    assert!(near > 500 && far > 50, "{near} {far}");
}
