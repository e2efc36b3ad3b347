//! Virtual point lights: the shading loop without its rays against its roofline, and the rays.
//!
//! The loop reads 24 bytes of a light for the geometry term and 16 for its intensity (RGB in one vector), and does 25 + 8 floating point
//! operations. 1024 lights are 40 KiB, so the second-level cache feeds it. `peak` measures how many operations the core does at
//! best in the same instructions (multiply and add in vectors of the target's width, eight independent chains): divide by 33 for the
//! roofline in lights per second. The division, one of the 25, has a unit of its own.
#![allow(missing_docs)]

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use qmc_sampling::{Independent, SamplerFamily};
use scene_core::builtin::{self, Builtin};
use scene_core::reference::SceneVertex;
use scene_core::{PowerChoice, ReferenceScene, Rgb, RussianRoulette, Scene, Sensor, Spectrum, Vertex};
use vpl_gi::{LightTracing, Partition, RobustIgi, ShadowRays, VirtualPointLights, unshadowed};

const LIGHTS: usize = 1024;
/// Floating point operations per light: see above.
const OPERATIONS: u64 = 33;

fn lights<'s>(scene: &'s ReferenceScene, paths: u32) -> VirtualPointLights<SceneVertex<'s>> {
    let choice = PowerChoice::new(scene.emitters());
    let tracing = LightTracing { choice, max_length: 16, roulette: RussianRoulette::LocalAlbedo { from_length: 0 } };
    let samplers = Independent::new(1);
    VirtualPointLights::trace(scene, &tracing, paths, |path| samplers.sampler(0, u64::from(path)))
}

/// Exactly [`LIGHTS`] of them.
fn some_lights<'s>(scene: &'s ReferenceScene) -> VirtualPointLights<SceneVertex<'s>> {
    let all = lights(scene, LIGHTS as u32);
    let mut some = VirtualPointLights::new(all.paths());
    all.as_slice().iter().take(LIGHTS).for_each(|light| some.push(scene, light.clone()));
    assert_eq!(some.len(), LIGHTS);
    some
}

/// What the camera sees, spread over the image.
fn vertices<'s>(scene: &'s ReferenceScene, count: usize) -> Vec<SceneVertex<'s>> {
    let [width, height] = scene.sensor().resolution();
    (0..count)
        .filter_map(|k| {
            let [x, y] = [(k * 37 % 101) as f32 / 101.0 * width as f32, (k * 53 % 97) as f32 / 97.0 * height as f32];
            scene.intersect(&scene.sensor().sample_ray([x, y], [0.5; 2]).ray)
        })
        .collect()
}

fn shading_loop(criterion: &mut Criterion) {
    let scene = ReferenceScene::new(builtin::cornell_box()).expect("a builtin scene");
    let lights = some_lights(&scene);
    let vertices = vertices(&scene, 64);
    let mut group = criterion.benchmark_group("virtual lights, no rays");
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(2)).sample_size(20);
    group.throughput(Throughput::Elements((vertices.len() * LIGHTS) as u64));
    for (name, partition) in [("hard", Partition::hard(1e-5)), ("soft", Partition::soft(1e-5))] {
        let partition = partition.expect("a threshold that is not negative");
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let sum = |sum: Rgb, x: &SceneVertex<'_>| sum + unshadowed(&scene, x, black_box(&lights), &partition);
                vertices.iter().fold(Rgb::ZERO, sum)
            });
        });
    }
    // The same by the plain way: one light after the other, BSDF by BSDF.
    let partition = Partition::hard(1e-5).expect("a threshold that is not negative");
    group.bench_function("plain", |bencher| {
        bencher
            .iter(|| vertices.iter().fold(Rgb::ZERO, |sum, x| sum + plain(&scene, x, black_box(&lights), &partition)));
    });
    group.finish();

    let mut group = criterion.benchmark_group("peak");
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(2)).sample_size(20);
    const STEPS: usize = 10_000;
    group.throughput(Throughput::Elements(STEPS as u64 * 64 * 2 / OPERATIONS));
    group.bench_function("lights if only arithmetic limits", |bencher| {
        bencher.iter(|| {
            let (mut x, mut y) = (black_box([1.0f32; 32]), black_box([1.0f32; 32]));
            for _ in 0..STEPS {
                x.iter_mut().for_each(|x| *x = *x * 0.999 + 0.001);
                y.iter_mut().for_each(|y| *y = *y * 0.998 + 0.002);
            }
            black_box((x, y))
        });
    });
    group.finish();
}

/// The oracle of the shading loop.
fn plain(
    scene: &ReferenceScene,
    x: &SceneVertex<'_>,
    lights: &VirtualPointLights<SceneVertex<'_>>,
    partition: &Partition,
) -> Rgb {
    use scene_core::{Emitter, TransportMode};
    use vpl_gi::{LightKind, geometry_term};
    let mut sum = Rgb::ZERO;
    for light in lights.as_slice() {
        let Some(y) = light.point() else { continue };
        let between = y.position - x.point().position;
        let d2 = between.length_squared();
        let wi = between / d2.sqrt();
        let g = geometry_term(x.point().position, x.point().normal, y.position, y.normal);
        let intensity = match &light.kind {
            LightKind::Emission { emitter, point } => {
                scene.emitters()[emitter.index()].radiance(Some(point), -wi) * point.normal.dot(wi).abs()
            }
            LightKind::Surface(vertex) => vertex.eval(-wi, TransportMode::Importance),
            LightKind::Delta { .. } | LightKind::Distant { .. } => Rgb::ZERO,
        };
        let value = x.eval(wi, TransportMode::Radiance) * intensity * light.scale * (partition.share(g, d2) / d2);
        if value.is_finite() {
            sum += value;
        }
    }
    sum
}

fn with_rays(criterion: &mut Criterion) {
    let name = "interior";
    let description = Builtin::named(name).expect("a builtin scene").description();
    let scene = ReferenceScene::new(description).expect("a builtin scene");
    let lights = lights(&scene, 32);
    let [width, height] = scene.sensor().resolution();
    let mut group = criterion.benchmark_group("robust-igi, paths");
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(2)).sample_size(10);
    let count = 256u64;
    group.throughput(Throughput::Elements(count));
    let partition = Partition::hard(1.0).expect("a threshold that is not negative");
    for (rays, shadow_rays) in [
        ("all shadow rays", ShadowRays::All),
        ("8 sampled", ShadowRays::Sampled { count: 8 }),
        ("ordered", ShadowRays::Ordered { tolerance: 0.1, remainder: 1 }),
    ] {
        let robust = RobustIgi { shadow_rays, ..RobustIgi::new(partition) };
        group.bench_function(rays, |bencher| {
            bencher.iter(|| {
                let samplers = Independent::new(2);
                let mut sum = Rgb::ZERO;
                for k in 0..count {
                    let raster =
                        [(k * 37 % 101) as f32 / 101.0 * width as f32, (k * 53 % 97) as f32 / 97.0 * height as f32];
                    let ray = scene.sensor().sample_ray(raster, [0.5; 2]).ray;
                    sum += robust.radiance(&scene, &lights, ray, &mut samplers.sampler(1, k));
                }
                sum
            });
        });
    }
    // Would shadow rays gain from coherence? The same lights along a Z-order curve, so that neighbouring rays from one origin are alike.
    let sorted = along_curve(&scene, &lights);
    let robust = RobustIgi::new(partition);
    group.bench_function("all shadow rays, lights along a curve", |bencher| {
        bencher.iter(|| {
            let samplers = Independent::new(2);
            let mut sum = Rgb::ZERO;
            for k in 0..count {
                let raster =
                    [(k * 37 % 101) as f32 / 101.0 * width as f32, (k * 53 % 97) as f32 / 97.0 * height as f32];
                let ray = scene.sensor().sample_ray(raster, [0.5; 2]).ray;
                sum += robust.radiance(&scene, &sorted, ray, &mut samplers.sampler(1, k));
            }
            sum
        });
    });
    group.finish();
}

/// Sorted by the interleaved bits of their positions.
fn along_curve<'s>(
    scene: &ReferenceScene,
    lights: &VirtualPointLights<SceneVertex<'s>>,
) -> VirtualPointLights<SceneVertex<'s>> {
    let (center, radius) = scene.bounding_sphere();
    let spread = |x: u32| (0..10).fold(0u32, |bits, k| bits | ((x >> k & 1) << (3 * k)));
    let code = |light: &vpl_gi::VirtualPointLight<SceneVertex<'s>>| {
        let place = light.point().map_or(center, |point| point.position);
        let cell = ((place - center) / radius * 511.0 + 512.0).to_array().map(|x| spread((x as u32).min(1023)));
        cell[0] | cell[1] << 1 | cell[2] << 2
    };
    let mut all: Vec<_> = lights.as_slice().to_vec();
    all.sort_by_key(code);
    let mut sorted = VirtualPointLights::new(lights.paths());
    all.into_iter().for_each(|light| sorted.push(scene, light));
    sorted
}

criterion_group!(benches, shading_loop, with_rays);
criterion_main!(benches);
