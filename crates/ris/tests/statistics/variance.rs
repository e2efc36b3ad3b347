//! Predicted and measured variances.

use estimator_checks::{Moments, Uniforms, mean_is, slope_is, variance_ratio_is};
use ris::{Budget, Proposal, Ris, Source, VarianceModel, from_fn};

use crate::{Rising, SUITE, Score, TARGETS, TRUTH, f, moments};

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
            let budget = Budget::new(candidates, samples);
            let ris = Ris::new(budget);
            let measured = measured(&mut uniforms, |u| ris.estimate(&Rising, &target, &mut || u.next_f64(), f));
            // Independent models of few candidates each: their predictions are unbiased, too.
            let mut predict = |count| -> Vec<f64> {
                (0..4000).map(|_| model(&mut uniforms, &Rising, target, count).predict(budget)[0]).collect()
            };
            let predicted = predict(25);
            variance_ratio_is(check, &measured, &predicted, 1.0).expect_pass();
        }
    }
}

#[test]
fn rounded_counts_have_their_own_variance() {
    let (target, budget) = (TARGETS[0].1, Budget::new(1.5, 1.5));
    let check = SUITE.check("variance of rounded counts");
    let mut uniforms = check.uniforms();
    let ris = Ris::new(budget);
    let measured: Vec<f64> = (0..1000)
        .map(|_| moments(&mut uniforms, 500, |u| ris.estimate(&Rising, &target, &mut || u.next_f64(), f)).variance())
        .collect();
    let mut models: Vec<_> = (0..1000).map(|_| model(&mut uniforms, &Rising, target, 500)).collect();
    let predicted: Vec<f64> = models.iter().map(|model| model.predict(budget)[0]).collect();
    variance_ratio_is(check, &measured, &predicted, 1.0).expect_pass();
    // Planted bug: one over the mean count for the mean of one over the count.
    let wrong: Vec<f64> =
        models.drain(..).map(|model| model.expectations().unwrap()[0].variance(1.0 / 1.5, 1.0 / 1.5)).collect();
    variance_ratio_is(SUITE.twin("rounding forgotten"), &measured, &wrong, 1.0).expect_reject();
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
        let ris = Ris::new(Budget::new(candidates, 1.0));
        measured(uniforms, |u| ris.estimate(&hemisphere, &lambert, &mut || u.next_f64(), lambert))
    };
    let check = SUITE.check("diffuse sphere, slope over M");
    let mut uniforms = check.uniforms();
    let points: Vec<(f64, f64)> = (0..7)
        .map(|k| {
            let candidates = 1 << k;
            let variances = measure(&mut uniforms, candidates as f64);
            (f64::from(candidates), variances.iter().sum::<f64>() / variances.len() as f64)
        })
        .collect();
    slope_is(check, &points, -1.0).expect_pass();
    // What Talbot, Cline and Egbert's figure 5 shows: M = 20 beside M = 1.
    let check = SUITE.check("diffuse sphere, M = 20 against M = 1");
    let (twenty, one) = (measure(&mut uniforms, 20.0), measure(&mut uniforms, 1.0));
    variance_ratio_is(check, &twenty, &one, 0.05).expect_pass();
    let check = SUITE.check("diffuse sphere, M = 20");
    variance_ratio_is(check, &twenty, &[1.0 / 60.0; 100], 1.0).expect_pass();
    variance_ratio_is(SUITE.twin("diffuse sphere, 1/sqrt(M)"), &twenty, &one, 1.0 / 20_f64.sqrt()).expect_reject();
}
