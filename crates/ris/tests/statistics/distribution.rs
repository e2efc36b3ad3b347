//! Distributions: of estimates, selections and sources.

use estimator_checks::{Interval, Uniforms, check_source, chi_square_counts, kolmogorov_smirnov_two_sample};
use ris::baselines::Tabulated1d;
use ris::{Batch, PrefixSums, Reservoir, Source};

use crate::unbiased::{by_one_number, streamed};
use crate::{Rising, SUITE, TARGETS, f, falling, proposal};

#[test]
fn streams_and_batches_have_one_distribution() {
    let target = TARGETS[0].1;
    let check = SUITE.check("streamed and by prefix sums");
    let mut uniforms = check.uniforms();
    let streams: Vec<f64> = (0..40_000).map(|_| streamed(&mut uniforms, target, 4)).collect();
    let single = |uniforms: &mut Uniforms, ignore: bool| {
        let drawn: Vec<_> = (0..4).map(|_| proposal(&Rising, uniforms)).collect();
        let score = |x: &f64| if ignore { 1.0 } else { target(x) };
        let u = uniforms.next_f64();
        Batch::<_, f64, PrefixSums>::new(drawn, &score).select(u).estimate(|x| f(x))
    };
    let batches: Vec<f64> = (0..40_000).map(|_| single(&mut uniforms, false)).collect();
    kolmogorov_smirnov_two_sample(check, &streams, &batches).expect_pass();
    let check = SUITE.check("streamed and by one number");
    let numbers: Vec<f64> = (0..40_000).map(|_| by_one_number(&mut uniforms, target, 4)).collect();
    kolmogorov_smirnov_two_sample(check, &streams, &numbers).expect_pass();
    // Planted bug: selected by 1/p, without the target.
    let wrong: Vec<f64> = (0..40_000).map(|_| single(&mut uniforms, true)).collect();
    kolmogorov_smirnov_two_sample(SUITE.twin("target forgotten"), &streams, &wrong).expect_reject();
}

#[test]
fn selection_frequencies() {
    let weights = [0.5, 2.0, 0.0, 1.0, 4.5];
    let probabilities = weights.map(|w| w / 8.0);
    let count = |name: &str, reverse: bool| -> [u64; 5] {
        let mut uniforms = Uniforms::named(name);
        let mut counts = [0; 5];
        for _ in 0..100_000 {
            let mut reservoir = Reservoir::new();
            let mut sum = 0.0;
            for (k, w) in weights.into_iter().enumerate() {
                let u = uniforms.next_f64();
                // Planted bug: u is compared with the share in the sum before.
                let u = if reverse && sum > 0.0 { u * sum / (sum + w) } else { u };
                sum += w;
                reservoir.update(k, w, 1.0_f64, u);
            }
            counts[*reservoir.finish().sample().unwrap()] += 1;
        }
        counts
    };
    let check = SUITE.check("selection by a reservoir");
    let name = check.test().to_owned();
    chi_square_counts(check, &count(&name, false), &probabilities).expect_pass();
    chi_square_counts(SUITE.twin("selection by the sum before"), &count("before", true), &probabilities)
        .expect_reject();
}

fn propose(source: &impl Source<f64, f64>, numbers: [f64; 3]) -> Option<(f64, f64)> {
    let mut numbers = numbers.into_iter();
    source.propose(&mut || numbers.next().unwrap()).map(|proposal| (proposal.sample, proposal.density))
}

#[test]
fn sources_follow_their_densities() {
    let mixture = falling();
    check_source(
        SUITE.check("mixture as a source"),
        Interval::UNIT,
        |numbers| propose(&mixture, numbers),
        |x| mixture.density(&x),
    )
    .expect_pass();
    check_source(
        SUITE.check("a source that fails"),
        Interval::UNIT,
        |numbers| propose(&Rising, numbers),
        |x| Rising.density(&x),
    )
    .expect_pass();
    let table = Tabulated1d::new(|x| f(&x), [0.0, 1.0], 8).unwrap();
    check_source(SUITE.check("a table"), Interval::UNIT, |numbers| propose(&table, numbers), |x| table.pdf(x))
        .expect_pass();
    // Planted bug: the mixture claims the density of the part that was drawn.
    check_source(
        SUITE.twin("the density of the part"),
        Interval::UNIT,
        |[lobe, u, _]| {
            let x = if lobe < 0.8 { 1.0 - (1.0 - u).sqrt() } else { u };
            Some((x, if lobe < 0.8 { 2.0 * (1.0 - x) } else { 1.0 }))
        },
        |x| mixture.density(&x),
    )
    .expect_reject();
}
