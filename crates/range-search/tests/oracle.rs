//! Every index against brute force, bit for bit.

use proptest::prelude::*;
use range_search::{BruteForce, HashGrid, Neighbor, RangeIndex, distance_squared};

/// The oracle's oracle: the rule as it is written.
fn plain(points: &[[f32; 3]], center: [f32; 3], radius: f32) -> Vec<Neighbor> {
    let finite = |p: &[f32; 3]| p.iter().all(|x| x.is_finite());
    if !finite(&center) || radius.is_nan() || radius < 0.0 {
        return Vec::new();
    }
    let all = (0..).zip(points).filter(|(_, p)| finite(p));
    let all = all.map(|(id, p)| Neighbor::new(id, distance_squared(*p, center)));
    let mut found: Vec<_> = all.filter(|n| n.distance_squared() <= radius * radius).collect();
    found.sort_by(|a, b| a.distance_squared().total_cmp(&b.distance_squared()).then(a.id().cmp(&b.id())));
    found
}

fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        20 => -2.0_f32..2.0,
        20 => (-8_i32..8).prop_map(|i| i as f32 * 0.25),
        2 => prop_oneof![Just(f32::NAN), Just(f32::INFINITY), Just(f32::NEG_INFINITY)],
        2 => prop_oneof![Just(f32::MAX), Just(f32::MIN), Just(1e19_f32), Just(-3e30_f32)],
        2 => prop_oneof![Just(0.0_f32), Just(-0.0), Just(1e-45), Just(-1e-23), Just(1e-30)],
    ]
}

fn points() -> impl Strategy<Value = Vec<[f32; 3]>> {
    prop::collection::vec([coordinate(), coordinate(), coordinate()], 0..150)
}

fn radius() -> impl Strategy<Value = f32> {
    prop_oneof![
        10 => 0.0_f32..3.0,
        5 => (0_i32..8).prop_map(|i| i as f32 * 0.25),
        2 => prop_oneof![Just(0.0_f32), Just(-0.0), Just(-1.0), Just(f32::NAN), Just(f32::INFINITY), Just(1e30), Just(1e-30)],
    ]
}

proptest! {
    #[test]
    fn all_indices_agree(
        points in points(),
        center in [coordinate(), coordinate(), coordinate()],
        radius in radius(),
        cell_size in prop_oneof![0.01_f32..4.0, Just(1e-40_f32), Just(1e30), Just(0.25)],
        k in 0_usize..200,
    ) {
        let expected = plain(&points, center, radius);
        let brute_force = BruteForce::build(&points, |p| *p).unwrap();
        let grid = HashGrid::build(&points, |p| *p, cell_size).unwrap();
        prop_assert_eq!(&brute_force.within(center, radius), &expected);
        prop_assert_eq!(&grid.within(center, radius), &expected);
        let nearest = &expected[..k.min(expected.len())];
        let mut found = vec![Neighbor::new(0, 0.0)];
        brute_force.k_nearest(center, k, radius, &mut found);
        prop_assert_eq!(&found, nearest);
        grid.k_nearest(center, k, radius, &mut found);
        prop_assert_eq!(&found, nearest);
        grid.self_query(radius).for_each(|neighborhood| {
            assert_eq!(neighborhood.position().map(f32::to_bits), points[neighborhood.id()].map(f32::to_bits));
            let mut one_by_one = Vec::new();
            grid.for_each_within(points[neighborhood.id()], radius, |id, d| one_by_one.push((id, d)));
            assert_eq!(neighborhood.iter().collect::<Vec<_>>(), one_by_one);
        });
    }
}
