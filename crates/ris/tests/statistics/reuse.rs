//! Contribution weights, reuse and several sources, with the bugs that are made there.

use estimator_checks::{Moments, Uniforms, check_resampling_weights, mean_is};
use mis_heuristics::{Heuristic, Power};
use ris::{BalanceWeights, Pairwise, Proposal, Resampled, Reservoir, Sources, Uniform, Weights, resample_sources};

use crate::{SUITE, Score, TARGETS, TRUTH, f, moments};

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
    let merge = |neighbour: Score, score: Score| {
        move |uniforms: &mut Uniforms| {
            let (mine, theirs) = (pixel(uniforms, here), pixel(uniforms, neighbour));
            let mut reservoir = Reservoir::new();
            reservoir.merge(mine, &here, uniforms.next_f64());
            reservoir.merge(theirs, &score, uniforms.next_f64());
            let (sum, candidates) = (reservoir.weight_sum(), reservoir.candidates());
            let mut picked = reservoir.finish();
            // W by the receiver's target, whatever score the weights were made with.
            if let Some(y) = &mut picked.selected {
                y.contribution_weight = sum / candidates / here(&y.sample);
            }
            picked
        }
    };
    let same = "merge, supports agree";
    mean_is(SUITE.check(same), &reuse(same, &merge(everywhere, here)), TRUTH).expect_pass();
    for (name, neighbour) in [("pairwise, supports differ", there), ("pairwise, supports agree", everywhere)] {
        mean_is(SUITE.check(name), &reuse(name, &pairwise(neighbour)), TRUTH).expect_pass();
    }
    let name = "merge, supports differ";
    mean_is(SUITE.twin(name), &reuse(name, &merge(there, here)), TRUTH).expect_reject();
    let name = "merge with the neighbour's score";
    mean_is(SUITE.twin(name), &reuse(name, &merge(everywhere, everywhere)), TRUTH).expect_reject();
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
