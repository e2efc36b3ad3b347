//! Resampled direct light, resampled directions, resampled connections and reuse between pixels equal path tracing, for every target, mixture
//! of sources, M and N; in the quick forms mixtures in turn.
//!
//! The long forms: `cargo test --release --workspace -- --ignored`.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::ops::ControlFlow;

use estimator_checks::Suite;
use lichtwerk::choices::{AnyChoice, LightSelection};
use lichtwerk::estimators::{
    DirectLight, EnvironmentSampling, FirstEvent, OwnSampling, PathTracer, ResampledDirect, SourceMix, TargetName,
};
use lichtwerk::light_paths::LightPathSettings;
use lichtwerk::program::{EstimatorName, RenderSettings};
use lichtwerk::render::Budget;
use lichtwerk::resampling::{Candidates, DirectName, ResamplingSettings, ScatteringName};
use lichtwerk_tests::{Effort, Truth, both_forms, means_of, render_by, scenes};
use qmc_sampling::{Independent, Sampler};
use ris::{Reservoir, Source, Target};
use scene_core::{RussianRoulette, Scene, SceneDescription, Spectrum};

/// Quick and long forms count: both may run.
static SUITE: Suite = Suite::with_share("workspace resampling", 80, 5e-8);

fn direct() -> RenderSettings {
    RenderSettings { estimator: EstimatorName::Direct, max_depth: 2, ..RenderSettings::new(Budget::Samples(0)) }
}

fn mix(lights: f32, environment: f32, scattering: f32) -> SourceMix {
    SourceMix::new(lights, environment, scattering).unwrap()
}

fn resampled(candidates: f32, samples: f32) -> ResamplingSettings {
    let candidates = Candidates::Count(candidates);
    ResamplingSettings { direct: DirectName::Ris, candidates, samples, ..ResamplingSettings::default() }
}

fn with(resampling: ResamplingSettings) -> RenderSettings {
    RenderSettings { resampling, ..direct() }
}

fn reuse(rounds: u32, resampling: ResamplingSettings) -> RenderSettings {
    let resampling = ResamplingSettings { reuse_rounds: rounds, reuse_radius: 4.0, ..resampling };
    RenderSettings { estimator: EstimatorName::RestirDirect, ..with(resampling) }
}

/// Every target with every mixture of sources, in the quick form with one of them; M and N fractional too.
fn direct_light(test: &str, description: SceneDescription, effort: Effort) {
    let truth = Truth::new(&SUITE, test, scenes::build(description), &direct(), effort);
    let mixtures = [("lights", mix(1.0, 0.0, 0.0)), ("mixed", mix(2.0, 1.0, 1.0))];
    let targets = [TargetName::Unshadowed, TargetName::GeometryVisibility, TargetName::GuessedVisibility];
    for (k, target) in targets.into_iter().enumerate() {
        for (turn, (sources, candidate_mix)) in mixtures.into_iter().enumerate() {
            if effort == Effort::QUICK && turn != k % 2 {
                continue;
            }
            let (m, n) = [(2.5, 1.0), (8.0, 1.6), (1.3, 2.5)][k];
            let settings = ResamplingSettings { target, candidate_mix, ..resampled(m, n) };
            truth.equals(&format!("{target:?}, {sources}, M {m}, N {n}"), &with(settings));
        }
    }
    let paper = ResamplingSettings {
        candidate_lights: LightSelection::Uniform,
        candidate_mix: mix(1.0, 0.0, 0.0),
        environment_candidates: EnvironmentSampling::Uniform,
        ..resampled(4.0, 1.0)
    };
    truth.equals("the paper's proposals", &with(paper.clone()));
    truth.equals("one candidate", &with(ResamplingSettings { candidates: Candidates::Count(1.0), ..paper.clone() }));
    for rounds in 0..3 {
        truth.equals(&format!("{rounds} rounds of reuse"), &reuse(rounds, paper.clone()));
    }
}

fn whole_paths(test: &str, description: SceneDescription, has_points: bool, effort: Effort) {
    let path = RenderSettings { max_depth: 5, ..RenderSettings::new(Budget::Samples(0)) };
    let truth = Truth::new(&SUITE, test, scenes::build(description), &path, effort);
    let of = |resampling: ResamplingSettings| RenderSettings { resampling, ..path.clone() };
    truth.equals("direct light by resampling", &of(resampled(3.5, 1.0)));
    let by_ris = ResamplingSettings {
        bsdf_sampling: ScatteringName::Ris,
        bsdf_candidates: 4.5,
        ..ResamplingSettings::default()
    };
    truth.equals("directions by resampling", &of(by_ris.clone()));
    truth.equals("both", &of(ResamplingSettings { direct: DirectName::Ris, ..by_ris.clone() }));
    // Rays never hit a point light.
    if !has_points {
        let scattering = of(ResamplingSettings { direct: DirectName::Scattering, ..by_ris });
        truth.equals("directions by resampling, light by scattering", &scattering);
    }
}

fn connections(test: &str, description: SceneDescription, effort: Effort) {
    let light_paths = LightPathSettings { light_paths: 2, interleave: None, ..LightPathSettings::default() };
    let path = RenderSettings { max_depth: 5, light_paths, ..RenderSettings::new(Budget::Samples(0)) };
    let truth = Truth::new(&SUITE, test, scenes::build(description), &path, effort);
    let mut settings = RenderSettings { estimator: EstimatorName::Bdpt, ..path };
    for rays in [1, 3] {
        settings.light_paths.resampled_connections = Some(rays);
        truth.equals(&format!("{rays} rays per path"), &settings);
    }
}

both_forms! {
    direct_light_on_rough_materials => |test, effort| direct_light(test, scenes::rough_materials(), effort);
    direct_light_of_an_environment => |test, effort| direct_light(test, scenes::environment_map(), effort);
    direct_light_of_points => |test, effort| direct_light(test, scenes::delta_lights(), effort);
    whole_paths_in_the_studio => |test, effort| whole_paths(test, scenes::studio(), true, effort);
    whole_paths_through_glass => |test, effort| whole_paths(test, scenes::glass_ball(), false, effort);
    connections_in_the_studio => |test, effort| connections(test, scenes::studio(), effort);
}

/// A planted bug: candidates that could not be drawn, or have weight zero, are not counted.
struct CountsOnlyThePositive<'a>(ResampledDirect<'a, AnyChoice>);

impl DirectLight for CountsOnlyThePositive<'_> {
    fn sample<S: Scene>(
        &self,
        scene: &S,
        vertex: &S::Vertex<'_>,
        length: u32,
        wanted: bool,
        sampler: &mut impl Sampler,
    ) -> S::Spectrum {
        if !wanted {
            return S::Spectrum::ZERO;
        }
        let mut numbers = sampler.fork(length);
        let (source, target) = (self.0.source(scene, vertex), self.0.target(scene, vertex));
        let mut reservoir = Reservoir::new();
        for _ in 0..4 {
            if let Some(proposal) = source.propose(&mut || numbers.next_1d()) {
                let score = target.score(&proposal.sample);
                if score > 0.0 {
                    reservoir.update(proposal.sample, score, 1.0 / proposal.density, numbers.next_1d());
                }
            }
        }
        match reservoir.finish().selected {
            Some(y) if y.sample.is_visible(scene, vertex) => y.sample.value(vertex) * y.contribution_weight,
            _ => S::Spectrum::ZERO,
        }
    }
}

#[test]
fn counting_only_positive_candidates_is_rejected() {
    let test = "only positive candidates count";
    let truth = Truth::new(&SUITE, test, scenes::build(scenes::environment_map()), &direct(), Effort::QUICK);
    let paper = ResamplingSettings {
        candidate_mix: mix(1.0, 0.0, 0.0),
        environment_candidates: EnvironmentSampling::Uniform,
        ..resampled(4.0, 1.0)
    };
    let scene = &truth.scene;
    let camera = PathTracer {
        direct: CountsOnlyThePositive(paper.resampled(scene, &Independent::new(0), None).unwrap()),
        scattering: OwnSampling,
        max_depth: 2,
        roulette: RussianRoulette::Never,
        first_event: FirstEvent::Any,
    };
    let render = |seed| render_by(scene, &camera, &Independent::new(seed), Effort::QUICK.samples);
    let means = means_of(test, Effort::QUICK, render);
    println!("{}", truth.means.agrees_with(SUITE.twin(test), &means).expect_reject());
}

#[test]
fn images_do_not_depend_on_the_number_of_threads() {
    let scene = scenes::build(scenes::environment_map());
    for settings in [reuse(2, resampled(3.0, 1.0)), with(resampled(2.5, 1.5))] {
        let image = |threads| {
            let settings = RenderSettings { threads, budget: Budget::Samples(3), ..settings.clone() };
            let rendering = lichtwerk::program::estimate(&scene, &settings, |_| ControlFlow::Continue(())).unwrap();
            (rendering.film.develop(0).rgb().unwrap(), rendering.rays)
        };
        assert_eq!(image(1), image(3));
    }
}
