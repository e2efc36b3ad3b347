//! Closest-hit and visibility rays through the reference scene, beside a test of every triangle. Throughput is in rays.

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use lichtwerk_benches::{blob, brute_force, camera_rays, segments, sized, triangles_of};
use scene_core::builtin::interior;
use scene_core::{Ray, ReferenceScene, Scene};

/// Rays per iteration.
const RAYS: usize = 1024;
/// Rays per iteration of the plain version.
const PLAIN_RAYS: usize = 2;

fn traversal(criterion: &mut Criterion) {
    let interior = sized(interior(), 256, 144).expect("a builtin scene");
    let blob = ReferenceScene::new(blob()).expect("a valid scene");
    let mut group = criterion.benchmark_group("traversal");
    group.warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(2)).sample_size(20);
    for (name, scene) in [("interior", &interior), ("blob", &blob)] {
        let inputs = [("camera rays", camera_rays(scene, RAYS)), ("segments", segments(scene, RAYS))];
        for (kind, rays) in &inputs {
            group.throughput(Throughput::Elements(rays.len() as u64));
            group.bench_function(format!("{name}, closest hit, {kind}"), |bencher| {
                bencher.iter(|| rays.iter().filter(|ray| scene.intersect(black_box(ray)).is_some()).count());
            });
            group.bench_function(format!("{name}, any hit, {kind}"), |bencher| {
                bencher.iter(|| rays.iter().filter(|ray| scene.occluded(black_box(ray))).count());
            });
        }
    }
    group.finish();
}

fn plain(criterion: &mut Criterion) {
    let description = blob();
    let triangles = triangles_of(&description);
    let scene = ReferenceScene::new(description).expect("a valid scene");
    let rays: Vec<Ray> = camera_rays(&scene, PLAIN_RAYS);
    let mut group = criterion.benchmark_group("brute force");
    group.warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(2)).sample_size(10);
    group.throughput(Throughput::Elements(PLAIN_RAYS as u64));
    group.bench_function("blob, closest hit, camera rays", |bencher| {
        bencher.iter(|| rays.iter().filter(|ray| brute_force(&triangles, black_box(ray)).is_some()).count());
    });
    group.finish();
}

criterion_group!(benches, traversal, plain);
criterion_main!(benches);
