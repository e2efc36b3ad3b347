//! The laws of `Target`, and of those who listen to one.

use crate::laws::{Law, hold};
use crate::outcome::{Outcome, Report};
use crate::pearson::chi_square_counts;
use crate::seed::{Uniforms, seed};
use crate::suite::Check;
use crate::verdict::{Undecided, Verdict};

/// Candidates that a source proposes.
const CANDIDATES: usize = 10_000;
/// Selections from the same candidates.
const SELECTIONS: usize = 100_000;
/// Round-off of a contribution weight that was computed in `f32`.
const ROUND_OFF: f64 = 1e-5;

/// Checks the laws of a target (the trait `Target` of crate `ris`) on samples of the caller's.
///
/// ```text
/// (1)  the same sample has the same score, bit for bit
/// (2)  f(x) != 0  =>  g(x) > 0 and finite
/// ```
///
/// `score` is the target `g`, `integrand` is `f`, of which all that counts is where it is not zero: give its largest component, or its
/// luminance, visibility left out or not. Scores that are zero, negative, infinite or NaN count as zero, so they all break
/// (2) where `f` is not zero: that part of the integral is never selected, and missing in the estimate.
///
/// (1) asks for each score twice, the second time after all the others. A proof where it rejects, and as good as the samples
/// where it passes; undecided if `f` is zero for all of them. Not finite values of `f` count as not zero. Cost: two scores per sample.
///
/// ```
/// use estimator_checks::laws::resampling::check_target;
///
/// let samples: Vec<f64> = (0..100).map(|i| f64::from(i) / 100.0).collect();
/// let integrand = |x: &f64| (x - 0.5).max(0.0);
/// check_target("cheaper", &samples, |x| *x, integrand).expect_pass();
/// // The twin: a target that ends before the integrand does.
/// check_target("too short", &samples, |x| if *x < 0.9 { *x } else { 0.0 }, integrand).expect_reject();
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn check_target<X>(test: &str, samples: &[X], score: impl Fn(&X) -> f64, integrand: impl Fn(&X) -> f64) -> Outcome {
    let mut covered = 0;
    let outcome = Outcome::of_laws(test, laws(samples, score, integrand, &mut covered));
    if outcome.passed() && covered == 0 {
        let reason = Undecided::TooFew { what: "samples with an integrand that is not zero", count: 0, needed: 1 };
        return Outcome::exact(test, seed(test), "laws", 0.0, Verdict::Undecided(reason));
    }
    outcome.with_detail(format!("the integrand is not zero for {covered} of {} samples", samples.len()))
}

/// [`check_target`] on 10 000 candidates that a source proposes, from three uniform numbers each, as in
/// [`check_source`](super::check_source): asked where it will be used. What the source never proposes is not seen.
///
/// ```
/// use estimator_checks::laws::resampling::check_target_on_source;
///
/// let propose = |[u, ..]: [f64; 3]| Some((u.sqrt(), 2.0 * u.sqrt()));
/// check_target_on_source("linear", propose, |x| *x, |x| x * x).expect_pass();
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn check_target_on_source<X>(
    test: &str,
    mut propose: impl FnMut([f64; 3]) -> Option<(X, f64)>,
    score: impl Fn(&X) -> f64,
    integrand: impl Fn(&X) -> f64,
) -> Outcome {
    let mut uniforms = Uniforms::named(test);
    let samples: Vec<X> = (0..CANDIDATES).filter_map(|_| propose(uniforms.array())).map(|(x, _)| x).collect();
    check_target(test, &samples, score, integrand)
}

fn laws<X>(samples: &[X], score: impl Fn(&X) -> f64, integrand: impl Fn(&X) -> f64, covered: &mut usize) -> Law {
    let scores: Vec<f64> = samples.iter().map(&score).collect();
    for (i, (x, &first)) in samples.iter().zip(&scores).enumerate() {
        let again = score(x);
        let same = first.to_bits() == again.to_bits() || (first.is_nan() && again.is_nan());
        hold("the same sample has the same score", same, || format!("{first}, then {again} for sample {i}"))?;
        let value = integrand(x);
        if value != 0.0 {
            *covered += 1;
            let shown = || format!("the score of sample {i} is {first}, the integrand {value}");
            hold("the score is positive and finite where the integrand is not zero", counts(first), shown)?;
        }
    }
    Ok(())
}

/// Whether a candidate of this score can be selected.
fn counts(score: f64) -> bool {
    score > 0.0 && score.is_finite()
}

/// Checks that a resampler treats scores as the laws of `Target` promise: those that are zero, negative, infinite or NaN count as zero.
///
/// ```text
/// (1)  a candidate whose score counts as zero is never selected; something is, unless all scores count as zero
/// (2)  W = 1/g_Y 1/M sum_j g_j           M counts all candidates, the sum those that count
/// (3)  P(Y = j) = g_j / sum_k g_k                                                              chi-square
/// ```
///
/// `resample` resamples candidates of these scores, each of density 1, with the uniform numbers that it is given, and returns the index
/// `Y` of the selected one with its contribution weight `W`. The scores have at most 12 bits: exact as `f32`.
///
/// (1) and (2) are exact, for candidates of all kinds; the report has two outcomes. Assumes that selections are independent. Cost: 100 000 of
/// them, of ten candidates.
///
/// ```
/// use estimator_checks::{Check, laws::resampling::check_scores};
///
/// let counts = |g: f64| if g > 0.0 && g.is_finite() { g } else { 0.0 };
/// let select = |scores: &[f64], u: &mut dyn FnMut() -> f64| {
///     let sum: f64 = scores.iter().map(|&g| counts(g)).sum();
///     let mut left = u() * sum;
///     let index = scores.iter().position(|&g| {
///         left -= counts(g);
///         left < 0.0
///     })?;
///     Some((index, sum / (scores[index] * scores.len() as f64)))
/// };
/// check_scores(Check::new("linear search", 1e-6)?, select).expect_pass();
/// # Ok::<(), estimator_checks::SuiteError>(())
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn check_scores(
    check: Check,
    mut resample: impl FnMut(&[f64], &mut dyn FnMut() -> f64) -> Option<(usize, f64)>,
) -> Report {
    const NAN: f64 = f64::NAN;
    const INF: f64 = f64::INFINITY;
    const ALL_KINDS: [f64; 10] = [0.0, 1.0, NAN, 3.5, -2.0, 0.25, INF, -INF, 8.0, -0.0];
    let mut uniforms = check.uniforms();
    let mut counted = [0; ALL_KINDS.len()];
    let mut laws = || {
        let one: [&[f64]; 6] = [&[], &[0.0], &[NAN], &[INF], &[-1.0], &[2.5]];
        let several: [&[f64]; 5] =
            [&[NAN, -1.0, 0.0, -INF], &[INF, 2.0], &[2.0, INF], &[NAN, 0.5, NAN], &[-3.0, 1.0, -0.5, 1.0]];
        for scores in one.into_iter().chain(several) {
            for _ in 0..100 {
                selection(scores, resample(scores, &mut || uniforms.next_f64()))?;
            }
        }
        for _ in 0..SELECTIONS {
            let selected = resample(&ALL_KINDS, &mut || uniforms.next_f64());
            if let Some(index) = selection(&ALL_KINDS, selected)? {
                counted[index] += 1;
            }
        }
        Ok(())
    };
    let mut report = Report::from(Outcome::of_laws(check.test(), laws() as Law));
    if report.passed() {
        let usable = ALL_KINDS.map(|score| if counts(score) { score } else { 0.0 });
        let sum: f64 = usable.iter().sum();
        report.outcomes.push(chi_square_counts(check, &counted, &usable.map(|score| score / sum)));
    }
    report
}

/// (1) and (2): which one was selected.
fn selection(scores: &[f64], selected: Option<(usize, f64)>) -> Result<Option<usize>, crate::Violation> {
    let sum: f64 = scores.iter().copied().filter(|&score| counts(score)).sum();
    let shown = || format!("{selected:?} of scores {scores:?}");
    hold("something is selected unless all scores count as zero", selected.is_some() == (sum > 0.0), shown)?;
    let Some((index, weight)) = selected else { return Ok(None) };
    let usable = scores.get(index).is_some_and(|&score| counts(score));
    hold("a score that counts as zero is never selected", usable, shown)?;
    let expected = sum / (scores[index] * scores.len() as f64);
    let shown = || format!("W = {weight} instead of {expected} for {index} of {scores:?}");
    let is_near = (weight - expected).abs() <= ROUND_OFF * expected;
    hold("candidates that count as zero are among the M, not in the sum", is_near, shown)?;
    Ok(Some(index))
}
