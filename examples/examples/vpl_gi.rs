//! A closed box whose walls emit 1 and reflect half of what arrives: every ray sees `1 + 1/2 + 1/4 + .. = 2`.
//!
//! Instant radiosity clamps the geometry term and loses light in the corners; robust instant global illumination scatters a ray
//! where the term is large, and loses nothing. Their errors against the truth, what a pixel costs in rays, and bidirectional path tracing beside.
//!
//! Run with `cargo run --release --example vpl_gi`.
#![allow(clippy::print_stdout)]

use mis_heuristics::{Power, RunningVariance};
use qmc_sampling::{Independent, IndependentSampler, SamplerFamily};
use scene_core::{Counting, PowerChoice, Ray, ReferenceScene, RussianRoulette, Scene, Sensor, Spectrum, builtin};
use vpl_gi::{
    Bidirectional, Classical, LightPaths, LightTracing, Partition, Residual, RobustIgi, TechniqueSet, Threshold,
    VirtualPointLights,
};

/// Radiance everywhere.
const TRUTH: f64 = 2.0;
/// Rays from the camera, for each of which all light paths are new.
const SAMPLES: u64 = 4000;
/// Light paths that a ray is connected to.
const LIGHT_PATHS: u32 = 8;
/// In units of one over the squared radius of the scene.
const THRESHOLD: f32 = 10.0;

/// Mean over random places of the image; prints it with its standard error, the bias, and the rays.
fn estimate(
    name: &str,
    scene: &ReferenceScene,
    radiance: impl Fn(&Counting<'_, ReferenceScene>, Ray, &dyn Fn(u32) -> IndependentSampler) -> f32,
) -> (f64, f64) {
    let (counting, numbers) = (Counting::new(scene), Independent::new(7));
    let [width, height] = scene.sensor().resolution();
    let mut values = RunningVariance::new();
    for index in 0..SAMPLES {
        let [u, v] = [index * 37 % 101, index * 53 % 97];
        let raster = [(u as f32 + 0.5) / 101.0 * width as f32, (v as f32 + 0.5) / 97.0 * height as f32];
        let ray = scene.sensor().sample_ray(raster, [0.5; 2]).ray;
        values.push(f64::from(radiance(&counting, ray, &|stream| numbers.sampler(u64::from(stream), index))));
    }
    let (mean, error) = (values.mean().unwrap_or(0.0), values.variance_of_mean().unwrap_or(0.0).sqrt());
    let rays = counting.counts().total() as f64 / SAMPLES as f64;
    println!("{name:<34} {mean:.4} +- {error:.4}   off by {:>7.4}   {rays:>5.1} rays", mean - TRUTH);
    (mean, error)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = ReferenceScene::new(builtin::furnace_box(0.5, 1.0))?;
    let threshold = Threshold::normalised(THRESHOLD).resolve(scene.bounding_sphere().1);
    let tracing = LightTracing {
        choice: PowerChoice::new(scene.emitters()),
        max_length: u32::MAX,
        roulette: RussianRoulette::LocalAlbedo { from_length: 0 },
    };
    // The streams of numbers: 0 for the eye path, 1 and on for light paths.
    let virtual_lights = |robust: RobustIgi| {
        let tracing = &tracing;
        move |scene: &Counting<'_, ReferenceScene>, ray: Ray, numbers: &dyn Fn(u32) -> IndependentSampler| {
            let lights = VirtualPointLights::trace(scene, tracing, LIGHT_PATHS, |path| numbers(1 + path));
            robust.radiance(scene, &lights, ray, &mut numbers(0)).luminance()
        }
    };

    println!("truth: {TRUTH}, {LIGHT_PATHS} light paths, threshold {THRESHOLD} / R^2\n");
    let hard = RobustIgi::new(Partition::hard(threshold)?);
    let soft = RobustIgi::new(Partition::soft(threshold)?);
    let clamped = RobustIgi { residual: Residual::Drop, ..soft };
    let (mean, error) = estimate("robust, hard partition", &scene, virtual_lights(hard));
    assert!((mean - TRUTH).abs() < 6.0 * error);
    let (mean, error) = estimate("robust, soft partition", &scene, virtual_lights(soft));
    assert!((mean - TRUTH).abs() < 6.0 * error);
    let (mean, error) = estimate("instant radiosity, clamped", &scene, virtual_lights(clamped));
    assert!(TRUTH - mean > 6.0 * error, "clamping loses light");
    let path = RobustIgi::new(Partition::hard(0.0)?);
    let (mean, error) = estimate("threshold 0: path tracing", &scene, virtual_lights(path));
    assert!((mean - TRUTH).abs() < 6.0 * error);

    let bidirectional = Bidirectional {
        heuristic: Classical(Power::TWO),
        techniques: TechniqueSet::WithoutLens,
        tracing: LightTracing { choice: PowerChoice::new(scene.emitters()), ..tracing },
        max_depth: u32::MAX,
        roulette: hard.roulette,
    };
    let (mean, error) = estimate("bidirectional, power heuristic", &scene, |scene, ray, numbers| {
        let mut lights = LightPaths::new(scene);
        bidirectional.trace_light_paths(scene, &mut lights, LIGHT_PATHS, |path| numbers(1 + path));
        bidirectional.radiance(scene, &lights, ray, &mut numbers(0), &mut ()).luminance()
    });
    assert!((mean - TRUTH).abs() < 6.0 * error);
    Ok(())
}
