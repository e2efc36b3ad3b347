//! What a path pays for its numbers: the pattern of the path tracer over six vertices. Throughput is in paths.
//!
//! The bench of `qmc-sampling` compares samplers with those of other crates, dimension by dimension.

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use qmc_sampling::sampler::{GlobalHalton, GlobalSobol, PaddedLattice, ZSobol};
use qmc_sampling::{Independent, OwenSobol, Sampler, SamplerFamily};

/// Paths per iteration.
const PATHS: u64 = 256;
const VERTICES: u32 = 6;

/// Raster and lens, then light choice, light, lobe, scattering for each vertex.
fn path(sampler: &mut impl Sampler) -> f32 {
    let (raster, lens) = (sampler.next_2d(), sampler.next_2d());
    let mut sum = raster[0] + lens[1];
    for _ in 0..VERTICES {
        sum += sampler.next_1d() + sampler.next_2d()[0];
        sum += sampler.next_1d() + sampler.next_2d()[1];
    }
    sum
}

fn samplers(criterion: &mut Criterion) {
    fn bench(criterion: &mut Criterion, name: &str, family: &impl SamplerFamily) {
        let mut group = criterion.benchmark_group("numbers of a path");
        group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1)).sample_size(20);
        group.throughput(Throughput::Elements(PATHS));
        group.bench_function(name, |bencher| {
            bencher.iter(|| (0..PATHS).map(|i| path(&mut family.sampler(black_box(7), i))).sum::<f32>());
        });
        group.finish();
    }
    bench(criterion, "Independent", &Independent::new(1));
    bench(criterion, "OwenSobol", &OwenSobol::new(1));
    bench(criterion, "GlobalSobol", &GlobalSobol::new(1024, 1024, 1).expect("a valid size"));
    bench(criterion, "GlobalHalton", &GlobalHalton::new(1024, 1024, 1).expect("a valid size"));
    bench(criterion, "ZSobol", &ZSobol::new(1024, 1024, PATHS as u32, 1).expect("a valid size"));
    bench(criterion, "PaddedLattice", &PaddedLattice::new(1));
}

criterion_group!(benches, samplers);
criterion_main!(benches);
