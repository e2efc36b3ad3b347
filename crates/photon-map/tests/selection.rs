//! Light selection, its expectation enumerated exactly.
#![allow(clippy::unwrap_used)]

use photon_map::{Allocation, ContributingLights, LightSelection, LightTable, SelectionError, ShadowRay, ShadowRays};

/// Weights of the lights; small whole numbers, so that few random numbers enumerate everything.
const WEIGHTS: [f64; 6] = [1.0, 3.0, 2.0, 1.0, 4.0, 2.0];
/// What the lights contribute.
const CONTRIBUTIONS: [f64; 6] = [5.0, 0.25, 3.0, 0.0, 1.0, 7.5];

fn greatest_common_divisor(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { greatest_common_divisor(b, a % b) }
}

/// A number of places between which no expected count has a fraction: a multiple of all sums of the least weights.
fn places(mut weights: Vec<u64>) -> u64 {
    weights.sort_unstable();
    let mut sum = 0;
    weights.iter().fold(1, |multiple, weight| {
        sum += weight;
        multiple / greatest_common_divisor(multiple, sum) * sum
    })
}

/// Replays a selection with all random numbers that differ, and averages what `value` makes of the rays.
fn enumerate(selection: &LightSelection, set: &ContributingLights, mut value: impl FnMut(&[ShadowRay]) -> f64) -> f64 {
    let weights = |contributing: bool| {
        let lights = (0..6).filter(|&light| set.contains(light) == contributing);
        places(lights.map(|light| WEIGHTS[light as usize] as u64).collect())
    };
    let (a, b) = (weights(true), weights(false));
    let (mut rays, mut sum) = (ShadowRays::default(), 0.0);
    for (i, j) in (0..a).flat_map(|i| (0..b).map(move |j| (i, j))) {
        let u = [(i as f64 + 0.5) / a as f64, (j as f64 + 0.5) / b as f64];
        selection.select_by_weight(set, u, &mut rays);
        sum += value(rays.as_slice());
    }
    sum / (a * b) as f64
}

fn estimate(rays: &[ShadowRay]) -> f64 {
    rays.iter().map(|ray| ray.weight * CONTRIBUTIONS[ray.light as usize]).sum()
}

/// All subsets of lights with selections of few and many rays.
fn cases(other_rays: u32, mut check: impl FnMut(&LightSelection, &ContributingLights, u32, u32)) {
    for allocation in [Allocation::Proportional, Allocation::BrightestFirst] {
        for rays in [1, 2, 3, 5, 6, 9] {
            let table = LightTable::new(&WEIGHTS).unwrap();
            let selection = LightSelection::new(table, rays, other_rays, allocation).unwrap();
            for subset in 0..64_u32 {
                let lights = (0..6).filter(|light| subset >> light & 1 == 1);
                let set = ContributingLights::from_lights(selection.table().len(), lights);
                check(&selection, &set, rays, subset);
            }
        }
    }
}

#[test]
fn the_expectation_is_the_full_sum_for_every_set_of_contributing_lights() {
    let full: f64 = CONTRIBUTIONS.iter().sum();
    for other_rays in [1, 2, 3] {
        cases(other_rays, |selection, set, rays, subset| {
            let mut shot = 0;
            let expected = enumerate(selection, set, |rays| {
                shot = rays.len() as u32;
                estimate(rays)
            });
            assert!((expected - full).abs() < 1e-7, "{subset:06b}, {rays} rays: {expected}");
            // The number of rays is fixed; only for an empty set none are shot.
            let expected_rays = if subset == 0 { 0 } else { rays } + if subset == 63 { 0 } else { other_rays };
            assert_eq!(shot, expected_rays);
        });
    }
}

#[test]
fn without_rays_to_the_others_their_light_is_missing() {
    cases(0, |selection, set, _, _| {
        let inside: f64 = set.as_slice().iter().map(|&(light, _)| CONTRIBUTIONS[light as usize]).sum();
        assert!((enumerate(selection, set, estimate) - inside).abs() < 1e-7);
    });
}

#[test]
fn every_contributing_light_is_expected_and_each_count_is_rounded_to_a_neighbour() {
    cases(1, |selection, set, _, _| {
        for &(light, _) in set.as_slice() {
            let (mut weight, mut least, mut most) = (0.0, u32::MAX, 0);
            let expected = enumerate(selection, set, |rays| {
                let own = || rays.iter().filter(|ray| ray.light == light);
                let count = own().count() as u32;
                (least, most) = (least.min(count), most.max(count));
                // The strata of a light are numbered, and all its rays weigh the same.
                for (stratum, ray) in own().enumerate() {
                    assert!(ray.contributing && ray.stratum == stratum as u32 && ray.strata == count);
                    weight = ray.weight;
                }
                f64::from(count)
            });
            assert!(expected > 0.0 && (expected * weight - 1.0).abs() < 1e-9, "light {light}: {expected}");
            assert!(most - least <= 1 && f64::from(least) <= expected && expected <= f64::from(most));
        }
    });
}

#[test]
fn the_brightest_are_certain_and_with_enough_rays_all_are() {
    let table = LightTable::uniform(5).unwrap();
    let selection = LightSelection::new(table, 3, 0, Allocation::BrightestFirst).unwrap();
    let set = ContributingLights::from_lights(selection.table().len(), 0..5);
    let importance = [0.1, 100.0, 0.2, 50.0, 0.1];
    let mut rays = ShadowRays::default();
    for i in 0..40 {
        selection.select(&set, |light, _| importance[light as usize], [(f64::from(i) + 0.5) / 40.0, 0.5], &mut rays);
        let certain: Vec<_> = rays.as_slice().iter().filter(|ray| ray.weight == 1.0).map(|ray| ray.light).collect();
        assert_eq!((certain, rays.as_slice().len()), (vec![1, 3], 3));
    }
    let enough = LightSelection::new(LightTable::uniform(5).unwrap(), 7, 0, Allocation::BrightestFirst).unwrap();
    enough.select(&set, |light, _| importance[light as usize], [0.3, 0.5], &mut rays);
    assert!((0..5).all(|light| rays.as_slice().iter().any(|ray| ray.light == light)));
}

#[test]
fn importance_that_is_nonsense_loses_no_light() {
    let selection = LightSelection::new(LightTable::uniform(4).unwrap(), 2, 0, Allocation::BrightestFirst).unwrap();
    let set = ContributingLights::from_lights(selection.table().len(), 0..4);
    for importance in
        [[f64::NAN; 4], [0.0; 4], [f64::INFINITY, -1.0, f64::NAN, 0.0], [f64::INFINITY; 4], [1e-300, 0.0, 0.0, 1e300]]
    {
        let (mut counts, mut rays) = ([0.0; 4], ShadowRays::default());
        const PLACES: u32 = 100_000;
        for i in 0..PLACES {
            let u = (f64::from(i) + 0.5) / f64::from(PLACES);
            selection.select(&set, |light, _| importance[light as usize], [u, 0.5], &mut rays);
            assert_eq!(rays.as_slice().len(), 2);
            rays.as_slice().iter().for_each(|ray| counts[ray.light as usize] += ray.weight / f64::from(PLACES));
        }
        assert!(counts.iter().all(|count| (count - 1.0).abs() < 0.02), "{importance:?}: {counts:?}");
    }
    let table = LightTable::uniform(4).unwrap();
    assert_eq!(LightSelection::new(table, 0, 1, Allocation::Proportional).err(), Some(SelectionError::NoRay));
}

/// The cost: importance is asked for once per contributing light, whatever the number of lights.
#[test]
fn nothing_is_asked_of_lights_that_do_not_contribute() {
    for lights in [100, 1_000_000] {
        let table = LightTable::uniform(lights).unwrap();
        let selection = LightSelection::new(table, 8, 1, Allocation::BrightestFirst).unwrap();
        let set = ContributingLights::from_lights(selection.table().len(), [7, 42, 99]);
        let mut asked = 0;
        let importance = |_, _| {
            asked += 1;
            1.0
        };
        selection.select(&set, importance, [0.5, 0.5], &mut ShadowRays::default());
        assert_eq!(asked, 3);
    }
}
