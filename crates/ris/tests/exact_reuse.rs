//! Reuse, exactly: every input's every outcome, every decision of the combination.
//!
//! An estimator is unbiased for any integrand exactly if the contributions `E[W; Y = x]` are one in every state.

#![allow(clippy::unwrap_used)]

mod support;

use proptest::prelude::*;
use ris::{Combination, Pairwise, Resampled, Reservoir, Selected, balance};
use support::{Problem, Random, STATES, Step, assert_close, contributions, walk};

type Outcome = (Resampled<usize, f64>, f64);

/// A receiver that sees all states, and neighbours with supports of their own: every target but the receiver's has a zero.
struct Pixels {
    problems: Vec<Problem>,
    candidates: Vec<usize>,
}

impl Pixels {
    fn random(random: &mut Random, neighbours: usize, same_supports: bool) -> Self {
        let mut problems: Vec<_> = (0..=neighbours).map(|_| Problem::random(random)).collect();
        for (k, neighbour) in problems.iter_mut().enumerate().skip(1) {
            if !same_supports {
                neighbour.g[k % STATES] = 0.0;
            }
        }
        let candidates = (0..=neighbours).map(|_| 1 + (2.0 * random.next()) as usize).collect();
        Self { problems, candidates }
    }

    /// All combinations of what the pixels select, with their probabilities.
    fn for_each(&self, visit: &mut impl FnMut(&[Resampled<usize, f64>], f64)) {
        fn go(
            outcomes: &[Vec<Outcome>],
            chosen: &mut Vec<Resampled<usize, f64>>,
            probability: f64,
            visit: &mut impl FnMut(&[Resampled<usize, f64>], f64),
        ) {
            let Some((first, rest)) = outcomes.split_first() else { return visit(chosen, probability) };
            for (resampled, p) in first {
                chosen.push(*resampled);
                go(rest, chosen, probability * p, visit);
                chosen.pop();
            }
        }
        let outcomes: Vec<_> = self.problems.iter().zip(&self.candidates).map(|(p, &m)| p.resampled(m)).collect();
        go(&outcomes, &mut Vec::new(), 1.0, visit);
    }

    fn confidence(&self, k: usize) -> f64 {
        self.candidates[k] as f64
    }

    /// The pairwise weight of input `k` in a state, written down from the equations.
    fn pairwise_weight(&self, k: usize, x: usize) -> f64 {
        let (c_own, g_own) = (self.confidence(0), self.problems[0].g[x]);
        let others: f64 = (1..self.problems.len()).map(|i| self.confidence(i)).sum();
        let all = c_own + others;
        let part = |i: usize| {
            let (theirs, own) = (others * self.problems[i].g[x], c_own * g_own);
            theirs / (theirs + own)
        };
        let share = |i: usize| self.confidence(i) / all;
        match k {
            0 => c_own / all + (1..self.problems.len()).map(|i| share(i) * (1.0 - part(i))).sum::<f64>(),
            k => share(k) * part(k),
        }
    }

    fn balance_weight(&self, k: usize, x: usize) -> f64 {
        let confidences: Vec<f64> = self.candidates.iter().map(|&m| m as f64).collect();
        let scores: Vec<f64> = self.problems.iter().map(|problem| problem.g[x]).collect();
        balance(k, &confidences, &scores)
    }

    /// The weights with which the inputs compete, in the order in which they are added: the receiver last.
    fn competition(&self, inputs: &[Resampled<usize, f64>], weight: impl Fn(usize, usize) -> f64) -> Vec<Step> {
        let order = (1..inputs.len()).chain([0]);
        order
            .map(|k| {
                let own = |y: &Selected<usize, f64>| {
                    weight(k, y.sample) * self.problems[0].g[y.sample] * y.contribution_weight
                };
                Step::Select(inputs[k].selected.as_ref().map_or(0.0, own))
            })
            .collect()
    }

    /// The outcomes of a combination whose inputs compete with these weights.
    fn combined(
        &self,
        weight: impl Fn(usize, usize) -> f64,
        combine: impl Fn(&[Resampled<usize, f64>], &[f64]) -> Resampled<usize, f64>,
    ) -> Vec<Outcome> {
        let mut outcomes = Vec::new();
        self.for_each(&mut |inputs, p| {
            let steps = self.competition(inputs, &weight);
            walk(&steps, &mut |numbers, q| outcomes.push((combine(inputs, numbers), p * q)));
        });
        outcomes
    }

    fn pairwise(&self) -> Vec<Outcome> {
        let others: f64 = (1..self.problems.len()).map(|k| self.confidence(k)).sum();
        let combine = |inputs: &[Resampled<usize, f64>], numbers: &[f64]| {
            let mut pairwise = Pairwise::new(inputs[0], others);
            for (k, &u) in (1..inputs.len()).zip(numbers) {
                pairwise.add(inputs[k], &self.problems[0].target(), &self.problems[k].target(), u);
            }
            pairwise.finish(*numbers.last().unwrap())
        };
        self.combined(|k, x| self.pairwise_weight(k, x), combine)
    }

    /// A combination with given weights.
    fn weighted(&self, weight: impl Fn(usize, usize) -> f64 + Copy) -> Vec<Outcome> {
        let combine = |inputs: &[Resampled<usize, f64>], numbers: &[f64]| {
            let mut combination = Combination::new();
            for (k, &u) in (1..inputs.len()).chain([0]).zip(numbers) {
                let at = |of: &dyn Fn(usize) -> f64| inputs[k].sample().map_or(0.0, |&x| of(x));
                combination.add(inputs[k], at(&|x| self.problems[0].g[x]), at(&|x| weight(k, x)), u);
            }
            combination.finish()
        };
        self.combined(weight, combine)
    }

    /// [`Reservoir::merge`] of all into an empty reservoir.
    fn merged(&self) -> Vec<Outcome> {
        let combine = |inputs: &[Resampled<usize, f64>], numbers: &[f64]| {
            let mut reservoir = Reservoir::new();
            for (k, &u) in (1..inputs.len()).chain([0]).zip(numbers) {
                reservoir.merge(inputs[k], &self.problems[0].target(), u);
            }
            reservoir.finish()
        };
        self.combined(|k, _| self.confidence(k), combine)
    }
}

#[track_caller]
fn assert_unbiased(outcomes: &[Outcome]) {
    let sums = contributions(outcomes);
    assert!(sums.iter().all(|sum| (sum - 1.0).abs() < 1e-9), "{sums:?}");
}

/// Variance of the estimates of an integrand.
fn variance(outcomes: &[Outcome], f: &[f64; STATES]) -> f64 {
    let moment = |power: i32| -> f64 { outcomes.iter().map(|(y, p)| p * y.estimate(|&x| f[x]).powi(power)).sum() };
    moment(2) - moment(1).powi(2)
}

#[test]
fn pairwise_and_balance_are_unbiased_with_any_supports() {
    let mut random = Random(1);
    for neighbours in [0, 1, 2] {
        for same_supports in [false, true] {
            for _ in 0..4 {
                let pixels = Pixels::random(&mut random, neighbours, same_supports);
                assert_unbiased(&pixels.pairwise());
                assert_unbiased(&pixels.weighted(|k, x| pixels.balance_weight(k, x)));
                let confidence: usize = pixels.candidates.iter().sum();
                assert!(pixels.pairwise().iter().all(|(y, _)| y.confidence == confidence as f64));
            }
        }
    }
}

#[test]
fn merging_is_unbiased_if_supports_agree_and_biased_if_not() {
    let mut random = Random(2);
    for _ in 0..5 {
        assert_unbiased(&Pixels::random(&mut random, 2, true).merged());
        // Negative control: state 1 is what the neighbour cannot see, and gets too little. The others are right.
        let pixels = Pixels::random(&mut random, 1, false);
        let sums = contributions(&pixels.merged());
        let expected = pixels.confidence(0) / (pixels.confidence(0) + pixels.confidence(1));
        assert_close(sums[1], expected, 1e-9);
        assert_close(sums[0], 1.0, 1e-9);
        assert_close(sums[2], 1.0, 1e-9);
    }
}

#[test]
fn a_neighbour_that_claims_what_its_source_cannot_draw_biases_pairwise_weights() {
    // Negative control of the condition in the documentation: the target is positive where the density is zero.
    let mut pixels = Pixels::random(&mut Random(3), 1, true);
    pixels.problems[1].p = [0.5, 0.0, 0.5];
    let sums = contributions(&pixels.pairwise());
    assert!(sums[1] < 0.95 && (sums[0] - 1.0).abs() < 1e-9, "{sums:?}");
    // With the target told it is unbiased again.
    pixels.problems[1].g[1] = 0.0;
    assert_unbiased(&pixels.pairwise());
}

#[test]
fn reuse_of_similar_neighbours_lowers_the_variance() {
    let mut random = Random(4);
    let (mut pairwise_best, mut balance_best, mut unlike_hurt) = (0, 0, 0);
    for _ in 0..30 {
        let mut pixels = Pixels::random(&mut random, 2, true);
        let own = pixels.problems[0];
        let compare = |pixels: &Pixels| {
            let variance = |outcomes: &[Outcome]| variance(outcomes, &own.g);
            let balanced = pixels.weighted(|k, x| pixels.balance_weight(k, x));
            [variance(&own.resampled(pixels.candidates[0])), variance(&pixels.pairwise()), variance(&balanced)]
        };
        let [alone, pairwise, _] = compare(&pixels);
        unlike_hurt += usize::from(pairwise > alone);
        for neighbour in &mut pixels.problems[1..] {
            neighbour.p = own.p;
            neighbour.g = own.g.map(|g| g * (0.7 + 0.6 * random.next()));
        }
        let [alone, pairwise, balanced] = compare(&pixels);
        assert!(pairwise < alone && balanced < alone, "{pairwise} {balanced} {alone}");
        pairwise_best += usize::from(pairwise < balanced);
        balance_best += usize::from(balanced < pairwise);
    }
    // Neither kind of weights is always the better one, and unlike neighbours may do harm: so say the documents.
    assert!(pairwise_best > 0 && balance_best > 0 && unlike_hurt > 0, "{pairwise_best} {balance_best} {unlike_hurt}");
}

/// What a neighbour of this confidence offers: state `x` with contribution weight `w`.
fn given(sample: usize, contribution_weight: f64, confidence: f64) -> Resampled<usize, f64> {
    Resampled { selected: Some(Selected { sample, score: 1.0, contribution_weight }), confidence }
}

/// Two halves make one candidate's confidence, and are two candidates all the same: both weights have to count.
#[test]
fn confidences_that_add_up_to_one_are_not_one_candidate() {
    let target = |x: &usize| [1.0, 3.0][*x];
    let mut reservoir = Reservoir::new();
    reservoir.merge(given(0, 2.0, 0.5), &target, 0.5);
    reservoir.merge(given(1, 2.0, 0.5), &target, 0.9);
    let picked = reservoir.finish();
    assert_eq!(picked.sample(), Some(&0));
    // (1/2 * 1 * 2 + 1/2 * 3 * 2) / g(Y)
    assert_eq!(picked.contribution_weight(), 4.0);
}

#[test]
fn a_dropped_sample_keeps_its_confidence_and_its_target_is_zero_where_it_was_dropped() {
    // State 2 is hidden from the neighbour: its sample is dropped there, and its target has to know.
    let mut random = Random(6);
    let mut pixels = Pixels::random(&mut random, 1, true);
    let mut hidden = pixels.problems[1];
    hidden.g[2] = 0.0;
    let others = pixels.confidence(1);
    let combined = |told: Problem, pixels: &Pixels| {
        let mut outcomes = Vec::new();
        pixels.for_each(&mut |inputs, p| {
            let neighbour = inputs[1].kept_if(|&x| x != 2);
            assert_eq!(neighbour.confidence, others);
            let told = Pixels { problems: vec![pixels.problems[0], told], candidates: pixels.candidates.clone() };
            let steps = told.competition(&[inputs[0], neighbour], |k, x| told.pairwise_weight(k, x));
            walk(&steps, &mut |numbers, q| {
                let mut pairwise = Pairwise::new(inputs[0], others);
                pairwise.add(neighbour, &pixels.problems[0].target(), &told.problems[1].target(), numbers[0]);
                outcomes.push((pairwise.finish(numbers[1]), p * q));
            });
        });
        outcomes
    };
    assert_unbiased(&combined(hidden, &pixels));
    // Negative control: the neighbour weighed by the target without its visibility.
    let sums = contributions(&combined(pixels.problems[1], &pixels));
    assert!(sums[2] < 0.95, "{sums:?}");
    pixels.candidates = vec![2, 1];
    assert_eq!(pixels.confidence(0), 2.0);
}

proptest! {
    /// A probe of the implementation's weights: every input in turn has selected `x` with `W = 1`, the others nothing; the
    /// contribution weight of the outcome is then the input's weight. With any normalisation of the neighbours' targets.
    #[test]
    fn pairwise_weights_sum_to_one(
        g_own in 1e-3..1e3_f64,
        neighbours in prop::collection::vec((prop_oneof![1 => Just(0.0), 4 => 1e-3..1e3_f64], 0.5..100.0_f64, 1e-3..1e3_f64), 1..6),
        c_own in 0.5..100.0_f64,
    ) {
        let all: f64 = neighbours.iter().map(|(_, c, _)| c).sum();
        let (target, nothing) = (|_: &usize| g_own, Resampled { selected: None, confidence: 0.0 });
        let sample = |score, confidence| Resampled {
            selected: Some(Selected { sample: 0_usize, score, contribution_weight: 1.0 }),
            confidence,
        };
        let mut sum = 0.0;
        for k in 0..=neighbours.len() {
            if k > 0 && neighbours[k - 1].0 == 0.0 {
                continue; // cannot have selected it
            }
            let own = if k == 0 { sample(g_own, c_own) } else { Resampled { confidence: c_own, ..nothing } };
            let mut pairwise = Pairwise::new(own, all);
            for (i, &(g, confidence, ratio)) in neighbours.iter().enumerate() {
                let input = if k == i + 1 { sample(g, confidence) } else { Resampled { confidence, ..nothing } };
                pairwise.add_normalised(input, &target, &|_: &usize| g, ratio, 0.5);
            }
            sum += pairwise.finish(0.5).contribution_weight();
        }
        prop_assert!((sum - 1.0).abs() < 1e-12, "{}", sum);
    }

    #[test]
    fn balance_weights_sum_to_one(inputs in prop::collection::vec((0.0..1e3_f32, 0.0..1e38_f32), 1..8)) {
        let (confidences, scores): (Vec<f32>, Vec<f32>) = inputs.into_iter().unzip();
        let sum: f32 = (0..scores.len()).map(|k| balance(k, &confidences, &scores)).sum();
        let any = confidences.iter().zip(&scores).any(|(&c, &g)| c > 0.0 && g > 0.0);
        // Products that vanish beside the largest one count as nothing.
        prop_assert!((sum - 1.0).abs() < 1e-5 || (!any && sum == 0.0), "{}", sum);
    }
}
