//! Several sources, exactly: mixtures, and a number of candidates from each with any heuristic.

#![allow(clippy::unwrap_used)]

mod support;

use estimator_checks::check_heuristic;
use mis_heuristics::{Balance, Cutoff, Densities, Heuristic, Maximum, Power};
use ris::{
    BalanceWeights, Budget, Mixture, Reservoir, Ris, Source, Sources, Uniform, Weights, from_fn, resample_sources,
};
use support::{Choice, Problem, Random, STATES, Step, assert_close, choices, contributions, invert, walk};

/// Three sources over the states, with zeros among their densities; what probability is left draws nothing.
struct Three([[f64; STATES]; 3]);

impl Three {
    fn random(random: &mut Random) -> Self {
        let mut table = [[0.0; STATES]; 3];
        for (k, source) in table.iter_mut().enumerate() {
            source.iter_mut().for_each(|p| *p = 0.1 + random.next());
            // The second and third source do not reach everything; the second draws nothing at times.
            if k > 0 {
                source[k] = 0.0;
            }
            let sum: f64 = source.iter().sum::<f64>() * if k == 1 { 1.3 } else { 1.0 };
            source.iter_mut().for_each(|p| *p /= sum);
        }
        Self(table)
    }
}

impl Sources<usize, f64, 3> for Three {
    fn propose(&self, source: usize, uniform: &mut impl Uniform<f64>) -> Option<usize> {
        let x = invert(&self.0[source], uniform.next_uniform());
        (x < STATES).then_some(x)
    }

    fn densities(&self, x: &usize) -> [f64; 3] {
        self.0.map(|p| p[*x])
    }
}

/// The estimator's outcomes with this heuristic.
fn outcomes(
    sources: &Three,
    counts: [u32; 3],
    target: &[f64; STATES],
    weights: &impl Weights<f64>,
) -> Vec<(ris::Resampled<usize, f64>, f64)> {
    let scaled = |x: usize| -> [f64; 3] { core::array::from_fn(|k| f64::from(counts[k]) * sources.0[k][x]) };
    let step = |source: usize| {
        let drawn = choices(&sources.0[source]).map(|(x, u, probability)| {
            let scaled = scaled(x);
            Choice { u, probability, weight: weights.weight(source, &scaled) * target[x] / scaled[source] }
        });
        Step::Candidate(drawn.collect())
    };
    // All tuples of drawn and missing candidates: a missing one takes its number and no other.
    let mut tuples: Vec<Vec<Step>> = vec![vec![]];
    for (source, &count) in counts.iter().enumerate() {
        let left = 1.0 - sources.0[source].iter().sum::<f64>();
        for _ in 0..count {
            let missing = |steps: &Vec<Step>| {
                let nothing = Step::Number(vec![(1.0 - 0.5 * left, left)]);
                steps.iter().cloned().chain([nothing]).collect::<Vec<_>>()
            };
            let drawn = |steps: &Vec<Step>| steps.iter().cloned().chain([step(source)]).collect::<Vec<_>>();
            let mut longer: Vec<_> = tuples.iter().map(drawn).collect();
            if left > 1e-9 {
                longer.extend(tuples.iter().map(missing));
            }
            tuples = longer;
        }
    }
    let mut outcomes = Vec::new();
    for steps in &tuples {
        walk(steps, &mut |numbers, probability| {
            let mut numbers = numbers.iter().copied();
            let target = |x: &usize| target[*x];
            let picked = resample_sources(sources, counts, weights, &target, &mut || numbers.next().unwrap());
            assert_eq!(numbers.next(), None);
            outcomes.push((picked, probability));
        });
    }
    outcomes
}

fn heuristic(heuristic: impl Heuristic<f64>) -> impl Weights<f64> {
    move |source: usize, densities: &[f64]| heuristic.weight(source, &densities)
}

#[test]
fn any_heuristic_is_unbiased() {
    let mut random = Random(1);
    for counts in [[1, 1, 1], [2, 1, 1], [1, 2, 0], [3, 0, 0]] {
        let sources = Three::random(&mut random);
        let target = Problem::random(&mut random).g;
        let check = |name: &str, weights: &dyn Fn(usize, &[f64]) -> f64| {
            let outcomes = outcomes(&sources, counts, &target, &weights);
            let sums = contributions(&outcomes);
            assert!(sums.iter().all(|sum| (sum - 1.0).abs() < 1e-9), "{name} {counts:?}: {sums:?}");
            assert!(outcomes.iter().all(|(y, _)| y.confidence == f64::from(counts.iter().sum::<u32>())));
        };
        check("balance", &|k, d| BalanceWeights.weight(k, d));
        check("balance of the other crate", &|k, d| heuristic(Balance).weight(k, d));
        check("power", &|k, d| heuristic(Power::TWO).weight(k, d));
        check("maximum", &|k, d| heuristic(Maximum).weight(k, d));
        check("cutoff", &|k, d| heuristic(Cutoff::new(0.5).unwrap()).weight(k, d));
    }
    // Negative control: weights that ignore which source can draw the candidate.
    let (sources, target) = (Three::random(&mut random), [1.0; STATES]);
    let sums = contributions(&outcomes(&sources, [1, 1, 1], &target, &|_: usize, _: &[f64]| 1.0 / 3.0));
    assert!(sums[1] < 0.9 && sums[2] < 0.9, "{sums:?}");
}

#[test]
fn with_the_balance_heuristic_the_weight_does_not_know_the_source() {
    // w = g / sum n_i p_i for all, so that with g = that sum every weight is one, and W = M / g.
    let sources = Three::random(&mut Random(2));
    let counts = [2, 1, 1];
    let sum = |x: usize| (0..3).map(|k| f64::from(counts[k]) * sources.0[k][x]).sum::<f64>();
    let target: [f64; STATES] = core::array::from_fn(sum);
    for (picked, _) in outcomes(&sources, counts, &target, &BalanceWeights) {
        let drawn = (1..=4).map(f64::from).any(|drawn| {
            picked.sample().is_none_or(|&x| (picked.contribution_weight() - drawn / target[x]).abs() < 1e-12)
        });
        assert!(drawn, "{picked:?}");
    }
}

#[test]
fn a_mixture_is_one_source() {
    let mut random = Random(3);
    for probability in [0.0, 0.3, 1.0] {
        let (first, second) = (Problem::random(&mut random), Problem::random(&mut random));
        let p: [f64; STATES] = core::array::from_fn(|x| (1.0 - probability) * first.p[x] + probability * second.p[x]);
        let mixture = Mixture::new(first.source(), second.source(), probability);
        (0..STATES).for_each(|x| assert_close(mixture.density(&x), p[x], 1e-15));
        // Which source, which state: the proposal has the mixture's density, and its frequency is that.
        let mut frequency = [0.0; STATES];
        for (lobe, source, share) in [(0.0, &second, probability), (1.0 - 1e-12, &first, 1.0 - probability)] {
            for (x, u, q) in choices(&source.p).filter(|_| share > 0.0) {
                let mut numbers = [lobe, u].into_iter();
                let proposal = mixture.propose(&mut || numbers.next().unwrap()).unwrap();
                assert_eq!(proposal.sample, x);
                assert_close(proposal.density, p[x], 1e-15);
                frequency[x] += share * q;
            }
        }
        frequency.iter().zip(p).for_each(|(a, b)| assert_close(*a, b, 1e-12));
        // One candidate of it is one-sample multiple importance sampling with the balance heuristic.
        let mut numbers = [0.0, 0.5].into_iter();
        let estimate: f64 =
            Ris::new(Budget::ONE).estimate(&mixture, &|_: &usize| 1.0, &mut || numbers.next().unwrap(), |&x| p[x]);
        assert_close(estimate, 1.0, 1e-15);
    }
}

#[test]
fn mixtures_nest_pass_failures_on_and_clamp() {
    let constant = |x: f64| from_fn(move |_: &mut dyn FnMut() -> f64| (x, 1.0), move |y: &f64| f64::from(*y == x));
    let nested = Mixture::new(Mixture::new(constant(0.0), constant(1.0), 0.5), constant(2.0), 0.2);
    assert_close(nested.density(&1.0), 0.4, 1e-15);
    assert_close(nested.density(&2.0), 0.2, 1e-15);
    for (probability, x) in [(f64::NAN, 0.0), (-1.0, 0.0), (7.0, 1.0), (1.0, 1.0)] {
        let mixture = Mixture::new(constant(0.0), constant(1.0), probability);
        assert_eq!(mixture.propose(&mut || 0.5).unwrap().sample, x, "{probability}");
    }
    struct Nothing;
    impl Source<f64, f64> for Nothing {
        fn propose(&self, _: &mut impl Uniform<f64>) -> Option<ris::Proposal<f64, f64>> {
            None
        }
        fn density(&self, _: &f64) -> f64 {
            0.0
        }
    }
    let mixture = Mixture::new(constant(0.0), Nothing, 0.5);
    assert_eq!(mixture.propose(&mut || 0.0), None);
    assert_eq!(mixture.propose(&mut || 0.9).unwrap().density, 0.5);
    // Nothing counts: with one failure the weight is halved.
    let mut reservoir = Reservoir::new();
    reservoir.update(0.0, 1.0, 2.0, 0.5);
    reservoir.skip();
    assert_eq!(reservoir.finish().contribution_weight(), 1.0);
}

/// The crate's own heuristic by the check that is offered to everybody.
struct Own;

impl<F: mis_heuristics::Float + ris::Float> Heuristic<F> for Own {
    fn weight(&self, technique: usize, densities: &(impl Densities<F> + ?Sized)) -> F {
        let all: Vec<F> = (0..densities.len()).map(|k| densities.density(k)).collect();
        BalanceWeights.weight(technique, &all)
    }
}

#[test]
fn balance_weights_obey_the_laws() {
    check_heuristic::<f32>("ris balance f32", &Own).expect_pass();
    check_heuristic::<f64>("ris balance f64", &Own).expect_pass();
}
