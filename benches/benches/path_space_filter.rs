//! Path space filtering of surface points with about 50 neighbours, normals and albedo weights, on two threads; beside the same filter over kiddo alone. Throughput
//! is in vertices.

use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use lichtwerk_benches::surface_points;
use path_space_filter::{
    AlbedoDifference, JitteredHash, NormalCone, PathFilter, PathSpaceFilter, Radius, Search, SimilarityExt, Vertex,
};
use rayon::prelude::*;

type Rgb = Vertex<[f32; 3]>;

fn two_threads() -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("two threads")
}

/// Vertices of an image, about: in rows along the surfaces. The normals of the sphere and of the square, a texture of 16 colours, contributions that are anything.
fn vertices(count: usize) -> (Vec<Rgb>, f32) {
    let (mut points, radius) = surface_points(count);
    let row = |x: f32| (x / (4.0 * radius)) as i32;
    points.sort_by(|a, b| (row(a[0]), row(a[1])).cmp(&(row(b[0]), row(b[1]))).then(a[2].total_cmp(&b[2])));
    let vertex = |(i, p): (usize, &[f32; 3])| {
        let length = (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]).sqrt().max(1e-6);
        let shade = (((p[0] * 8.0).floor() + (p[1] * 8.0).floor()) as i32).rem_euclid(16) as f32 / 16.0;
        Vertex {
            position: *p,
            normal: if p[2] == -1.0 { [0.0, 0.0, 1.0] } else { p.map(|x| x / length) },
            albedo: [shade, 0.5, 1.0 - shade],
            path_length: 1.0,
            contribution: [(i % 17) as f32, (i % 5) as f32, (i % 3) as f32],
            ..Vertex::default()
        }
    };
    (points.iter().enumerate().map(vertex).collect(), radius)
}

/// The same averages, with nothing but kiddo.
fn over_kiddo(vertices: &[Rgb], radius: f32) -> Vec<[f32; 3]> {
    let points: Vec<[f32; 3]> = vertices.iter().map(|vertex| vertex.position).collect();
    let tree = ImmutableKdTree::<f32, 3>::new_from_slice(&points).expect("a tree");
    let mean = |i: &Rgb| {
        let (mut sum, mut count) = ([0.0_f64; 3], 0.0);
        for found in tree.query(&i.position).within::<SquaredEuclidean<f32>>(radius * radius).unsorted().execute() {
            let j = &vertices[found.item as usize];
            let cosine: f32 = (0..3).map(|k| i.normal[k] * j.normal[k]).sum();
            let difference: f32 = (0..3).map(|k| (i.albedo[k] - j.albedo[k]).powi(2)).sum();
            if cosine >= 0.95 && difference <= 0.05 * 0.05 {
                count += 1.0;
                (0..3).for_each(|k| sum[k] += f64::from(j.contribution[k]));
            }
        }
        sum.map(|s| (s / count) as f32)
    };
    vertices.par_iter().map(mean).collect()
}

#[expect(clippy::print_stdout, reason = "the number of neighbours belongs to the times")]
fn filters(criterion: &mut Criterion) {
    let pool = two_threads();
    // The largest take minutes: not when benches are merely tested.
    let most = if std::env::args().any(|argument| argument == "--test") { 100_000 } else { 10_000_000 };
    for count in [100_000, 1_000_000, 10_000_000].into_iter().filter(|&count| count <= most) {
        let (vertices, radius) = vertices(count);
        let radius_of = Radius::absolute(radius).expect("a radius");
        let filter = PathSpaceFilter::new(radius_of).similarity(NormalCone::PAPER.and(AlbedoDifference::PAPER));
        let hash = JitteredHash::new(radius_of).key(|vertex: &Rgb| (vertex.albedo[0] * 16.0) as u32);
        println!(
            "{count} vertices: {:.1} averaged of each by search, {:.1} by hash",
            pool.install(|| filter.average(&vertices, 1).mean_count()),
            pool.install(|| hash.average(&vertices, 1).mean_count()),
        );
        let mut group = criterion.benchmark_group(format!("path space filter, {count} vertices, two threads"));
        group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1)).sample_size(10);
        group.throughput(Throughput::Elements(count as u64));
        group.bench_function("grid", |b| b.iter(|| pool.install(|| filter.average(&vertices, 1))));
        group.bench_function("hash", |b| b.iter(|| pool.install(|| hash.average(&vertices, 1))));
        if count <= 1_000_000 {
            group.bench_function("kiddo alone", |b| b.iter(|| pool.install(|| over_kiddo(&vertices, radius))));
            for search in [Search::KdTree, Search::Hierarchy, Search::DivideAndConquer] {
                let filter = filter.search(search);
                group.bench_function(format!("{search:?}"), |b| {
                    b.iter(|| pool.install(|| filter.average(&vertices, 1)))
                });
            }
        }
        group.finish();
    }
}

criterion_group!(benches, filters);
criterion_main!(benches);
