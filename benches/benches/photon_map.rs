//! Photon maps: storing, building, density estimates from about 50 photons, the decision to keep a photon, and the
//! choice of shadow rays among 100 and 10,000 lights, whose cost must not differ.

use std::hint::black_box;
use std::time::Duration;

use criterion::{
    BatchSize, BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main, measurement::WallTime,
};
use photon_map::{
    Allocation, Bound, ContributingLights, DensityEstimation, DepositionExt, Gather, GatherPoint, ImportanceMap,
    ImportanceScale, ImportonDeposition, KeepAll, Kernel, LightSelection, LightTable, MapPartition, Photon, PhotonMap,
    Photons, PrimaryPhotonMap, PrimaryPhotons, Scratch, ShadowRays,
};
use qmc_sampling::{Independent, Sampler, SamplerFamily};

/// Photons of the map.
const PHOTONS: u64 = 1_000_000;
/// Queries per iteration.
const QUERIES: u64 = 1000;
const UP: [f32; 3] = [0.0, 0.0, 1.0];

/// On the faces of a unit cube, as in a room.
fn photon(index: u64) -> Photon<[f32; 3]> {
    let mut numbers = Independent::new(1).sampler(0, index);
    let ([x, y], [u, v]) = (numbers.next_2d(), numbers.next_2d());
    let side = (index / 3 % 2) as f32;
    let position = match index % 3 {
        0 => [x, y, side],
        1 => [side, x, y],
        _ => [y, side, x],
    };
    Photon::new(position, [u - 0.5, v - 0.5, 0.7], [1.0, 0.8, 0.6])
}

fn photons(count: u64) -> Photons<[f32; 3]> {
    let mut photons = Photons::with_capacity(count as usize);
    (0..count).for_each(|index| photons.store(photon(index)));
    photons.add_paths(count);
    photons
}

/// On the floor, away from the walls: neighbours come one after the other, as pixels do.
fn points() -> Vec<GatherPoint> {
    let place = |i: u64| [0.2 + 0.6 * (i % 40) as f32 / 40.0, 0.2 + 0.6 * (i / 40) as f32 / 25.0, 0.0];
    (0..QUERIES).map(|i| GatherPoint::on(place(i), UP)).collect()
}

fn group<'c>(criterion: &'c mut Criterion, name: &str) -> BenchmarkGroup<'c, WallTime> {
    let mut group = criterion.benchmark_group(name);
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(2)).sample_size(20);
    group
}

fn maps(criterion: &mut Criterion) {
    let mut group = group(criterion, "photon map");
    let ready: Vec<_> = (0..100_000).map(photon).collect();
    group.throughput(Throughput::Elements(ready.len() as u64));
    group.bench_function("store 100,000", |bencher| {
        bencher.iter_batched_ref(
            || Photons::with_capacity(ready.len()),
            |photons| ready.iter().for_each(|photon| photons.store(*black_box(photon))),
            BatchSize::LargeInput,
        );
    });
    let all = photons(PHOTONS);
    group.throughput(Throughput::Elements(PHOTONS));
    group.sample_size(10);
    group.bench_function("build 1,000,000", |bencher| {
        bencher.iter_batched(|| all.clone(), |photons| PhotonMap::build(photons, 0.01), BatchSize::PerIteration);
    });
    group.finish();
}

/// A sixth of a million photons lie on the floor: 50 of them within a radius of 0.0098.
fn estimates(criterion: &mut Criterion) {
    let mut group = group(criterion, "density estimate");
    let map = PhotonMap::build(photons(PHOTONS), 0.0098).expect("photons of a million paths");
    let (points, mut scratch) = (points(), Scratch::default());
    group.throughput(Throughput::Elements(QUERIES));
    let within = Gather::within(0.0098).expect("a radius");
    let nearest = Gather::nearest(50, 0.1).expect("a count and a radius");
    for (name, gather, kernel) in [
        ("radius, constant", within, Kernel::Constant),
        ("radius, cone", within, Kernel::CONE),
        ("radius, Epanechnikov", within, Kernel::Epanechnikov),
        ("50 nearest, Epanechnikov", nearest, Kernel::Epanechnikov),
    ] {
        let estimation = DensityEstimation { gather, kernel };
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                points.iter().map(|at| map.irradiance(&estimation, black_box(at), &mut scratch).value[0]).sum::<f32>()
            });
        });
    }
    group.finish();
}

fn decisions(criterion: &mut Criterion) {
    let mut importons = Photons::new();
    for index in 0..100_000 {
        importons.store(Photon::new(photon(index).position, UP, 1.0_f32));
    }
    importons.add_paths(100_000);
    let look = DensityEstimation { gather: Gather::within(0.03).expect("a radius"), kernel: Kernel::Constant };
    let map = PhotonMap::build(importons, 0.03).expect("importons of many paths");
    let importance = ImportanceMap::new(map, look);
    let scale = ImportanceScale::new(0.5 / importance.at([0.5, 0.5, 0.0])).expect("importance on the floor");
    let by_importance = ImportonDeposition::new(&importance, scale, Bound::Floor(0.01)).expect("a probability");
    let partition = MapPartition::two_numbers(0.1).expect("a ratio");
    let inputs: Vec<_> = (0..QUERIES)
        .map(|index| (photon(index), Independent::new(2).sampler(0, index).next_2d().map(f64::from)))
        .collect();

    let mut group = group(criterion, "deposition decision");
    group.throughput(Throughput::Elements(QUERIES));
    group.bench_function("keep all", |bencher| {
        bencher.iter(|| inputs.iter().filter_map(|(photon, u)| KeepAll.decide(*black_box(photon), u[0])).count());
    });
    group.bench_function("by importance, 47 importons", |bencher| {
        bencher.iter(|| inputs.iter().filter_map(|(photon, u)| by_importance.decide(*black_box(photon), u[0])).count());
    });
    group.bench_function("the same for a tenth in the global map", |bencher| {
        let decide = |(photon, u): &(Photon<_>, [f64; 2])| partition.decide(*black_box(photon), 0, &by_importance, *u);
        bencher.iter(|| inputs.iter().filter_map(decide).count());
    });
    group.finish();
}

/// Eight lights contribute anywhere, of however many; 60 primary photons are found.
fn lights(criterion: &mut Criterion) {
    let mut group = group(criterion, "light selection");
    group.throughput(Throughput::Elements(QUERIES));
    for count in [100_u32, 10_000] {
        let selection = LightTable::uniform(count as usize)
            .map(|table| LightSelection::new(table, 8, 1, Allocation::BrightestFirst).expect("rays"))
            .expect("lights");
        let mut primary = PrimaryPhotons::new();
        for index in 0..150_000 {
            let mut photon = photon(6 * index).from_light((index % 8) as u32 * (count / 8));
            photon.primary = true;
            primary.offer(&photon);
        }
        let map = PrimaryPhotonMap::build(primary, 0.0113).expect("a radius");
        let gather = Gather::within(0.0113).expect("a radius");
        let (points, mut contributing, mut rays) =
            (points(), ContributingLights::new(count as usize), ShadowRays::default());
        group.bench_function(format!("query among {count} lights"), |bencher| {
            bencher.iter(|| {
                let query = |at: &GatherPoint| {
                    map.contributing(black_box(at.position()), &gather, &mut contributing);
                    contributing.len()
                };
                points.iter().map(query).sum::<usize>()
            });
        });
        group.bench_function(format!("9 rays among {count} lights"), |bencher| {
            bencher.iter(|| {
                let select = |i: u64| {
                    let u = [i as f64 / QUERIES as f64, 0.5];
                    selection.select(black_box(&contributing), |_, photons| f64::from(photons), u, &mut rays);
                    rays.as_slice().len()
                };
                (0..QUERIES).map(select).sum::<usize>()
            });
        });
    }
    group.finish();
}

criterion_group!(benches, maps, estimates, decisions, lights);
criterion_main!(benches);
