//! Every sampler that the program offers gives the same expectation.
//!
//! Images are compared block by block with those of independent numbers, over independent seeds: each seed is one
//! randomisation of all sequences. The filter is wider than a pixel, so that the place in the pixel is put to use.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use estimator_checks::{BatchMeans, Suite};
use lichtwerk::choices::{AnyChoice, AnyHeuristic, LightSelection};
use lichtwerk::estimators::{FirstEvent, NextEvent, OwnSampling, PathTracer};
use lichtwerk::program::{EstimatorName, RenderSettings, SamplerName};
use lichtwerk::render::Budget;
use lichtwerk_tests::planted::{FewDimensions, PlaceInImage};
use lichtwerk_tests::{Effort, block_means, means_of, render_through, scenes};
use qmc_sampling::{OwenSobol, SamplerFamily};
use scene_core::film::Filter;
use scene_core::{ReferenceScene, RussianRoulette, Scene};

/// Two estimators by every sampler, and one check by hand.
static SUITE: Suite = Suite::with_share("workspace samplers", 32, 1e-8);

fn settings(estimator: EstimatorName, sampler: SamplerName) -> RenderSettings {
    let filter = Filter::gaussian(0.6).unwrap();
    RenderSettings { estimator, sampler, filter, max_depth: 6, ..RenderSettings::new(Budget::Samples(0)) }
}

fn scene() -> ReferenceScene {
    // Not square, and no side a power of two or three: sequences run through a grid that is larger than the image.
    scenes::build(scenes::resized(scenes::cornell_box(), 24, 18))
}

fn independent(estimator: EstimatorName) -> BatchMeans {
    let name = format!("{estimator:?} by independent numbers");
    block_means(&name, &scene(), &settings(estimator, SamplerName::Independent), Effort::QUICK)
}

fn every_sampler_agrees(estimator: EstimatorName) {
    let (scene, expected) = (scene(), independent(estimator));
    for &sampler in SamplerName::all().iter().filter(|&&sampler| sampler != SamplerName::Independent) {
        let test = format!("{estimator:?} by {}", sampler.name());
        let means = block_means(&test, &scene, &settings(estimator, sampler), Effort::QUICK);
        println!("{}", expected.agrees_with(SUITE.check(&test), &means).expect_pass());
    }
}

#[test]
fn every_sampler_agrees_with_independent_numbers_on_paths() {
    every_sampler_agrees(EstimatorName::Path);
}

#[test]
fn every_sampler_agrees_with_independent_numbers_on_light_paths() {
    every_sampler_agrees(EstimatorName::Light);
}

/// Path tracing by samplers that the program does not offer.
fn path_by<F: SamplerFamily>(name: &str, family: impl Fn(u64) -> F) -> BatchMeans {
    let scene = scene();
    let settings = settings(EstimatorName::Path, SamplerName::Sobol);
    let camera = PathTracer {
        direct: NextEvent {
            heuristic: AnyHeuristic::Power,
            choice: AnyChoice::new(LightSelection::Power, scene.emitters()),
        },
        scattering: OwnSampling,
        max_depth: settings.max_depth,
        roulette: RussianRoulette::PathThroughput { from_length: settings.rr_depth - 1 },
        first_event: FirstEvent::Any,
    };
    means_of(name, Effort::QUICK, |seed| {
        render_through(settings.filter, &scene, &camera, &family(seed), Effort::QUICK.samples)
    })
}

#[test]
fn planted_bugs_of_samplers() {
    let expected = independent(EstimatorName::Path);
    let right = path_by("by hand", OwenSobol::new);
    println!("{}", expected.agrees_with(SUITE.check("by hand"), &right).expect_pass());
    for (test, wrong) in [
        (
            "the place in the image for that in the pixel",
            path_by("place", |seed| PlaceInImage { family: OwenSobol::new(seed), size: [24, 18] }),
        ),
        ("few dimensions", path_by("few dimensions", |seed| FewDimensions(OwenSobol::new(seed)))),
    ] {
        println!("{}", expected.agrees_with(SUITE.twin(test), &wrong).expect_reject());
    }
}
