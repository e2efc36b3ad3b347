//! Range searches over a million surface points with about 50 neighbours, beside kiddo alone. Throughput is in points or queries.
//!
//! On one thread, but where the name says two.

use std::hint::black_box;
use std::time::Duration;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use lichtwerk_benches::{kiddo_nearest, kiddo_tree, kiddo_within, surface_points};
use range_search::{Bvh, HashGrid, KdTree, RangeIndex, divide_and_conquer};

/// Points.
const POINTS: usize = 1_000_000;
/// Queries of a group, unless all points are.
const QUERIES: usize = 20_000;
/// Neighbours of a nearest-neighbour query.
const NEAREST: usize = 50;

fn group<'a>(criterion: &'a mut Criterion, name: &str, elements: usize) -> BenchmarkGroup<'a, WallTime> {
    let mut group = criterion.benchmark_group(name);
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1)).sample_size(10);
    group.throughput(Throughput::Elements(elements as u64));
    group
}

fn two_threads() -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("two threads")
}

fn build(criterion: &mut Criterion) {
    let (points, radius) = surface_points(POINTS);
    let points = &points;
    let pool = two_threads();
    let mut group = group(criterion, "range search, build", POINTS);
    group.bench_function("kiddo", |b| b.iter(|| kiddo_tree(points)));
    group.bench_function("grid", |b| b.iter(|| HashGrid::build(points, |p| *p, radius)));
    group.bench_function("grid, two threads", |b| {
        b.iter(|| pool.install(|| HashGrid::par_build(points, |p| *p, radius)));
    });
    group.bench_function("k-d tree", |b| b.iter(|| KdTree::build(points, |p| *p)));
    group.bench_function("hierarchy", |b| b.iter(|| Bvh::build(points, |p| *p)));
    group.finish();
}

/// The neighbours' squared distances, summed up.
fn sum_within(index: &impl RangeIndex, queries: &[[f32; 3]], radius: f32) -> f32 {
    let mut sum = 0.0;
    for query in queries {
        index.for_each_within(*query, radius, |id, distance_squared| {
            black_box(id);
            sum += distance_squared;
        });
    }
    sum
}

fn queries(criterion: &mut Criterion) {
    let (points, radius) = surface_points(POINTS);
    let grid = HashGrid::build(&points, |p| *p, radius).expect("a grid");
    let kiddo = kiddo_tree(&points);
    let tree = KdTree::build(&points, |p| *p).expect("a tree");
    let bvh = Bvh::build(&points, |p| *p).expect("a hierarchy");
    // In random order, and one after the other along the surface.
    let random = points[..QUERIES].to_vec();
    let ordered: Vec<[f32; 3]> = grid.order().skip(POINTS / 2).take(QUERIES).map(|id| points[id]).collect();
    for (order, queries) in [("random order", &random), ("in order", &ordered)] {
        let mut group = group(criterion, &format!("range search, fixed radius, {order}"), QUERIES);
        group.bench_function("kiddo", |b| b.iter(|| kiddo_within(&kiddo, black_box(queries), radius)));
        group.bench_function("grid", |b| b.iter(|| sum_within(&grid, black_box(queries), radius)));
        group.bench_function("grid, half the radius", |b| {
            b.iter(|| sum_within(&grid, black_box(queries), 0.5 * radius));
        });
        group.bench_function("k-d tree", |b| b.iter(|| sum_within(&tree, black_box(queries), radius)));
        group.bench_function("hierarchy", |b| b.iter(|| sum_within(&bvh, black_box(queries), radius)));
        group.finish();
    }

    let mut group = group(criterion, "range search, 50 nearest, random order", QUERIES);
    group.bench_function("kiddo", |b| b.iter(|| kiddo_nearest(&kiddo, &random, NEAREST)));
    fn nearest(index: &impl RangeIndex, queries: &[[f32; 3]]) -> f32 {
        let mut found = Vec::new();
        let farthest = |query: &[f32; 3]| {
            index.k_nearest(*query, NEAREST, f32::INFINITY, &mut found);
            found.last().map(|last| last.distance_squared())
        };
        queries.iter().filter_map(farthest).sum()
    }
    group.bench_function("grid", |b| b.iter(|| nearest(&grid, &random)));
    group.bench_function("k-d tree", |b| b.iter(|| nearest(&tree, &random)));
    group.bench_function("hierarchy", |b| b.iter(|| nearest(&bvh, &random)));
    group.finish();
}

fn all_points(criterion: &mut Criterion) {
    let (points, radius) = surface_points(POINTS);
    let grid = HashGrid::build(&points, |p| *p, radius).expect("a grid");
    let kiddo = kiddo_tree(&points);
    let ordered: Vec<[f32; 3]> = grid.order().map(|id| points[id]).collect();
    let mut group = group(criterion, "range search, all points around all points", POINTS);
    group.bench_function("kiddo, random order", |b| b.iter(|| kiddo_within(&kiddo, &points, radius)));
    group.bench_function("kiddo, in order", |b| b.iter(|| kiddo_within(&kiddo, &ordered, radius)));
    group.bench_function("grid, one by one, in order", |b| b.iter(|| sum_within(&grid, &ordered, radius)));
    group.bench_function("divide and conquer", |b| {
        b.iter(|| {
            let mut sum = 0.0;
            divide_and_conquer(
                &points,
                |p| *p,
                &points,
                |q| *q,
                radius,
                |_, found| {
                    sum += found.iter().map(|neighbour| neighbour.distance_squared()).sum::<f32>();
                },
            )
            .map(|()| sum)
        });
    });
    group.finish();
}

/// A filter: the mean of what the neighbours carry, in all points.
fn filter(criterion: &mut Criterion) {
    let pool = two_threads();
    // The largest takes half a minute: not when benches are merely tested.
    let most = if std::env::args().any(|argument| argument == "--test") { 1_000_000 } else { 10_000_000 };
    for count in [100_000, 1_000_000, 10_000_000].into_iter().filter(|&count| count <= most) {
        let (points, radius) = surface_points(count);
        let grid = HashGrid::build(&points, |p| *p, radius).expect("a grid");
        let payloads = grid.reorder(&points.iter().map(|point| point[0]).collect::<Vec<f32>>());
        let mean = |neighbourhood: range_search::Neighbourhood<'_>| {
            let sum: f32 = neighbourhood.slots().iter().map(|&slot| payloads[slot as usize]).sum();
            sum / neighbourhood.len() as f32
        };
        let mut group = group(criterion, &format!("range search, self-query with means, {count} points"), count);
        group.bench_function("grid", |b| b.iter(|| grid.self_query(radius).map(mean)));
        group
            .bench_function("grid, two threads", |b| b.iter(|| pool.install(|| grid.self_query(radius).par_map(mean))));
        group.finish();
    }
}

criterion_group!(benches, build, queries, all_points, filter);
criterion_main!(benches);
