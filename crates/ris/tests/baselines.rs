//! The baselines against closed forms.

#![allow(clippy::unwrap_used)]

mod support;

use ris::baselines::{ImportanceSampling, RejectionSampling, Tabulated1d, Tabulated2d, WeightedImportanceSampling};
use ris::{Budget, Source, from_fn};
use support::{Problem, Random, STATES, assert_close, choices};

/// All tuples of `count` states with their numbers and probabilities.
fn tuples(problem: &Problem, count: u32) -> Vec<(Vec<f64>, f64)> {
    let single: Vec<_> = choices(&problem.p).collect();
    (0..STATES.pow(count))
        .map(|index| {
            let drawn = (0..count).map(|k| single[index / STATES.pow(k) % STATES]);
            (drawn.clone().map(|(_, u, _)| u).collect(), drawn.map(|(_, _, p)| p).product())
        })
        .collect()
}

/// Mean and variance over all tuples.
fn moments(tuples: &[(Vec<f64>, f64)], mut estimate: impl FnMut(&mut dyn FnMut() -> f64) -> f64) -> (f64, f64) {
    let (mut mean, mut square) = (0.0, 0.0);
    for (numbers, probability) in tuples {
        let mut numbers = numbers.iter().copied();
        let estimate = estimate(&mut || numbers.next().unwrap());
        mean += probability * estimate;
        square += probability * estimate * estimate;
    }
    (mean, square - mean * mean)
}

#[test]
fn importance_sampling() {
    let mut random = Random(1);
    for count in 1..=4_u32 {
        let problem = Problem::random(&mut random);
        let e = problem.expectations();
        let sampling = ImportanceSampling { samples: count as f64 };
        let source = problem.source();
        let (mean, variance) =
            moments(&tuples(&problem, count), |u| sampling.estimate(&source, &mut || u(), |&x| problem.f[x]));
        assert_close(mean, problem.integral(), 1e-12);
        assert_close(variance, (e.e3 - e.e1) / f64::from(count), 1e-9);
    }
    // A count that is rounded: 3/4 of the numbers give two samples.
    let (mut asked, sampling) = (0, ImportanceSampling { samples: 1.75 });
    let source = from_fn(|u: &mut dyn FnMut() -> f64| (u(), 1.0), |_: &f64| 1.0);
    for k in 0..4 {
        let mut numbers = [(f64::from(k) + 0.5) / 4.0, 0.1, 0.3].into_iter();
        let estimate: f64 = sampling.estimate(&source, &mut || numbers.next().unwrap(), |x| *x);
        asked += 2 - numbers.count();
        assert_eq!(estimate, if k < 3 { 0.2 } else { 0.1 });
    }
    assert_eq!(asked, 7);
}

#[test]
fn weighted_importance_sampling_is_biased_of_order_one_over_n() {
    let problem = Problem { f: [1.0, 4.0, 2.0], g: [1.0, 3.0, 3.0], p: [0.5, 0.2, 0.3] };
    let source = problem.source();
    let target = problem.target();
    let target_integral: f64 = problem.g.iter().sum();
    // Second order: bias = -(Cov(a, c) - I/G Var(c)) / (n G), with a = f/p, c = g/p.
    let expect = |of: &dyn Fn(usize) -> f64| (0..STATES).map(|x| problem.p[x] * of(x)).sum::<f64>();
    let (integral, g) = (problem.integral(), target_integral);
    let product = expect(&|x| problem.f[x] * problem.g[x] / problem.p[x].powi(2));
    let square = expect(&|x| (problem.g[x] / problem.p[x]).powi(2));
    let leading = -(product - integral * g - integral / g * (square - g * g)) / g;
    let mut scaled = Vec::new();
    for count in [1_u32, 2, 4, 8, 11] {
        let weighted = WeightedImportanceSampling { samples: count as f64, target_integral };
        let (mean, _) =
            moments(&tuples(&problem, count), |u| weighted.estimate(&source, &target, &mut || u(), |&x| problem.f[x]));
        scaled.push((mean - integral) * f64::from(count));
    }
    // Biased with any number, and the bias times the number tends to the leading term: consistent.
    assert!(scaled.iter().all(|bias| bias.abs() > 0.1), "{scaled:?}");
    let errors: Vec<f64> = scaled.iter().map(|bias| (bias / leading - 1.0).abs()).collect();
    assert!(errors[4] < 0.15 && errors.windows(2).all(|pair| pair[1] < pair[0]), "{errors:?} {leading}");
    // A target that is the integrand has no error at all.
    let perfect = WeightedImportanceSampling { samples: 3.0, target_integral: problem.integral() };
    let exact = |x: &usize| problem.f[*x];
    let (mean, variance) =
        moments(&tuples(&problem, 3), |u| perfect.estimate(&source, &exact, &mut || u(), |&x| problem.f[x]));
    assert_close(mean, problem.integral(), 1e-12);
    assert_close(variance, 0.0, 1e-12);
}

/// `P(accepted as candidate 1)` of each state, and what is rejected: by the numbers at both sides of the threshold.
fn accepted(problem: &Problem, bound: f64) -> ([f64; STATES], f64, bool) {
    let (source, target) = (problem.source(), problem.target());
    let sampling = RejectionSampling::new(bound, 1).unwrap();
    let (mut first, mut exceeded) = ([0.0; STATES], false);
    for (x, u, p) in choices(&problem.p) {
        let share = (problem.g[x] / problem.p[x] / bound).min(1.0);
        for (v, q) in [(share * (1.0 - 1e-12), share), (share + 1e-12 * (1.0 - share), 1.0 - share)] {
            let mut numbers = [u, v.min(1.0 - 1e-12)].into_iter();
            if q > 0.0
                && let Some(accepted) = sampling.draw(&source, &target, &mut || numbers.next().unwrap())
            {
                assert_eq!((accepted.sample, accepted.candidates), (x, 1));
                first[x] += p * q;
                exceeded |= accepted.bound_exceeded;
            }
        }
    }
    (first, 1.0 - first.iter().sum::<f64>(), exceeded)
}

#[test]
fn rejection_sampling_is_exact() {
    let problem = Problem { f: [1.0; 3], g: [1.0, 3.0, 0.0], p: [0.5, 0.2, 0.3] };
    // The bound is met exactly by state 1. Rejections repeat, so the distribution is that of the first acceptance.
    let bound = 15.0;
    let (first, rejected, exceeded) = accepted(&problem, bound);
    let accepted_at_all = 1.0 - rejected;
    assert_close(accepted_at_all, 4.0 / bound, 1e-12);
    first.iter().zip(problem.g).for_each(|(p, g)| assert_close(p / accepted_at_all, g / 4.0, 1e-12));
    assert!(!exceeded);
    // A bound that is none: the density is that of min(g, bound p), and the outcome tells.
    let (first, rejected, exceeded) = self::accepted(&problem, 5.0);
    assert_close(first[1] / (1.0 - rejected), 1.0 / 2.0, 1e-12);
    assert!(exceeded);
    // The limit.
    let never = RejectionSampling::new(1e9, 5).unwrap();
    let mut asked = 0;
    let mut numbers = || {
        asked += 1;
        0.9
    };
    assert_eq!(never.draw(&problem.source(), &problem.target(), &mut numbers), None);
    assert_eq!(asked, 10);
}

#[test]
fn tables_invert_their_distribution_functions() {
    let table = Tabulated1d::new(|x| x * x + 0.1, [-1.0, 3.0], 7).unwrap();
    let (mut sum, mut last) = (0.0, -1.0);
    const STEPS: u32 = 70_000;
    for k in 0..STEPS {
        let u = (f64::from(k) + 0.5) / f64::from(STEPS);
        let x = table.sample(u);
        assert!(x > last, "monotonic");
        last = x;
        // The distribution function up to x is u again.
        let cell = 4.0 / 7.0;
        let full = ((x + 1.0) / cell) as usize;
        let below: f64 = (0..full).map(|i| table.pdf(-1.0 + cell * (i as f64 + 0.5)) * cell).sum();
        let start = -1.0 + cell * full as f64;
        assert!((below + table.pdf(x) * (x - start) - u).abs() < 1e-9);
        sum += 1.0 / table.pdf(x) / f64::from(STEPS);
    }
    assert_close(sum, 4.0, 1e-3);
    // The square of x is no step function: the table follows it at the middles.
    let total: f64 = (0..7).map(|i| (-1.0 + 4.0 / 7.0 * (f64::from(i) + 0.5)).powi(2) + 0.1).sum();
    assert_close(table.pdf(0.9), ((-1.0 + 4.0 / 7.0 * 3.5_f64).powi(2) + 0.1) / total * 7.0 / 4.0, 1e-12);
}

#[test]
fn tables_of_two_dimensions() {
    let domain = [[0.0, 2.0], [-1.0, 1.0]];
    let table = Tabulated2d::new(|[x, y]| if x > 1.0 && y > 0.0 { 0.0 } else { x + y + 2.0 }, domain, [4, 6]).unwrap();
    const STEPS: u32 = 240;
    let at = |k: u32| (f64::from(k) + 0.5) / f64::from(STEPS);
    let (mut area, mut integral) = (0.0, 0.0);
    for (i, j) in (0..STEPS).flat_map(|i| (0..STEPS).map(move |j| (i, j))) {
        let mut numbers = [at(i), at(j)].into_iter();
        let proposal = table.propose(&mut || numbers.next().unwrap()).unwrap();
        assert!(proposal.density > 0.0);
        assert_eq!(proposal.density, table.density(&proposal.sample));
        area += 1.0 / proposal.density / f64::from(STEPS * STEPS);
        integral += table.pdf([2.0 * at(i), 2.0 * at(j) - 1.0]) * 4.0 / f64::from(STEPS * STEPS);
    }
    // The quarter without weight is never sampled.
    assert_close(area, 3.0, 1e-2);
    assert_close(integral, 1.0, 1e-9);
    assert_eq!(Budget::ONE.cost(ris::CostModel::new(1.0, 2.0).unwrap()), 3.0);
}
