//! The scenes for importance resampling are what they say: the blob shadows itself, the sun is small and strong, the
//! spheres of the row have their albedo.

use qmc_sampling::{Independent, Sampler, SamplerFamily};
use scene_core::builtin::{self, sky_image};
use scene_core::glam::Vec3A;
use scene_core::material::Material;
use scene_core::reference::Light;
use scene_core::{Emitter, Ray, ReferenceScene, Rgb, Scene, SceneDescription, Sensor, Spectrum, TransportMode, Vertex};

fn build(description: SceneDescription) -> ReferenceScene {
    ReferenceScene::new(description).expect("a builtin scene")
}

/// `count` points that the camera sees, from uniformly distributed positions of the image; fewer where it sees nothing.
fn seen(scene: &ReferenceScene, count: u64) -> Vec<(Ray, [f32; 2])> {
    let [width, height] = scene.sensor().resolution();
    let samples = (0..count).map(|i| {
        let [x, y] = Independent::new(3).sampler(0, i).next_2d();
        let raster = [x * width as f32, y * height as f32];
        (scene.sensor().sample_ray(raster, [0.0; 2]).ray, raster)
    });
    samples.filter(|(ray, _)| scene.intersect(ray).is_some()).collect()
}

#[test]
fn the_blob_has_its_triangles_and_lights() {
    let scene = build(builtin::blob());
    // The blob, the ground, two lights.
    assert_eq!(scene.triangle_count(), 12 * 112 * 112 + 3 * 2);
    assert_eq!((scene.emitters().len(), scene.environment()), (2, None));
    let power = |i: usize| scene.emitters()[i].power().luminance();
    assert!(power(0) > 1.4 * power(1) && power(1) > 0.1 * power(0), "{} {}", power(0), power(1));
    let under_sky = build(builtin::blob_environment());
    assert_eq!((under_sky.emitters().len(), under_sky.triangle_count()), (3, scene.triangle_count()));
    let hdr = builtin::blob_under(sky_image(), 2.0, 30.0);
    assert!(matches!(hdr.lights[..], [Light::Environment { scale: 2.0, .. }]));
    assert_eq!(build(hdr).emitters().len(), 3);
}

#[test]
fn the_camera_sees_all_finishes_and_shadows() {
    let description = builtin::blob();
    // Ground, gold, lacquer, diffuse.
    let names: Vec<_> = description
        .materials
        .iter()
        .map(|m| if let Material::TwoSided { front, .. } = m { front.name() } else { m.name() })
        .collect();
    assert_eq!(names[..4], ["diffuse", "roughconductor", "roughplastic", "diffuse"]);
    let scene = build(description);
    let rays = seen(&scene, 4000);
    let (mut blob, mut facing, mut shadowed) = (0, 0, 0);
    for (ray, _) in &rays {
        let vertex = scene.intersect(ray).unwrap();
        let point = *vertex.point();
        if point.position.y < 1e-3 {
            continue;
        }
        blob += 1;
        for emitter in scene.emitters() {
            let Some(sample) = emitter.sample_direct(point.position, [0.5; 2]) else { continue };
            if vertex.eval(sample.wi, TransportMode::Radiance) != Rgb::ZERO {
                facing += 1;
                shadowed += u32::from(!scene.visible(&point, &sample.at.unwrap().0));
            }
        }
    }
    let share = shadowed as f32 / facing as f32;
    assert!((800..2400).contains(&blob), "{blob} of {}", rays.len());
    // Of what faces a light, a considerable part lies in the blob's own shadow.
    assert!((0.1..0.6).contains(&share), "{share}");
}

/// Integrals of the luminance over all directions, and over those within `radius` of the brightest; relative
/// standard deviation of the estimate of the former by one uniform direction.
fn sky_integrals(radius: f32) -> (f64, f64, f64) {
    let scene = build(builtin::blob_environment());
    let environment = &scene.emitters()[scene.environment().expect("a sky").index()];
    let sun = environment.sample_direct(Vec3A::ZERO, [0.5; 2]).expect("a sky that is not black").wi;
    let (mut all, mut near, mut squares) = (0.0, 0.0, 0.0);
    let (rows, columns) = (1024, 2048);
    for i in 0..rows {
        let y = 1.0 - 2.0 * (i as f32 + 0.5) / rows as f32;
        for j in 0..columns {
            let (sin, cos) = (std::f32::consts::TAU * (j as f32 + 0.5) / columns as f32).sin_cos();
            let r = (1.0 - y * y).sqrt();
            let direction = Vec3A::new(r * cos, y, r * sin);
            let radiance = f64::from(environment.radiance(None, direction).luminance());
            let weight = 4.0 * std::f64::consts::PI / f64::from(rows * columns);
            all += weight * radiance;
            squares += weight * radiance * radiance;
            near += if direction.dot(sun) > radius.cos() { weight * radiance } else { 0.0 };
        }
    }
    (all, near, (4.0 * std::f64::consts::PI * squares / (all * all) - 1.0).sqrt())
}

#[test]
fn most_of_the_sky_s_light_comes_from_a_small_sun() {
    // Importance sampling of the middle of the unit square need not hit the sun's middle, but does hit the sun.
    let (all, near, deviation) = sky_integrals(0.14);
    let share = near / all;
    assert!((0.55..0.85).contains(&share), "{share}");
    // Far from one, where uniform directions would serve, and far from the hundreds of a true sun.
    assert!((15.0..60.0).contains(&deviation), "{deviation}");
}

#[test]
fn the_row_s_outer_halves_have_the_albedo_of_their_material() {
    let scene = build(builtin::sphere_row());
    assert_eq!((scene.emitters().len(), scene.triangle_count()), (1, 0));
    let rays = seen(&scene, 6000);
    // All of them are in the image.
    let hits: Vec<_> = rays.iter().map(|(ray, _)| scene.intersect(ray).unwrap().point().position.x).collect();
    let within = |center: f32| hits.iter().filter(|x| (*x - center).abs() < 1.0).count();
    assert!([-3.9, -1.3, 1.3, 3.9].iter().all(|&center| within(center) > 300));
    // Radiance of the left half of the diffuse sphere, by a midpoint rule over the numbers that scatter: no
    // direction meets another sphere.
    let vertex = rays.iter().filter_map(|(ray, _)| scene.intersect(ray)).find(|v| v.point().position.x < -4.0).unwrap();
    let number = |i: u32| (i as f32 + 0.5) / 32.0;
    for k in 0..32 * 32 {
        let sample = vertex.sample([0.5, number(k % 32), number(k / 32)], TransportMode::Radiance).unwrap();
        assert!(scene.intersect(&vertex.spawn_ray(sample.wi)).is_none());
        assert!((sample.throughput[0] - 0.5).abs() < 1e-5);
    }
}
