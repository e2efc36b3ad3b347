//! A scene made by hand, rays traced through it, and an estimator written against the traits of `scene-core`, compared
//! with what is known exactly.
//!
//! Run with `cargo run --release --example scene_core`.
#![allow(clippy::print_stdout)]

use std::ops::ControlFlow;

use qmc_sampling::{OwenSobol, Sampler, SamplerFamily};
use scene_core::builtin::{SceneBuilder, furnace_box};
use scene_core::glam::Vec3A;
use scene_core::material::Material;
use scene_core::{
    Counting, Emitter, Ray, ReferenceScene, Rgb, RussianRoulette, Scene, SceneError, Sensor, Spectrum, TransportMode,
    Vertex, WalkStart, random_walk,
};

/// The radiance that arrives along `ray`: a walk that counts the emission of every surface it meets.
///
/// Knows no more of the scene than the trait says, so it runs on any renderer that implements it.
fn radiance<S: Scene>(scene: &S, ray: Ray, sampler: &mut impl Sampler) -> S::Spectrum {
    let mut sum = S::Spectrum::ZERO;
    let start = WalkStart {
        ray,
        throughput: S::Spectrum::splat(1.0),
        mode: TransportMode::Radiance,
        max_length: u32::MAX,
        roulette: RussianRoulette::LocalAlbedo { from_length: 3 },
    };
    random_walk(scene, start, sampler, |walk| {
        sum += walk.throughput * walk.vertex.emitted();
        ControlFlow::Continue(())
    });
    sum
}

/// A floor, a sphere that floats one unit above it and shines, a camera.
fn floor_and_lamp() -> Result<ReferenceScene, SceneError> {
    let mut builder = SceneBuilder::new("floor and lamp");
    let floor = builder.material(Material::diffuse(0.5));
    builder.quad(floor, Vec3A::new(-5.0, 0.0, -5.0), Vec3A::Z * 10.0, Vec3A::X * 10.0);
    let black = builder.material(Material::diffuse(0.0));
    builder.sphere(black, Vec3A::new(0.0, 1.0, 0.0), 0.25);
    builder.emit(Rgb::splat(10.0));
    builder.look(Vec3A::new(0.0, 1.0, -3.0), Vec3A::new(0.0, 0.5, 0.0), 45.0, 64, 48);
    ReferenceScene::new(builder.finish())
}

fn main() -> Result<(), SceneError> {
    // Trace rays: the closest surface, and whether anything is in between.
    let scene = floor_and_lamp()?;
    let down = Ray::new(Vec3A::new(0.0, 3.0, 0.0), -Vec3A::Y);
    let hit = scene.intersect(&down).expect("the sphere is below");
    println!("hit at {}, {}", hit.point().position, if hit.emitter().is_some() { "a lamp" } else { "no lamp" });
    assert!((hit.point().position.y - 1.25).abs() < 1e-5);
    assert!(scene.occluded(&down) && !scene.occluded(&down.up_to(1.5)));

    // Irradiance under the lamp against the closed form: pi L (r/d)^2 for a sphere overhead.
    let floor = scene.intersect(&Ray::new(Vec3A::new(0.0, 0.5, 0.0), -Vec3A::Y)).expect("the floor is below");
    let family = OwenSobol::new(1);
    let samples = 1024;
    let mut irradiance = 0.0f64;
    for index in 0..samples {
        let u = family.sampler(0, index).next_2d();
        let Some(light) = scene.emitters()[0].sample_direct(floor.point().position, u) else { continue };
        let visible = light.at.is_none_or(|(at, _)| scene.visible(floor.point(), &at));
        if visible {
            let cos = light.wi.dot(floor.shading_normal()).max(0.0);
            irradiance += f64::from(light.radiance.luminance() * cos / light.pdf_solid_angle);
        }
    }
    irradiance /= samples as f64;
    report("irradiance", irradiance, std::f64::consts::PI * 10.0 * 0.25f64.powi(2), 1e-3);

    // A closed box that emits 1 and reflects half of everything: L = 1 + 0.5 L = 2 wherever one looks.
    let furnace = ReferenceScene::new(furnace_box(0.5, 1.0))?;
    let furnace = Counting::new(&furnace);
    let [width, height] = furnace.sensor().resolution();
    let mut sum = 0.0f64;
    for pixel in 0..u64::from(width * height) {
        let mut sampler = family.sampler(pixel, 0);
        let [dx, dy] = sampler.next_2d();
        let raster = [(pixel % u64::from(width)) as f32 + dx, (pixel / u64::from(width)) as f32 + dy];
        let ray = furnace.sensor().sample_ray(raster, sampler.next_2d()).ray;
        sum += f64::from(radiance(&furnace, ray, &mut sampler).luminance());
    }
    println!("{} rays in the furnace", furnace.counts().total());
    report("furnace", sum / f64::from(width * height), 2.0, 0.02);
    Ok(())
}

/// Prints a result beside the truth.
fn report(name: &str, value: f64, truth: f64, tolerance: f64) {
    let error = value / truth - 1.0;
    println!("{name:<10} {value:.5}, truth {truth:.5}, error {:+.3} %", 100.0 * error);
    assert!(error.abs() < tolerance, "{name} is off");
}
