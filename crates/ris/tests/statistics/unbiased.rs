//! Means, of every way to resample.

use estimator_checks::{Truth, Uniforms, mean_is, randomised_mean_is};
use qmc_sampling::{OwenSobol, Sampler, SamplerFamily};
use ris::baselines::WeightedImportanceSampling;
use ris::{AliasTable, Batch, Budget, Float, PrefixSums, Reservoir, Ris, Source, Table, from_fn};

use crate::{Rising, SUITE, Score, TARGETS, TRUTH, f, falling, moments, proposal, uniform};

const BUDGETS: [[f64; 2]; 6] = [[1.0, 1.0], [1.3, 1.0], [4.0, 1.0], [2.5, 1.5], [7.9, 3.2], [16.0, 2.0]];

fn unbiased(name: &str, source: &impl Source<f64, f64>) {
    for (target_name, target) in TARGETS {
        for [candidates, samples] in BUDGETS {
            let check = SUITE.check(&format!("{name}, {target_name}, M = {candidates}, N = {samples}"));
            let mut uniforms = check.uniforms();
            let ris = Ris::new(Budget::new(candidates, samples));
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

fn batch<T: Table<f64>>(uniforms: &mut Uniforms, target: Score, candidates: usize) -> f64 {
    let drawn: Vec<_> = (0..candidates).map(|_| proposal(&Rising, uniforms)).collect();
    let batch = Batch::<_, f64, T>::new(drawn, &target);
    // The mean of two samples with strata of their number.
    batch.select_stratified(2, uniforms.next_f64()).map(|picked| 0.5 * picked.estimate(|x| f(x))).sum()
}

pub(crate) fn streamed(uniforms: &mut Uniforms, target: Score, candidates: usize) -> f64 {
    let drawn: Vec<_> = (0..candidates).map(|_| proposal(&Rising, uniforms)).collect();
    Reservoir::stream(drawn, &target, &mut || uniforms.next_f64()).estimate(f)
}

pub(crate) fn by_one_number(uniforms: &mut Uniforms, target: Score, candidates: usize) -> f64 {
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
        let ris = Ris::new(Budget::new(candidates, samples));
        let estimates = moments(&mut uniforms, 20_000, |u| {
            ris.estimate(&source, &|x: &f32| x + 0.1, &mut || u.next_f32(), |x| x * x * x + 0.2).to_f64()
        });
        mean_is(check, &estimates, Truth::relative(TRUTH, 1e-6)).expect_pass();
    }
}

#[test]
fn quasi_monte_carlo_is_unbiased_over_its_randomisations() {
    let estimate = |seed: u64| -> f64 {
        let ris = Ris::new(Budget::new(4.5, 1.0));
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
