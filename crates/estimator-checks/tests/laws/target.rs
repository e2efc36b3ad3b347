//! Targets of resampling, and resamplers that listen to them.

use std::cell::Cell;

use estimator_checks::laws::resampling::{check_scores, check_target, check_target_on_source};
use estimator_checks::{Outcome, Report, Verdict};
use ris::{AliasTable, Batch, PrefixSums, Proposal, Reservoir, Target};

use crate::{SUITE, broken, broken_exactly, rejects};

fn integrand(x: &f64) -> f64 {
    (x - 0.25).max(0.0).sqrt()
}

fn run(score: impl Fn(&f64) -> f64) -> Outcome {
    let samples: Vec<f64> = (0..1000).map(|i| f64::from(i) / 1000.0).collect();
    check_target("target", &samples, score, integrand)
}

#[test]
fn targets_keep_their_laws() {
    run(|x| *x).expect_pass();
    run(|_| 1.0).expect_pass();
    run(integrand).expect_pass();
    // Nothing is asked where the integrand is zero.
    run(|x| if *x < 0.25 { f64::NAN } else { 1.0 }).expect_pass();
    let target = |x: &f64| 0.5 + x.sin();
    run(|x| target.score(x)).expect_pass();
    let linear = |[u, ..]: [f64; 3]| Some((u.sqrt(), 2.0 * u.sqrt()));
    check_target_on_source("linear", linear, |x| *x, integrand).expect_pass();
}

#[test]
fn targets_that_lie_are_rejected() {
    let covers = "the score is positive and finite where the integrand is not zero";
    for beyond in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(broken(run(|x| if *x < 0.99 { 1.0 } else { beyond })), covers, "{beyond}");
    }
    let calls = Cell::new(0.0);
    let counting = |x: &f64| {
        calls.set(calls.get() + 1.0);
        x + calls.get()
    };
    assert_eq!(broken(run(counting)), "the same sample has the same score");
    let uniform = |[u, ..]: [f64; 3]| Some((u, 1.0));
    let short = |x: &f64| if *x < 0.99 { 1.0 } else { 0.0 };
    assert_eq!(broken(check_target_on_source("short", uniform, short, integrand)), covers);
    // What is never proposed is not seen; and where the integrand is zero there is nothing to see.
    check_target_on_source("half", |[u, ..]| Some((0.5 * u, 2.0)), short, integrand).expect_pass();
    let nothing = check_target("nothing", &[0.1, 0.2], |x| *x, integrand);
    assert!(matches!(nothing.verdict, Verdict::Undecided(_)), "{nothing}");
}

/// Indices of candidates of density one.
fn proposals<F: From<f32>>(scores: &[f64]) -> impl Iterator<Item = Proposal<usize, F>> {
    (0..scores.len()).map(|sample| Proposal { sample, density: F::from(1.0) })
}

#[test]
fn resamplers_keep_the_laws_of_targets() {
    let reservoir = |scores: &[f64], u: &mut dyn FnMut() -> f64| {
        let target = |i: &usize| scores[*i] as f32;
        let picked = Reservoir::stream(proposals(scores), &target, &mut || u() as f32);
        picked.sample().map(|&i| (i, f64::from(picked.contribution_weight())))
    };
    check_scores(SUITE.check("reservoir"), reservoir).expect_pass();
    let batch = |scores: &[f64], u: &mut dyn FnMut() -> f64| {
        let batch = Batch::<_, f64, PrefixSums>::new(proposals(scores), &|i: &usize| scores[*i]);
        let picked = batch.select(u());
        picked.sample().map(|&&i| (i, picked.contribution_weight()))
    };
    check_scores(SUITE.check("batch"), batch).expect_pass();
    let alias = |scores: &[f64], u: &mut dyn FnMut() -> f64| {
        let batch = Batch::<_, f64, AliasTable>::new(proposals(scores), &|i: &usize| scores[*i]);
        let picked = batch.select(u());
        picked.sample().map(|&&i| (i, picked.contribution_weight()))
    };
    check_scores(SUITE.check("alias table"), alias).expect_pass();
}

/// Linear search, with room for a bug.
#[derive(Clone, Copy)]
struct Search {
    counts: fn(f64) -> f64,
    bend: f64,
    candidates: fn(&[f64]) -> usize,
    insists: bool,
}

const CORRECT: Search = Search {
    counts: |g| if g > 0.0 && g.is_finite() { g } else { 0.0 },
    bend: 1.0,
    candidates: <[f64]>::len,
    insists: false,
};

fn search(name: &str, search: Search) -> Report {
    check_scores(SUITE.twin(&format!("search: {name}")), |scores, u| {
        let sum: f64 = scores.iter().map(|&g| (search.counts)(g)).sum();
        let mut left = u().powf(search.bend) * sum;
        let index = scores.iter().position(|&g| {
            left -= (search.counts)(g);
            left < 0.0
        });
        let index = if search.insists { index.or(scores.len().checked_sub(1)) } else { index }?;
        Some((index, sum / (scores[index] * (search.candidates)(scores) as f64)))
    })
}

#[test]
fn resamplers_that_lie_are_rejected() {
    search("correct", CORRECT).expect_pass();
    let never = "a score that counts as zero is never selected";
    let something = "something is selected unless all scores count as zero";
    let takes_nan = Search { counts: |g| if g.is_nan() { 1.0 } else { (CORRECT.counts)(g) }, ..CORRECT };
    assert_eq!(broken_exactly(search("takes NaN", takes_nan)), something);
    assert_eq!(broken_exactly(search("size counts", Search { counts: f64::abs, ..CORRECT })), something);
    assert_eq!(broken_exactly(search("insists", Search { insists: true, ..CORRECT })), something);
    assert_eq!(broken_exactly(search("gives up", Search { counts: |_| 0.0, ..CORRECT })), something);
    let infinite = Search { counts: |g| if g > 0.0 { g.min(100.0) } else { 0.0 }, ..CORRECT };
    assert_eq!(broken_exactly(search("takes infinity", infinite)), something);
    // One that fails only beside others.
    let last = |scores: &[f64], u: &mut dyn FnMut() -> f64| {
        let sum: f64 = scores.iter().map(|&g| (CORRECT.counts)(g)).sum();
        let weight = sum / (scores.last()? * scores.len() as f64);
        (sum > 0.0 && u() < 1.0).then(|| (scores.len() - 1, weight))
    };
    assert_eq!(broken_exactly(check_scores(SUITE.twin("search: the last"), last)), never);
    let among = "candidates that count as zero are among the M, not in the sum";
    let few = Search { candidates: |scores| scores.iter().filter(|&&g| (CORRECT.counts)(g) > 0.0).count(), ..CORRECT };
    assert_eq!(broken_exactly(search("M without zeros", few)), among);
    rejects(search("bent", Search { bend: 1.05, ..CORRECT }), "bent");
}
