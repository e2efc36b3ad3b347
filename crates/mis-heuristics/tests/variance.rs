//! Variances of the estimators, exactly: integrals over a handful of states are sums.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use mis_heuristics::{
    Balance, Bounded, Cutoff, Heuristic, Maximum, OptimalMoments, OptimalWeights, Power, Stratification, compensate,
    variance_bound, variance_bound_with_counts,
};

const STATES: usize = 6;

/// An integrand and three techniques over six states.
#[derive(Clone, Debug)]
struct Problem {
    f: [f64; STATES],
    pdf: [[f64; STATES]; 3],
    counts: [u32; 3],
}

impl Problem {
    /// Anything from smooth to spiky; zeros included, but every state can be reached.
    fn random(random: &mut Random) -> Self {
        let mut value = || if random.next() < 0.2 { 0.0 } else { 10_f64.powf(4.0 * random.next() - 2.0) };
        let f = core::array::from_fn(|_| value());
        let mut pdf: [[f64; STATES]; 3] = core::array::from_fn(|_| core::array::from_fn(|_| value()));
        for (x, first) in pdf[0].iter_mut().enumerate() {
            *first += 1e-3 * (1 + x) as f64;
        }
        for technique in &mut pdf {
            let sum: f64 = technique.iter().sum::<f64>() + 1e-9;
            technique[0] += 1e-9;
            technique.iter_mut().for_each(|p| *p /= sum);
        }
        let counts = core::array::from_fn(|_| 1 + (4.0 * random.next()) as u32);
        Self { f, pdf, counts }
    }

    fn equal_counts(mut self) -> Self {
        self.counts = [1; 3];
        self
    }

    fn integral(&self) -> f64 {
        self.f.iter().sum()
    }

    fn densities(&self, x: usize) -> [f64; 3] {
        core::array::from_fn(|i| f64::from(self.counts[i]) * self.pdf[i][x])
    }

    /// Mean and variance of the multi-sample estimator.
    fn moments(&self, weight: impl Fn(usize, usize) -> f64) -> (f64, f64) {
        let (mut mean, mut variance) = (0.0, 0.0);
        for i in 0..3 {
            let n = f64::from(self.counts[i]);
            let (mut first, mut second) = (0.0, 0.0);
            for x in 0..STATES {
                let p = self.pdf[i][x];
                if p > 0.0 {
                    let value = weight(i, x) * self.f[x] / (n * p);
                    first += p * value;
                    second += p * value * value;
                }
            }
            mean += n * first;
            variance += n * (second - first * first);
        }
        (mean, variance)
    }

    fn variance(&self, heuristic: &impl Heuristic<f64>) -> f64 {
        let (mean, variance) = self.moments(|i, x| heuristic.weight(i, &self.densities(x)));
        assert!((mean / self.integral() - 1.0).abs() < 1e-12, "biased: {mean} instead of {}", self.integral());
        variance.max(0.0)
    }

    /// The true moments: every sample with its expected number of occurrences.
    fn optimal(&self) -> OptimalWeights<3> {
        // Moments are sums over samples: scale each state to its share D(x) by adding it D(x) times, which the
        // quadratic form allows at once: d_i d_k / D^2 * D = (d_i / D) (d_k / D) D.
        let mut moments = OptimalMoments::new(self.counts).unwrap();
        const RESOLUTION: f64 = 2e4;
        for x in 0..STATES {
            let densities = self.densities(x);
            let times = (densities.iter().sum::<f64>() * RESOLUTION).round() as u32;
            for _ in 0..times {
                moments.add(self.f[x], &densities).unwrap();
            }
        }
        moments.solve()
    }

    /// Mean and variance with optimal weights, by their contributions.
    fn optimal_moments(&self, weights: &OptimalWeights<3>) -> (f64, f64) {
        let (mut mean, mut variance) = (weights.constant(), 0.0);
        for i in 0..3 {
            let n = f64::from(self.counts[i]);
            let (mut first, mut second) = (0.0, 0.0);
            for x in 0..STATES {
                let value = weights.contribution(self.f[x], &self.densities(x)).unwrap();
                first += self.pdf[i][x] * value;
                second += self.pdf[i][x] * value * value;
            }
            mean += n * first;
            variance += n * (second - first * first);
        }
        (mean, variance.max(0.0))
    }
}

/// A soft stratification whose shares have nothing to do with the densities.
fn strata(problem: &Problem, technique: usize, x: usize) -> f64 {
    let densities = problem.densities(x);
    let strata = Stratification::new(|k| (densities[k] > 0.0).then_some(if x.is_multiple_of(2) { 0.25 } else { 1.0 }));
    if densities[2] > 0.0 {
        strata.weight(technique, &densities)
    } else {
        strata.without_last().weight(technique, &densities)
    }
}

/// PCG32 of a fixed seed.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let mixed = (((self.0 >> 18) ^ self.0) >> 27) as u32;
        f64::from(mixed.rotate_right((self.0 >> 59) as u32)) / 4_294_967_296.0
    }
}

/// Rounding of variances that are differences.
fn at_most(variance: f64, bound: f64, scale: f64) -> bool {
    variance <= bound + 1e-9 * scale * scale
}

#[test]
fn equation_5_holds_against_any_weights() {
    let mut random = Random(5);
    for _ in 0..2000 {
        let problem = Problem::random(&mut random);
        let equal = problem.clone().equal_counts();
        // Non-negative weights that sum to one, whatever they are.
        let shares: [[f64; STATES]; 3] = core::array::from_fn(|_| core::array::from_fn(|_| random.next().powi(4)));
        let share = |p: &Problem, i: usize, x: usize| {
            let total: f64 = (0..3).map(|k| if p.pdf[k][x] > 0.0 { shares[k][x] } else { 0.0 }).sum();
            if p.pdf[i][x] > 0.0 { shares[i][x] / total } else { 0.0 }
        };
        for (problem, is_equal) in [(&equal, true), (&problem, false)] {
            let mean = problem.integral();
            if mean == 0.0 {
                continue;
            }
            let others = [
                problem.moments(|i, x| share(problem, i, x)).1.max(0.0),
                problem.variance(&Balance),
                problem.variance(&Power::TWO),
                problem.variance(&Maximum),
            ];
            for other in others {
                for (kind, variance) in [
                    (Bounded::Balance, problem.variance(&Balance)),
                    (Bounded::Square, problem.variance(&Power::TWO)),
                    (Bounded::Maximum, problem.variance(&Maximum)),
                    (Bounded::Cutoff(0.3), problem.variance(&Cutoff::new(0.3).unwrap())),
                ] {
                    let bound = variance_bound_with_counts(kind, other, mean, &problem.counts);
                    assert!(at_most(variance, bound, mean), "{kind:?}: {variance} > {bound} for {problem:?}");
                    if is_equal {
                        let bound = variance_bound(kind, 3, other, mean, 1);
                        assert!(at_most(variance, bound, mean), "{kind:?}: {variance} > {bound} for {problem:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn the_bound_as_printed_is_violated() {
    // Planted bug: E in place of E^2. Scale the integrand down and up: only one of the two forms scales along.
    let mut violated = false;
    let mut random = Random(6);
    for _ in 0..200 {
        let mut problem = Problem::random(&mut random).equal_counts();
        problem.f = problem.f.map(|f| 1e3 * f);
        let best = problem.optimal_moments(&problem.optimal()).1;
        violated |= problem.integral() > 0.0 && problem.variance(&Power::TWO) > 1.37 * best + problem.integral();
    }
    assert!(violated);
}

#[test]
fn optimal_weights_have_least_variance_and_are_unbiased() {
    let mut random = Random(7);
    let mut below_balance = 0;
    for _ in 0..50 {
        let problem = Problem::random(&mut random);
        let mean = problem.integral();
        if mean == 0.0 {
            continue;
        }
        let (expected, variance) = problem.optimal_moments(&problem.optimal());
        assert!((expected / mean - 1.0).abs() < 1e-6, "biased: {expected} instead of {mean}");
        // The moments are rounded to 1 / RESOLUTION per state.
        let slack = 1e-2 * problem.variance(&Balance);
        for other in [
            problem.variance(&Balance),
            problem.variance(&Power::TWO),
            problem.variance(&Maximum),
            problem.variance(&Cutoff::new(0.3).unwrap()),
            problem.moments(|i, x| strata(&problem, i, x)).1,
        ] {
            assert!(variance <= other + slack, "{variance} > {other} for {problem:?}");
        }
        below_balance += usize::from(variance < 0.9 * problem.variance(&Balance));
    }
    assert!(below_balance > 10, "optimal weights hardly ever help: {below_balance} of 50");
}

#[test]
fn strata_are_unbiased_and_those_as_printed_are_not() {
    let mut random = Random(11);
    let mut biased = 0;
    for _ in 0..50 {
        let problem = Problem::random(&mut random);
        let (mean, _) = problem.moments(|i, x| strata(&problem, i, x));
        assert!((mean - problem.integral()).abs() <= 1e-12 * problem.integral());
        // Planted bug: the weight of the last technique is left out.
        let (mean, _) = problem.moments(|i, x| if i == 2 { 0.0 } else { strata(&problem, i, x) });
        biased += usize::from(mean < 0.999 * problem.integral());
    }
    assert!(biased > 40, "{biased} of 50");
}

#[test]
fn optimal_weights_as_a_heuristic_are_the_same_estimator() {
    let mut random = Random(8);
    for _ in 0..20 {
        let mut problem = Problem::random(&mut random);
        // Nowhere zero, so that the division by f is harmless.
        problem.f = problem.f.map(|f| f + 0.5);
        let weights = problem.optimal();
        let by_weights = problem.moments(|i, x| weights.at(problem.f[x]).weight(i, &problem.densities(x)));
        let by_contributions = problem.optimal_moments(&weights);
        assert!((by_weights.0 / problem.integral() - 1.0).abs() < 1e-9);
        assert!((by_weights.1 - by_contributions.1).abs() < 1e-6 * problem.integral().powi(2));
    }
}

#[test]
fn compensation_lowers_the_variance_of_the_balance_heuristic() {
    let mut random = Random(10);
    let mut lower = 0;
    for _ in 0..200 {
        // The table follows the integrand, the other technique is uniform. The integrand has a bright spot.
        let mut f: [f64; STATES] = core::array::from_fn(|_| 0.5 + random.next());
        f[2] = 10.0;
        let total: f64 = f.iter().sum();
        let (table, uniform) = (f.map(|f| f / total), [1.0 / STATES as f64; STATES]);
        let mut compensated = f;
        compensate(&mut compensated, &uniform, 0.5).unwrap();
        // The third technique must not matter: it is the uniform one again, with the samples shared out.
        let problem = |pdf| Problem { f, pdf: [pdf, uniform, uniform], counts: [2, 1, 1] };
        let (before, after) = (problem(table).variance(&Balance), problem(compensated).variance(&Balance));
        lower += usize::from(after < before);
    }
    assert_eq!(lower, 200);
}
