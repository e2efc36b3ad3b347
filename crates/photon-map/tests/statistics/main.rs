//! The statistical checks of the crate: one suite, one share of the workspace's false-positive rate.
#![allow(clippy::unwrap_used)]

use estimator_checks::Suite;

mod density;
mod deposition;
mod emission;
mod lights;
mod partition;

static SUITE: Suite = Suite::with_share("photon-map", 34, 5e-8);
