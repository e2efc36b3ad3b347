//! The field of lanterns has as many lamps as it says, of very different power, all of them free, and many in shadow.

use qmc_sampling::{Independent, Sampler, SamplerFamily};
use scene_core::{Emitter, ReferenceScene, Rgb, Scene, Sensor, Spectrum, TransportMode, Vertex, builtin};

#[test]
fn a_thousand_lamps_of_very_different_power() {
    let description = builtin::lantern_field();
    let scene = ReferenceScene::new(description).expect("a builtin scene");
    assert_eq!(scene.emitters().len(), 1000);
    // Ground, 92 blocks, 200 squares.
    assert_eq!(scene.triangle_count(), 2 + 92 * 12 + 200 * 2);
    let mut powers: Vec<f32> = scene.emitters().iter().map(|emitter| emitter.power().luminance()).collect();
    powers.sort_by(f32::total_cmp);
    assert!(powers[0] < 0.02 && (14.0..16.1).contains(&powers[999]), "{} {}", powers[0], powers[999]);
    // Evenly by the logarithm: the median is the geometric mean of the bounds, and few lamps give most of the light.
    assert!((powers[500] / (0.016f32 * 16.0).sqrt()).ln().abs() < 0.4, "{}", powers[500]);
    let (all, brightest): (f32, f32) = (powers.iter().sum(), powers[900..].iter().sum());
    assert!((0.4..0.65).contains(&(brightest / all)), "{}", brightest / all);
    // No lamp is buried: its light gets away.
    let mut sampler = Independent::new(3).sampler(0, 0);
    for (i, emitter) in scene.emitters().iter().enumerate() {
        let away = (0..32).filter(|_| {
            let start = emitter.sample_emission(sampler.next_2d(), sampler.next_2d()).expect("lambertian");
            let hit = scene.intersect(&start.point.ray_along(start.direction));
            hit.is_none_or(|vertex| (vertex.point().position - start.point.position).length() > 0.15)
        });
        assert!(away.count() > 24, "lamp {i}");
    }
}

#[test]
fn each_point_sees_some_of_them() {
    let scene = ReferenceScene::new(builtin::lantern_field()).expect("a builtin scene");
    let [width, height] = scene.sensor().resolution();
    let (mut points, mut lit, mut shadowed, mut bright) = (0, 0, 0, 0.0);
    for path in 0..400 {
        let mut sampler = Independent::new(3).sampler(0, path);
        let [x, y] = sampler.next_2d();
        let ray = scene.sensor().sample_ray([x * width as f32, y * height as f32], [0.0; 2]).ray;
        let Some(vertex) = scene.intersect(&ray) else { continue };
        if vertex.emitted() != Rgb::ZERO {
            continue;
        }
        points += 1;
        for emitter in scene.emitters() {
            let Some(sample) = emitter.sample_direct(vertex.point().position, sampler.next_2d()) else { continue };
            let value = vertex.eval(sample.wi, TransportMode::Radiance);
            if value == Rgb::ZERO {
                continue;
            }
            if sample.at.is_some_and(|(light, _)| scene.visible(vertex.point(), &light)) {
                lit += 1;
                bright += (value * sample.radiance).luminance() / sample.pdf_solid_angle;
            } else {
                shadowed += 1;
            }
        }
    }
    // Most of the image shows the field and not the sky, at a radiance that an image can show.
    assert!(points > 200, "{points}");
    let (mean_lit, mean_radiance) = (lit as f32 / points as f32, bright / points as f32);
    assert!((100.0..900.0).contains(&mean_lit), "{mean_lit}");
    assert!((0.1..0.6).contains(&mean_radiance), "{mean_radiance}");
    let share = shadowed as f32 / (lit + shadowed) as f32;
    assert!((0.15..0.8).contains(&share), "{share}");
}
