//! The choice of M and N against brute force.

#![allow(clippy::unwrap_used)]

use proptest::prelude::*;
use ris::{Budget, CostError, CostModel, Expectations, Objective, RatioMap, VarianceModel, robust_mean};

/// A model with these parts in each component, up to rounding: `e1` of the integrand's mean one, and what is asked for beyond.
///
/// Two states of probability 1/2 with `f/p = 1 + d, 1 - d` and `g/p = 1 + t, 1 - t` have `e1 = 1`, `e3 = 1 + d^2` and
/// `e2 = ((1 + d)^2 / (1 + t) + (1 - d)^2 / (1 - t)) / 2`.
fn model<const C: usize>(d: [f64; C], t: f64) -> VarianceModel<C> {
    let mut model = VarianceModel::new();
    // So many that the U-statistics' 1/n does not matter.
    for _ in 0..200_000 {
        model.add(d.map(|d| 0.5 * (1.0 + d)), 0.5 * (1.0 + t), 0.5);
        model.add(d.map(|d| 0.5 * (1.0 - d)), 0.5 * (1.0 - t), 0.5);
    }
    model
}

/// Variance within a time, for real counts: equation 2 at `N = T / (M T_X + T_Y)`.
fn variance(e: &Expectations, cost: CostModel, time: f64, candidates: f64) -> f64 {
    e.variance(1.0 / candidates, (candidates * cost.candidate() + cost.sample()) / time)
}

/// The best `M >= 1` with `N >= 1` of a fine scan.
fn scan(cost: CostModel, time: f64, objective: impl Fn(f64) -> f64) -> f64 {
    let largest = ((time - cost.sample()) / cost.candidate()).max(1.0);
    let candidates = |k: u32| largest.powf(f64::from(k) / 20_000.0);
    (0..=20_000).map(candidates).min_by(|a, b| objective(*a).total_cmp(&objective(*b))).unwrap()
}

#[test]
fn weighted_is_the_brute_force_optimum() {
    for (d, t) in [([0.5, 0.9], 0.4), ([0.2, 0.8], 0.5), ([0.9, 0.1], 0.3), ([0.5, 0.5], -0.3), ([0.6, 0.6], 0.6)] {
        let model = model(d, t);
        let all = model.expectations().unwrap();
        for factors in [[1.0, 1.0], [0.2, 0.7], [1.0, 0.0]] {
            for (candidate, sample, time) in
                [(1.0, 20.0, 200.0), (1.0, 0.1, 50.0), (3.0, 500.0, 2000.0), (1.0, 10.0, 12.0)]
            {
                let cost = CostModel::new(candidate, sample).unwrap();
                let objective = |m: f64| -> f64 {
                    all.iter().zip(factors).map(|(e, factor)| factor * variance(e, cost, time, m)).sum()
                };
                let best = objective(scan(cost, time, objective));
                let budget = model.optimal(cost, time, Objective::Weighted(factors));
                assert!(budget.candidates() >= 1.0 && budget.samples() >= 1.0);
                assert!(budget.cost(cost) <= time * (1.0 + 1e-6), "{budget:?}");
                let chosen = objective(budget.candidates());
                assert!(chosen <= best + 1e-6 * best.abs(), "{budget:?}: {chosen} against {best}");
            }
        }
    }
}

#[test]
fn norm_of_variance_is_the_brute_force_optimum_and_the_norm_of_parts_an_upper_bound() {
    let mut differ = 0;
    for (d, t) in [([0.5, 0.9, 0.1], 0.4), ([0.2, 0.8, 0.5], 0.5), ([0.9, 0.0, 0.3], 0.35), ([0.45, 0.5, 0.6], 0.5)] {
        let model = model(d, t);
        let all = model.expectations().unwrap();
        let cost = CostModel::new(1.0, 30.0).unwrap();
        let norm = |of: &dyn Fn(&Expectations) -> f64| all.iter().map(|e| of(e).powi(2)).sum::<f64>().sqrt();
        let objective = |m: f64| norm(&|e| variance(e, cost, 1e6, m));
        let best = objective(scan(cost, 1e6, objective));
        let by_norm = objective(model.optimal_candidates(cost, Objective::NormOfVariance));
        assert!(by_norm <= best * (1.0 + 1e-6), "{by_norm} {best}");
        // Talbot, Cline and Egbert's equation 3 minimises the sum of the norms of the parts, which is no less.
        let bound = |m: f64| (norm(&Expectations::reducible) / m + norm(&Expectations::remaining)) * (m + 30.0) / 1e6;
        let chosen = model.optimal_candidates(cost, Objective::NormOfParts);
        let reducible: f64 = all.iter().map(Expectations::reducible).sum();
        if reducible > 0.0 {
            assert!(bound(chosen) <= bound(scan(cost, 1e6, bound)) * (1.0 + 1e-6));
        } else {
            assert_eq!(chosen, 1.0);
        }
        assert!(objective(chosen) <= bound(chosen) * (1.0 + 1e-9));
        differ += usize::from(objective(chosen) > best * 1.001);
    }
    assert!(differ > 0, "the two objectives are never told apart");
}

#[test]
fn the_special_cases_of_the_paper() {
    let cost = CostModel::new(2.0, 30.0).unwrap();
    // A perfect target: e2 = e1, equation 3 is infinite. All the time goes to the candidates of one sample.
    let mut perfect = VarianceModel::<1>::new();
    for k in 0..8 {
        // Powers of two, so that the sums are exact.
        let f = [1.0, 2.0, 4.0, 8.0][k % 4];
        perfect.add([f], f, 1.0);
    }
    for objective in [Objective::NormOfParts, Objective::Weighted([1.0])] {
        assert_eq!(perfect.optimal_candidates(cost, objective), f64::INFINITY);
        assert_eq!(perfect.optimal(cost, 100.0, objective), Budget::new(35.0, 1.0));
    }
    let numerical = perfect.optimal(cost, 100.0, Objective::NormOfVariance);
    assert_eq!(numerical, Budget::new(35.0, 1.0));

    // e3 < e2: more candidates hurt.
    let hurt = model([0.5], -0.5);
    assert!(hurt.more_candidates_hurt([1.0]) && hurt.expectations().unwrap()[0].reducible() < 0.0);
    for objective in [Objective::NormOfParts, Objective::Weighted([1.0]), Objective::NormOfVariance] {
        assert_eq!(hurt.optimal_candidates(cost, objective), 1.0, "{objective:?}");
        assert_eq!(hurt.optimal(cost, 320.0, objective), Budget::new(1.0, 10.0));
    }

    // T < T_X + T_Y: one of each; a little more: one sample.
    let usual = model([0.5], 0.3);
    for time in [0.0, 1.0, 31.9, -5.0, f64::NAN] {
        assert_eq!(usual.optimal(cost, time, Objective::NormOfParts), Budget::ONE, "{time}");
    }
    let one = usual.optimal(cost, 34.0, Objective::NormOfParts);
    assert_eq!((one.candidates(), one.samples()), (2.0, 1.0));

    // Without candidates, without costs: importance sampling.
    assert_eq!(VarianceModel::<1>::new().optimal_candidates(cost, Objective::NormOfParts), 1.0);
    let free = CostModel::new(1.0, 0.0).unwrap();
    assert_eq!(perfect.optimal_candidates(free, Objective::NormOfParts), 1.0);
    assert_eq!(free.robust(), Budget::ONE);
    assert!(VarianceModel::<1>::new().predict(Budget::ONE)[0].is_nan());
}

#[test]
fn the_robust_bound_fails_where_more_candidates_hurt() {
    // The target promises most where the integrand is least.
    let e = model([0.9], -0.9).expectations().unwrap()[0];
    assert!(e.reducible() < 0.0);
    let cost = CostModel::new(1.0, 30.0).unwrap();
    let robust = cost.robust().candidates();
    let best = variance(&e, cost, 1e6, scan(cost, 1e6, |m| variance(&e, cost, 1e6, m)));
    assert!(variance(&e, cost, 1e6, robust) > 5.0 * best);
}

proptest! {
    /// Factor two, for any parts with `e3 >= e2 >= e1`, and no more than that.
    #[test]
    fn the_robust_choice_has_at_most_twice_the_least_variance(
        reducible in 0.0..10.0_f64,
        remaining in 0.0..10.0_f64,
        ratio in -3.0..3.0_f64,
        more in 0.0..4.0_f64,
    ) {
        let cost = CostModel::new(1.0, 10_f64.powf(ratio)).unwrap();
        let time = (cost.candidate() + cost.sample()) * 10_f64.powf(more);
        let e = Expectations { e1: 1.0, e2: 1.0 + remaining, e3: 1.0 + remaining + reducible };
        let of = |b: Budget| e.variance(1.0 / b.candidates(), 1.0 / b.samples());
        let robust = of(Budget::within(cost.robust().candidates(), cost, time));
        let best = of(Budget::within(scan(cost, time, |m| of(Budget::within(m, cost, time))), cost, time));
        prop_assert!(robust <= 2.0 * best * (1.0 + 1e-5), "{} {}", robust, best);
    }

    #[test]
    fn budgets_stay_within_their_time(m in 0.0..1e9_f64, candidate in 1e-3..1e3_f64, sample in 0.0..1e3_f64, time in 0.0..1e9_f64) {
        let cost = CostModel::new(candidate, sample).unwrap();
        let budget = Budget::within(m, cost, time);
        prop_assert!(budget.candidates() >= 1.0 && budget.samples() >= 1.0);
        prop_assert!(budget.cost(cost) <= time.max(candidate + sample) * (1.0 + 1e-12));
    }
}

#[test]
fn costs_are_measured_and_checked() {
    assert_eq!(CostModel::new(0.0, 1.0), Err(CostError::Candidate(0.0)));
    assert_eq!(CostModel::new(1.0, -1.0), Err(CostError::Sample(-1.0)));
    assert!(CostModel::new(f64::NAN, 1.0).unwrap_err().to_string().contains("NaN"));
    assert!(CostModel::new(1.0, f64::INFINITY).unwrap_err().to_string().contains("inf"));
    assert_eq!(robust_mean(&[1.0, f64::NAN, 2.0, 3.0]), Err(CostError::TooFew { count: 3 }));
    assert_eq!(robust_mean(&[3.0, 1.0, 2.0, 1e9, 2.0, -1e9, 2.0, 2.0]), Ok(2.0));
    // A clock of a unit per call, blocks of four and one; blocks that did nothing do not count.
    let mut now = 0.0;
    let clock = || {
        now += 1.0;
        now
    };
    let mut calls = 0;
    let candidate = || {
        calls += 1;
        if calls % 2 == 0 { 0 } else { 4 }
    };
    assert_eq!(CostModel::measure(8, clock, candidate, || 1), CostModel::new(0.25, 1.0));
    assert_eq!(CostModel::measure(8, || 1.0, || 1, || 1), Err(CostError::Candidate(0.0)));
    // Talbot, Cline and Egbert 2005, figure 4.
    let paper = CostModel::new(1.0, 15.75).unwrap();
    assert_eq!(paper.robust().candidates(), 15.75);
}

#[test]
fn maps_pool_their_neighbours() {
    let mut map = RatioMap::<1>::new(3, 2);
    assert_eq!(map.size(), [3, 2]);
    for (x, y) in [(0, 0), (1, 0), (2, 1)] {
        for k in 0..10 {
            let value = f64::from(k) + 0.5;
            map.pixel_mut(x, y).unwrap().add([value * value], value, 1.0);
        }
    }
    assert!(map.pixel_mut(3, 0).is_none() && map.pixel_mut(0, 2).is_none());
    assert!(map.pixel_mut(0, usize::MAX).is_none());
    assert_eq!(map.pooled(0, 0, 0).count(), 10);
    assert_eq!(map.pooled(0, 0, 1).count(), 20);
    assert_eq!(map.pooled(1, 1, 1).count(), 30);
    assert_eq!(map.pooled(1, 1, usize::MAX).count(), 30);
    assert_eq!(map.pooled(100, 100, 1).count(), 0);
    assert_eq!(map.total().count(), 30);
    let cost = CostModel::new(1.0, 10.0).unwrap();
    let candidates = map.candidates(0, cost, Objective::NormOfParts);
    assert!(candidates[0] > 1.0 && candidates[3] == 1.0 && candidates.len() == 6);
    assert!(RatioMap::<1>::new(0, 0).candidates(1, cost, Objective::NormOfParts).is_empty());
}
