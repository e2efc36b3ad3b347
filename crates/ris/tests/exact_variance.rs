//! Equation 2, exactly: closed forms of polynomials, and the real estimator over every sequence of numbers.

#![allow(clippy::unwrap_used)]

mod support;

use core::f64::consts::PI;

use ris::{Budget, Expectations, Ris, VarianceModel};
use support::{Problem, Random, STATES, assert_close, choices};

/// `e1, e2, e3` on `[0, 1]` for `f = x^a`, `g = x^b`, `p = (c + 1) x^c`, where they exist.
fn polynomial(a: f64, b: f64, c: f64) -> Expectations {
    let integral = |exponent: f64| 1.0 / (exponent + 1.0);
    Expectations {
        e1: integral(a).powi(2),
        e2: integral(2.0 * a - b) * integral(b),
        e3: integral(2.0 * a - c) / (c + 1.0),
    }
}

/// A model of many candidates at the midpoints of equal shares of `p`.
fn model<const C: usize>(
    count: u32,
    sample: impl Fn(f64) -> f64,
    f: impl Fn(f64) -> [f64; C],
    g: impl Fn(f64) -> f64,
    p: impl Fn(f64) -> f64,
) -> VarianceModel<C> {
    let mut model = VarianceModel::new();
    for k in 0..count {
        let x = sample((f64::from(k) + 0.5) / f64::from(count));
        model.add(f(x), g(x), p(x));
    }
    model
}

fn assert_expectations(estimate: Expectations, truth: Expectations, tolerance: f64) {
    let Expectations { e1, e2, e3 } = estimate;
    for (a, b) in [(e1, truth.e1), (e2, truth.e2), (e3, truth.e3)] {
        assert!((a - b).abs() <= tolerance * b, "{estimate:?} is not {truth:?}");
    }
}

#[test]
fn polynomials() {
    // (a, b, c): the target may fit better than the source, worse, perfectly, or be the source.
    for [a, b, c] in
        [[2.0, 1.0, 0.0], [2.0, 2.0, 0.0], [3.0, 2.0, 1.0], [1.0, 2.0, 0.0], [2.0, 0.5, 1.0], [2.0, 1.0, 1.0]]
    {
        let truth = polynomial(a, b, c);
        let inverse = |u: f64| u.powf(1.0 / (c + 1.0));
        let model = model(20_000, inverse, |x| [x.powf(a)], |x| x.powf(b), |x| (c + 1.0) * x.powf(c));
        // The U-statistics of points that are no independent samples are off by 1/n.
        assert_expectations(model.expectations().unwrap()[0], truth, 2e-3);
    }
    // The variance itself, as in the example of the documentation.
    let truth = polynomial(2.0, 1.0, 0.0);
    assert_close(truth.variance(0.5, 1.0), (0.2 - 0.125) / 2.0 + 0.125 - 1.0 / 9.0, 1e-15);
    // A perfect target leaves nothing, a target like the source changes nothing.
    assert_close(polynomial(2.0, 2.0, 0.0).remaining(), 0.0, 1e-15);
    assert_close(polynomial(2.0, 1.0, 1.0).reducible(), 0.0, 1e-15);
}

#[test]
fn a_target_that_fits_worse_than_the_source_makes_more_candidates_hurt() {
    // f = x, p = 1, g = 1 - x + eps: e3 = 1/3 is less than e2.
    let eps = 0.1_f64;
    // integral x^2 / (1 + eps - x) = (1+eps)^2 ln((1+eps)/eps) - (1+eps) - 1/2
    let over = (1.0 + eps).powi(2) * ((1.0 + eps) / eps).ln() - (1.0 + eps) - 0.5;
    let truth = Expectations { e1: 0.25, e2: over * (0.5 + eps), e3: 1.0 / 3.0 };
    assert!(truth.reducible() < -0.2);
    let model = model(20_000, |u| u, |x| [x], |x| 1.0 + eps - x, |_| 1.0);
    assert_expectations(model.expectations().unwrap()[0], truth, 2e-3);
    assert!(model.more_candidates_hurt([1.0]));
    let variance = |candidates| model.predict(Budget::new(candidates, 1.0))[0];
    assert!(variance(1.0) < variance(2.0) && variance(2.0) < variance(8.0));
    // Where the target fits better they help.
    assert!(!self::model(1000, |u| u, |x| [x], |x| 0.1 + x, |_| 1.0).more_candidates_hurt([1.0]));
}

#[test]
fn the_diffuse_sphere_falls_as_one_over_m() {
    // Uniform light, f = g = cos / pi over the hemisphere, p = 1 / (2 pi). cos is uniform in [0, 1].
    let f = |cos: f64| cos / PI;
    let model = model(20_000, |u| u, |cos| [f(cos)], f, |_| 1.0 / (2.0 * PI));
    assert_expectations(model.expectations().unwrap()[0], Expectations { e1: 1.0, e2: 1.0, e3: 4.0 / 3.0 }, 2e-4);
    for candidates in [1.0_f64, 2.0, 4.0, 20.0] {
        let predicted = model.predict(Budget::new(candidates, 1.0))[0];
        assert_close(predicted, 1.0 / (3.0 * candidates), 2e-4);
    }
}

/// Mean and variance of the real estimator.
fn moments(problem: &Problem, budget: Budget) -> (f64, f64) {
    let (source, target, ris) = (problem.source(), problem.target(), Ris::new(budget));
    let (mut total, mut mean, mut square) = (0.0, 0.0, 0.0);
    problem.for_each_sequence(budget, &mut |numbers, probability| {
        let mut numbers = numbers.iter().copied();
        let estimate = ris.estimate(&source, &target, &mut || numbers.next().unwrap(), |&x| problem.f[x]);
        assert_eq!(numbers.next(), None, "fewer numbers were asked for");
        total += probability;
        mean += probability * estimate;
        square += probability * estimate * estimate;
    });
    assert_close(total, 1.0, 1e-12);
    (mean, square - mean * mean)
}

#[test]
fn the_estimator_has_the_variance_of_equation_2() {
    let mut random = Random(1);
    let budgets = [[1.0, 1.0], [2.0, 1.0], [3.0, 1.0], [4.0, 1.0], [2.0, 2.0], [1.0, 3.0]];
    let fractional = [[1.25, 1.0], [2.5, 1.0], [3.75, 1.0], [2.0, 1.5], [1.5, 1.75]];
    let mut hurt = 0;
    for _ in 0..20 {
        let problem = Problem::random(&mut random);
        let e = problem.expectations();
        hurt += usize::from(e.reducible() < 0.0);
        for [candidates, samples] in budgets.iter().chain(&fractional).copied() {
            let (mean, variance) = moments(&problem, Budget::new(candidates, samples));
            assert_close(mean, problem.integral(), 1e-9);
            let predicted = e.variance(Budget::mean_inverse(candidates), Budget::mean_inverse(samples));
            assert!((variance - predicted).abs() < 1e-7 * e.e3, "{variance} {predicted} {candidates} {samples}");
        }
        // Planted bug: fractional counts taken as they are.
        let (_, variance) = moments(&problem, Budget::new(1.5, 1.0));
        assert!((variance - e.variance(1.0 / 1.5, 1.0)).abs() > 1e-4 * e.reducible().abs());
    }
    assert!((3..18).contains(&hurt), "both signs of e3 - e2 are wanted: {hurt} of 20");
}

#[test]
fn probability_that_is_left_counts_as_candidates_of_weight_zero() {
    let mut problem = Problem::random(&mut Random(9));
    problem.p = [0.3, 0.2, 0.1];
    let e = problem.expectations();
    let mut model = VarianceModel::<1>::new();
    for x in [0, 0, 0, 1, 1, 2] {
        (0..1000).for_each(|_| model.add([problem.f[x]], problem.g[x], problem.p[x]));
    }
    (0..4000).for_each(|_| model.add_nothing());
    assert_expectations(model.expectations().unwrap()[0], e, 2e-3);
    // The estimator: states that the walk leaves out are drawn as none, of density zero.
    let (source, target) = (problem.source(), problem.target());
    let drawn: Vec<_> = choices(&[0.3, 0.2, 0.1, 0.4]).collect();
    let mut mean = 0.0;
    for &(x, u, p) in &drawn {
        for &(y, v, q) in &drawn {
            let weight = |x: usize| if x < STATES { problem.g[x] / problem.p[x] } else { 0.0 };
            let share = if weight(y) > 0.0 { weight(y) / (weight(x) + weight(y)) } else { 0.0 };
            for (w, r) in [(0.5 * share, share), (0.5 * (1.0 + share), 1.0 - share)] {
                let mut numbers = [u, 0.5, v, w].into_iter();
                let ris = Ris::new(Budget::new(2.0, 1.0));
                let estimate = ris.estimate(&source, &target, &mut || numbers.next().unwrap(), |&x| problem.f[x]);
                mean += p * q * r * estimate;
            }
        }
    }
    assert_close(mean, problem.integral(), 1e-12);
}

#[test]
fn the_estimates_of_the_expectations_are_unbiased() {
    // All triples of candidates, with their probabilities.
    let problem = Problem::random(&mut Random(3));
    let mut mean = [0.0; 3];
    let mut naive = 0.0;
    for index in 0..STATES.pow(3) {
        let drawn = [index % STATES, index / STATES % STATES, index / STATES / STATES];
        let mut model = VarianceModel::<1>::new();
        drawn.iter().for_each(|&x| model.add([problem.f[x]], problem.g[x], problem.p[x]));
        let probability: f64 = drawn.iter().map(|&x| problem.p[x]).product();
        let Expectations { e1, e2, e3 } = model.expectations().unwrap()[0];
        for (mean, e) in mean.iter_mut().zip([e1, e2, e3]) {
            *mean += probability * e;
        }
        let sum: f64 = drawn.iter().map(|&x| problem.f[x] / problem.p[x]).sum();
        naive += probability * (sum / 3.0).powi(2);
    }
    let truth = problem.expectations();
    for (mean, truth) in mean.into_iter().zip([truth.e1, truth.e2, truth.e3]) {
        assert_close(mean, truth, 1e-12);
    }
    // Planted bug: the square of the mean, without the correction for pairs of a candidate with itself.
    assert!(naive > 1.05 * truth.e1);
}

#[test]
fn merged_models_and_several_components() {
    let mut random = Random(4);
    let (mut all, mut parts) = (VarianceModel::<2>::new(), [VarianceModel::<2>::new(); 2]);
    for k in 0..100 {
        let (f, g, p) = ([random.next(), -random.next()], 0.1 + random.next(), 0.1 + random.next());
        all.add(f, g, p);
        parts[k % 2].add(f, g, p);
    }
    let [mut sum, other] = parts;
    sum.merge(&other);
    assert_eq!(sum.count(), 100);
    let (a, b) = (sum.expectations().unwrap(), all.expectations().unwrap());
    for (a, b) in a.into_iter().zip(b) {
        assert_expectations(a, b, 1e-12);
    }
}
