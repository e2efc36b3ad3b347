//! The laws of what resampling is built of: sources, and weights over several of them.

use mis_heuristics::{Densities, Float, Heuristic};

use crate::domain::{Domain, IntoPoint};
use crate::heuristic::HeuristicLaws;
use crate::outcome::{Outcome, Report};
use crate::sampling::{Sampled, SamplingCheck};
use crate::suite::Check;

/// Checks that a source of candidates for resampling (the trait `Source` of crate `ris`, or any sampler) follows its density.
///
/// ```text
/// (1)  the density that comes with a candidate is positive, finite and density(x)
/// (2)  candidates are distributed like density                                       chi-square
/// (3)  P(a candidate) = integral of density(x) dx                                    t-test against quadrature
/// ```
///
/// `propose` maps three uniform numbers to a candidate and its density, or to nothing, with what probability is left: a
/// candidate that could not be drawn counts as one of weight zero. A sampler that needs more numbers may draw them from
/// elsewhere.
///
/// Level, outcomes and cost are those of [`SamplingCheck`], with the density itself as the function that is estimated.
///
/// ```
/// use estimator_checks::{Check, Interval, check_source};
///
/// // Density 2 x on [0, 1], of which a fifth is not drawn.
/// let propose = |[u, v, _]: [f64; 3]| (v < 0.8).then(|| (u.sqrt(), 1.6 * u.sqrt()));
/// check_source(Check::new("linear", 1e-6)?, Interval::UNIT, propose, |x| 1.6 * x).expect_pass();
/// // The twin: the density does not know of the fifth.
/// let propose = |[u, v, _]: [f64; 3]| (v < 0.8).then(|| (u.sqrt(), 2.0 * u.sqrt()));
/// check_source(Check::new("normalised", 1e-6)?, Interval::UNIT, propose, |x| 2.0 * x).expect_reject();
/// # Ok::<(), estimator_checks::SuiteError>(())
/// ```
pub fn check_source<D: Domain + Clone, S: IntoPoint<D::Point>>(
    check: Check,
    domain: D,
    mut propose: impl FnMut([f64; 3]) -> Option<(S, f64)>,
    density: impl Fn(D::Point) -> f64,
) -> Report {
    let sample = |numbers| propose(numbers).map(|(point, pdf)| Sampled { point, weight: 1.0, pdf });
    SamplingCheck::on(domain).run(check, sample, &density, &density)
}

/// Checks the laws of weights over several sources (the trait `Weights` of crate `ris`): with them any resampling is unbiased.
///
/// ```text
/// (1)  sum_i w_i = 1        wherever any density is positive
/// (2)  w_i = 0              if density i is zero
/// (3)  w_i is finite        for any finite densities
/// ```
///
/// `weights(i, densities)` is the weight of source `i`, given the densities `n_k p_k` of all. No chance is involved; see
/// [`HeuristicLaws`] for the densities that are tried.
///
/// ```
/// use estimator_checks::check_resampling_weights;
///
/// let largest = |i: usize, densities: &[f64]| {
///     let best = (0..densities.len()).fold(0, |best, k| if densities[k] > densities[best] { k } else { best });
///     if i == best && densities[i] > 0.0 { 1.0 } else { 0.0 }
/// };
/// check_resampling_weights("largest", largest).expect_pass();
/// // A neighbour that cannot have drawn the sample gets its share all the same.
/// check_resampling_weights("equal", |_, densities: &[f64]| 1.0 / densities.len() as f64).expect_reject();
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn check_resampling_weights<F: Float>(test: &str, weights: impl Fn(usize, &[F]) -> F) -> Outcome {
    HeuristicLaws::new().run(test, &OfSlices(weights))
}

/// Weights of slices as a heuristic.
struct OfSlices<W>(W);

impl<F: Float, W: Fn(usize, &[F]) -> F> Heuristic<F> for OfSlices<W> {
    fn weight(&self, technique: usize, densities: &(impl Densities<F> + ?Sized)) -> F {
        let all: Vec<F> = (0..densities.len()).map(|i| densities.density(i)).collect();
        (self.0)(technique, &all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::Interval;

    fn check(name: &str) -> Check {
        Check::new(name, 1e-8).unwrap()
    }

    #[test]
    fn planted_bugs_of_sources() {
        let good = |[u, ..]: [f64; 3]| Some((u.sqrt(), 2.0 * u.sqrt()));
        check_source(check("good"), Interval::UNIT, good, |x| 2.0 * x).expect_pass();
        // Uniform, but claims to be linear.
        let shape = |[u, ..]: [f64; 3]| Some((u, 2.0 * u));
        check_source(check("shape"), Interval::UNIT, shape, |x| 2.0 * x).expect_reject();
        // What comes with the candidate is the inverse density.
        let inverse = |[u, ..]: [f64; 3]| Some((u.sqrt(), 0.5 / u.sqrt()));
        check_source(check("inverse"), Interval::UNIT, inverse, |x| 2.0 * x).expect_reject();
        let nan = |[u, ..]: [f64; 3]| Some((u, f64::NAN));
        check_source(check("nan"), Interval::UNIT, nan, |_| 1.0).expect_reject();
    }

    #[test]
    fn planted_bugs_of_weights() {
        let balance = |i: usize, d: &[f64]| {
            let largest = d.iter().copied().fold(0.0, f64::max);
            if d[i] > 0.0 { d[i] / largest / d.iter().map(|d| d / largest).sum::<f64>() } else { 0.0 }
        };
        check_resampling_weights("balance", balance).expect_pass();
        check_resampling_weights("99 %", |i, d: &[f64]| 0.99 * balance(i, d)).expect_reject();
        check_resampling_weights("nan", |i, d: &[f64]| d[i] / d.iter().sum::<f64>()).expect_reject();
    }
}
