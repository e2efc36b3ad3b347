//! What sampling shows: means, variances and distributions of the real estimators, and bugs that have to be found.
//!
//! The integrand is `f(x) = x^3 + 0.2` on `[0, 1]`, of integral 0.45.

#![allow(clippy::unwrap_used)]

use estimator_checks::{
    Interval, Moments, Suite, Truth, Uniforms, check_resampling_weights, check_source, chi_square_counts,
    kolmogorov_smirnov_two_sample, mean_is, randomised_mean_is, slope_is, variance_ratio_is,
};
use mis_heuristics::{Heuristic, Power};
use qmc_sampling::{OwenSobol, Sampler, SamplerFamily};
use ris::baselines::{Tabulated1d, WeightedImportanceSampling};
use ris::{
    AliasTable, BalanceWeights, Batch, Budget, Float, Mixture, Pairwise, PrefixSums, Proposal, Resampled, Reservoir,
    Ris, Source, Sources, Table, Uniform, VarianceModel, Weights, from_fn, resample_sources,
};

static SUITE: Suite = Suite::with_share("ris", 130, 5e-8);

const TRUTH: f64 = 0.45;

fn f(x: &f64) -> f64 {
    x * x * x + 0.2
}

type Score = fn(&f64) -> f64;

/// From a perfect target to one that promises most where there is least.
const TARGETS: [(&str, Score); 4] =
    [("linear", |x| x + 0.1), ("constant", |_| 3.0), ("perfect", |x| 2.0 * f(x)), ("adverse", |x| 1.3 - x)];

fn uniform() -> impl Source<f64, f64> {
    from_fn(|u: &mut dyn FnMut() -> f64| (u(), 1.0), |_: &f64| 1.0)
}

/// Density `2 (1 - x) 0.8 + 0.2`, by its two parts.
fn falling() -> impl Source<f64, f64> {
    let linear = from_fn(
        |u: &mut dyn FnMut() -> f64| {
            let x = 1.0 - (1.0 - u()).sqrt();
            (x, 2.0 * (1.0 - x))
        },
        |x: &f64| 2.0 * (1.0 - x),
    );
    Mixture::new(uniform(), linear, 0.8)
}

/// Density `1.6 x + 0.1`, and nothing with probability 0.1.
struct Rising;

impl Source<f64, f64> for Rising {
    fn propose(&self, uniform: &mut impl Uniform<f64>) -> Option<Proposal<f64, f64>> {
        let lobe = uniform.next_uniform();
        let u = uniform.next_uniform();
        let sample = if lobe < 0.8 { u.sqrt() } else { u };
        (lobe < 0.9).then(|| Proposal { sample, density: self.density(&sample) })
    }
    fn density(&self, x: &f64) -> f64 {
        1.6 * x + 0.1
    }
}

fn moments(uniforms: &mut Uniforms, count: usize, mut estimate: impl FnMut(&mut Uniforms) -> f64) -> Moments {
    (0..count).map(|_| estimate(uniforms)).collect()
}

const BUDGETS: [[f32; 2]; 6] = [[1.0, 1.0], [1.3, 1.0], [4.0, 1.0], [2.5, 1.5], [7.9, 3.2], [16.0, 2.0]];

fn unbiased(name: &str, source: &impl Source<f64, f64>) {
    for (target_name, target) in TARGETS {
        for [candidates, samples] in BUDGETS {
            let check = SUITE.check(&format!("{name}, {target_name}, M = {candidates}, N = {samples}"));
            let mut uniforms = check.uniforms();
            let ris = Ris::new(Budget { candidates, samples });
            let estimates = moments(&mut uniforms, 20_000, |u| ris.estimate(source, &target, &mut || u.next_f64(), f));
            mean_is(check, &estimates, TRUTH).expect_pass();
        }
    }
}

#[test]
fn unbiased_for_uniform_candidates() {
    unbiased("uniform", &uniform());
}

#[test]
fn unbiased_for_a_mixture() {
    unbiased("falling", &falling());
}

#[test]
fn unbiased_for_a_source_that_fails_at_times() {
    unbiased("rising", &Rising);
}

/// A candidate of a source, with density zero where it failed.
fn proposal(source: &impl Source<f64, f64>, uniforms: &mut Uniforms) -> Proposal<f64, f64> {
    source.propose(&mut || uniforms.next_f64()).unwrap_or(Proposal { sample: 0.0, density: 0.0 })
}

fn batch<T: Table<f64>>(uniforms: &mut Uniforms, target: Score, candidates: usize) -> f64 {
    let drawn: Vec<_> = (0..candidates).map(|_| proposal(&Rising, uniforms)).collect();
    let batch = Batch::<_, f64, T>::new(drawn, &target);
    // The mean of two samples with strata of their number.
    batch.select_stratified(2, uniforms.next_f64()).map(|picked| 0.5 * picked.estimate(|x| f(x))).sum()
}

fn streamed(uniforms: &mut Uniforms, target: Score, candidates: usize) -> f64 {
    let drawn: Vec<_> = (0..candidates).map(|_| proposal(&Rising, uniforms)).collect();
    Reservoir::stream(drawn, &target, &mut || uniforms.next_f64()).estimate(f)
}

fn by_one_number(uniforms: &mut Uniforms, target: Score, candidates: usize) -> f64 {
    let drawn: Vec<_> = (0..candidates).map(|_| proposal(&Rising, uniforms)).collect();
    Reservoir::stream_with_one_number(drawn, &target, uniforms.next_f64()).estimate(f)
}

#[test]
fn batches_and_single_numbers_are_unbiased() {
    for (name, target) in TARGETS {
        for (way, estimate) in [
            ("prefix sums", batch::<PrefixSums> as fn(&mut Uniforms, Score, usize) -> f64),
            ("alias table", batch::<AliasTable>),
            ("one number", by_one_number),
        ] {
            let check = SUITE.check(&format!("{way}, {name}"));
            let mut uniforms = check.uniforms();
            let estimates = moments(&mut uniforms, 20_000, |u| estimate(u, target, 5));
            mean_is(check, &estimates, TRUTH).expect_pass();
        }
    }
}

#[test]
fn single_precision_is_unbiased() {
    for [candidates, samples] in BUDGETS {
        let check = SUITE.check(&format!("f32, M = {candidates}, N = {samples}"));
        let mut uniforms = check.uniforms();
        let source = from_fn(|u: &mut dyn FnMut() -> f32| (u(), 1.0), |_: &f32| 1.0);
        let ris = Ris::new(Budget { candidates, samples });
        let estimates = moments(&mut uniforms, 20_000, |u| {
            ris.estimate(&source, &|x: &f32| x + 0.1, &mut || u.next_f32(), |x| x * x * x + 0.2).to_f64()
        });
        mean_is(check, &estimates, Truth::relative(TRUTH, 1e-6)).expect_pass();
    }
}

#[test]
fn streams_and_batches_have_one_distribution() {
    let target = TARGETS[0].1;
    let check = SUITE.check("streamed and by prefix sums");
    let mut uniforms = check.uniforms();
    let streams: Vec<f64> = (0..40_000).map(|_| streamed(&mut uniforms, target, 4)).collect();
    let single = |uniforms: &mut Uniforms, ignore: bool| {
        let drawn: Vec<_> = (0..4).map(|_| proposal(&Rising, uniforms)).collect();
        let score = |x: &f64| if ignore { 1.0 } else { target(x) };
        let u = uniforms.next_f64();
        Batch::<_, f64, PrefixSums>::new(drawn, &score).select(u).estimate(|x| f(x))
    };
    let batches: Vec<f64> = (0..40_000).map(|_| single(&mut uniforms, false)).collect();
    kolmogorov_smirnov_two_sample(check, &streams, &batches).expect_pass();
    let check = SUITE.check("streamed and by one number");
    let numbers: Vec<f64> = (0..40_000).map(|_| by_one_number(&mut uniforms, target, 4)).collect();
    kolmogorov_smirnov_two_sample(check, &streams, &numbers).expect_pass();
    // Planted bug: selected by 1/p, without the target.
    let wrong: Vec<f64> = (0..40_000).map(|_| single(&mut uniforms, true)).collect();
    kolmogorov_smirnov_two_sample(SUITE.twin("target forgotten"), &streams, &wrong).expect_reject();
}

#[test]
fn selection_frequencies() {
    let weights = [0.5, 2.0, 0.0, 1.0, 4.5];
    let probabilities = weights.map(|w| w / 8.0);
    let count = |name: &str, reverse: bool| -> [u64; 5] {
        let mut uniforms = Uniforms::named(name);
        let mut counts = [0; 5];
        for _ in 0..100_000 {
            let mut reservoir = Reservoir::new();
            let mut sum = 0.0;
            for (k, w) in weights.into_iter().enumerate() {
                let u = uniforms.next_f64();
                // Planted bug: u is compared with the share in the sum before.
                let u = if reverse && sum > 0.0 { u * sum / (sum + w) } else { u };
                sum += w;
                reservoir.update(k, w, 1.0_f64, u);
            }
            counts[*reservoir.finish().sample().unwrap()] += 1;
        }
        counts
    };
    let check = SUITE.check("selection by a reservoir");
    let name = check.test().to_owned();
    chi_square_counts(check, &count(&name, false), &probabilities).expect_pass();
    chi_square_counts(SUITE.twin("selection by the sum before"), &count("before", true), &probabilities)
        .expect_reject();
}

/// Sample variances of batches of estimates.
fn measured(uniforms: &mut Uniforms, mut estimate: impl FnMut(&mut Uniforms) -> f64) -> Vec<f64> {
    (0..100).map(|_| moments(uniforms, 1000, &mut estimate).variance()).collect()
}

/// A model of so many candidates.
fn model(uniforms: &mut Uniforms, source: &impl Source<f64, f64>, target: Score, count: usize) -> VarianceModel<1> {
    let mut model = VarianceModel::new();
    for _ in 0..count {
        match source.propose(&mut || uniforms.next_f64()) {
            Some(Proposal { sample, density }) => model.add([f(&sample)], target(&sample), density),
            None => model.add_nothing(),
        }
    }
    model
}

#[test]
fn predicted_variance_is_measured_variance() {
    for (name, target) in TARGETS {
        for [candidates, samples] in [[1.5, 1.0], [4.0, 1.0], [2.5, 1.5], [10.0, 3.0]] {
            let check = SUITE.check(&format!("variance with {name}, M = {candidates}, N = {samples}"));
            let mut uniforms = check.uniforms();
            let budget = Budget { candidates, samples };
            let ris = Ris::new(budget);
            let measured = measured(&mut uniforms, |u| ris.estimate(&Rising, &target, &mut || u.next_f64(), f));
            // Independent models of few candidates each: their predictions are unbiased, too.
            let mut predict = |count| -> Vec<f64> {
                (0..4000).map(|_| model(&mut uniforms, &Rising, target, count).predict(budget)[0]).collect()
            };
            let predicted = predict(25);
            variance_ratio_is(check, &measured, &predicted, 1.0).expect_pass();
            if (candidates, samples) == (2.5, 1.5) {
                // Planted bug: one over the mean count for the mean of one over the count.
                let e = model(&mut uniforms, &Rising, target, 200_000).expectations().unwrap()[0];
                let wrong = vec![e.variance(1.0 / f64::from(candidates), 1.0 / f64::from(samples)); 100];
                variance_ratio_is(SUITE.twin(&format!("{name}, rounding forgotten")), &measured, &wrong, 1.0)
                    .expect_reject();
            }
        }
    }
}

#[test]
fn estimates_of_e1_are_unbiased_only_with_the_correction() {
    let check = SUITE.check("e1");
    let mut uniforms = check.uniforms();
    let (mut e1, mut naive) = (Moments::new(), Moments::new());
    for _ in 0..100_000 {
        let ratios = [(); 4].map(|()| f(&uniforms.next_f64()));
        let mut model = VarianceModel::<1>::new();
        ratios.iter().for_each(|&ratio| model.add([ratio], 1.0, 1.0));
        e1.push(model.expectations().unwrap()[0].e1);
        naive.push((ratios.iter().sum::<f64>() / 4.0).powi(2));
    }
    mean_is(check, &e1, TRUTH * TRUTH).expect_pass();
    mean_is(SUITE.twin("e1 without the correction of a U-statistic"), &naive, TRUTH * TRUTH).expect_reject();
}

#[test]
fn the_diffuse_sphere_has_variance_one_over_three_m() {
    use core::f64::consts::PI;
    let hemisphere = from_fn(|u: &mut dyn FnMut() -> f64| (u(), 0.5 / PI), |_: &f64| 0.5 / PI);
    let lambert = |cos: &f64| cos / PI;
    let measure = |uniforms: &mut Uniforms, candidates| {
        let ris = Ris::new(Budget { candidates, samples: 1.0 });
        measured(uniforms, |u| ris.estimate(&hemisphere, &lambert, &mut || u.next_f64(), lambert))
    };
    let check = SUITE.check("diffuse sphere, slope over M");
    let mut uniforms = check.uniforms();
    let points: Vec<(f64, f64)> = (0..7)
        .map(|k| {
            let candidates = 1 << k;
            let variances = measure(&mut uniforms, candidates as f32);
            (f64::from(candidates), variances.iter().sum::<f64>() / variances.len() as f64)
        })
        .collect();
    slope_is(check, &points, -1.0).expect_pass();
    // What P3's figure 5 shows: M = 20 beside M = 1.
    let check = SUITE.check("diffuse sphere, M = 20 against M = 1");
    let (twenty, one) = (measure(&mut uniforms, 20.0), measure(&mut uniforms, 1.0));
    variance_ratio_is(check, &twenty, &one, 0.05).expect_pass();
    let check = SUITE.check("diffuse sphere, M = 20");
    variance_ratio_is(check, &twenty, &[1.0 / 60.0; 100], 1.0).expect_pass();
    variance_ratio_is(SUITE.twin("diffuse sphere, 1/sqrt(M)"), &twenty, &one, 1.0 / 20_f64.sqrt()).expect_reject();
}

#[test]
fn planted_bugs_of_the_contribution_weight() {
    // A target that is zero on half of the candidates, for an integrand that is zero there.
    let half = |x: &f64| if *x < 0.5 { 0.0 } else { 1.0 };
    let integrand = |x: &f64| if *x < 0.5 { 0.0 } else { *x };
    let check = SUITE.check("half of the candidates have weight zero");
    let mut uniforms = check.uniforms();
    let (mut good, mut no_count, mut non_zero) = (Moments::new(), Moments::new(), Moments::new());
    for _ in 0..20_000 {
        let (mut reservoir, mut positive) = (Reservoir::new(), 0.0);
        for _ in 0..4 {
            let x = uniforms.next_f64();
            positive += half(&x);
            reservoir.update(x, half(&x), 1.0, uniforms.next_f64());
        }
        let picked = reservoir.finish();
        let value = picked.estimate(|x| integrand(x));
        good.push(value);
        no_count.push(4.0 * value);
        non_zero.push(if positive > 0.0 { value * 4.0 / positive } else { 0.0 });
    }
    mean_is(check, &good, 0.375).expect_pass();
    mean_is(SUITE.twin("1/M forgotten"), &no_count, 0.375).expect_reject();
    mean_is(SUITE.twin("only candidates with weight counted"), &non_zero, 0.375).expect_reject();
}

/// Two candidates for a target.
fn pixel(uniforms: &mut Uniforms, target: Score) -> Resampled<f64, f64> {
    let drawn = [(); 2].map(|()| Proposal { sample: uniforms.next_f64(), density: 1.0 });
    Reservoir::stream(drawn, &target, &mut || uniforms.next_f64())
}

#[test]
fn reuse_is_unbiased_if_it_is_done_right() {
    let here: Score = |x| x + 0.1;
    // The neighbour cannot see the upper half.
    let there: Score = |x| if *x < 0.5 { 1.0 - x } else { 0.0 };
    let everywhere: Score = |x| 1.3 - x;
    let reuse = |name: &str, combine: &dyn Fn(&mut Uniforms) -> Resampled<f64, f64>| {
        moments(&mut Uniforms::named(name), 40_000, |uniforms| combine(uniforms).estimate(f))
    };
    let pairwise = |neighbour: Score| {
        move |uniforms: &mut Uniforms| {
            let (mine, theirs) = (pixel(uniforms, here), pixel(uniforms, neighbour));
            let mut pairwise = Pairwise::new(mine, theirs.confidence);
            pairwise.add(theirs, &here, &neighbour, uniforms.next_f64());
            pairwise.finish(uniforms.next_f64())
        }
    };
    let merge = |neighbour: Score, re_evaluate: bool| {
        move |uniforms: &mut Uniforms| {
            let (mine, theirs) = (pixel(uniforms, here), pixel(uniforms, neighbour));
            let mut reservoir = Reservoir::new();
            reservoir.merge(mine, &here, uniforms.next_f64());
            reservoir.merge(theirs, if re_evaluate { &here } else { &neighbour }, uniforms.next_f64());
            reservoir.finish()
        }
    };
    let same = "merge, supports agree";
    mean_is(SUITE.check(same), &reuse(same, &merge(everywhere, true)), TRUTH).expect_pass();
    for (name, neighbour) in [("pairwise, supports differ", there), ("pairwise, supports agree", everywhere)] {
        mean_is(SUITE.check(name), &reuse(name, &pairwise(neighbour)), TRUTH).expect_pass();
    }
    let name = "merge, supports differ";
    mean_is(SUITE.twin(name), &reuse(name, &merge(there, true)), TRUTH).expect_reject();
    let name = "merge with the neighbour's score";
    mean_is(SUITE.twin(name), &reuse(name, &merge(everywhere, false)), TRUTH).expect_reject();
    // Weights that ignore supports, for a neighbour that claims them: half each.
    let name = "pairwise, target of the neighbour not told";
    let untold = |uniforms: &mut Uniforms| {
        let (mine, theirs) = (pixel(uniforms, here), pixel(uniforms, there));
        let mut pairwise = Pairwise::new(mine, theirs.confidence);
        pairwise.add(theirs, &here, &here, uniforms.next_f64());
        pairwise.finish(uniforms.next_f64())
    };
    mean_is(SUITE.twin(name), &reuse(name, &untold), TRUTH).expect_reject();
}

/// The uniform source and one of density `2x`.
struct Two;

impl Sources<f64, f64, 2> for Two {
    fn propose(&self, source: usize, uniform: &mut impl Uniform<f64>) -> Option<f64> {
        let u = uniform.next_uniform();
        Some(if source == 0 { u } else { u.sqrt() })
    }
    fn densities(&self, x: &f64) -> [f64; 2] {
        [1.0, 2.0 * x]
    }
}

#[test]
fn several_sources() {
    let power = |k: usize, densities: &[f64]| Power::TWO.weight(k, &densities);
    let run = |name: &str, weights: &dyn Fn(usize, &[f64]) -> f64| {
        moments(&mut Uniforms::named(name), 20_000, |u| {
            resample_sources(&Two, [2, 3], &weights, &TARGETS[0].1, &mut || u.next_f64()).estimate(f)
        })
    };
    let balance = |k: usize, densities: &[f64]| BalanceWeights.weight(k, densities);
    mean_is(SUITE.check("balance"), &run("balance", &balance), TRUTH).expect_pass();
    mean_is(SUITE.check("power"), &run("power", &power), TRUTH).expect_pass();
    // Planted bug: the weights know the densities of one sample each, but not the counts, and do not sum to one.
    let half = |k: usize, densities: &[f64]| densities[k] / (densities[0] + 2.0 * densities[1]);
    mean_is(SUITE.twin("weights that do not sum to one"), &run("half", &half), TRUTH).expect_reject();
    check_resampling_weights("balance weights f32", |k, d: &[f32]| BalanceWeights.weight(k, d)).expect_pass();
    check_resampling_weights("balance weights f64", |k, d: &[f64]| BalanceWeights.weight(k, d)).expect_pass();
    check_resampling_weights("half", half_of_two).expect_reject();
}

fn half_of_two(k: usize, densities: &[f64]) -> f64 {
    0.5 * BalanceWeights.weight(k, densities)
}

#[test]
fn sources_follow_their_densities() {
    let propose = |source: &dyn Fn(&mut dyn FnMut() -> f64) -> Option<Proposal<f64, f64>>, numbers: [f64; 3]| {
        let mut numbers = numbers.into_iter();
        source(&mut || numbers.next().unwrap()).map(|proposal| (proposal.sample, proposal.density))
    };
    let mixture = falling();
    check_source(
        SUITE.check("mixture as a source"),
        Interval::UNIT,
        |numbers| propose(&|mut u| mixture.propose(&mut u), numbers),
        |x| mixture.density(&x),
    )
    .expect_pass();
    check_source(
        SUITE.check("a source that fails"),
        Interval::UNIT,
        |numbers| propose(&|mut u| Rising.propose(&mut u), numbers),
        |x| Rising.density(&x),
    )
    .expect_pass();
    let table = Tabulated1d::new(|x| f(&x), [0.0, 1.0], 8).unwrap();
    check_source(
        SUITE.check("a table"),
        Interval::UNIT,
        |numbers| propose(&|mut u| table.propose(&mut u), numbers),
        |x| table.pdf(x),
    )
    .expect_pass();
    // Planted bug: the mixture claims the density of the part that was drawn.
    check_source(
        SUITE.twin("the density of the part"),
        Interval::UNIT,
        |[lobe, u, _]| {
            let x = if lobe < 0.8 { 1.0 - (1.0 - u).sqrt() } else { u };
            Some((x, if lobe < 0.8 { 2.0 * (1.0 - x) } else { 1.0 }))
        },
        |x| mixture.density(&x),
    )
    .expect_reject();
}

#[test]
fn quasi_monte_carlo_is_unbiased_over_its_randomisations() {
    let estimate = |seed: u64| -> f64 {
        let ris = Ris::new(Budget { candidates: 4.5, samples: 1.0 });
        let one = |index| {
            let mut sampler = OwenSobol::new(seed).sampler(0, index);
            ris.estimate(&uniform(), &TARGETS[0].1, &mut || f64::from(sampler.next_1d()), f)
        };
        (0..64).map(one).sum::<f64>() / 64.0
    };
    randomised_mean_is(SUITE.check("Owen-scrambled Sobol' points"), 500, TRUTH, estimate).expect_pass();
}

#[test]
fn weighted_importance_sampling_is_biased() {
    let estimates = |samples| {
        let weighted = WeightedImportanceSampling { samples, target_integral: 0.6 };
        let mut uniforms = Uniforms::named("weighted");
        moments(&mut uniforms, 40_000, |u| weighted.estimate(&uniform(), &TARGETS[0].1, &mut || u.next_f64(), f))
    };
    mean_is(SUITE.twin("weighted importance sampling"), &estimates(2.0), TRUTH).expect_reject();
}
