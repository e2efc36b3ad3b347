//! Every index against the rule as it is written, bit for bit.
#![cfg(all(feature = "kiddo", feature = "obvhs", feature = "rayon"))]

use proptest::prelude::*;
use range_search::check::{Violation, check_index, check_query, expected, point_sets};
use range_search::{BruteForce, Bvh, HashGrid, KdTree, Neighbour, QueryRadius, RangeIndex, batch, divide_and_conquer};
use range_search::{BuildError, par_divide_and_conquer};

fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        20 => -2.0_f32..2.0,
        20 => (-8_i32..8).prop_map(|i| i as f32 * 0.25),
        2 => prop_oneof![Just(f32::NAN), Just(f32::INFINITY), Just(f32::NEG_INFINITY)],
        2 => prop_oneof![Just(f32::MAX), Just(f32::MIN), Just(1e19_f32), Just(-3e30_f32)],
        2 => prop_oneof![Just(0.0_f32), Just(-0.0), Just(1e-45), Just(-1e-23), Just(1e-30)],
    ]
}

fn points(most: usize) -> impl Strategy<Value = Vec<[f32; 3]>> {
    prop::collection::vec([coordinate(), coordinate(), coordinate()], 0..most)
}

fn radius() -> impl Strategy<Value = f32> {
    let extreme = prop_oneof![
        Just(0.0_f32),
        Just(-0.0),
        Just(-1.0),
        Just(f32::NAN),
        Just(f32::INFINITY),
        Just(1e30),
        Just(1e-30)
    ];
    prop_oneof![10 => 0.0_f32..3.0, 5 => (0_i32..8).prop_map(|i| i as f32 * 0.25), 2 => extreme]
}

fn cell_size() -> impl Strategy<Value = f32> {
    prop_oneof![4 => 0.01_f32..4.0, 1 => Just(1e-40_f32), 1 => Just(1e30), 2 => Just(0.25)]
}

proptest! {
    #[test]
    fn all_indices_agree(
        points in points(150),
        center in [coordinate(), coordinate(), coordinate()],
        radius in radius(),
        cell_size in cell_size(),
    ) {
        let check = |violation: Result<(), Violation>| violation.map_err(|v| TestCaseError::fail(v.to_string()));
        check(check_query(&BruteForce::build(&points, |p| *p).unwrap(), &points, center, radius))?;
        check(check_query(&HashGrid::build(&points, |p| *p, cell_size).unwrap(), &points, center, radius))?;
        check(check_query(&KdTree::build(&points, |p| *p).unwrap(), &points, center, radius))?;
        check(check_query(&Bvh::build(&points, |p| *p).unwrap(), &points, center, radius))?;
    }

    #[test]
    fn self_queries_are_queries_at_each_point(points in points(150), radius in radius(), cell_size in cell_size()) {
        let grid = HashGrid::build(&points, |p| *p, cell_size).unwrap();
        compare_self_query(&grid, &points, radius);
    }

    #[test]
    fn queries_all_at_once_are_queries_one_by_one(
        points in points(300),
        queries in points(300),
        radius in radius(),
    ) {
        let mut seen = vec![false; queries.len()];
        divide_and_conquer(&points, |p| *p, &queries, |q| *q, radius, |query, found| {
            assert!(!std::mem::replace(&mut seen[query], true));
            assert!(found.windows(2).all(|pair| pair[0].id() < pair[1].id()));
            let mut found = found.to_vec();
            found.sort_unstable();
            assert_eq!(found, expected(&points, queries[query], radius));
        })?;
        prop_assert!(seen.into_iter().all(|seen| seen));
    }
}

fn compare_self_query(grid: &HashGrid, points: &[[f32; 3]], radius: f32) {
    compare_self_query_of(grid, points, radius, |_| radius);
    let radius_of = |id: usize| [1.0, 0.3, f32::NAN, -1.0, 0.0, 2.0][id % 6] * radius;
    compare_self_query_of(grid, points, |slot: usize| radius_of(grid.id(slot)), radius_of);
}

fn compare_self_query_of(
    grid: &HashGrid,
    points: &[[f32; 3]],
    radius: impl QueryRadius,
    radius_of: impl Fn(usize) -> f32,
) {
    let mut slot = 0;
    grid.self_query(radius).for_each(|neighbourhood| {
        let id = neighbourhood.id();
        let radius = radius_of(id);
        assert_eq!((neighbourhood.slot(), grid.id(slot)), (slot, id));
        assert_eq!(neighbourhood.position().map(f32::to_bits), points[id].map(f32::to_bits));
        let mut one_by_one = Vec::new();
        grid.for_each_within(points[id], radius, |id, distance_squared| one_by_one.push((id, distance_squared)));
        assert_eq!(neighbourhood.iter().collect::<Vec<_>>(), one_by_one);
        assert!(neighbourhood.slots().windows(2).all(|pair| pair[0] < pair[1]));
        slot += 1;
    });
    assert_eq!(slot, grid.len());
}

#[test]
fn the_laws_hold_on_adversarial_sets() {
    for (name, points) in point_sets() {
        let hold = |index: &str, result: Result<(), Violation>| {
            result.unwrap_or_else(|violation| panic!("{index}, {name}: {violation}"));
        };
        hold("brute force", check_index(&BruteForce::build(&points, |p| *p).unwrap(), &points));
        hold("k-d tree", check_index(&KdTree::build(&points, |p| *p).unwrap(), &points));
        hold("hierarchy", check_index(&Bvh::build(&points, |p| *p).unwrap(), &points));
        for cell_size in [0.1, 0.03, 1e-4, 7.0, 1e-38, 1e38] {
            let grid = HashGrid::build(&points, |p| *p, cell_size).unwrap();
            hold("grid", check_index(&grid, &points));
            hold("parallel grid", check_index(&HashGrid::par_build(&points, |p| *p, cell_size).unwrap(), &points));
            for radius in [0.0, 0.05, 0.1, 0.25, 1e-30, f32::INFINITY, f32::NAN, -1.0] {
                compare_self_query(&grid, &points, radius);
            }
        }
    }
}

/// An index with a planted error.
struct Wrong<F>(BruteForce, F);

impl<F: Fn(usize, f32) -> Option<(usize, f32)>> RangeIndex for Wrong<F> {
    fn len(&self) -> usize {
        self.0.len()
    }

    fn skipped(&self) -> usize {
        self.0.skipped()
    }

    fn try_for_each_within<B>(
        &self,
        center: [f32; 3],
        radius: f32,
        mut f: impl FnMut(usize, f32) -> std::ops::ControlFlow<B>,
    ) -> std::ops::ControlFlow<B> {
        self.0.try_for_each_within(center, radius, |id, distance_squared| match (self.1)(id, distance_squared) {
            Some((id, distance_squared)) if distance_squared <= radius * radius => f(id, distance_squared),
            _ => std::ops::ControlFlow::Continue(()),
        })
    }

    fn k_nearest(&self, center: [f32; 3], k: usize, max_radius: f32, out: &mut Vec<Neighbour>) {
        self.0.k_nearest(center, k, max_radius, out);
    }
}

#[test]
fn the_check_rejects_planted_errors() {
    let points = point_sets().swap_remove(2).1;
    let brute_force = || BruteForce::build(&points, |p| *p).unwrap();
    check_index(&Wrong(brute_force(), |id, d| Some((id, d))), &points).unwrap();
    check_index(&Wrong(brute_force(), |id, d| (id != 17).then_some((id, d))), &points).unwrap_err();
    check_index(&Wrong(brute_force(), |id, d: f32| Some((id, d.next_up()))), &points).unwrap_err();
    check_index(&Wrong(brute_force(), |id, d| Some((id ^ 1, d))), &points).unwrap_err();
    check_index(&brute_force(), &points[1..]).unwrap_err();
}

/// Points on a sphere and on a plane, in no order.
fn surfaces(count: usize) -> Vec<[f32; 3]> {
    let unit = |i: usize, step: f64| ((i as f64 * step).fract() * 2.0 - 1.0) as f32;
    (0..count)
        .map(|i| {
            let (u, v) = (unit(i, 0.754_877_666_246_692_7), unit(i, 0.569_840_290_998_053_2));
            let (height, angle) = (u, std::f32::consts::PI * v);
            let radius = (1.0 - height * height).max(0.0).sqrt();
            if i % 2 == 0 { [radius * angle.cos(), radius * angle.sin(), height] } else { [u, v, -1.0] }
        })
        .collect()
}

#[test]
fn parallel_is_serial() {
    let mut points = surfaces(60_000);
    points[1234] = [f32::NAN; 3];
    for cell_size in [0.02, 0.001] {
        let serial = HashGrid::build(&points, |p| *p, cell_size).unwrap();
        let parallel = HashGrid::par_build(&points, |p| *p, cell_size).unwrap();
        assert_eq!(format!("{serial:?}"), format!("{parallel:?}"));
    }
    let grid = HashGrid::build(&points, |p| *p, 0.02).unwrap();
    let sums = |n: range_search::Neighbourhood<'_>| (n.id(), n.distances_squared().iter().sum::<f32>().to_bits());
    assert_eq!(grid.self_query(0.02).map(sums), grid.self_query(0.02).par_map(sums));

    let centers = &points[..3000];
    assert_eq!(batch::within(&grid, centers, 0.03), batch::par_within(&grid, centers, 0.03));
    assert_eq!(batch::k_nearest(&grid, centers, 9, 0.03), batch::par_k_nearest(&grid, centers, 9, 0.03));

    let mut serial = vec![Vec::new(); points.len()];
    divide_and_conquer(&points, |p| *p, &points, |q| *q, 0.02, |query, found| serial[query] = found.to_vec()).unwrap();
    let parallel = std::sync::Mutex::new(vec![Vec::new(); points.len()]);
    par_divide_and_conquer(
        &points,
        |p| *p,
        &points,
        |q| *q,
        0.02,
        |query, found| {
            parallel.lock().unwrap()[query] = found.to_vec();
        },
    )
    .unwrap();
    assert_eq!(serial, parallel.into_inner().unwrap());
    let lists = batch::within(&grid, &points, 0.02);
    assert!(lists.iter().zip(&mut serial).all(|(list, found)| {
        found.sort_unstable();
        list == found
    }));
}

#[test]
fn a_million_coincident_points_are_no_trouble() {
    let mut points = vec![[0.25_f32, 0.5, 0.75]; 1_000_000];
    points.push([1.0, 1.0, 1.0]);
    let nearest: Vec<_> = (0..3).map(|id| Neighbour::new(id, 0.0)).collect();
    let mut found = Vec::new();
    let mut ask = |index: &dyn Fn(&mut Vec<Neighbour>) -> usize| {
        assert_eq!(index(&mut found), 1_000_000);
        assert_eq!(found, nearest);
    };
    fn both(index: &impl RangeIndex, found: &mut Vec<Neighbour>) -> usize {
        index.k_nearest([0.25, 0.5, 0.75], 3, f32::INFINITY, found);
        index.count_within([0.25, 0.5, 0.75], 0.1)
    }
    let grid = HashGrid::build(&points, |p| *p, 0.1).unwrap();
    ask(&|found| both(&grid, found));
    let tree = KdTree::build(&points, |p| *p).unwrap();
    ask(&|found| both(&tree, found));
    let bvh = Bvh::build(&points, |p| *p).unwrap();
    ask(&|found| both(&bvh, found));
}

#[test]
fn cell_sizes_that_make_no_sense_are_refused() {
    for size in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        let error = HashGrid::build(&[[0.0; 3]], |p| *p, size).unwrap_err();
        assert!(matches!(error, BuildError::CellSize(_)) && error.to_string().contains(&size.to_string()));
    }
}

#[test]
fn payloads_follow_the_order_of_slots() {
    let mut points = surfaces(500);
    points[3] = [f32::INFINITY; 3];
    let grid = HashGrid::build(&points, |p| *p, 0.2).unwrap();
    let reordered = grid.reorder(&points);
    assert!((0..grid.len()).all(|slot| reordered[slot] == grid.position(slot)));
    let mut restored = vec![[f32::INFINITY; 3]; points.len()];
    grid.restore(&reordered, &mut restored);
    assert_eq!(restored, points);
}

/// Renumbering is building again over what was reordered: dense and hashed, with and without points that are skipped.
#[test]
fn renumbered_grids_are_those_over_reordered_payloads() {
    let mut sets = point_sets();
    sets.push(("surfaces", surfaces(60_000)));
    for (name, points) in sets {
        for cell_size in [0.2, 0.003, 30.0] {
            let grid = HashGrid::build(&points, |p| *p, cell_size).unwrap();
            let again = HashGrid::build(&grid.reorder(&points), |p| *p, cell_size).unwrap();
            assert_eq!(format!("{:?}", grid.renumbered()), format!("{again:?}"), "{name}, {cell_size}");
        }
    }
}
