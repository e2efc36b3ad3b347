//! Path space filtering of surface points with about 50 neighbours, normals and albedo weights, on two threads; beside the same filter over kiddo alone. Throughput
//! is in vertices.

use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use lichtwerk_benches::{RgbVertex, filter_over_kiddo, vertices};
use path_space_filter::{
    AlbedoDifference, JitteredHash, NormalCone, PathFilter, PathSpaceFilter, Radius, Search, SimilarityExt,
};

fn two_threads() -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("two threads")
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
        let hash = JitteredHash::new(radius_of).key(|vertex: &RgbVertex| (vertex.albedo[0] * 16.0) as u32);
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
            group.bench_function("kiddo alone", |b| b.iter(|| pool.install(|| filter_over_kiddo(&vertices, radius))));
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
