//! The best M and N for a time.

use crate::variance::Expectations;
use crate::{Budget, CostModel, VarianceModel};

/// What to minimise: the variance has a value per component, and the choice has to be one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Objective<const C: usize> {
    /// Talbot, Cline and Egbert's equation 3, `M = sqrt(|e3 - e2| T_Y / (|e2 - e1| T_X))` with Euclidean norms: the sum of the two norms over `M` and 1.
    ///
    /// By the triangle inequality this minimises an **upper bound** of the norm of the variance, not that norm; and norms hide
    /// signs, so a negative `e3 - e2` asks for more candidates where they hurt. Here a sum of `e3 - e2` that is negative gives
    /// `M = 1` instead.
    NormOfParts,
    /// The sum of the components with these factors: ones give the trace, the weights of luminance that of luminance. Equation 3 is then
    /// exact, and signs count.
    Weighted([f64; C]),
    /// The Euclidean norm of the variance itself, minimised numerically over `M` up to `e^20`.
    NormOfVariance,
}

impl<const C: usize> VarianceModel<C> {
    /// The real `M >= 1` of least variance times cost, ignoring how long there is.
    ///
    /// Infinite if nothing remains but what candidates reduce (`e2 <= e1`: a perfect target); one if more candidates hurt, and
    /// without enough candidates to tell.
    ///
    /// ```text
    /// minimise  (b + a/M) (M T_X + T_Y)   =>   M = sqrt(a T_Y / (b T_X)),     a = e3 - e2,  b = e2 - e1
    /// ```
    pub fn optimal_candidates(&self, cost: CostModel, objective: Objective<C>) -> f64 {
        let Some(all) = self.expectations() else { return 1.0 };
        let ratio = match objective {
            Objective::NormOfParts => norm_of_parts(&all),
            Objective::Weighted(factors) => {
                let sum = |part: fn(&Expectations) -> f64| -> f64 {
                    all.iter().zip(factors).map(|(component, factor)| factor * part(component)).sum()
                };
                part_ratio(sum(Expectations::reducible), sum(Expectations::remaining))
            }
            Objective::NormOfVariance => return norm_of_variance(&all, cost),
        };
        let optimal = libm::sqrt(ratio * cost.sample() / cost.candidate());
        // Free samples with a perfect target: 0 times infinity. Candidates cannot help.
        if optimal > 1.0 { optimal } else { 1.0 }
    }

    /// The budget of least predicted variance that takes `time` in all, in the unit of `cost`.
    ///
    /// As Talbot, Cline and Egbert 2005, section 4.2: `M` by equation 3 clamped to at least 1; `N = T / (M T_X + T_Y)` clamped to at least 1; `M` again from
    /// what is left. Less time than `T_X + T_Y` would make that `M` smaller than one: it is clamped again, and one sample of one
    /// candidate takes longer than `time`.
    pub fn optimal(&self, cost: CostModel, time: f64, objective: Objective<C>) -> Budget {
        let candidates = self.optimal_candidates(cost, objective);
        Budget::within(candidates, cost, time)
    }
}

impl Budget {
    /// `N` for given `candidates` and a time, both clamped to at least one, and `M` solved again; see [`VarianceModel::optimal`].
    ///
    /// ```
    /// use ris::{Budget, CostModel};
    /// let cost = CostModel::new(1.0, 10.0)?;
    /// assert_eq!(Budget::within(10.0, cost, 100.0), Budget::new(10.0, 5.0));
    /// // Time for less than one sample of so many candidates: fewer candidates.
    /// assert_eq!(Budget::within(1e9, cost, 100.0), Budget::new(90.0, 1.0));
    /// // Time for nothing: one of each.
    /// assert_eq!(Budget::within(10.0, cost, 0.5), Budget::ONE);
    /// # Ok::<(), ris::CostError>(())
    /// ```
    pub fn within(candidates: f64, cost: CostModel, time: f64) -> Self {
        let at_least_one = |x: f64| if x > 1.0 { x } else { 1.0 };
        let m = at_least_one(candidates);
        let n = at_least_one(time / (m * cost.candidate() + cost.sample()));
        let m = if n > 1.0 { m } else { at_least_one((time / n - cost.sample()) / cost.candidate()).min(m) };
        Self::new(m, n)
    }
}

/// `a / b` with the signs that matter: nothing to gain gives zero, nothing to remain infinity.
fn part_ratio(reducible: f64, remaining: f64) -> f64 {
    match (reducible > 0.0, remaining > 0.0) {
        (true, true) => reducible / remaining,
        (true, false) => f64::INFINITY,
        (false, _) => 0.0,
    }
}

fn norm<const C: usize>(all: &[Expectations; C], part: impl Fn(&Expectations) -> f64) -> f64 {
    libm::sqrt(all.iter().map(|component| part(component) * part(component)).sum())
}

fn norm_of_parts<const C: usize>(all: &[Expectations; C]) -> f64 {
    if all.iter().map(Expectations::reducible).sum::<f64>() < 0.0 {
        return 0.0;
    }
    part_ratio(norm(all, Expectations::reducible), norm(all, Expectations::remaining))
}

/// Golden section search for `log M` of the least `|V(M)| (M T_X + T_Y)`: with signs mixed it need not have one minimum
/// only, so the best of a coarse scan is refined.
fn norm_of_variance<const C: usize>(all: &[Expectations; C], cost: CostModel) -> f64 {
    const LARGEST: f64 = 20.0;
    const STEPS: u32 = 80;
    let objective = |log_m: f64| {
        let m = libm::exp(log_m);
        // What remains is a variance; where an estimate of it is negative it is noise.
        let variance = |component: &Expectations| component.reducible() / m + component.remaining().max(0.0);
        norm(all, variance) * (m * cost.candidate() + cost.sample())
    };
    let step = LARGEST / f64::from(STEPS);
    let best = (0..=STEPS)
        .fold(0, |best, k| if objective(f64::from(k) * step) < objective(f64::from(best) * step) { k } else { best });
    if best == STEPS {
        return f64::INFINITY;
    }
    let (mut low, mut high) = ((f64::from(best) - 1.0).max(0.0) * step, (f64::from(best) + 1.0) * step);
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    for _ in 0..60 {
        let (a, b) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
        if objective(a) < objective(b) { high = b } else { low = a }
    }
    let log_m = 0.5 * (low + high);
    // The end of the interval is the minimum if one candidate is.
    if objective(0.0) <= objective(log_m) { 1.0 } else { libm::exp(log_m) }
}
