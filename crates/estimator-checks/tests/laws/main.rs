//! The checkers of laws, on the types of the Lichtwerk crates, which pass, and on types that break one law each, which do not.

// Helper functions of tests may unwrap.
#![allow(clippy::unwrap_used)]

mod caustics;
mod connections;
mod emitter;
mod liar;
mod numbers;
mod path_space;
mod paths;
mod sampler;
mod sampler_lies;
mod scene;
mod spectrum;
mod target;
mod vertex;

use estimator_checks::{Outcome, Report, Suite, Verdict, Violation};

pub(crate) static SUITE: Suite = Suite::with_share("estimator-checks laws", 42, 6e-8);

/// The law that an outcome names.
#[track_caller]
pub(crate) fn broken(outcome: Outcome) -> &'static str {
    match outcome.expect_reject().verdict {
        Verdict::Violation(Violation::Law { law, .. }) => law,
        other => panic!("{other:?}"),
    }
}

/// The law that the exact part of a report names.
#[track_caller]
pub(crate) fn broken_exactly(report: Report) -> &'static str {
    broken(report.outcomes[0].clone())
}

/// Insists that the exact laws hold, and that a part with this name does not.
#[track_caller]
pub(crate) fn rejects(report: Report, part: &str) {
    assert!(report.outcomes[0].passed(), "{report}");
    let found = report.outcomes.iter().any(|outcome| outcome.rejected() && outcome.test.contains(part));
    assert!(found, "'{part}' is not rejected: {report}");
}
