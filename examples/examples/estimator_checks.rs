//! Checking one's own sampler with `estimator-checks`, and the same check with a planted bug.
//!
//! The sampler is that of a glossy lobe around the normal, `f = (n + 1) / (2 pi) cos^n`, with directions of density
//! `p = (n + 2) / (2 pi) cos^(n+1)`, so that the weight `f cos / p = (n + 1) / (n + 2)` is the albedo.
//!
//! Run with `cargo run --release --example estimator_checks`.
#![allow(clippy::print_stdout)]

use std::f64::consts::TAU;

use estimator_checks::{Hemisphere, Sampled, SamplingCheck, Suite};

/// The exponent of the lobe.
const N: f64 = 20.0;
/// The true albedo.
const ALBEDO: f64 = (N + 1.0) / (N + 2.0);

/// One statistical check is made; its level is the false-positive rate of the whole suite.
static SUITE: Suite = Suite::new("example", 1);

/// The bug to be found: the density was given the factor of the lobe, `n + 1`, where it needs `n + 2`.
#[derive(Clone, Copy, PartialEq)]
enum Bug {
    None,
    WrongFactor,
}

fn value(wi: [f64; 3]) -> f64 {
    (N + 1.0) / TAU * wi[2].max(0.0).powf(N + 1.0)
}

fn pdf(wi: [f64; 3], bug: Bug) -> f64 {
    let factor = if bug == Bug::WrongFactor { N + 1.0 } else { N + 2.0 };
    factor / TAU * wi[2].max(0.0).powf(N + 1.0)
}

fn sample([u, v, _]: [f64; 3], bug: Bug) -> Option<Sampled<[f64; 3]>> {
    let z = (1.0 - u).powf(1.0 / (N + 2.0));
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (TAU * v).sin_cos();
    let point = [radius * cos, radius * sin, z];
    let pdf = pdf(point, bug);
    (pdf > 0.0).then(|| Sampled { point, weight: value(point) / pdf, pdf })
}

fn main() {
    let check = || SamplingCheck::on(Hemisphere).samples(100_000).peak([0.0, 0.0, 1.0]);

    let report = check().run(SUITE.check("lobe"), |u| sample(u, Bug::None), |wi| pdf(wi, Bug::None), value);
    println!("{report}");
    report.expect_pass();

    // Weight and density still fit together sample by sample: only the statistics can tell.
    let bug = Bug::WrongFactor;
    let report = check().run(SUITE.twin("lobe, wrong density"), |u| sample(u, bug), |wi| pdf(wi, bug), value);
    println!("{report}");
    report.expect_reject();

    // What the bug would do to an image.
    for (name, bug) in [("correct", Bug::None), ("planted bug", bug)] {
        let mut numbers = estimator_checks::Uniforms::named(name);
        let albedo = (0..100_000)
            .filter_map(|_| sample([numbers.next_f64(), numbers.next_f64(), 0.0], bug))
            .map(|sample| sample.weight)
            .sum::<f64>()
            / 1e5;
        let error = albedo / ALBEDO - 1.0;
        println!("{name:<12} albedo {albedo:.4}, truth {ALBEDO:.4}, error {:+.2} %", 100.0 * error);
        assert_eq!(error.abs() > 0.01, bug != Bug::None);
    }
}
