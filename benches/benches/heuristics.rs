//! One weight of each heuristic, for two techniques (next event estimation and scattering) and for eight (the connections
//! of a bidirectional path). Densities are at hand; where they must be computed, count them with `Counting`.

use std::hint::black_box;
use std::time::Duration;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use mis_heuristics::{Balance, Cutoff, Heuristic, Maximum, Power, Stratification};
use qmc_sampling::{Independent, Sampler, SamplerFamily};

/// Weights per iteration.
const WEIGHTS: usize = 256;

fn densities<const N: usize>() -> Vec<[f32; N]> {
    let mut numbers = Independent::new(4).sampler(0, 0);
    (0..WEIGHTS).map(|_| [(); N].map(|()| (8.0 * numbers.next_1d() - 4.0).exp())).collect()
}

fn bench<const N: usize>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    name: &str,
    inputs: &[[f32; N]],
    heuristic: &impl Heuristic<f32>,
) {
    group.bench_function(name, |bencher| {
        bencher.iter(|| {
            let weights = inputs.iter().enumerate().map(|(i, d)| black_box(heuristic).weight(i % N, black_box(d)));
            weights.sum::<f32>()
        });
    });
}

fn all<const N: usize>(criterion: &mut Criterion) {
    let inputs = densities::<N>();
    let mut group = criterion.benchmark_group(format!("weight among {N}"));
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1)).sample_size(20);
    group.throughput(Throughput::Elements(WEIGHTS as u64));
    bench(&mut group, "balance", &inputs, &Balance);
    bench(&mut group, "power, exponent 2", &inputs, &Power::TWO);
    bench(&mut group, "power, exponent 1.5", &inputs, &Power::new(1.5).expect("a positive exponent"));
    bench(&mut group, "maximum", &inputs, &Maximum);
    bench(&mut group, "cutoff", &inputs, &Cutoff::new(0.1).expect("a fraction"));
    bench(&mut group, "stratification", &inputs, &Stratification::new(|k: usize| black_box(k) == 1));
    group.finish();
}

fn heuristics(criterion: &mut Criterion) {
    all::<2>(criterion);
    all::<8>(criterion);
}

criterion_group!(benches, heuristics);
criterion_main!(benches);
