//! The progressive estimator is unbiased; statistical, with its planted bugs.

use estimator_checks::{Check, FALSE_POSITIVE_RATE, Moments, Outcome, Suite, Uniforms, mean_is};
use mis_heuristics::{OptimalMoments, ProgressiveOptimal};

static SUITE: Suite = Suite::with_share("mis-heuristics", 1, 0.01 * FALSE_POSITIVE_RATE);

const INTEGRAND: [f64; 6] = [0.0, 1.0, 4.0, 0.0, 0.5, 2.0];
const PDF: [[f64; 6]; 2] = [[0.3, 0.1, 0.1, 0.2, 0.2, 0.1], [0.05, 0.15, 0.4, 0.3, 0.05, 0.05]];
const COUNTS: [u32; 2] = [3, 2];
const ITERATIONS: usize = 6;
const RUNS: usize = 20_000;

fn densities(x: usize) -> [f64; 2] {
    core::array::from_fn(|i| f64::from(COUNTS[i]) * PDF[i][x])
}

/// The states that one iteration samples.
fn iteration(uniforms: &mut Uniforms) -> impl Iterator<Item = usize> {
    [0, 0, 0, 1, 1].into_iter().map(|technique: usize| {
        let mut u = uniforms.next_f64();
        PDF[technique]
            .iter()
            .position(|p| {
                u -= p;
                u < 0.0
            })
            .unwrap_or(5)
    })
}

fn judge(check: Check, run: impl Fn(&mut Uniforms) -> f64) -> Outcome {
    let mut uniforms = check.uniforms();
    let moments: Moments = (0..RUNS).map(|_| run(&mut uniforms)).collect();
    mean_is(check, &moments, INTEGRAND.iter().sum::<f64>())
}

fn progressive(uniforms: &mut Uniforms, is_added: impl Fn(usize) -> bool) -> f64 {
    let mut estimate = ProgressiveOptimal::new(COUNTS, 2).expect("two techniques with samples");
    for _ in 0..ITERATIONS {
        for x in iteration(uniforms).filter(|&x| is_added(x)) {
            estimate.add(INTEGRAND[x], &densities(x)).expect("a possible sample");
        }
        estimate.end_iteration();
    }
    estimate.estimates().mean().expect("an iteration")
}

#[test]
fn progressive_estimate_is_unbiased() {
    judge(SUITE.check("progressive"), |uniforms| progressive(uniforms, |_| true)).expect_pass();
}

#[test]
fn planted_bug_samples_without_value_are_left_out() {
    judge(SUITE.twin("progressive"), |uniforms| progressive(uniforms, |x| INTEGRAND[x] > 0.0)).expect_reject();
}

#[test]
fn planted_bug_weights_learnt_from_the_samples_they_weight() {
    judge(SUITE.twin("progressive"), |uniforms| {
        let samples: Vec<usize> = iteration(uniforms).collect();
        let mut moments = OptimalMoments::new(COUNTS).expect("two techniques with samples");
        for &x in &samples {
            moments.add(INTEGRAND[x], &densities(x)).expect("a possible sample");
        }
        let weights = moments.solve();
        let contribution = |&x: &usize| weights.contribution(INTEGRAND[x], &densities(x)).expect("a possible sample");
        weights.constant() + samples.iter().map(contribution).sum::<f64>()
    })
    .expect_reject();
}
