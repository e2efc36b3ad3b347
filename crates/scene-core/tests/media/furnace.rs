//! Balls and boxes in uniform light: what scatters without loss cannot be seen, what absorbs keeps Beer and Lambert's
//! law.

use estimator_checks::{Check, Moments, Truth, mean_is};
use qmc_sampling::{Independent, SamplerFamily};
use scene_core::builtin::SceneBuilder;
use scene_core::glam::Vec3A;
use scene_core::material::{Distribution, Material};
use scene_core::medium::Medium;
use scene_core::reference::Light;
use scene_core::{Ray, ReferenceScene, Rgb};

use super::{SUITE, ball, down, moments, slab};

const CHROMATIC: Rgb = Rgb::new(0.5, 4.0, 20.0);

/// The mean is one; without any variance every sample is.
fn is_one(check: Check, moments: &Moments) {
    if moments.variance() < 1e-6 {
        assert!((moments.mean() - 1.0).abs() < 1e-3, "{}", moments.mean());
    } else {
        mean_is(check, moments, Truth::relative(1.0, 2e-4)).expect_pass();
    }
}

fn lossless(sigma_s: Rgb, g: f32) -> Medium<Rgb> {
    Medium::new(Rgb::ZERO, sigma_s, g).unwrap()
}

#[test]
fn media_without_absorption_are_invisible_in_uniform_light() {
    let grey = ball(1.5, lossless(Rgb::splat(5.0), 0.5));
    let check = SUITE.check("furnace, grey");
    let values = moments(&check, &grey, down(0.8), 2000, |end| end.throughput[1]);
    is_one(check, &values);
    for (name, scene) in [
        ("matched ball", ball(1.0, lossless(CHROMATIC, 0.0))),
        ("glass ball", ball(1.5, lossless(CHROMATIC, 0.7))),
        ("glass slab", slab(1.5, 1.0, lossless(CHROMATIC, -0.4))),
    ] {
        for i in 0..3 {
            let check = SUITE.check(&format!("furnace, {name}, {i}"));
            let values = moments(&check, &scene, down(0.8), 3000, |end| end.throughput[i]);
            is_one(check, &values);
        }
    }
}

#[test]
fn a_little_absorption_is_seen() {
    let medium = Medium::from_albedo(CHROMATIC, Rgb::splat(0.995), 0.7).unwrap();
    let twin = SUITE.twin("furnace: albedo 0.995");
    let values = moments(&twin, &ball(1.5, medium), down(0.8), 20_000, |end| end.throughput[2]);
    mean_is(twin, &values, Truth::relative(1.0, 2e-4)).expect_reject();
}

/// From the middle of a ball it takes some four thousand scatterings to the surface, so that the roulette by their
/// number is played.
#[test]
fn the_longest_walks_lose_nothing_on_average() {
    let medium = lossless(Rgb::splat(90.0), 0.0);
    let scene = ball(1.0, medium);
    let values = |check: &Check| -> (Moments, Moments) {
        let family = Independent::new(check.seed());
        let walks = (0..2000).map(|i| {
            let ray = Ray::new(Vec3A::ZERO, Vec3A::X);
            medium.walk(&scene, ray, Rgb::ONE, &mut family.sampler(0, i)).map_or(0.0, |exit| exit.throughput[1])
        });
        let walks: Vec<f64> = walks.map(f64::from).collect();
        (walks.iter().copied().collect(), walks.iter().map(|value| value.min(1.0)).collect())
    };
    let check = SUITE.check("dense ball, from the middle");
    let (right, uncompensated) = values(&check);
    mean_is(check, &right, Truth::relative(1.0, 2e-4)).expect_pass();
    let twin = SUITE.twin("dense ball, from the middle: roulette without compensation");
    mean_is(twin, &uncompensated, Truth::relative(1.0, 2e-4)).expect_reject();
}

/// Rough interfaces lose some light between facets, and only some.
#[test]
fn rough_boundaries_hide_the_medium_nearly() {
    let boundary = Material::RoughDielectric {
        int_ior: 1.3,
        ext_ior: 1.0,
        specular_reflectance: 1.0.into(),
        specular_transmittance: 1.0.into(),
        distribution: Distribution::Ggx,
        alpha: [0.05; 2],
    };
    let boundary = boundary.filled_with(lossless(Rgb::splat(5.0), 0.0));
    let scene = ReferenceScene::new(scene_core::builtin::furnace(boundary)).unwrap();
    let check = SUITE.check("furnace, rough");
    let values = moments(&check, &scene, down(0.9), 4000, |end| end.throughput[1]);
    mean_is(check, &values, Truth { value: 0.99, error: 0.012 }).expect_pass();
}

/// A white ball in a medium without absorption: surfaces inside leave the medium as it is.
#[test]
fn opaque_things_inside_stay_in_the_medium() {
    let scene = |albedo: f32| {
        let mut b = SceneBuilder::new("ball in ball");
        let milk = b.material(Material::glass(1.3).filled_with(lossless(CHROMATIC, 0.3)));
        let white = b.material(Material::diffuse(albedo));
        b.sphere(milk, Vec3A::ZERO, 1.0).sphere(white, Vec3A::new(0.1, 0.0, 0.2), 0.5);
        b.light(Light::Constant { radiance: Rgb::ONE });
        b.look(Vec3A::new(0.0, 0.0, 4.0), Vec3A::ZERO, 40.0, 16, 16);
        ReferenceScene::new(b.finish()).unwrap()
    };
    for i in 0..3 {
        let check = SUITE.check(&format!("furnace, white ball inside, {i}"));
        let values = moments(&check, &scene(1.0), down(0.9), 3000, |end| end.throughput[i]);
        is_one(check, &values);
    }
    let twin = SUITE.twin("furnace, grey ball inside");
    let values = moments(&twin, &scene(0.8), down(0.9), 3000, |end| end.throughput[0]);
    mean_is(twin, &values, Truth::relative(1.0, 2e-4)).expect_reject();
}

#[test]
fn absorption_alone_has_no_variance() {
    let medium = Medium::new(Rgb::new(0.1, 0.7, 2.0), Rgb::ZERO, 0.0).unwrap();
    // Through the middle of the ball: a chord of length 2.
    let scene = ball(1.0, medium);
    let check = SUITE.twin("not a statistical check: a seed");
    for i in 0..3 {
        let values = moments(&check, &scene, down(1.0), 20, |end| end.throughput[i]);
        let truth = (-2.0 * f64::from(medium.sigma_a()[i])).exp();
        assert!(values.variance() < 1e-10 && (values.mean() / truth - 1.0).abs() < 1e-3, "{}", values.mean());
    }
}

#[test]
fn light_that_does_not_scatter_keeps_beer_and_lambert_s_law() {
    let medium = Medium::new(Rgb::new(0.1, 0.2, 0.1), Rgb::new(0.4, 0.1, 0.9), 0.9).unwrap();
    let scene = ball(1.0, medium);
    for i in 0..3 {
        let straight = |check: &Check| {
            moments(check, &scene, down(1.0), 20_000, |end| if end.scatterings == 0 { end.throughput[i] } else { 0.0 })
        };
        let truth = (-2.0 * f64::from(medium.sigma_t()[i])).exp();
        let check = SUITE.check(&format!("unscattered, {i}"));
        let values = straight(&check);
        mean_is(check, &values, Truth::relative(truth, 1e-3)).expect_pass();
        let twin = SUITE.twin(&format!("unscattered, {i}: absorption forgotten"));
        let values = straight(&twin);
        mean_is(twin, &values, (-2.0 * f64::from(medium.sigma_s()[i])).exp()).expect_reject();
    }
}
