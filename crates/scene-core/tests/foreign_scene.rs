//! A foreign renderer implements the traits in about a hundred lines (`foreign/scene.rs`) and renders what is known in closed form.

// Helper functions of tests may unwrap.
#![allow(clippy::unwrap_used)]

mod foreign {
    // The lines are counted: one method a line where it fits.
    #[rustfmt::skip]
    pub(crate) mod scene;
}

use core::ops::ControlFlow;

use estimator_checks::{Moments, Suite, Truth, mean_is};
use foreign::scene::{Ball, Balls, Camera, Lamp};
use qmc_sampling::{Independent, Sampler, SamplerFamily};
use scene_core::glam::Vec3A;
use scene_core::{
    Counting, Emitter, Ray, RayCounts, RussianRoulette, Scene, Sensor, Spectrum, TransportMode, Vertex, WalkStart,
    random_walk,
};

static SUITE: Suite = Suite::with_share("scene-core foreign scene", 4, 1e-8);

fn ball(x: f32, albedo: f32, is_mirror: bool) -> Ball {
    Ball { center: Vec3A::new(x, 0.0, 0.0), radius: 1.0, albedo, is_mirror }
}

fn scene(balls: Vec<Ball>, radiance: f32) -> Balls {
    let lamp = Lamp::Point { position: Vec3A::new(3.0, 4.0, 5.0), intensity: 30.0 };
    let camera = Camera { eye: Vec3A::new(0.0, 0.0, 5.0), size: 16 };
    Balls { balls, lamps: vec![Lamp::Sky { radiance, radius: 5.0 }, lamp], camera }
}

/// A path tracer in a screenful: light is what the path escapes to.
fn escape<S: Scene>(scene: &S, mut ray: Ray, sampler: &mut impl Sampler) -> S::Spectrum {
    let mut throughput = S::Spectrum::splat(1.0);
    while let Some(vertex) = scene.intersect(&ray) {
        let lobe = sampler.next_1d();
        let [u, v] = sampler.next_2d();
        let Some(sample) = vertex.sample([lobe, u, v], TransportMode::Radiance) else { return S::Spectrum::ZERO };
        throughput *= sample.throughput;
        if throughput.max_component() < 1e-6 {
            return S::Spectrum::ZERO;
        }
        ray = vertex.spawn_ray(sample.wi);
    }
    throughput * scene.environment_radiance(ray.direction)
}

/// The random walk, with light from emitter `which` at every vertex.
fn next_event<S: Scene>(scene: &S, ray: Ray, which: usize, max_length: u32, sampler: &mut impl Sampler) -> S::Spectrum {
    let mut lights = sampler.fork(1);
    let mut radiance = S::Spectrum::ZERO;
    let roulette = RussianRoulette::PathThroughput { from_length: 4 };
    let throughput = S::Spectrum::splat(1.0);
    let start = WalkStart { ray, throughput, mode: TransportMode::Radiance, max_length, roulette };
    random_walk(scene, start, sampler, |walk| {
        let point = walk.vertex.point();
        if let Some(light) = scene.emitters()[which].sample_direct(point.position, lights.next_2d()) {
            let ray = light.at.map_or_else(|| point.ray_along(light.wi), |(at, _)| point.ray_to(&at));
            if !scene.occluded(&ray) {
                let scattered = walk.vertex.eval(light.wi, TransportMode::Radiance);
                radiance += walk.throughput * scattered * light.radiance * (1.0 / light.pdf_solid_angle);
            }
        }
        ControlFlow::Continue(())
    });
    radiance
}

fn pixels() -> impl Iterator<Item = ([f32; 2], u64)> {
    (0..256u64).map(|k| ([(k % 16) as f32 + 0.5, (k / 16) as f32 + 0.5], k))
}

/// One convex ball of albedo `rho` under a sky of radiance `L` looks like `rho L` everywhere, mirror or not.
#[test]
fn a_ball_under_the_sky_shows_its_albedo() {
    for is_mirror in [false, true] {
        let scene = scene(vec![ball(0.0, 0.7, is_mirror)], 2.0);
        for (raster, k) in pixels() {
            let ray = scene.sensor().sample_ray(raster, [0.5; 2]).ray;
            let expected = if scene.intersect(&ray).is_some() { 0.7 * 2.0 } else { 2.0 };
            let value = escape(&scene, ray, &mut Independent::new(1).sampler(k, 0));
            assert!((value - expected).abs() < 1e-5, "{raster:?}: {value} {expected}");
        }
    }
    let scene = scene(vec![ball(0.0, 0.7, false)], 2.0);
    let check = SUITE.check("next event estimation under the sky");
    let ray = scene.sensor().sample_ray([8.5, 7.0], [0.5; 2]).ray;
    let family = Independent::new(check.seed());
    let values: Moments =
        (0..20_000).map(|i| f64::from(next_event(&scene, ray, 0, 1, &mut family.sampler(0, i)))).collect();
    mean_is(check, &values, Truth::relative(1.4, 1e-5)).expect_pass();
    mean_is(SUITE.twin("next event estimation, 10 %"), &values, 1.1 * 1.4).expect_reject();
}

/// White balls lose no light, however often it goes to and fro between them: everything is as bright as the sky.
#[test]
fn white_balls_are_a_furnace() {
    let scene = scene(vec![ball(-1.05, 1.0, false), ball(1.05, 1.0, true), ball(3.2, 1.0, false)], 2.0);
    for (raster, k) in pixels() {
        let ray = scene.sensor().sample_ray(raster, [0.5; 2]).ray;
        assert_eq!(escape(&scene, ray, &mut Independent::new(1).sampler(k, 0)), 2.0);
    }
    // The diffuse balls alone, by next event estimation and roulette.
    let check = SUITE.check("furnace of two balls");
    let scene = self::scene(vec![ball(-1.05, 1.0, false), ball(1.05, 1.0, false)], 2.0);
    let ray = Ray::new(scene.camera.eye, (Vec3A::new(-0.4, 0.0, 0.0) - scene.camera.eye).normalize());
    let family = Independent::new(check.seed());
    let values: Moments =
        (0..20_000).map(|i| f64::from(next_event(&scene, ray, 0, u32::MAX, &mut family.sampler(0, i)))).collect();
    mean_is(check, &values, Truth::relative(2.0, 1e-5)).expect_pass();
    mean_is(SUITE.twin("a furnace that loses 10 %"), &values, 0.9 * 2.0).expect_reject();
}

/// A convex ball under a point light: `rho / pi I cos / d^2`, exactly.
#[test]
fn a_point_light_follows_the_inverse_square_law() {
    let scene = scene(vec![ball(0.0, 0.7, false)], 0.0);
    let light = Vec3A::new(3.0, 4.0, 5.0);
    let mut lit = 0;
    for (raster, k) in pixels() {
        let ray = scene.sensor().sample_ray(raster, [0.5; 2]).ray;
        let Some(vertex) = scene.intersect(&ray) else { continue };
        let between = light - vertex.point().position;
        let cos = vertex.point().normal.dot(between.normalize()).max(0.0);
        let expected = 0.7 / std::f32::consts::PI * 30.0 * cos / between.length_squared();
        let value = next_event(&scene, ray, 1, u32::MAX, &mut Independent::new(1).sampler(k, 0));
        assert!((value - expected).abs() < 1e-4 * expected + 1e-3, "{raster:?}: {value} {expected}");
        lit += u32::from(value > 0.0);
    }
    assert!(lit > 3, "{lit}");
}

/// Camera connections invert camera rays, and rays are counted exactly.
#[test]
fn the_other_laws_hold() {
    let scene = scene(vec![ball(0.0, 0.7, false)], 1.0);
    let counting = Counting::new(&scene);
    let (mut closest_hit, mut visibility) = (0, 0);
    for (raster, _) in pixels() {
        let ray = counting.sensor().sample_ray(raster, [0.5; 2]).ray;
        closest_hit += 1;
        let Some(vertex) = counting.intersect(&ray) else { continue };
        let connection = counting.sensor().connect(vertex.point().position, [0.5; 2]).unwrap();
        assert!((connection.raster[0] - raster[0]).abs() < 1e-3 && (connection.raster[1] - raster[1]).abs() < 1e-3);
        assert!((connection.wi + ray.direction).length() < 1e-5);
        visibility += 1;
        assert!(counting.visible(vertex.point(), &connection.lens));
        assert!(counting.environment_radiance(ray.direction) == 1.0);
        assert!(counting.bounding_sphere() == scene.bounding_sphere());
    }
    assert_eq!(counting.counts(), RayCounts { closest_hit, visibility });
    assert!(visibility > 3 && counting.counts().total() == closest_hit + visibility);
}
