//! What a candidate costs beyond drawing it and evaluating its target: streams, batches, and reuse. In `f32`, one thread.
//!
//! Throughput is in candidates (merges). `source and target` sums up the weights and is what the others are to be compared with:
//! the difference of the times per element is the overhead. It includes the number that selects.

use std::hint::black_box;
use std::time::Duration;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use ris::{
    AliasTable, Batch, OneNumber, Pairwise, PrefixSums, Proposal, Resampled, Reservoir, Source, Target, Uniform,
};

/// Candidates per reservoir, and reservoirs per iteration.
const CANDIDATES: u32 = 32;
const RESERVOIRS: u32 = 64;
/// Neighbours per receiver.
const NEIGHBOURS: usize = 5;

/// PCG32 of a fixed seed.
struct Numbers(u64);

impl Uniform<f32> for Numbers {
    #[inline(always)]
    fn next_uniform(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let mixed = (((self.0 >> 18) ^ self.0) >> 27) as u32;
        (mixed.rotate_right((self.0 >> 59) as u32) >> 8) as f32 / 16_777_216.0
    }
}

/// A number, uniform.
struct Cheap;

impl Source<f32> for Cheap {
    #[inline(always)]
    fn propose(&self, uniform: &mut impl Uniform<f32>) -> Option<Proposal<f32>> {
        Some(Proposal { sample: uniform.next_uniform(), density: 1.0 })
    }
    fn density(&self, _: &f32) -> f32 {
        1.0
    }
}

/// A triangle that emits.
struct Light {
    corner: [f32; 3],
    edges: [[f32; 3]; 2],
    radiance: f32,
}

/// A point on one of many lights: what next event estimation draws.
struct Lights(Vec<Light>);

#[derive(Clone, Copy)]
struct OnLight {
    light: u32,
    point: [f32; 3],
}

fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl Lights {
    fn new(count: usize) -> Self {
        let mut numbers = Numbers(3);
        let mut vector = || [(); 3].map(|()| numbers.next_uniform() - 0.5);
        let light = |_| {
            let [corner, a, b, [radiance, ..]] = [(); 4].map(|()| vector());
            Light { corner: corner.map(|x| 8.0 * x), edges: [a, b], radiance: 1.0 + radiance }
        };
        Self((0..count).map(light).collect())
    }

    /// The unshadowed contribution to a diffuse surface at the origin.
    #[inline(always)]
    fn unshadowed(&self, x: &OnLight) -> f32 {
        let light = &self.0[x.light as usize];
        let normal = cross(light.edges[0], light.edges[1]);
        let distance_squared = dot(x.point, x.point);
        let cosines = x.point[2].max(0.0) * dot(normal, x.point).abs() / dot(normal, normal).sqrt();
        light.radiance * cosines / (distance_squared * distance_squared)
    }
}

impl Source<OnLight> for Lights {
    #[inline(always)]
    fn propose(&self, uniform: &mut impl Uniform<f32>) -> Option<Proposal<OnLight>> {
        let index = (uniform.next_uniform() * self.0.len() as f32) as usize;
        let light = self.0.get(index)?;
        let root = uniform.next_uniform().sqrt();
        let (u, v) = (1.0 - root, uniform.next_uniform() * root);
        let point = core::array::from_fn(|i| light.corner[i] + u * light.edges[0][i] + v * light.edges[1][i]);
        let normal = cross(light.edges[0], light.edges[1]);
        let density = 2.0 / (dot(normal, normal).sqrt() * self.0.len() as f32);
        Some(Proposal { sample: OnLight { light: index as u32, point }, density })
    }
    fn density(&self, _: &OnLight) -> f32 {
        f32::NAN // never asked
    }
}

/// One after the other: source and target alone, streams, batches.
fn ways<X: Copy>(group: &mut BenchmarkGroup<'_, WallTime>, source: &impl Source<X>, target: &impl Target<X>) {
    fn bench(group: &mut BenchmarkGroup<'_, WallTime>, name: &str, mut resample: impl FnMut(&mut Numbers) -> f32) {
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let mut numbers = black_box(Numbers(7));
                (0..RESERVOIRS).map(|_| resample(&mut numbers)).sum::<f32>()
            });
        });
    }
    // Borrowed through black boxes, so that nothing of them is known in advance.
    let draw = |numbers: &mut Numbers| {
        let proposal = black_box(source).propose(numbers);
        proposal.unwrap_or_else(|| unreachable!("the sources of this bench never fail"))
    };
    bench(group, "source and target", |numbers| {
        (0..CANDIDATES)
            .map(|_| {
                let Proposal { sample, density } = draw(numbers);
                target.score(&sample) / density
            })
            .sum()
    });
    bench(group, "stream", |numbers| {
        let mut reservoir = Reservoir::new();
        for _ in 0..CANDIDATES {
            let Proposal { sample, density } = draw(numbers);
            reservoir.update(sample, target.score(&sample), 1.0 / density, numbers.next_uniform());
        }
        reservoir.finish().contribution_weight()
    });
    bench(group, "stream by one number", |numbers| {
        let mut reservoir = Reservoir::new();
        let mut number = OneNumber::new(numbers.next_uniform());
        for _ in 0..CANDIDATES {
            let Proposal { sample, density } = draw(numbers);
            reservoir.update_by(sample, target.score(&sample), 1.0 / density, &mut number);
        }
        reservoir.finish().contribution_weight()
    });
    bench(group, "batch, prefix sums", |numbers| {
        let batch = Batch::<_, f32, PrefixSums>::new((0..CANDIDATES).map(|_| draw(numbers)), target);
        batch.select(numbers.next_uniform()).contribution_weight()
    });
    bench(group, "batch, alias table", |numbers| {
        let batch = Batch::<_, f32, AliasTable>::new((0..CANDIDATES).map(|_| draw(numbers)), target);
        batch.select(numbers.next_uniform()).contribution_weight()
    });
}

fn group<'a>(criterion: &'a mut Criterion, name: &str) -> BenchmarkGroup<'a, WallTime> {
    let mut group = criterion.benchmark_group(name);
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1)).sample_size(20);
    group.throughput(Throughput::Elements(u64::from(CANDIDATES * RESERVOIRS)));
    group
}

/// Pairwise reuse of five neighbours, beside merging them.
fn reuse(criterion: &mut Criterion) {
    let mut numbers = Numbers(5);
    let target = |tilt: f32| move |x: &f32| tilt + x;
    let inputs: Vec<Resampled<f32>> = (0..1024)
        .map(|k| {
            let candidates = [(); 4].map(|()| Proposal { sample: numbers.next_uniform(), density: 1.0 });
            Reservoir::stream(candidates, &target(k as f32 / 1024.0), &mut numbers)
        })
        .collect();
    let mut group = criterion.benchmark_group("reuse");
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1)).sample_size(20);
    group.throughput(Throughput::Elements((inputs.len() / (NEIGHBOURS + 1) * NEIGHBOURS) as u64));
    let mut bench = |name: &str, combine: &dyn Fn(&[Resampled<f32>], &mut Numbers) -> f32| {
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let mut numbers = black_box(Numbers(9));
                inputs.chunks_exact(NEIGHBOURS + 1).map(|inputs| combine(inputs, &mut numbers)).sum::<f32>()
            });
        });
    };
    bench("pairwise", &|inputs, numbers| {
        let (here, there) = (target(0.5), target(0.25));
        let mut pairwise = Pairwise::new(inputs[0], 4.0 * NEIGHBOURS as f32);
        for neighbour in &inputs[1..] {
            pairwise.add(*neighbour, &here, &there, numbers.next_uniform());
        }
        pairwise.finish(numbers.next_uniform()).contribution_weight()
    });
    bench("merge", &|inputs, numbers| {
        let mut reservoir = Reservoir::new();
        for input in inputs {
            reservoir.merge(*input, &target(0.5), numbers.next_uniform());
        }
        reservoir.finish().contribution_weight()
    });
    group.finish();
}

fn resampling(criterion: &mut Criterion) {
    ways(&mut group(criterion, "candidates, cheap source"), &Cheap, &|x: &f32| x + 0.1);
    let lights = Lights::new(1000);
    ways(&mut group(criterion, "candidates, points on 1000 lights"), &lights, &|x: &OnLight| lights.unshadowed(x));
}

criterion_group!(benches, resampling, reuse);
criterion_main!(benches);
