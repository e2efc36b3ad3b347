//! Bidirectional path tracing equals path tracing under every heuristic, with and without the connection to the lens, through the program's
//! own loop.
//!
//! The long forms: `cargo test --release --workspace -- --ignored`.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::ops::ControlFlow;

use estimator_checks::Suite;
use lichtwerk::choices::AnyHeuristic;
use lichtwerk::light_paths::LightPathSettings;
use lichtwerk::program::{EstimatorName, RenderSettings, estimate};
use lichtwerk::render::Budget;
use lichtwerk_tests::{Effort, assets, block_means, scenes};
use qmc_sampling::Interleaved;
use scene_core::ReferenceScene;
use scene_core::builtin::Builtin;
use vpl_gi::Threshold;

/// Quick and long forms count: both may run.
static SUITE: Suite = Suite::with_share("workspace bidirectional", 140, 5e-9);

const HEURISTICS: [AnyHeuristic; 5] = [
    AnyHeuristic::Balance,
    AnyHeuristic::Power,
    AnyHeuristic::Maximum,
    AnyHeuristic::Cutoff,
    AnyHeuristic::Stratification,
];

fn path() -> RenderSettings {
    RenderSettings { max_depth: 5, ..RenderSettings::new(Budget::Samples(0)) }
}

fn bdpt(heuristic: AnyHeuristic, without_lens: bool, interleaved: bool) -> RenderSettings {
    let interleave = if interleaved { Some(Interleaved::new(3, 2).unwrap()) } else { None };
    let light_paths = if interleaved { 3 } else { 1 };
    // A small one: this form of stratification looks at the geometry term alone, and glossy surfaces have heavy tails under large ones.
    let threshold = Some(Threshold::Normalised(3.0));
    let light_paths =
        LightPathSettings { threshold, light_paths, interleave, without_lens, ..LightPathSettings::default() };
    RenderSettings { estimator: EstimatorName::Bdpt, heuristic, light_paths, ..path() }
}

/// Every heuristic; both sets of techniques and both ways of sharing, all or in turn.
fn equals_path(test: &str, scene: &ReferenceScene, effort: Effort, heuristics: &[AnyHeuristic], all: bool) {
    let truth = block_means(&format!("{test}: path"), scene, &path(), effort);
    for (k, &heuristic) in heuristics.iter().enumerate() {
        for (turn, (without_lens, interleaved)) in
            [(false, false), (true, true), (true, false), (false, true)].into_iter().enumerate()
        {
            if !all && turn != k % 4 {
                continue;
            }
            let what = format!("{test}: {heuristic:?}, lens {}, interleaved {interleaved}", !without_lens);
            let means = block_means(&what, scene, &bdpt(heuristic, without_lens, interleaved), effort);
            println!("{}", truth.agrees_with(SUITE.check(&what), &means).expect_pass());
        }
    }
}

fn office() -> ReferenceScene {
    let office = Builtin::named("office").unwrap().description();
    scenes::build(scenes::resized(office, scenes::SIZE, scenes::SIZE))
}

fn modern_hall() -> Option<ReferenceScene> {
    let description = assets::modern_hall()?;
    Some(ReferenceScene::new(scenes::resized(description, scenes::SIZE, scenes::SIZE)).unwrap())
}

/// In quick forms of scenes other than the Cornell box.
const FEW: [AnyHeuristic; 2] = [AnyHeuristic::Power, AnyHeuristic::Stratification];

mod quick {
    use super::*;

    #[test]
    fn bdpt_equals_path_in_the_cornell_box() {
        equals_path("cornell box", &scenes::build(scenes::cornell_box()), Effort::QUICK, &HEURISTICS, false);
    }

    #[test]
    fn bdpt_equals_path_on_rough_materials() {
        equals_path("rough materials", &scenes::build(scenes::rough_materials()), Effort::QUICK, &FEW, false);
    }

    #[test]
    fn bdpt_equals_path_through_glass() {
        equals_path("glass", &scenes::build(scenes::glass_ball()), Effort::QUICK, &FEW, false);
    }

    #[test]
    fn bdpt_equals_path_with_bent_normals() {
        equals_path("bent normals", &scenes::build(scenes::bent_normals()), Effort::QUICK, &FEW, false);
    }

    #[test]
    fn bdpt_equals_path_in_the_office() {
        equals_path("office", &office(), Effort::QUICK, &FEW, false);
    }

    #[test]
    fn bdpt_equals_path_in_the_modern_hall() {
        if let Some(scene) = modern_hall() {
            equals_path("modern hall", &scene, Effort::QUICK, &FEW, false);
        }
    }
}

mod long {
    use super::*;

    #[test]
    #[ignore = "long form: cargo test --release --workspace -- --ignored"]
    fn bdpt_equals_path() {
        let long = |name: &str| format!("{name} (long)");
        equals_path(&long("cornell box"), &scenes::build(scenes::cornell_box()), Effort::LONG, &HEURISTICS, true);
        for (name, description) in [
            ("rough materials", scenes::rough_materials()),
            ("glass", scenes::glass_ball()),
            ("bent normals", scenes::bent_normals()),
            ("environment map", scenes::environment_map()),
            ("delta lights", scenes::delta_lights()),
            ("lens and masks", scenes::lens_and_masks()),
            ("studio", scenes::studio()),
        ] {
            equals_path(&long(name), &scenes::build(description), Effort::LONG, &HEURISTICS, false);
        }
        equals_path(&long("office"), &office(), Effort::LONG, &HEURISTICS, false);
        if let Some(scene) = modern_hall() {
            equals_path(&long("modern hall"), &scene, Effort::LONG, &HEURISTICS, false);
        }
    }
}

#[test]
fn planted_bugs_are_rejected() {
    let scene = scenes::build(scenes::cornell_box());
    let truth = block_means("planted: path", &scene, &path(), Effort::QUICK);
    let one_less = RenderSettings { max_depth: 4, ..bdpt(AnyHeuristic::Balance, false, true) };
    let means = block_means("planted: one segment less", &scene, &one_less, Effort::QUICK);
    truth.agrees_with(SUITE.twin("one segment less"), &means).expect_reject();
}

#[test]
fn images_do_not_depend_on_threads() {
    let scene = scenes::build(scenes::studio());
    for interleaved in [true, false] {
        let render = |threads| {
            let settings = bdpt(AnyHeuristic::Power, false, interleaved);
            let settings = RenderSettings { threads, budget: Budget::Samples(4), ..settings };
            estimate(&scene, &settings, |_| ControlFlow::Continue(())).unwrap()
        };
        let (one, three) = (render(1), render(3));
        assert_eq!(one.film, three.film);
        assert_eq!((one.rays, one.light_paths), (three.rays, three.light_paths));
    }
}
