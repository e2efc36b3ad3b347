//! What other crates can do as well, beside ours: contestants in turn, so that slow phases of the machine hit all of them.
//!
//! Prints the seconds of each contestant's fastest turn as JSON, `{"comparison": {"contestant": seconds}}`, for
//! `peers/run.sh table`, which repeats it, and puts ratios and intervals beside those of other programs. One thread, but where the name says two.

use std::collections::BTreeMap;
use std::hint::black_box;
use std::time::Instant;

use lichtwerk_benches::{filter_over_kiddo, kiddo_nearest, kiddo_tree, kiddo_within, surface_points, vertices};
use path_space_filter::{
    AlbedoDifference, JitteredHash, NormalCone, PathFilter, PathSpaceFilter, Radius, SimilarityExt,
};
use qmc_sampling::{Independent, OwenSobol, Sampler, SamplerFamily};
use rand::Rng;
use range_search::{HashGrid, RangeIndex};

/// Neighbours of a nearest-neighbour query.
const NEAREST: usize = 50;
/// Groups of four dimensions that a path takes.
const GROUPS: u32 = 8;

/// How much of everything.
struct Effort {
    turns: u32,
    points: usize,
    queries: usize,
    paths: u32,
}

/// A contestant's name, and what it does, which returns something that depends on all of it.
type Contestant<'a> = (&'static str, Box<dyn FnMut() -> f32 + 'a>);

/// Seconds of the fastest turn of each.
fn race(turns: u32, mut contestants: Vec<Contestant<'_>>) -> BTreeMap<&'static str, f64> {
    let mut fastest = BTreeMap::new();
    for _ in 0..turns {
        for (name, run) in &mut contestants {
            let start = Instant::now();
            black_box(run());
            let seconds = start.elapsed().as_secs_f64();
            fastest.entry(*name).and_modify(|best: &mut f64| *best = best.min(seconds)).or_insert(seconds);
        }
    }
    fastest
}

/// All comparisons, in the order in which they are made.
fn comparisons(effort: &Effort) -> Vec<(&'static str, BTreeMap<&'static str, f64>)> {
    let mut all = range_searches(effort);
    all.push(("path space filter, two threads", filters(effort)));
    all.extend(samplers(effort));
    all
}

fn range_searches(effort: &Effort) -> Vec<(&'static str, BTreeMap<&'static str, f64>)> {
    let turns = effort.turns;
    let (points, radius) = surface_points(effort.points);
    let points = &points;
    let grid = &HashGrid::build(points, |p| *p, radius).expect("a grid");
    let kiddo = &kiddo_tree(points);
    let random = &points[..effort.queries];
    // All points one after the other along the surfaces, which is kind to both.
    let ordered: Vec<[f32; 3]> = grid.order().map(|id| points[id]).collect();
    let ordered = &ordered[..];
    let sum_within = |index: &HashGrid, queries: &[[f32; 3]]| {
        let mut sum = 0.0;
        queries.iter().for_each(|query| index.for_each_within(*query, radius, |_, d2| sum += d2));
        sum
    };
    let build: Vec<Contestant<'_>> = vec![
        ("ours", Box::new(|| HashGrid::build(points, |p| *p, radius).map_or(0.0, |grid| grid.len() as f32))),
        ("kiddo", Box::new(|| kiddo_within(&kiddo_tree(points), &points[..1], radius))),
    ];
    let within: Vec<Contestant<'_>> = vec![
        ("ours", Box::new(|| sum_within(grid, random))),
        ("kiddo", Box::new(|| kiddo_within(kiddo, random, radius))),
    ];
    let nearest: Vec<Contestant<'_>> = vec![
        (
            "ours",
            Box::new(|| {
                let mut found = Vec::new();
                let farthest = |query: &[f32; 3]| {
                    grid.k_nearest(*query, NEAREST, f32::INFINITY, &mut found);
                    found.last().map(|last| last.distance_squared())
                };
                random.iter().filter_map(farthest).sum()
            }),
        ),
        ("kiddo", Box::new(|| kiddo_nearest(kiddo, random, NEAREST))),
    ];
    let all_points: Vec<Contestant<'_>> = vec![
        ("ours", Box::new(|| sum_within(grid, ordered))),
        ("kiddo", Box::new(|| kiddo_within(kiddo, ordered, radius))),
    ];
    vec![
        ("range search, build", race(turns, build)),
        ("range search, fixed radius, random order", race(turns, within)),
        ("range search, 50 nearest, random order", race(turns, nearest)),
        ("range search, all around all, in order", race(turns, all_points)),
    ]
}

fn filters(effort: &Effort) -> BTreeMap<&'static str, f64> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("two threads");
    let (vertices, radius) = vertices(effort.points);
    let radius_of = Radius::absolute(radius).expect("a radius");
    let filter = PathSpaceFilter::new(radius_of).similarity(NormalCone::PAPER.and(AlbedoDifference::PAPER));
    let hash =
        JitteredHash::new(radius_of).key(|vertex: &lichtwerk_benches::RgbVertex| (vertex.albedo[0] * 16.0) as u32);
    race(
        effort.turns,
        vec![
            ("ours", Box::new(|| pool.install(|| filter.average(&vertices, 1)).values()[0][0])),
            ("ours, by hash", Box::new(|| pool.install(|| hash.average(&vertices, 1)).values()[0][0])),
            ("kiddo", Box::new(|| pool.install(|| filter_over_kiddo(&vertices, radius))[0][0])),
        ],
    )
}

fn samplers(effort: &Effort) -> Vec<(&'static str, BTreeMap<&'static str, f64>)> {
    let paths = effort.paths;
    let four = |point: [f32; 4]| point.iter().sum::<f32>();
    let sobol: Vec<Contestant<'_>> = vec![
        (
            "ours",
            Box::new(|| {
                let family = OwenSobol::new(black_box(1));
                let path = |index: u32| {
                    let mut sampler = family.sampler(black_box(77), u64::from(index));
                    (0..GROUPS).map(|_| four(sampler.next_4d())).sum::<f32>()
                };
                (0..paths).map(path).sum()
            }),
        ),
        (
            "openqmc-rs",
            Box::new(|| {
                let path = |index: u32| {
                    let sampler = openqmc::SobolSampler::new(black_box(77), 0, 0, index as i32);
                    (0..GROUPS).map(|key| four(sampler.new_domain(key as i32).draw_sample_f32::<4>())).sum::<f32>()
                };
                (0..paths).map(path).sum()
            }),
        ),
        (
            "sobol_burley",
            Box::new(|| {
                // Its limit is 2^16 points.
                let path = |index: u32| {
                    (0..GROUPS)
                        .map(|set| four(sobol_burley::sample_4d(index & 0xffff, set, black_box(77))))
                        .sum::<f32>()
                };
                (0..paths).map(path).sum()
            }),
        ),
    ];
    let independent: Vec<Contestant<'_>> = vec![
        (
            "ours",
            Box::new(|| {
                let mut sampler = Independent::new(black_box(1)).sampler(2, 3);
                (0..4 * paths * GROUPS).map(|_| sampler.next_1d()).sum()
            }),
        ),
        (
            "rand_pcg",
            Box::new(|| {
                let mut rng = rand_pcg::Pcg32::new(black_box(1), 2);
                // As rand's StandardUniform for f32.
                (0..4 * paths * GROUPS).map(|_| (rng.next_u32() >> 8) as f32 / 16_777_216.0).sum()
            }),
        ),
    ];
    vec![
        ("Owen-scrambled Sobol points, 4D", race(effort.turns, sobol)),
        ("independent numbers", race(effort.turns, independent)),
    ]
}

#[expect(clippy::print_stdout, reason = "what was measured goes to the script that asked for it")]
fn main() {
    // Cargo's own arguments are passed over; `--test` is what it says to benches that shall merely run.
    let effort = if std::env::args().any(|argument| argument == "--test") {
        Effort { turns: 1, points: 10_000, queries: 100, paths: 100 }
    } else {
        Effort { turns: 3, points: 1_000_000, queries: 20_000, paths: 200_000 }
    };
    let seconds: BTreeMap<_, _> = comparisons(&effort).into_iter().collect();
    println!("{}", serde_json::json!(seconds));
}
