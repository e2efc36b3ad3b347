//! The outcome of a check, and how a test insists on it.

use std::fmt;

use crate::suite::Check;
use crate::verdict::{Undecided, Verdict, Violation};

/// What a check found; printed in full when an expectation fails.
///
/// ```
/// use estimator_checks::{Check, Moments, mean_is};
///
/// let biased: Moments = [0.9, 1.0, 1.1].into_iter().cycle().take(3000).collect();
/// let outcome = mean_is(Check::new("unbiased", 1e-6)?, &biased, 1.1).expect_reject();
/// let text = outcome.to_string();
/// assert!(text.contains("statistic") && text.contains("p-value") && text.contains("threshold") && text.contains("seed"));
/// # Ok::<(), estimator_checks::SuiteError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Outcome {
    /// The name of the check.
    pub test: String,
    /// The test that was performed, with its degrees of freedom.
    pub method: String,
    /// The test statistic: chi-square, t, z, the distance of two distribution functions, an integral, a worst error.
    pub statistic: f64,
    /// The probability of a statistic at least as extreme if the claim is true; 0 or 1 for an exact check.
    pub p_value: f64,
    /// The significance level; zero for an exact check.
    pub alpha: f64,
    /// The seed.
    pub seed: u64,
    /// How the check ended.
    pub verdict: Verdict,
    /// More about the worst case, possibly empty.
    pub detail: String,
}

impl Outcome {
    /// The outcome of a statistical test.
    pub(crate) fn decide(check: Check, method: impl Into<String>, statistic: f64, p_value: f64) -> Self {
        let verdict = if p_value.is_nan() || statistic.is_nan() {
            Verdict::Violation(Violation::NotFinite { what: "test statistic", at: "the given data".into() })
        } else if p_value < check.alpha() {
            Verdict::Reject
        } else {
            Verdict::Pass
        };
        Self::new(check, method, statistic, p_value, verdict)
    }

    /// A claim that is refuted with certainty.
    pub(crate) fn violation(check: Check, method: impl Into<String>, violation: Violation) -> Self {
        Self::new(check, method, f64::NAN, 0.0, Verdict::Violation(violation))
    }

    /// A check that could not decide.
    pub(crate) fn undecided(check: Check, method: impl Into<String>, reason: Undecided) -> Self {
        Self::new(check, method, f64::NAN, f64::NAN, Verdict::Undecided(reason))
    }

    /// The outcome of a check that involves no chance.
    pub(crate) fn exact(test: &str, seed: u64, method: &str, statistic: f64, verdict: Verdict) -> Self {
        let p_value = if verdict == Verdict::Pass { 1.0 } else { 0.0 };
        Self {
            test: test.into(),
            method: method.into(),
            statistic,
            p_value,
            alpha: 0.0,
            seed,
            verdict,
            detail: String::new(),
        }
    }

    fn new(check: Check, method: impl Into<String>, statistic: f64, p_value: f64, verdict: Verdict) -> Self {
        Self {
            test: check.test().into(),
            method: method.into(),
            statistic,
            p_value,
            alpha: check.alpha(),
            seed: check.seed(),
            verdict,
            detail: String::new(),
        }
    }

    pub(crate) fn with_detail(mut self, detail: String) -> Self {
        self.detail = detail;
        self
    }

    /// Whether the data are consistent with the claim.
    pub fn passed(&self) -> bool {
        self.verdict == Verdict::Pass
    }

    /// Whether the claim is refuted, by statistics or with certainty.
    pub fn rejected(&self) -> bool {
        matches!(self.verdict, Verdict::Reject | Verdict::Violation(_))
    }

    /// Insists that the claim holds.
    ///
    /// # Panics
    /// With statistic, p-value, threshold and seed, if the claim was refuted or the check could not decide.
    #[track_caller]
    #[expect(clippy::return_self_not_must_use, reason = "it panics unless it holds: most callers want no more")]
    pub fn expect_pass(self) -> Self {
        assert!(self.passed(), "{self}");
        self
    }

    /// Insists that the claim is refuted: for the planted-bug twin of a test.
    ///
    /// # Panics
    /// If the claim was not refuted, or the check could not decide.
    #[track_caller]
    #[expect(clippy::return_self_not_must_use, reason = "it panics unless it holds: most callers want no more")]
    pub fn expect_reject(self) -> Self {
        assert!(self.rejected(), "the planted bug was not found: {self}");
        self
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.test)?;
        match &self.verdict {
            Verdict::Pass => write!(f, "passed")?,
            Verdict::Reject => write!(f, "REJECTED")?,
            Verdict::Violation(violation) => write!(f, "VIOLATED: {violation}")?,
            Verdict::Undecided(reason) => write!(f, "UNDECIDED: {reason}")?,
        }
        write!(f, " ({}: statistic {:.6e}, p-value {:.3e}", self.method, self.statistic, self.p_value)?;
        write!(f, ", threshold {:.3e}, seed {:#018x})", self.alpha, self.seed)?;
        if !self.detail.is_empty() {
            write!(f, "; {}", self.detail)?;
        }
        Ok(())
    }
}

/// The outcomes of a check that has several parts; they share the level of the check.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Report {
    /// The parts.
    pub outcomes: Vec<Outcome>,
}

impl Report {
    /// Whether every part passed. A report without parts has not.
    pub fn passed(&self) -> bool {
        !self.outcomes.is_empty() && self.outcomes.iter().all(Outcome::passed)
    }

    /// Whether any part refutes its claim.
    pub fn rejected(&self) -> bool {
        self.outcomes.iter().any(Outcome::rejected)
    }

    /// Insists that every part passed.
    ///
    /// # Panics
    /// With all outcomes, if one did not.
    #[track_caller]
    #[expect(clippy::return_self_not_must_use, reason = "it panics unless it holds: most callers want no more")]
    pub fn expect_pass(self) -> Self {
        assert!(self.passed(), "{self}");
        self
    }

    /// Insists that some part refutes its claim: for the planted-bug twin of a test.
    ///
    /// # Panics
    /// If none does.
    #[track_caller]
    #[expect(clippy::return_self_not_must_use, reason = "it panics unless it holds: most callers want no more")]
    pub fn expect_reject(self) -> Self {
        assert!(self.rejected(), "the planted bug was not found: {self}");
        self
    }
}

impl From<Outcome> for Report {
    fn from(outcome: Outcome) -> Self {
        Self { outcomes: vec![outcome] }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, outcome) in self.outcomes.iter().enumerate() {
            write!(f, "{}{outcome}", if i == 0 { "" } else { "\n" })?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check() -> Check {
        Check::new("outcome", 1e-3).unwrap()
    }

    #[test]
    fn the_text_names_everything_needed_to_repeat_the_failure() {
        let text = Outcome::decide(check(), "t, 9 dof", 12.5, 1e-9).to_string();
        for part in ["outcome", "REJECTED", "t, 9 dof", "1.25", "1.000e-9", "1.000e-3", "seed 0x"] {
            assert!(text.contains(part), "{text}");
        }
    }

    #[test]
    #[should_panic(expected = "REJECTED")]
    fn expect_pass_panics_on_rejection() {
        Outcome::decide(check(), "z", 9.0, 0.0).expect_pass();
    }

    #[test]
    #[should_panic(expected = "planted bug was not found")]
    fn expect_reject_panics_on_a_pass() {
        Outcome::decide(check(), "z", 0.0, 1.0).expect_reject();
    }

    #[test]
    fn undecided_satisfies_nobody() {
        let outcome = Outcome::undecided(check(), "t", Undecided::TooFew { what: "samples", count: 1, needed: 2 });
        assert!(!outcome.passed() && !outcome.rejected());
        assert!(!Report { outcomes: Vec::new() }.passed());
    }

    #[test]
    fn a_nan_statistic_is_a_violation() {
        assert!(Outcome::decide(check(), "t", f64::NAN, f64::NAN).rejected());
    }
}
