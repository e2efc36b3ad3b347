//! Whatever comes in, nothing panics, nothing is NaN, and the answers are those of the documentation.

#![allow(clippy::unwrap_used)]

use proptest::prelude::*;
use ris::baselines::{ImportanceSampling, RejectionSampling, Tabulated1d, Tabulated2d, WeightedImportanceSampling};
use ris::{
    AliasTable, BalanceWeights, Batch, Budget, Combination, OneNumber, Pairwise, PrefixSums, Proposal, Resampled,
    Reservoir, Ris, Selected, Source, Sources, Uniform, VarianceModel, balance, from_fn, resample_sources,
};

const STRANGE: [f32; 15] = [
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    -1.0,
    -0.0,
    0.0,
    1e-45,
    f32::MIN_POSITIVE,
    1e-20,
    0.5,
    1.0,
    1e20,
    f32::MAX,
    f32::MIN,
    f32::EPSILON,
];

/// Numbers that decide, the limits of what is allowed and beyond.
const NUMBERS: [f32; 5] = [0.0, 0.5, 1.0 - f32::EPSILON / 2.0, 1.0, f32::NAN];

/// Every way to resample these pairs of score and density.
fn all(pairs: &[(f32, f32)], u: f32) -> Vec<Resampled<usize, f32>> {
    let target = |k: &usize| pairs[*k].0;
    let proposals = || pairs.iter().enumerate().map(|(sample, &(_, density))| Proposal { sample, density });
    let owned = |picked: Resampled<&usize, f32>| Resampled {
        selected: picked.selected.map(|y| Selected {
            sample: *y.sample,
            score: y.score,
            contribution_weight: y.contribution_weight,
        }),
        confidence: picked.confidence,
    };
    let (sums, alias) = (
        Batch::<_, f32, PrefixSums>::new(proposals(), &target),
        Batch::<_, f32, AliasTable>::new(proposals(), &target),
    );
    let mut outcomes = vec![
        Reservoir::stream(proposals(), &target, &mut || u),
        Reservoir::stream_with_one_number(proposals(), &target, u),
        owned(sums.select(u)),
        owned(alias.select(u)),
    ];
    outcomes.extend(sums.select_stratified(3, u).map(owned));
    let mut absorbed = Reservoir::new();
    for Proposal { sample, density } in proposals() {
        let mut one = Reservoir::new();
        one.update(sample, target(&sample), 1.0 / density, u);
        absorbed.absorb(one, u);
    }
    outcomes.push(absorbed.finish());
    outcomes
}

/// Positive, finite, and of a candidate that could be selected.
fn check(picked: &Resampled<usize, f32>, pairs: &[(f32, f32)], context: &str) {
    let possible = |&(score, density): &(f32, f32)| {
        let weight = score * (1.0 / density);
        score > 0.0 && weight > 0.0 && weight.is_finite()
    };
    assert_eq!(picked.selected.is_some(), pairs.iter().any(possible), "{context}: {picked:?}");
    assert_eq!(picked.confidence, pairs.len() as f32, "{context}");
    if let Some(y) = &picked.selected {
        assert!(possible(&pairs[y.sample]), "{context}: {picked:?}");
        assert!(y.contribution_weight >= 0.0 && y.contribution_weight.is_finite(), "{context}: {picked:?}");
    }
    assert!(!picked.estimate(|_| 0.0_f32).is_nan(), "{context}: {picked:?}");
}

#[test]
fn strange_scores_and_densities() {
    for u in NUMBERS {
        let pairs: Vec<(f32, f32)> = STRANGE.iter().flat_map(|&g| STRANGE.iter().map(move |&p| (g, p))).collect();
        let usual = (1.0, 1.0);
        for &pair in &pairs {
            for pairs in [vec![pair], vec![pair, usual], vec![usual, pair], vec![pair; 3]] {
                all(&pairs, u).iter().for_each(|picked| check(picked, &pairs, &format!("{pairs:?} at {u}")));
            }
        }
        all(&pairs, u).iter().for_each(|picked| check(picked, &pairs, "all"));
    }
}

#[test]
fn nothing_at_all() {
    for u in NUMBERS {
        for picked in all(&[], u) {
            assert_eq!(picked, Resampled { selected: None, confidence: 0.0 });
        }
        for picked in all(&[(0.0, 1.0), (f32::NAN, 1.0), (1.0, f32::NAN), (1.0, 0.0)], u) {
            assert_eq!(picked, Resampled { selected: None, confidence: 4.0 });
            assert_eq!(picked.estimate(|_| f32::NAN), 0.0);
        }
    }
    let empty = Pairwise::new(Resampled::<usize, f32>::EMPTY, 0.0);
    assert_eq!(empty.finish(0.5), Resampled::EMPTY);
    assert_eq!(Combination::<usize, f32>::new().finish(), Resampled::EMPTY);
}

#[test]
fn two_negative_numbers_make_no_weight() {
    let picked = Reservoir::stream([Proposal { sample: 0, density: -1.0 }], &|_: &i32| -1.0_f32, &mut || 0.5);
    assert_eq!(picked.selected, None);
}

#[test]
fn the_largest_and_smallest_numbers() {
    // M g and sum / g overflow in between.
    let large = Reservoir::stream(
        [Proposal { sample: 0, density: 1.0 }, Proposal { sample: 1, density: 1e10 }],
        &|_: &i32| 3e38_f32,
        &mut || 0.999,
    );
    assert!((large.contribution_weight() - 0.5).abs() < 1e-6, "{large:?}");
    // One over the density of a sample that hardly ever is: cut off, not infinite.
    let rare = Reservoir::stream(
        [0, 1].map(|sample| Proposal { sample, density: 1e-38 }),
        &|x: &i32| [1e-30_f32, 1.0][*x as usize],
        &mut || 0.9999999,
    );
    assert_eq!((rare.sample(), rare.contribution_weight()), (Some(&1), 1.0 / 1e-38_f32 / 2.0));
    let mut rare = Reservoir::new();
    rare.update(1, 1.0_f32, 1e38, 0.5);
    rare.update(0, 1e-30, 1e30, 0.0);
    assert_eq!((rare.finish().sample(), rare.finish().contribution_weight()), (Some(&0), f32::MAX));
    // A subnormal weight that comes first is selected by any number.
    for u in NUMBERS {
        let tiny = Reservoir::stream([Proposal { sample: 0, density: 1.0 }; 2], &|_: &i32| 1e-45_f32, &mut || u);
        assert_eq!(tiny.contribution_weight(), 1.0, "{u}");
    }
}

#[test]
fn counts_of_f32_stop_at_two_to_the_24() {
    let mut single = Reservoir::<(), f32>::new();
    let mut double = Reservoir::<(), f64>::new();
    single.merge(Resampled { selected: None, confidence: 16_777_215.0 }, &|_: &()| 1.0, 0.0);
    double.merge(Resampled { selected: None, confidence: 16_777_215.0 }, &|_: &()| 1.0, 0.0);
    (0..10).for_each(|_| (single.skip(), double.skip()).0);
    assert_eq!((single.candidates(), double.candidates()), (16_777_216.0, 16_777_225.0));
}

#[test]
fn sums_of_many_equal_weights_in_f32() {
    // What the documentation says about streams: 2^16 candidates are fine, as far as the sum is concerned.
    let candidates = (0..65_536_u32).map(|sample| Proposal { sample, density: 0.3_f32 });
    let picked = Reservoir::stream(candidates, &|_: &u32| 0.7, &mut || 0.5);
    assert!((picked.contribution_weight() * 0.3 - 1.0).abs() < 2e-3, "{picked:?}");
}

#[test]
fn estimators_with_strange_sources() {
    for density in STRANGE {
        for score in STRANGE {
            let source = from_fn(|u: &mut dyn FnMut() -> f32| (u(), density), |_: &f32| density);
            let target = |_: &f32| score;
            for candidates in [1.0, 1.5, 2.0, 5.0] {
                let ris = Ris::new(Budget::new(candidates, 2.0));
                let estimate: f32 = ris.estimate(&source, &target, &mut || 0.5, |_| 0.0);
                assert_eq!(estimate, 0.0, "{density} {score} {candidates}");
            }
            let importance: f32 = ImportanceSampling { samples: 2.0 }.estimate(&source, &mut || 0.5, |_| 0.0);
            let weighted = WeightedImportanceSampling { samples: 2.0, target_integral: 1.0 };
            let weighted: f32 = weighted.estimate(&source, &target, &mut || 0.5, |_| 0.0);
            assert_eq!((importance, weighted), (0.0, 0.0), "{density} {score}");
            let accepted = RejectionSampling::new(1.0, 3).unwrap().draw(&source, &target, &mut || 0.5);
            assert!(accepted.is_none_or(|accepted| accepted.candidates <= 3));
        }
    }
}

#[test]
fn strange_combinations() {
    let own = |score, contribution_weight, confidence| Resampled {
        selected: Some(Selected { sample: (), score, contribution_weight }),
        confidence,
    };
    for a in STRANGE {
        for b in STRANGE {
            for c in STRANGE {
                let mut pairwise = Pairwise::new(own(a, b, 1.0), 2.0);
                pairwise.add(own(b, c, 1.0), &|_: &()| a, &|_: &()| c, 0.5);
                pairwise.add(own(1.0, 1.0, c), &|_: &()| 1.0, &|_: &()| b, 0.5);
                let first = pairwise.finish(0.5);
                let mut pairwise = Pairwise::new(own(1.0, 1.0, a), b);
                pairwise.add(own(1.0, 1.0, c), &|_: &()| 1.0, &|_: &()| 1.0, 0.5);
                let second = pairwise.finish(0.5);
                let mut reservoir = Reservoir::new();
                reservoir.merge(own(1.0, a, b), &|_: &()| c, 0.5);
                reservoir.merge(own(1.0, 1.0, 1.0).with_confidence_at_most(a), &|_: &()| c, 0.5);
                let mut combination = Combination::new();
                combination.add(own(1.0, a, 1.0), b, c, 0.5);
                for picked in [first, second, reservoir.finish(), combination.finish()] {
                    let weight = picked.contribution_weight();
                    assert!(
                        (0.0..=f32::MAX).contains(&weight) && !picked.confidence.is_nan(),
                        "{a} {b} {c} {picked:?}"
                    );
                }
                let weight = balance(1, &[a, b], &[c, 1.0]);
                assert!((0.0..=1.0).contains(&weight), "{a} {b} {c}: {weight}");
            }
        }
    }
    assert_eq!(balance(7, &[1.0_f32], &[1.0]), 0.0);
    // Scores that overflow if multiplied by confidences: half each.
    let huge = own(3e38, 1.0, 20.0);
    let mut pairwise = Pairwise::new(huge, 20.0);
    pairwise.add(huge, &|_: &()| 3e38, &|_: &()| 3e38, 0.5);
    assert!((pairwise.finish(0.5).contribution_weight() - 1.0).abs() < 1e-6);
}

struct Strange([f32; 2]);

impl Sources<f32, f32, 2> for Strange {
    fn propose(&self, source: usize, uniform: &mut impl Uniform<f32>) -> Option<f32> {
        (source == 0).then(|| uniform.next_uniform())
    }
    fn densities(&self, _: &f32) -> [f32; 2] {
        self.0
    }
}

#[test]
fn strange_densities_of_several_sources() {
    for a in STRANGE {
        for b in STRANGE {
            let picked = resample_sources(&Strange([a, b]), [2, 1], &BalanceWeights, &|_: &f32| 1.0, &mut || 0.5);
            assert!(picked.contribution_weight() >= 0.0 && picked.contribution_weight().is_finite(), "{a} {b}");
            assert_eq!(picked.confidence, 3.0);
        }
    }
    let none = resample_sources(&Strange([1.0; 2]), [0, 0], &BalanceWeights, &|_: &f32| 1.0, &mut || 0.5);
    assert_eq!(none, Resampled::EMPTY);
}

#[test]
fn strange_candidates_of_the_variance_model() {
    let wide = STRANGE.map(f64::from).into_iter().chain([1e-300, 1e300, f64::MAX, 5e-324]).collect::<Vec<_>>();
    let mut all = VarianceModel::<1>::new();
    let mut count = 0;
    for &f in &wide {
        for &g in &wide {
            for &p in &wide {
                let mut model = VarianceModel::<1>::new();
                model.add([f], g, p);
                model.add([f], g, p);
                all.add([f.clamp(-1e9, 1e9)], g, p);
                count += 1;
                let e = model.expectations().unwrap()[0];
                assert!(e.e1.is_finite() && !e.e2.is_nan() && e.e3.is_finite(), "{f} {g} {p}: {e:?}");
            }
        }
    }
    assert_eq!(all.count(), count);
    // g = 0 where f is not: told, and left out of e2.
    let mut model = VarianceModel::<1>::new();
    model.add([1.0], 0.0, 1.0);
    model.add([0.0], 0.0, 1.0);
    assert_eq!(model.unsupported(), 1);
    assert_eq!(model.expectations().unwrap()[0].e2, 0.0);
}

#[test]
fn tables_stay_in_their_domain() {
    let table = Tabulated1d::new(|x| if x < 0.0 { f64::NAN } else { x }, [-1.0, 2.0], 3).unwrap();
    let plane = Tabulated2d::new(|[x, y]| x * y, [[-1.0, 2.0], [0.0, 1.0]], [3, 2]).unwrap();
    for u in [0.0, 0.3, 1.0 - f64::EPSILON / 2.0, 1.0, 7.0, -1.0, f64::NAN] {
        let x = table.sample(u);
        assert!((-1.0..=2.0).contains(&x), "{u}: {x}");
        let [x, y] = plane.sample([u, u]);
        assert!((-1.0..=2.0).contains(&x) && (0.0..=1.0).contains(&y), "{u}: {x} {y}");
    }
    // The largest number leads to the edge of a cell of density zero, and has the density of its own cell.
    let edge = Tabulated1d::new(|x| if x < 2.0 { 1.0 } else { 0.0 }, [0.0, 3.0], 3).unwrap();
    for u in [0.5 - f64::EPSILON / 4.0, 1.0 - f64::EPSILON / 2.0] {
        let proposal = edge.propose(&mut || u).unwrap();
        assert!(proposal.sample <= 2.0 && proposal.density == 0.5, "{proposal:?}");
    }
    for x in [f64::NAN, f64::INFINITY, -1.1, 2.1] {
        assert_eq!((table.pdf(x), plane.pdf([x, 0.5]), plane.pdf([0.5, x])), (0.0, 0.0, 0.0));
    }
    for (g, domain, cells) in
        [(1.0, [0.0, 1.0], 0), (1.0, [1.0, 0.0], 2), (1.0, [0.0, f64::NAN], 2), (0.0, [0.0, 1.0], 2)]
    {
        assert!(Tabulated1d::new(|_| g, domain, cells).is_err());
        assert!(Tabulated2d::new(|_| g, [domain, [0.0, 1.0]], [cells, 2]).is_err());
    }
    assert!(RejectionSampling::new(f32::NAN, 1).is_err() && RejectionSampling::new(1.0_f32, 0).is_err());
}

fn any_bits() -> impl Strategy<Value = f32> {
    any::<u32>().prop_map(f32::from_bits)
}

proptest! {
    #[test]
    fn arbitrary_bits(
        pairs in prop::collection::vec((any_bits(), any_bits()), 0..9),
        u in any_bits(),
        budget in (any_bits(), any_bits()),
    ) {
        all(&pairs, u).iter().for_each(|picked| check(picked, &pairs, &format!("{pairs:?} at {u}")));
        let mut number = OneNumber::new(u);
        for &(p, _) in &pairs {
            number.accept(f64::from(p));
            prop_assert!((0.0..1.0).contains(&number.rest()));
        }
        let budget = Budget::new(budget.0.into(), budget.1.into());
        let inverse = Budget::mean_inverse(budget.candidates());
        prop_assert!(inverse > 0.0 && inverse <= 1.0);
        let count = Budget::round(budget.samples(), &mut || u);
        prop_assert!((1..=1 << 24).contains(&count));
    }
}
