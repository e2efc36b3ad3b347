//! The path tracer on builtin scenes, on one thread. Throughput is in paths.

use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use lichtwerk::estimators::{CameraEstimator, FirstEvent, NextEvent, OwnSampling, PathTracer};
use lichtwerk_benches::sized;
use mis_heuristics::Power;
use qmc_sampling::{OwenSobol, Sampler, SamplerFamily};
use scene_core::builtin::{cornell_box, interior};
use scene_core::{PowerChoice, ReferenceScene, RussianRoulette, Scene, Sensor, Spectrum};

const WIDTH: u32 = 64;
const HEIGHT: u32 = 36;

/// One path per pixel; the sum of the image.
fn pass(scene: &ReferenceScene, estimator: &impl CameraEstimator, index: u64) -> f32 {
    let family = OwenSobol::new(1);
    let mut sum = 0.0;
    for y in 0..HEIGHT {
        for x in 0..WIDTH {
            let mut sampler = family.sampler(u64::from(y * WIDTH + x), index);
            let [dx, dy] = sampler.next_2d();
            let ray = scene.sensor().sample_ray([x as f32 + dx, y as f32 + dy], sampler.next_2d()).ray;
            sum += estimator.radiance(scene, ray, &mut sampler).0.luminance();
        }
    }
    sum
}

fn path_tracing(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("path tracing");
    group.warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(4)).sample_size(10);
    group.throughput(Throughput::Elements(u64::from(WIDTH * HEIGHT)));
    for (description, max_depth) in [(cornell_box(), 6), (interior(), 6), (interior(), u32::MAX)] {
        let scene = sized(description, WIDTH, HEIGHT).expect("a builtin scene");
        let estimator = PathTracer {
            direct: NextEvent { heuristic: Power::TWO, choice: PowerChoice::new(scene.emitters()) },
            scattering: OwnSampling,
            max_depth,
            roulette: RussianRoulette::PathThroughput { from_length: 4 },
            first_event: FirstEvent::Any,
        };
        let depth = if max_depth == u32::MAX { "any depth".to_owned() } else { format!("depth {max_depth}") };
        let mut index = 0;
        group.bench_function(format!("{}, {depth}", scene.name()), |bencher| {
            bencher.iter(|| {
                index += 1;
                pass(&scene, &estimator, index)
            });
        });
    }
    group.finish();
}

criterion_group!(benches, path_tracing);
criterion_main!(benches);
