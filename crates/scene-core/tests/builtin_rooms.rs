//! The rooms among the builtin scenes are what they say: furnished, closed, lit as they should be, always the same.

use qmc_sampling::{Independent, Sampler, SamplerFamily};
use scene_core::builtin::{self, Builtin};
use scene_core::glam::Vec3A;
use scene_core::reference::Shape;
use scene_core::{Emitter, Ray, ReferenceScene, Rgb, Scene, SceneDescription, Sensor, TransportMode, Vertex};

fn build(description: SceneDescription) -> ReferenceScene {
    ReferenceScene::new(description).expect("a builtin scene")
}

/// A ray through a pixel, as if the image were uniform noise.
fn camera_ray(scene: &ReferenceScene, sampler: &mut impl Sampler) -> Ray {
    let [width, height] = scene.sensor().resolution();
    let [x, y] = sampler.next_2d();
    scene.sensor().sample_ray([x * width as f32, y * height as f32], [0.0; 2]).ray
}

/// How many of `paths` from the camera leave the scene within `length` segments.
fn escapes(scene: &ReferenceScene, paths: u32, length: u32) -> u32 {
    let family = Independent::new(7);
    let mut count = 0;
    for path in 0..paths {
        let mut sampler = family.sampler(0, u64::from(path));
        let mut ray = camera_ray(scene, &mut sampler);
        for _ in 0..length {
            let Some(vertex) = scene.intersect(&ray) else {
                count += 1;
                break;
            };
            let lobe = sampler.next_1d();
            let [u, v] = sampler.next_2d();
            let Some(sample) = vertex.sample([lobe, u, v], TransportMode::Radiance) else { break };
            ray = vertex.spawn_ray(sample.wi);
        }
    }
    count
}

#[test]
fn counts_are_as_stated() {
    for (description, triangles, lamps) in
        [(builtin::office(), 60_000..100_000, 9), (builtin::conference(), 60_000..100_000, 9)]
    {
        let scene = build(description);
        assert!(triangles.contains(&scene.triangle_count()), "{} {}", scene.name(), scene.triangle_count());
        assert_eq!(scene.emitters().len(), lamps, "{}", scene.name());
        assert_eq!(scene.warnings(), &[] as &[String]);
    }
}

#[test]
fn every_builtin_scene_is_the_same_each_time() {
    for builtin in Builtin::ALL {
        let (a, b) = (builtin.description(), builtin.description());
        assert_eq!(a.shapes.len(), b.shapes.len());
        for shapes in a.shapes.iter().zip(&b.shapes) {
            if let (Shape::Mesh(one), Shape::Mesh(other)) = shapes {
                assert_eq!(one.positions(), other.positions(), "{}", builtin.name);
                assert_eq!(one.triangles(), other.triangles(), "{}", builtin.name);
            }
        }
        for (one, other) in a.instances.iter().zip(&b.instances) {
            assert_eq!((one.to_world, one.material, one.radiance), (other.to_world, other.material, other.radiance));
        }
    }
}

#[test]
fn no_path_leaves_a_closed_room() {
    let rooms = [builtin::office(), builtin::conference(), builtin::interior()];
    let photon_maps = [builtin::rooms(10, 10), builtin::rooms(1, 1), builtin::door_slit(), builtin::caustic_room()];
    for description in rooms.into_iter().chain(photon_maps) {
        let scene = build(description);
        assert_eq!(escapes(&scene, 4000, 12), 0, "{}", scene.name());
    }
    // The Cornell box has no wall behind the camera, and so the count is able to find something.
    assert!(escapes(&build(builtin::cornell_box()), 1000, 12) > 100);
}

/// Mean height of the directions in which an emitter shines, from 1 (up) to -1, and the share of its light that
/// gets farther than half a metre.
fn shine(scene: &ReferenceScene, emitter: usize) -> (f32, f32) {
    let mut sampler = Independent::new(11).sampler(0, 0);
    let count = 512;
    let (mut up, mut far) = (0.0, 0.0);
    for _ in 0..count {
        let sample =
            scene.emitters()[emitter].sample_emission(sampler.next_2d(), sampler.next_2d()).expect("lambertian");
        up += sample.direction.y / count as f32;
        let hit = scene.intersect(&sample.point.ray_along(sample.direction));
        let distance = hit.map_or(f32::INFINITY, |v| (v.point().position - sample.point.position).length());
        far += f32::from(u8::from(distance > 0.5)) / count as f32;
    }
    (up, far)
}

#[test]
fn lamps_shine_where_they_should() {
    // The mean cosine of a lambertian emitter is 2/3.
    for (description, upwards) in [(builtin::office(), 7), (builtin::conference(), 1)] {
        let scene = build(description);
        let lamps: Vec<_> = (0..scene.emitters().len()).map(|i| shine(&scene, i)).collect();
        assert_eq!(lamps.iter().filter(|(up, _)| *up > 0.6).count(), upwards, "{lamps:?}");
        assert_eq!(lamps.iter().filter(|(up, _)| *up < -0.55).count(), lamps.len() - upwards, "{lamps:?}");
        // None is buried in its housing.
        let power = |i: usize| scene.emitters()[i].power()[1];
        let total: f32 = (0..lamps.len()).map(power).sum();
        let out: f32 = lamps.iter().enumerate().map(|(i, (_, far))| power(i) * far).sum();
        assert!(lamps.iter().all(|(_, far)| *far > 0.1) && out > 0.4 * total, "{lamps:?}");
    }
}

/// The share of what the camera sees that at least one of `tries` random points of an emitter lights.
fn lit_share(scene: &ReferenceScene, tries: u32) -> f32 {
    let family = Independent::new(13);
    let count = 2000;
    let lit = (0..count).filter(|&path| {
        let mut sampler = family.sampler(0, path);
        let ray = camera_ray(scene, &mut sampler);
        let Some(vertex) = scene.intersect(&ray) else { return false };
        scene.emitters().iter().any(|emitter| {
            (0..tries).any(|_| {
                let sample = emitter.sample_direct(vertex.point().position, sampler.next_2d());
                let Some((light, _)) = sample.and_then(|sample| sample.at) else { return false };
                vertex.eval(sample.map_or(Vec3A::Y, |s| s.wi), TransportMode::Radiance) != Rgb::ZERO
                    && scene.visible(vertex.point(), &light)
            })
        })
    });
    lit.count() as f32 / count as f32
}

#[test]
fn little_of_the_office_sees_a_lamp_and_much_of_the_conference_room_does() {
    assert!(lit_share(&build(builtin::office()), 2) < 0.4);
    assert!(lit_share(&build(builtin::conference()), 2) > 0.7);
}

/// Irradiance of the floor from the first emitter, at `from`, by a midpoint rule over the numbers that sample it.
fn irradiance(scene: &ReferenceScene, from: Vec3A) -> f64 {
    let count = 256;
    let number = |i: u32| (i as f32 + 0.5) / count as f32;
    let samples = (0..count * count)
        .filter_map(|k| scene.emitters()[0].sample_direct(from, [number(k % count), number(k / count)]));
    let sum: f64 = samples.map(|s| f64::from(s.radiance[0] * s.wi.y.max(0.0) / s.pdf_solid_angle)).sum();
    sum / f64::from(count * count)
}

#[test]
fn the_lights_at_the_plane_have_their_irradiance() {
    // The configuration factor from a point of the floor to a rectangle that stands on it, of width 2 a and height b, at
    // the distance c from its middle (Howell, A Catalog of Radiation Heat Transfer Configuration Factors, B-4, twice).
    let factor = |a: f64, b: f64, c: f64| {
        let d = (b * b + c * c).sqrt();
        ((a / c).atan() - c / d * (a / d).atan()) / std::f64::consts::PI
    };
    // It tends to one half at the light.
    assert!((factor(0.5, 0.5, 1e-6) - 0.5).abs() < 1e-5);
    let scene = build(builtin::plane_light());
    for c in [0.05, 0.3, 1.0] {
        let expected = std::f64::consts::PI * 2.5 * factor(0.5, 0.5, c);
        let found = irradiance(&scene, Vec3A::new(0.0, 0.0, c as f32 - 0.5));
        assert!((found / expected - 1.0).abs() < 2e-3, "{c}: {found} {expected}");
    }
    // Nothing behind it.
    assert_eq!(irradiance(&scene, Vec3A::new(0.0, 0.0, -0.7)), 0.0);
    let below = irradiance(&build(builtin::plane_point()), Vec3A::ZERO);
    assert!((below / (0.33 / (0.25 * 0.25)) - 1.0).abs() < 1e-4, "{below}");
}

#[test]
fn the_upright_light_touches_the_plane() {
    let scene = build(builtin::plane_light());
    let along = |y: f32| {
        let hit = scene.intersect(&Ray::new(Vec3A::new(0.0, y, 2.0), -Vec3A::Z)).unwrap();
        (hit.emitted(), (hit.point().position.z + 0.5).abs())
    };
    assert!([1e-5, 0.25, 0.49].iter().all(|&y| along(y).0 == Rgb::splat(2.5) && along(y).1 < 1e-5));
}
