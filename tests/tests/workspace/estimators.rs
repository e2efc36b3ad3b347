//! Estimators agree with each other, and with what is known in closed form.
//!
//! Images are compared block by block over independent seeds. The long forms are the same tests with more samples:
//! `cargo test --release --workspace -- --ignored`.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::ops::ControlFlow;

use estimator_checks::{BatchMeans, Suite};
use lichtwerk::choices::{AnyChoice, AnyHeuristic, LightSelection};
use lichtwerk::estimators::{FirstEvent, LightTracer, NextEvent, OwnSampling, PathTracer};
use lichtwerk::program::{EstimatorName, RenderSettings, SamplerName, estimate};
use lichtwerk::render::{Budget, Job, Rendering};
use lichtwerk_tests::planted::{Liar, OneMode, Unnormalised};
use lichtwerk_tests::{Effort, block_means, both_forms, means_of, render_by, scenes};
use mis_heuristics::{Balance, Heuristic};
use qmc_sampling::{Independent, OwenSobol};
use scene_core::film::Filter;
use scene_core::{
    EmitterChoice, PowerChoice, ReferenceScene, Rgb, RussianRoulette, Scene, SceneDescription, UniformChoice,
};

/// Quick and long forms count: both may run.
static SUITE: Suite = Suite::with_share("workspace estimators", 60, 1.3e-7);

/// A closed form comes without noise to compare skewness with: more batches.
const FURNACE: Effort = Effort { samples: 64, batches: 40, block: 6 };

fn path() -> RenderSettings {
    RenderSettings { max_depth: 6, ..RenderSettings::new(Budget::Samples(0)) }
}

fn light() -> RenderSettings {
    RenderSettings { estimator: EstimatorName::Light, ..path() }
}

/// Renders with the settings under a name of their own, so that all seeds differ.
fn render(test: &str, what: &str, scene: &ReferenceScene, settings: &RenderSettings, effort: Effort) -> BatchMeans {
    block_means(&format!("{test}: {what}"), scene, settings, effort)
}

fn path_equals_light(test: &str, description: SceneDescription, effort: Effort) {
    let scene = scenes::build(description);
    let a = render(test, "path", &scene, &path(), effort);
    let b = render(test, "light", &scene, &light(), effort);
    println!("{}", a.agrees_with(SUITE.check(test), &b).expect_pass());
}

fn path_equals_path(test: &str, settings: &RenderSettings, effort: Effort) {
    let scene = scenes::build(scenes::studio());
    let a = render(test, "path", &scene, &path(), effort);
    let b = render(test, "variant", &scene, settings, effort);
    println!("{}", a.agrees_with(SUITE.check(test), &b).expect_pass());
}

both_forms! {
    path_equals_light_in_the_cornell_box => |test, effort| path_equals_light(test, scenes::cornell_box(), effort);
    path_equals_light_through_glass => |test, effort| path_equals_light(test, scenes::glass_ball(), effort);
    path_equals_light_under_water => |test, effort| path_equals_light(test, scenes::under_water(None), effort);
    path_equals_light_under_rough_water => |test, effort| path_equals_light(test, scenes::under_water(Some(0.3)), effort);
    path_equals_light_with_bent_normals => |test, effort| path_equals_light(test, scenes::bent_normals(), effort);
    path_equals_light_on_rough_materials => |test, effort| path_equals_light(test, scenes::rough_materials(), effort);
    path_equals_light_from_delta_lights => |test, effort| path_equals_light(test, scenes::delta_lights(), effort);
    path_equals_light_in_a_constant_environment =>
        |test, effort| path_equals_light(test, scenes::constant_environment(), effort);
    path_equals_light_in_an_environment_map => |test, effort| path_equals_light(test, scenes::environment_map(), effort);
    path_equals_light_with_lens_and_masks => |test, effort| path_equals_light(test, scenes::lens_and_masks(), effort);

    path_is_the_same_by_balance =>
        |test, effort| path_equals_path(test, &RenderSettings { heuristic: AnyHeuristic::Balance, ..path() }, effort);
    path_is_the_same_by_maximum =>
        |test, effort| path_equals_path(test, &RenderSettings { heuristic: AnyHeuristic::Maximum, ..path() }, effort);
    path_is_the_same_with_lights_chosen_uniformly =>
        |test, effort| path_equals_path(test, &RenderSettings { lights: LightSelection::Uniform, ..path() }, effort);
    path_is_the_same_with_independent_numbers =>
        |test, effort| path_equals_path(test, &RenderSettings { sampler: SamplerName::Independent, ..path() }, effort);
    path_is_the_same_without_russian_roulette =>
        |test, effort| path_equals_path(test, &RenderSettings { rr_depth: u32::MAX, ..path() }, effort);
    path_is_the_same_with_early_russian_roulette =>
        |test, effort| path_equals_path(test, &RenderSettings { rr_depth: 1, ..path() }, effort);
}

/// All blocks of an image have this value.
fn is_uniform(test: &str, means: &BatchMeans, value: f64) {
    let truth = vec![value; means.blocks().len()];
    // Round-off of f32 along the path.
    println!("{}", means.clone().allowance(1e-5).agrees_with_truth(SUITE.check(test), &truth).expect_pass());
}

#[test]
fn furnace_box_is_the_geometric_series() {
    let scene = scenes::build(scenes::furnace_box());
    let test = "furnace box, unlimited";
    let means = render(test, "path", &scene, &RenderSettings { max_depth: u32::MAX, ..path() }, FURNACE);
    is_uniform(test, &means, 2.0);

    // 1 + 1/2 + 1/4 + 1/8, and a planted bug: the depth off by one.
    let (test, truth) = ("furnace box, depth 4", 1.875);
    let of_depth = |max_depth| {
        render(test, &format!("depth {max_depth}"), &scene, &RenderSettings { max_depth, ..path() }, FURNACE)
    };
    is_uniform(test, &of_depth(4), truth);
    for wrong in [3, 5] {
        let means = of_depth(wrong);
        let truth = vec![truth; means.blocks().len()];
        means.agrees_with_truth(SUITE.twin(test), &truth).expect_reject();
    }
}

#[test]
fn furnace_ball_shows_its_albedo() {
    let scene = scenes::build(scenes::furnace_ball());
    for (estimator, settings) in [("path", path()), ("light", light())] {
        let test = format!("furnace ball by {estimator}");
        let means = render(&test, estimator, &scene, &settings, FURNACE);
        // The image is seen through a camera at a distance of 4: every ray hits the ball.
        is_uniform(&test, &means, f64::from(0.8f32));
    }
}

#[test]
fn direct_is_path_of_two_segments() {
    let scene = scenes::build(scenes::cornell_box());
    let render = |estimator, max_depth| {
        let settings = RenderSettings { estimator, max_depth, threads: 1, ..RenderSettings::new(Budget::Samples(8)) };
        estimate(&scene, &settings, |_| ControlFlow::Continue(())).unwrap().film
    };
    let direct = render(EstimatorName::Direct, u32::MAX);
    assert_eq!(direct, render(EstimatorName::Path, 2));
    assert_ne!(direct, render(EstimatorName::Path, 3));
    assert_eq!(render(EstimatorName::Direct, 1), render(EstimatorName::Path, 1));
}

/// The mean of each column of ambient occlusion, as a block.
fn occlusion_by_column(test: &str, description: SceneDescription, distance: f32) -> BatchMeans {
    let scene = scenes::build(description);
    let settings = RenderSettings { estimator: EstimatorName::Ao, ao_distance: distance, ..path() };
    let effort = Effort { samples: 256, batches: 40, block: 1 };
    // Rays start a little above the surface: at 256 units in the last place of the vertices' coordinates.
    let mut columns = BatchMeans::new(8).allowance(5e-4);
    for batch in 0..effort.batches {
        let seed = estimator_checks::seed(test).wrapping_add(batch);
        let settings = RenderSettings { seed, threads: 1, budget: Budget::Samples(effort.samples), ..settings.clone() };
        let rendering = estimate(&scene, &settings, |_| ControlFlow::Continue(())).unwrap();
        let column = |x: u32| (0..8).map(|y| rendering.film.pixel(x, y).mean()[0]).sum::<f64>() / 8.0;
        columns.push_batch(&(0..8).map(column).collect::<Vec<_>>()).unwrap();
    }
    columns
}

/// A wall of height 1 at the distance `x` covers `1/2 (1 - x / sqrt(x^2 + 1))` of the hemisphere, weighted by the
/// cosine; the mean over the strip of floor that a column of pixels sees is elementary.
#[test]
fn ambient_occlusion_beside_a_wall() {
    let antiderivative = |x: f64| 0.5 * (x + x.hypot(1.0));
    let truth: Vec<f64> = (0..8)
        .map(|column| {
            let [right, left] = [7 - column, 8 - column].map(|i| f64::from(i) / 8.0);
            (antiderivative(left) - antiderivative(right)) / (left - right)
        })
        .collect();
    let test = "ambient occlusion beside a wall";
    let columns = occlusion_by_column(test, scenes::beside_a_wall(), f32::INFINITY);
    println!("{}", columns.agrees_with_truth(SUITE.check(test), &truth).expect_pass());
    let mirrored: Vec<f64> = truth.iter().rev().copied().collect();
    columns.agrees_with_truth(SUITE.twin(test), &mirrored).expect_reject();
}

/// Between planes at a distance of 1 a ray of length `d` at an angle with cosine above `1/d` hits: `1/d^2` is free.
#[test]
fn ambient_occlusion_has_a_range() {
    let test = "ambient occlusion below a ceiling";
    let columns = occlusion_by_column(test, scenes::below_a_ceiling(), 2.0);
    println!("{}", columns.agrees_with_truth(SUITE.check(test), &[0.25; 8]).expect_pass());
    occlusion_by_column(test, scenes::below_a_ceiling(), 1.98)
        .agrees_with_truth(SUITE.twin(test), &[0.25; 8])
        .expect_reject();
}

/// Light tracing as by [`light`], with light paths that scatter as if they carried radiance.
fn light_in_one_mode(scene: &OneMode<ReferenceScene>, seed: u64) -> Rendering {
    let camera = PathTracer { first_event: FirstEvent::SpecularOnly, ..light().path_tracer(scene) };
    let (choice, max_depth, roulette) = (camera.direct.choice.clone(), camera.max_depth, camera.roulette);
    let job = Job {
        scene,
        samplers: &OwenSobol::new(seed),
        camera: &camera,
        light: Some(&LightTracer { choice, max_depth, roulette }),
        filter: Filter::BOX,
        budget: Budget::Samples(Effort::QUICK.samples),
        first: 0,
        threads: 1,
    };
    job.render(&mut |_| ControlFlow::Continue(())).unwrap()
}

/// Light paths that scatter as if they carried radiance are found out wherever the two differ.
#[test]
fn planted_bug_importance_scatters_like_radiance() {
    for (test, description) in [
        ("no correction for shading normals", scenes::bent_normals()),
        ("refraction scales importance", scenes::under_water(None)),
        ("rough refraction scales importance", scenes::under_water(Some(0.3))),
    ] {
        let scene = scenes::build(description);
        let right = render(test, "path", &scene, &path(), Effort::QUICK);
        let scene = OneMode(scene);
        let wrong = means_of(&format!("{test}: light"), Effort::QUICK, |seed| light_in_one_mode(&scene, seed));
        println!("{}", right.agrees_with(SUITE.twin(test), &wrong).expect_reject());
    }
}

#[test]
fn planted_bug_paths_are_one_segment_longer() {
    let test = "one segment more";
    let scene = scenes::build(scenes::cornell_box());
    let right = render(test, "path", &scene, &RenderSettings { max_depth: 3, ..path() }, Effort::QUICK);
    let wrong = render(test, "light", &scene, &RenderSettings { max_depth: 4, ..light() }, Effort::QUICK);
    right.agrees_with(SUITE.twin(test), &wrong).expect_reject();
}

#[test]
fn planted_bug_a_lamp_is_two_percent_brighter() {
    let test = "2 % brighter";
    let effort = Effort { samples: 128, ..Effort::QUICK };
    let with_gain = |what: &str, gain: f32| {
        let mut description = scenes::constant_environment();
        let lamps = description.instances.iter_mut().filter_map(|instance| instance.radiance.as_mut());
        lamps.for_each(|radiance: &mut Rgb| *radiance = *radiance * gain);
        render(test, what, &scenes::build(description), &RenderSettings { max_depth: 2, ..path() }, effort)
    };
    let (right, wrong) = (with_gain("right", 1.0), with_gain("wrong", 1.02));
    println!("{}", right.agrees_with(SUITE.twin(test), &wrong).expect_reject());
}

/// Path tracing with a heuristic and a choice that the program does not offer.
fn path_with<H, C>(name: &str, scene: &ReferenceScene, heuristic: H, choice: C) -> BatchMeans
where
    H: Heuristic<f32> + Copy + Sync,
    C: EmitterChoice + Clone + Sync,
{
    means_of(name, Effort::QUICK, |seed| {
        let roulette = RussianRoulette::Never;
        let camera = PathTracer {
            direct: NextEvent { heuristic, choice: choice.clone() },
            scattering: OwnSampling,
            max_depth: 6,
            roulette,
            first_event: FirstEvent::Any,
        };
        render_by(scene, &camera, &Independent::new(seed), Effort::QUICK.samples)
    })
}

#[test]
fn planted_bug_weights_and_probabilities() {
    let scene = scenes::build(scenes::studio());
    let right = render("planted in path", "path", &scene, &path(), Effort::QUICK);
    let power = PowerChoice::new(scene.emitters());
    let uniform = UniformChoice::new(scene.emitters().len());
    let same = path_with("balance by hand", &scene, Balance, power.clone());
    println!("{}", right.agrees_with(SUITE.check("path by hand"), &same).expect_pass());
    for (test, wrong) in [
        ("weights sum to 1.1", path_with("weights", &scene, Unnormalised(1.1), power.clone())),
        (
            "wrong probabilities of lights",
            path_with("lights", &scene, Balance, Liar { chooses: uniform, claims: power.clone() }),
        ),
    ] {
        println!("{}", right.agrees_with(SUITE.twin(test), &wrong).expect_reject());
    }
    // The choices by name are those.
    assert!(matches!(AnyChoice::new(LightSelection::Power, scene.emitters()), AnyChoice::Power(_)));
}
