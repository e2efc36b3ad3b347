//! The laws of the traits of the Lichtwerk crates, asked of anybody's implementation.
//!
//! Each crate has a feature of its own name; [`domain`] and [`resampling`] need none, and `vpl-gi` brings `scene-core`. A checker takes what is to be checked, and
//! - a name where no chance is involved, and returns an [`Outcome`]: what it reports is a proof,
//! - a [`Check`](crate::Check) where laws are statistical, and returns a [`Report`](crate::Report): first the laws that hold
//!   exactly, then the others, which share the level of the check.
//!
//! A law that is broken is a [`Violation`] that says which one, with the values that break it. The checkers that
//! live in the crates themselves return a `Result`: [`Outcome::of_laws`] makes an outcome of it.

pub mod domain;
#[cfg(feature = "path-space-filter")]
pub mod path_space;
#[cfg(feature = "vpl-gi")]
pub mod paths;
#[cfg(feature = "photon-map")]
pub mod photons;
#[cfg(feature = "range-search")]
pub mod ranges;
pub mod resampling;
#[cfg(feature = "qmc-sampling")]
pub mod sampler;
#[cfg(feature = "scene-core")]
pub mod scene;

use crate::outcome::Outcome;
use crate::seed::seed;
use crate::verdict::{Verdict, Violation};

impl Outcome {
    /// The outcome of a checker of laws that returns a result.
    ///
    /// ```
    /// use estimator_checks::{Outcome, Violation};
    ///
    /// let broken = Violation::Law { law: "one is one", counterexample: "it is two".into() };
    /// Outcome::of_laws("unity", Err(broken)).expect_reject();
    /// Outcome::of_laws("unity", Ok::<(), Violation>(())).expect_pass();
    /// ```
    #[must_use = "it decides nothing until it is expected to pass or to reject"]
    pub fn of_laws(test: &str, result: Result<(), impl Into<Violation>>) -> Self {
        let (statistic, verdict) = match result {
            Ok(()) => (0.0, Verdict::Pass),
            Err(violation) => (1.0, Verdict::Violation(violation.into())),
        };
        Self::exact(test, seed(test), "laws", statistic, verdict)
    }
}

/// That of the crates, which have but laws.
#[cfg(any(feature = "path-space-filter", feature = "photon-map", feature = "range-search"))]
impl From<range_search::check::Violation> for Violation {
    fn from(broken: range_search::check::Violation) -> Self {
        Self::Law { law: broken.law, counterexample: broken.counterexample }
    }
}

/// What the checkers share.
mod tools {
    use crate::verdict::Violation;

    pub(in crate::laws) type Law = Result<(), Violation>;

    /// A law, and what shows that it does not hold.
    pub(in crate::laws) fn hold(law: &'static str, holds: bool, counterexample: impl FnOnce() -> String) -> Law {
        if holds { Ok(()) } else { Err(Violation::Law { law, counterexample: counterexample() }) }
    }

    /// Whether two numbers are as near as that, relative to the larger one.
    #[cfg(any(feature = "path-space-filter", feature = "scene-core"))]
    pub(in crate::laws) fn near(a: f64, b: f64, tolerance: f64) -> bool {
        a == b || (a - b).abs() <= tolerance * a.abs().max(b.abs())
    }
}

#[cfg(any(feature = "path-space-filter", feature = "scene-core"))]
use tools::near;
use tools::{Law, hold};
