//! The laws of the traits of `ris` that are functions of numbers: `Target`, `Select`, `Uniform`, and, in the crate's root, `Source`
//! and `Weights`. No feature is needed, and no dependency: closures stand for the traits.

mod target;

pub use target::{check_scores, check_target, check_target_on_source};

pub use crate::resampling::{check_resampling_weights, check_source};

use super::tools::{Law, hold};
use crate::correlation::serially_uncorrelated;
use crate::outcome::{Outcome, Report};
use crate::pearson::chi_square_counts;
use crate::suite::Check;

/// Numbers that are drawn.
const NUMBERS: usize = 100_000;
/// Cells of the unit interval.
const CELLS: usize = 64;

/// Checks the laws of choosing an index in proportion to weights (the trait `Select` of crate `ris`).
///
/// ```text
/// (1)  an index of weight zero is never chosen; something is, for every u in [0, 1), unless all weights are zero
/// (2)  P(i) = w_i / sum_j w_j                                                                chi-square
/// ```
///
/// `select` maps a uniform number to an index; the weights are those it was made of, finite and not negative. The report has two
/// outcomes, or one if fewer than two weights are positive. Cost: 100 000 choices.
///
/// ```
/// use estimator_checks::{Check, laws::resampling::check_selection};
///
/// let weights = [1.0, 0.0, 3.0];
/// let select = |u: f64| Some(if u < 0.25 { 0 } else { 2 });
/// check_selection(Check::new("one in four", 1e-6)?, &weights, select).expect_pass();
/// check_selection(Check::new("one in three", 1e-6)?, &weights, |u| Some(if u < 1.0 / 3.0 { 0 } else { 2 })).expect_reject();
/// # Ok::<(), estimator_checks::SuiteError>(())
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn check_selection(check: Check, weights: &[f64], mut select: impl FnMut(f64) -> Option<usize>) -> Report {
    let sum: f64 = weights.iter().sum();
    let mut uniforms = check.uniforms();
    let mut counts = vec![0; weights.len()];
    let mut laws = || {
        for i in 0..NUMBERS {
            let ends = [0.0, 1.0 - f64::from(f32::EPSILON) / 2.0, f64::MIN_POSITIVE];
            let u = ends.get(i).copied().unwrap_or_else(|| uniforms.next_f64());
            let chosen = select(u);
            let shown = || format!("{chosen:?} of {u}, weights {weights:?}");
            hold("something is chosen unless all weights are zero", chosen.is_some() == (sum > 0.0), shown)?;
            let Some(index) = chosen else { continue };
            let positive = weights.get(index).is_some_and(|&weight| weight > 0.0);
            hold("what is chosen has a positive weight", positive, shown)?;
            counts[index] += 1;
        }
        Ok(())
    };
    let mut report = Report::from(Outcome::of_laws(check.test(), laws() as Law));
    if report.passed() && weights.iter().filter(|&&weight| weight > 0.0).count() > 1 {
        let probabilities: Vec<f64> = weights.iter().map(|weight| weight / sum).collect();
        report.outcomes.push(chi_square_counts(check, &counts, &probabilities));
    }
    report
}

/// Checks the laws of a stream of uniform numbers (the trait `Uniform` of crate `ris`, or any generator).
///
/// ```text
/// (1)  numbers lie in [0, 1)
/// (2)  they are uniform                                chi-square
/// (3)  neighbours are uncorrelated                     Pearson correlation
/// ```
///
/// (1) is exact; (2) and (3) share the level of the check. Assumes numbers that are to be independent: for quasi-Monte Carlo
/// points see `laws::sampler`. Cost: 100 000 numbers.
///
/// ```
/// use estimator_checks::{Check, Uniforms, laws::resampling::check_uniform};
///
/// let mut uniforms = Uniforms::named("generator");
/// check_uniform(Check::new("generator", 1e-6)?, || uniforms.next_f64()).expect_pass();
/// check_uniform(Check::new("squares", 1e-6)?, || uniforms.next_f64().powi(2)).expect_reject();
/// # Ok::<(), estimator_checks::SuiteError>(())
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn check_uniform(check: Check, mut next: impl FnMut() -> f64) -> Report {
    let numbers: Vec<f64> = (0..NUMBERS).map(|_| next()).collect();
    let outside = numbers.iter().position(|x| !(0.0..1.0).contains(x));
    let law = match outside {
        Some(i) => hold("numbers lie in [0, 1)", false, || format!("number {i} is {}", numbers[i])),
        None => Ok(()),
    };
    let mut report = Report::from(Outcome::of_laws(check.test(), law));
    if report.passed() {
        let mut counts = [0; CELLS];
        numbers.iter().for_each(|x| counts[((x * CELLS as f64) as usize).min(CELLS - 1)] += 1);
        let [uniform, serial] = check.split(["uniform", "neighbours"]);
        report.outcomes.push(chi_square_counts(uniform, &counts, &[1.0 / CELLS as f64; CELLS]));
        report.outcomes.push(serially_uncorrelated(serial, &numbers));
    }
    report
}
