//! The laws of `vpl-gi`'s traits, on what the renderers implement them with.
#![allow(clippy::unwrap_used)]

use estimator_checks::Suite;
use estimator_checks::laws::paths::{check_connection_tests, check_path_heuristic};
use lichtwerk::choices::{AnyHeuristic, AnyPathHeuristic};
use lichtwerk::estimators::ResampledConnections;
use qmc_sampling::{Independent, Sampler, SamplerFamily};
use scene_core::{Ray, Rgb};
use vpl_gi::{ConnectionTests, Partition};

static SUITE: Suite = Suite::with_share("workspace laws", 4, 1e-8);

const VALUES: [Rgb; 4] =
    [Rgb::new(1.0, 0.5, 0.25), Rgb::new(0.1, 3.0, 0.1), Rgb::new(0.2, 0.0, 0.0), Rgb::new(2.0, 0.7, 5.0)];

fn resampled(rays: u32) -> ResampledConnections<Rgb, impl Sampler> {
    ResampledConnections::new(rays, Independent::new(estimator_checks::seed("connections")).sampler(0, 0))
}

/// Believes that what the second and later rays ask for is occluded.
struct Impatient<T>(T);

impl<T: ConnectionTests<Rgb>> ConnectionTests<Rgb> for Impatient<T> {
    fn connect(&mut self, value: Rgb, ray: Ray, is_occluded: impl FnOnce(&Ray) -> bool) -> Rgb {
        self.0.connect(value, ray, is_occluded)
    }
    fn finish(&mut self, mut is_occluded: impl FnMut(&Ray) -> bool) -> Rgb {
        let mut first = true;
        self.0.finish(|ray| !core::mem::take(&mut first) || is_occluded(ray))
    }
}

#[test]
fn resampled_connections() {
    check_connection_tests(SUITE.check("one ray"), &mut resampled(1), &VALUES).expect_pass();
    check_connection_tests(SUITE.check("three rays"), &mut resampled(3), &VALUES).expect_pass();
    check_connection_tests(SUITE.twin("impatient"), &mut Impatient(resampled(3)), &VALUES).expect_reject();
}

#[test]
fn heuristics_by_name() {
    use AnyHeuristic::{Balance, Cutoff, Maximum, Power, Stratification};
    for name in [Balance, Power, Maximum, Cutoff, Stratification] {
        for partition in [Partition::hard(0.1), Partition::soft(0.1)] {
            let heuristic = AnyPathHeuristic { name, partition: partition.unwrap() };
            check_path_heuristic(&format!("{name:?}"), &heuristic).expect_pass();
        }
    }
}
