//! The distribution of the selected sample: every sequence of candidates, every interval of the number that selects.

#![allow(clippy::unwrap_used)]

mod support;

use proptest::prelude::*;
use qmc_sampling::{OwenSobol, Sampler, SamplerFamily};
use ris::baselines::ImportanceSampling;
use ris::{AliasTable, Batch, Budget, OneNumber, PrefixSums, Reservoir, Ris, Select, Table, from_fn};
use support::{Problem, Random, STATES, Step, assert_close, contributions, walk};

/// `P(Y = y)` from the integral form: the sum over all tuples of candidates of `P(tuple) * w_y / sum w`.
fn integral_form(problem: &Problem, candidates: u32) -> [f64; STATES] {
    let mut probabilities = [0.0; STATES];
    for index in 0..STATES.pow(candidates) {
        let drawn: Vec<usize> = (0..candidates).map(|k| index / STATES.pow(k) % STATES).collect();
        let weight = |x: usize| problem.g[x] / problem.p[x];
        let tuple: f64 = drawn.iter().map(|&x| problem.p[x]).product();
        let sum: f64 = drawn.iter().map(|&x| weight(x)).sum();
        drawn.iter().for_each(|&x| probabilities[x] += tuple * weight(x) / sum);
    }
    probabilities
}

#[test]
fn the_reservoir_follows_the_integral_form_and_is_unbiased() {
    let mut random = Random(1);
    for candidates in 1..=4 {
        for _ in 0..5 {
            let problem = Problem::random(&mut random);
            let outcomes = problem.resampled(candidates);
            let expected = integral_form(&problem, candidates as u32);
            for (x, expected) in expected.into_iter().enumerate() {
                let probability: f64 = outcomes.iter().filter(|(y, _)| y.sample() == Some(&x)).map(|(_, p)| p).sum();
                assert_close(probability, expected, 1e-12);
            }
            contributions(&outcomes).into_iter().for_each(|sum| assert_close(sum, 1.0, 1e-12));
        }
    }
}

#[test]
fn the_distribution_goes_from_the_source_to_the_target() {
    let problem = Problem::random(&mut Random(5));
    let sum: f64 = problem.g.iter().sum();
    let distance = |candidates, to: [f64; STATES]| -> f64 {
        integral_form(&problem, candidates).iter().zip(to).map(|(a, b)| (a - b).abs()).sum()
    };
    let target = problem.g.map(|g| g / sum);
    assert_close(distance(1, problem.p), 0.0, 1e-15);
    let distances = [1, 2, 4, 8].map(|m| distance(m, target));
    assert!(distances.windows(2).all(|pair| pair[1] < 0.75 * pair[0]), "{distances:?}");
}

#[test]
fn two_candidates_on_an_interval() {
    // p = 1, g = x on [0, 1]: density 2 y ln(1 + 1/y), distribution y^2 ln(1 + 1/y) + y - ln(1 + y).
    let cdf = |y: f64| y * y * (1.0 + 1.0 / y).ln() + y - y.ln_1p();
    const CELLS: usize = 400;
    let middle = |i: usize| (i as f64 + 0.5) / CELLS as f64;
    let mut histogram = [0.0; 4];
    for (i, j) in (0..CELLS).flat_map(|i| (0..CELLS).map(move |j| (i, j))) {
        let candidates = [middle(i), middle(j)];
        walk(&candidates.map(Step::Select), &mut |numbers, probability| {
            let mut reservoir = Reservoir::new();
            for (x, &u) in candidates.into_iter().zip(numbers) {
                reservoir.update(x, x, 1.0, u);
            }
            let picked = reservoir.finish();
            histogram[(4.0 * picked.sample().unwrap()) as usize] += probability / (CELLS * CELLS) as f64;
        });
    }
    let mut below = 0.0;
    for (k, share) in histogram.into_iter().enumerate() {
        below += share;
        assert_close(below, cdf((k as f64 + 1.0) / 4.0), 1e-5);
    }
}

/// The measure of the numbers that select each index, of a selection that takes at most two values on each of `pieces` equal
/// intervals: by bisection, to the last bit.
fn measures(len: usize, pieces: usize, select: impl Fn(f64) -> Option<usize>) -> Vec<f64> {
    let mut measures = vec![0.0; len];
    for piece in 0..pieces {
        let (low, high) = (piece as f64 / pieces as f64, (piece as f64 + 1.0) / pieces as f64);
        let (first, last) = (select(low).unwrap(), select(high - 1e-15).unwrap());
        let (mut a, mut b) = (low, high);
        while first != last && b - a > 1e-16 && (a + b) / 2.0 > a && (a + b) / 2.0 < b {
            let middle = (a + b) / 2.0;
            let chosen = select(middle).unwrap();
            assert!(chosen == first || chosen == last, "three values on a piece");
            if chosen == first { a = middle } else { b = middle }
        }
        measures[first] += if first == last { high - low } else { b - low };
        measures[last] += if first == last { 0.0 } else { high - b };
    }
    measures
}

#[test]
fn tables_select_in_proportion_to_weights() {
    let mut random = Random(2);
    for len in 1..12 {
        let weights: Vec<f64> =
            (0..len).map(|k| if random.next() < 0.3 && k > 0 { 0.0 } else { random.next() + 1e-3 }).collect();
        let sum: f64 = weights.iter().sum();
        let table = AliasTable::new(weights.iter().copied());
        let alias = measures(len, len, |u| table.select(u));
        // Monotonic, so that every edge of an interval is found where the next index begins.
        let sums = PrefixSums::new(weights.iter().copied());
        let first = |index: usize| {
            let (mut a, mut b) = (0.0, 1.0);
            for _ in 0..60 {
                let middle = 0.5 * (a + b);
                if sums.select(middle).unwrap() < index { a = middle } else { b = middle }
            }
            if sums.select(0.0_f64).unwrap() >= index { 0.0 } else { b }
        };
        for (k, weight) in weights.iter().enumerate() {
            assert_close(alias[k], weight / sum, 1e-12);
            assert_close(first(k + 1) - first(k), weight / sum, 1e-12);
        }
    }
}

/// Visits the interval of the number that belongs to each sequence of decisions: its lower end, its length, the last weight
/// that was accepted.
fn intervals(weights: &[f64], visit: &mut impl FnMut(f64, f64, usize)) {
    fn go(
        weights: &[f64],
        k: usize,
        sum: f64,
        [low, length]: [f64; 2],
        kept: usize,
        visit: &mut impl FnMut(f64, f64, usize),
    ) {
        if k == weights.len() {
            return visit(low, length, kept);
        }
        let sum = sum + weights[k];
        let share = if sum > 0.0 { weights[k] / sum } else { 0.0 };
        for (low, length, kept) in [(low, share * length, k), (low + share * length, (1.0 - share) * length, kept)] {
            if length > 0.0 {
                go(weights, k + 1, sum, [low, length], kept, visit);
            }
        }
    }
    go(weights, 0, 0.0, [0.0, 1.0], 0, visit);
}

#[test]
fn one_number_selects_in_proportion_to_weights() {
    let mut random = Random(3);
    for len in 1..=8 {
        let weights: Vec<f64> = (0..len).map(|k| if k == 1 { 0.0 } else { 0.1 + random.next() }).collect();
        let mut measure = vec![0.0; len];
        intervals(&weights, &mut |low, length, kept| {
            measure[kept] += length;
            // Both ends and the middle of the interval select what it says.
            for place in [1e-6, 0.5, 1.0 - 1e-6] {
                let mut reservoir = Reservoir::new();
                let mut number = OneNumber::new(low + place * length);
                for (k, &weight) in weights.iter().enumerate() {
                    reservoir.update_by(k, weight, 1.0, &mut number);
                }
                assert_eq!(reservoir.finish().sample(), Some(&kept));
                assert!((number.rest() - place).abs() < 1e-6, "{} is left of {place}", number.rest());
            }
        });
        let sum: f64 = weights.iter().sum();
        measure.iter().zip(&weights).for_each(|(m, w)| assert_close(*m, w / sum, 1e-12));
    }
}

/// The distribution of a batch's selection from these weights, times what it contributes.
fn batch<T: Table<f64>>(weights: &[f64], pieces: usize) -> Vec<(f64, f64)> {
    let candidates = (0..weights.len()).map(|sample| ris::Proposal { sample, density: 0.5 });
    let batch = Batch::<_, f64, T>::new(candidates, &|k: &usize| 0.5 * weights[*k]);
    let select = |u: f64| batch.select(u).sample().map(|k| **k);
    let measures = measures(weights.len(), pieces, select);
    let contribution_of = |k: usize| {
        (0..10_000).map(|i| batch.select((f64::from(i) + 0.5) / 1e4)).find(|y| y.sample() == Some(&&k)).unwrap()
    };
    measures.into_iter().enumerate().map(|(k, m)| (m, contribution_of(k).contribution_weight())).collect()
}

#[test]
fn streaming_and_batch_are_the_same_estimator() {
    let weights = [0.3, 1.1, 0.6, 2.0];
    // Pieces on which the prefix sums take two values at most.
    for outcomes in [batch::<PrefixSums>(&weights, 40), batch::<AliasTable>(&weights, 4)] {
        let mut streamed = [[0.0; 2]; 4];
        walk(&weights.map(Step::Select), &mut |numbers, probability| {
            let mut reservoir = Reservoir::new();
            for ((k, weight), &u) in weights.iter().enumerate().zip(numbers) {
                reservoir.update(k, 0.5 * weight, 2.0, u);
            }
            let picked = reservoir.finish();
            let k = *picked.sample().unwrap();
            streamed[k][0] += probability;
            streamed[k][1] = picked.contribution_weight();
        });
        for ((measure, weight), [probability, contribution]) in outcomes.into_iter().zip(streamed) {
            assert_close(measure, probability, 1e-12);
            assert_close(weight, contribution, 1e-12);
        }
    }
}

#[test]
fn absorbing_equals_one_stream() {
    let weights = [0.3, 1.1, 0.0, 2.0, 0.7];
    for split in 0..=weights.len() {
        let mut probabilities = [0.0; 5];
        let (left, right) = weights.split_at(split);
        let sums: [f64; 2] = [left, right].map(|part| part.iter().sum());
        let mut steps: Vec<_> = left.iter().copied().map(Step::Select).collect();
        steps.push(Step::NewSample);
        steps.extend(right.iter().copied().map(Step::Select));
        // The sums compete like weights.
        let share = if sums[1] > 0.0 { sums[1] / (sums[0] + sums[1]) } else { 0.0 };
        steps.push(Step::Number(vec![(share * (1.0 - 1e-12), share), (share + 1e-12 * (1.0 - share), 1.0 - share)]));
        walk(&steps, &mut |numbers, probability| {
            if probability == 0.0 {
                return;
            }
            let mut reservoirs = [Reservoir::new(), Reservoir::new()];
            for (k, (&weight, &u)) in weights.iter().zip(numbers).enumerate() {
                reservoirs[usize::from(k >= split)].update(k, weight, 1.0, u);
            }
            let [mut all, other] = reservoirs;
            all.absorb(other, numbers[weights.len()]);
            assert_eq!(all.candidates(), 5.0);
            let picked = all.finish();
            probabilities[*picked.sample().unwrap()] += probability;
            assert_close(picked.contribution_weight(), 4.1 / 5.0 / weights[*picked.sample().unwrap()], 1e-12);
        });
        for (probability, weight) in probabilities.into_iter().zip(weights) {
            assert_close(probability, weight / 4.1, 1e-12);
        }
    }
}

#[test]
fn stratified_selections_are_unbiased() {
    let weights = [0.3, 1.1, 0.6, 2.0];
    let candidates = (0..4).map(|sample| ris::Proposal { sample, density: 1.0 });
    let batch = Batch::<usize, f64, PrefixSums>::new(candidates, &|k: &usize| weights[*k]);
    // The midpoint rule over the number is exact up to its step times the number of jumps.
    const STEPS: u32 = 100_000;
    for count in [1, 2, 3, 7] {
        let mut shares = [0.0; 4];
        for k in 0..STEPS {
            let u = (f64::from(k) + 0.5) / f64::from(STEPS);
            let picked: Vec<usize> = batch.select_stratified(count, u).map(|y| **y.sample().unwrap()).collect();
            assert!(picked.is_sorted(), "the order of the candidates is kept");
            picked.iter().for_each(|&k| shares[k] += 1.0 / (f64::from(STEPS) * count as f64));
        }
        shares.iter().zip(weights).for_each(|(share, weight)| assert_close(*share, weight / 4.0, 1e-4));
    }
    assert_eq!(batch.select_stratified(0, 0.5).count(), 0);
}

#[test]
fn a_quasi_monte_carlo_sampler_is_all_it_takes() {
    let source = from_fn(|u: &mut dyn FnMut() -> f32| (u(), 1.0), |_: &f32| 1.0);
    let estimate = |seed, index| -> f32 {
        let mut sampler = OwenSobol::new(seed).sampler(0, index);
        let ris = Ris::new(Budget::new(4.5, 1.0));
        ris.estimate(&source, &|x: &f32| *x, &mut || sampler.next_1d(), |x| x * x)
    };
    let mean = |seed| (0..4096).map(|index| f64::from(estimate(seed, index))).sum::<f64>() / 4096.0;
    assert_eq!(mean(7).to_bits(), mean(7).to_bits());
    assert_ne!(mean(7), mean(8));
}

/// One candidate in every way there is.
macro_rules! one_candidate {
    ($name:ident, $float:ty) => {
        proptest! {
            #[test]
            fn $name(x in -10.0..10.0 as $float, density in 1e-6..1e6 as $float, g in 1e-6..1e6 as $float, u in 0.0..1.0 as $float) {
                let source = from_fn(|_: &mut dyn FnMut() -> $float| (x, density), |_: &$float| density);
                let f = |x: &$float| x.sin();
                let budget = Budget::ONE;
                let expected: $float = ImportanceSampling { samples: 1.0 }.estimate(&source, &mut || u, f);
                let resampled: $float = Ris::new(budget).estimate(&source, &|_: &$float| g, &mut || u, f);
                prop_assert_eq!(resampled.to_bits(), expected.to_bits());
                prop_assert_eq!(expected.to_bits(), (f(&x) * (1.0 / density)).to_bits());
                let proposal = || [ris::Proposal { sample: x, density }];
                let target = |_: &$float| g;
                for picked in [
                    Reservoir::stream(proposal(), &target, &mut || u),
                    Reservoir::stream_with_one_number(proposal(), &target, u),
                ] {
                    prop_assert_eq!(picked.contribution_weight().to_bits(), (1.0 / density).to_bits());
                    // Reused alone, for any target.
                    let mut receiver = Reservoir::new();
                    receiver.merge(picked, &|_: &$float| 0.37, u);
                    prop_assert_eq!(receiver.finish().contribution_weight().to_bits(), (1.0 / density).to_bits());
                }
                let batch = Batch::<_, $float, AliasTable>::new(proposal(), &target);
                prop_assert_eq!(batch.select(u).contribution_weight().to_bits(), (1.0 / density).to_bits());
            }
        }
    };
}

one_candidate!(one_candidate_is_importance_sampling_bit_for_bit_in_f32, f32);
one_candidate!(one_candidate_is_importance_sampling_bit_for_bit_in_f64, f64);
