//! The samplers beside their peers, in one run: `cargo bench -p qmc-sampling`. Throughput is in values.
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main, measurement::WallTime};
use qmc_sampling::sampler::{GlobalHalton, GlobalSobol, PaddedLattice, ZSobol};
use qmc_sampling::{Independent, OwenSobol, Sampler, SamplerFamily};
use rand::Rng;
use std::hint::black_box;
use std::time::Duration;

/// Paths per iteration.
const PATHS: u32 = 256;
/// Groups of four dimensions per path.
const GROUPS: u32 = 8;

fn group<'a>(criterion: &'a mut Criterion, name: &str) -> BenchmarkGroup<'a, WallTime> {
    let mut group = criterion.benchmark_group(name);
    group.throughput(Throughput::Elements(u64::from(4 * PATHS * GROUPS)));
    group.warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(2)).sample_size(30);
    group
}

fn four_dimensions(criterion: &mut Criterion) {
    let mut group = group(criterion, "four dimensions at once");
    group.bench_function("qmc-sampling OwenSobol", |bencher| {
        let family = OwenSobol::new(black_box(1));
        bencher.iter(|| {
            let mut sum = [0.0; 4];
            for index in 0..PATHS {
                let mut sampler = family.sampler(black_box(77), u64::from(index));
                for _ in 0..GROUPS {
                    add(&mut sum, sampler.next_4d());
                }
            }
            sum
        });
    });
    group.bench_function("qmc-sampling GlobalSobol, 2^32 points", |bencher| {
        // 4096 x 4096 pixels, 256 paths each
        let family = GlobalSobol::new(4096, 4096, black_box(1)).expect("a valid size");
        bencher.iter(|| {
            let mut sum = [0.0; 4];
            for index in 0..PATHS {
                let mut sampler = family.sampler(black_box(77_777), u64::from(index));
                for _ in 0..GROUPS {
                    add(&mut sum, sampler.next_4d());
                }
            }
            sum
        });
    });
    group.bench_function("openqmc-rs SobolSampler", |bencher| {
        bencher.iter(|| {
            let mut sum = [0.0; 4];
            for index in 0..PATHS {
                let sampler = openqmc::SobolSampler::new(black_box(77), 0, 0, index as i32);
                for key in 0..GROUPS {
                    add(&mut sum, sampler.new_domain(key as i32).draw_sample_f32::<4>());
                }
            }
            sum
        });
    });
    group.bench_function("sobol_burley sample_4d", |bencher| {
        bencher.iter(|| {
            let mut sum = [0.0; 4];
            for index in 0..PATHS {
                let seed = black_box(77);
                for set in 0..GROUPS {
                    add(&mut sum, sobol_burley::sample_4d(index, set, seed));
                }
            }
            sum
        });
    });
    group.finish();
}

fn independent(criterion: &mut Criterion) {
    let mut group = group(criterion, "independent");
    group.bench_function("qmc-sampling Independent", |bencher| {
        let mut sampler = Independent::new(black_box(1)).sampler(2, 3);
        bencher.iter(|| (0..4 * PATHS * GROUPS).map(|_| sampler.next_1d()).sum::<f32>());
    });
    group.bench_function("rand_pcg Pcg32", |bencher| {
        let mut rng = rand_pcg::Pcg32::new(black_box(1), 2);
        // as rand's StandardUniform for f32
        bencher.iter(|| (0..4 * PATHS * GROUPS).map(|_| (rng.next_u32() >> 8) as f32 / 16_777_216.0).sum::<f32>());
    });
    group.finish();
}

#[inline]
fn add(sum: &mut [f32; 4], values: [f32; 4]) {
    for (s, v) in sum.iter_mut().zip(values) {
        *s += v;
    }
}

/// As a path takes them: in pairs.
fn pairs(criterion: &mut Criterion) {
    fn bench(group: &mut BenchmarkGroup<'_, WallTime>, name: &str, family: &impl SamplerFamily) {
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let mut sum = [0.0; 4];
                for index in 0..PATHS {
                    let mut sampler = family.sampler(black_box(77_777), u64::from(index));
                    for _ in 0..GROUPS {
                        let ([a, b], [c, d]) = (sampler.next_2d(), sampler.next_2d());
                        add(&mut sum, [a, b, c, d]);
                    }
                }
                sum
            });
        });
    }
    let mut group = group(criterion, "in pairs");
    bench(&mut group, "Independent", &Independent::new(1));
    bench(&mut group, "OwenSobol", &OwenSobol::new(1));
    bench(&mut group, "GlobalSobol", &GlobalSobol::new(4096, 4096, 1).expect("a valid size"));
    bench(&mut group, "ZSobol", &ZSobol::new(4096, 4096, PATHS, 1).expect("a valid size"));
    bench(&mut group, "GlobalHalton", &GlobalHalton::new(4096, 4096, 1).expect("a valid size"));
    bench(&mut group, "PaddedLattice", &PaddedLattice::new(1));
    group.finish();
}

criterion_group!(benches, four_dimensions, independent, pairs);
criterion_main!(benches);
