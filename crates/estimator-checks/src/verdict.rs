//! How a check can end.

use std::fmt;

/// How a check ended.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Verdict {
    /// The data are consistent with the claim at the level of the check.
    Pass,
    /// The p-value is below the level.
    Reject,
    /// The claim is false with certainty; no statistics are needed.
    Violation(Violation),
    /// The check could not decide; neither `expect_pass` nor `expect_reject` accept this.
    Undecided(Undecided),
}

/// A fact that refutes a claim with certainty. A broken law is [`Law`](Self::Law), made of the `Violation` of the crates' own checkers
/// (`range_search::check`), which know no more than laws.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Violation {
    /// A value is NaN or infinite.
    NotFinite {
        /// What it is a value of.
        what: &'static str,
        /// Where it occurred.
        at: String,
    },
    /// A density is negative.
    NegativeDensity {
        /// Its value.
        density: f64,
        /// Where it occurred.
        at: String,
    },
    /// A sample is not a point of the domain: a direction that is not of unit length or points below the hemisphere.
    OutsideDomain {
        /// The sample.
        sample: String,
    },
    /// Samples fall where the density is zero.
    ZeroDensity {
        /// How many.
        samples: u64,
        /// The first of them.
        example: String,
    },
    /// A density integrates to something else than it must.
    NotNormalised {
        /// The integral.
        integral: f64,
        /// The estimated error of the quadrature.
        error: f64,
        /// What it must be, in words.
        expected: &'static str,
    },
    /// Two values that must be equal differ.
    Unequal {
        /// What was compared.
        what: &'static str,
        /// The first value of the worst case.
        left: f64,
        /// The second value of the worst case.
        right: f64,
        /// Where the worst case occurred.
        at: String,
        /// How many cases differ.
        cases: u64,
    },
    /// A law does not hold.
    Law {
        /// The law.
        law: &'static str,
        /// The counterexample.
        counterexample: String,
    },
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { what, at } => write!(f, "{what} is not finite at {at}"),
            Self::NegativeDensity { density, at } => write!(f, "density {density} is negative at {at}"),
            Self::OutsideDomain { sample } => write!(f, "sample {sample} is outside of the domain"),
            Self::ZeroDensity { samples, example } => {
                write!(f, "{samples} samples lie where the density is zero, the first at {example}")
            }
            Self::NotNormalised { integral, error, expected } => {
                write!(f, "density integrates to {integral:.8} +- {error:.1e}, not to {expected}")
            }
            Self::Unequal { what, left, right, at, cases } => {
                write!(f, "{what} in {cases} cases, worst {left:e} and {right:e} at {at}")
            }
            Self::Law { law, counterexample } => write!(f, "{law}, but {counterexample}"),
        }
    }
}

/// Why a check could not decide.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Undecided {
    /// There are too few data for the test.
    TooFew {
        /// What there are too few of.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many the test needs.
        needed: usize,
    },
    /// The quadrature of a density did not converge within its budget.
    Quadrature {
        /// The integral so far.
        integral: f64,
        /// Its estimated error.
        error: f64,
        /// The number of times that the density was evaluated.
        evaluations: usize,
    },
    /// An argument makes no sense.
    Argument(String),
}

impl fmt::Display for Undecided {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooFew { what, count, needed } => write!(f, "{count} {what} are too few, {needed} are needed"),
            Self::Quadrature { integral, error, evaluations } => {
                write!(f, "quadrature stopped at {integral:.8} +- {error:.1e} after {evaluations} evaluations")
            }
            Self::Argument(text) => write!(f, "{text}"),
        }
    }
}
