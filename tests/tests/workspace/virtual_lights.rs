//! Robust instant global illumination equals path tracing, for every partition and way of sharing light paths, these two in turn.
//!
//! The long forms: `cargo test --release --workspace -- --ignored`.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::ops::ControlFlow;

use estimator_checks::Suite;
use lichtwerk::estimators::VirtualLights;
use lichtwerk::light_paths::{LightPathSettings, PartitionName};
use lichtwerk::program::{EstimatorName, RenderSettings, estimate};
use lichtwerk::render::{Budget, Rendering, Shared};
use lichtwerk_tests::planted::AllDiffuse;
use lichtwerk_tests::{Effort, Truth, assets, both_forms, means_of, render_by, scenes};
use qmc_sampling::{Interleaved, OwenSobol};
use scene_core::builtin::Builtin;
use scene_core::{PowerChoice, ReferenceScene, RussianRoulette, Scene};
use vpl_gi::{LightTracing, Residual, RobustIgi, ShadowRays, Threshold};

/// Quick and long forms count: both may run.
static SUITE: Suite = Suite::with_share("workspace virtual lights", 200, 3e-8);

/// In units of one over the squared radius of the scene.
const THRESHOLDS: [f32; 6] = [0.0, 0.05, 0.3, 1.0, 10.0, 1000.0];

fn path() -> RenderSettings {
    RenderSettings { max_depth: 5, ..RenderSettings::new(Budget::Samples(0)) }
}

fn robust(threshold: f32, partition: PartitionName, interleaved: bool) -> RenderSettings {
    let interleave = if interleaved { Some(Interleaved::new(3, 3).unwrap()) } else { None };
    let light_paths = LightPathSettings {
        threshold: Some(Threshold::Normalised(threshold)),
        partition,
        light_paths: if interleaved { 4 } else { 1 },
        interleave,
        ..LightPathSettings::default()
    };
    RenderSettings { estimator: EstimatorName::RobustIgi, light_paths, ..path() }
}

/// A scene with its image by path tracing.
fn by_path(test: &str, scene: ReferenceScene, effort: Effort) -> Truth {
    Truth::new(&SUITE, test, scene, &path(), effort)
}

/// Every threshold, hard and soft, the one with light paths of one's own and the other with shared ones, in turn.
fn equal_everywhere(truth: &Truth, thresholds: &[f32]) {
    for (k, &threshold) in thresholds.iter().enumerate() {
        for (turn, partition) in [PartitionName::Hard, PartitionName::Soft].into_iter().enumerate() {
            let interleaved = (k + turn) % 2 == 0;
            let what = format!("{partition:?} {threshold}, interleaved {interleaved}");
            truth.equals(&what, &robust(threshold, partition, interleaved));
        }
    }
}

fn is_quick(effort: Effort) -> bool {
    effort == Effort::QUICK
}

/// The quick forms take fewer thresholds where the scene is not the Cornell box.
fn equal_on(test: &str, scene: ReferenceScene, effort: Effort) {
    let thresholds: &[f32] = if is_quick(effort) { &[10.0] } else { &THRESHOLDS };
    equal_everywhere(&by_path(test, scene, effort), thresholds);
}

both_forms! {
    robust_equals_path_in_the_cornell_box => |test, effort| {
        equal_everywhere(&by_path(test, scenes::build(scenes::cornell_box()), effort), &THRESHOLDS);
    };
    robust_equals_path_on_rough_materials => |test, effort| equal_on(test, scenes::build(scenes::rough_materials()), effort);
    robust_equals_path_through_glass => |test, effort| equal_on(test, scenes::build(scenes::glass_ball()), effort);
    robust_equals_path_with_bent_normals => |test, effort| equal_on(test, scenes::build(scenes::bent_normals()), effort);
    robust_equals_path_in_an_environment => |test, effort| equal_on(test, scenes::build(scenes::environment_map()), effort);
    robust_equals_path_with_lens_and_masks => |test, effort| equal_on(test, scenes::build(scenes::lens_and_masks()), effort);
    robust_equals_path_in_the_studio => |test, effort| equal_on(test, scenes::build(scenes::studio()), effort);
    robust_equals_path_from_delta_lights => |test, effort| equal_on(test, scenes::build(scenes::delta_lights()), effort);
    robust_equals_path_in_the_office => |test, effort| {
        let Some(office) = Builtin::named("office") else { panic!("no office") };
        let office = scenes::resized(office.description(), scenes::SIZE, scenes::SIZE);
        equal_on(test, scenes::build(office), effort);
    };
    robust_equals_path_in_the_modern_hall => |test, effort| {
        let Some(description) = assets::modern_hall() else { return };
        // Some of its triangles have no area, which is a warning.
        let scene = ReferenceScene::new(scenes::resized(description, scenes::SIZE, scenes::SIZE)).unwrap();
        equal_on(test, scene, effort);
    };
}

/// The other two partitions, final gathering, and fewer shadow rays change no expectation.
#[test]
fn variants_equal_path() {
    let truth = by_path("variants", scenes::build(scenes::studio()), Effort::QUICK);
    for partition in [PartitionName::Balance, PartitionName::Distance] {
        truth.equals(&format!("{partition:?}"), &robust(10.0, partition, true));
    }
    let with = |change: fn(&mut LightPathSettings)| {
        let mut settings = robust(10.0, PartitionName::Hard, true);
        change(&mut settings.light_paths);
        settings
    };
    truth.equals("sampled", &with(|l| l.shadow_rays = ShadowRays::Sampled { count: 3 }));
    truth.equals("one shadow ray", &with(|l| l.shadow_rays = ShadowRays::Sampled { count: 1 }));
    truth.equals("ordered", &with(|l| l.shadow_rays = ShadowRays::Ordered { tolerance: 0.2, remainder: 1 }));
    truth.equals("ordered, all", &with(|l| l.shadow_rays = ShadowRays::Ordered { tolerance: 0.0, remainder: 1 }));
    truth.equals("geometry term alone", &with(|l| l.geometry_alone = true));
    truth.equals("final gathering", &with(|l| l.gather = 3));
}

/// What is lost in corners, and behind glass, is found missing.
#[test]
fn planted_bugs_are_rejected() {
    let truth = by_path("planted", scenes::build(scenes::cornell_box()), Effort::QUICK);
    let dropped = |threshold, partition| RenderSettings {
        estimator: EstimatorName::InstantRadiosity,
        ..robust(threshold, partition, true)
    };
    truth.rejects("clamped", &dropped(3.0, PartitionName::Soft));
    truth.rejects("attenuated", &dropped(3.0, PartitionName::Balance));
    truth.rejects("distance alone", &dropped(3.0, PartitionName::Distance));
    truth.rejects("geometry term alone", &dropped(3.0, PartitionName::Hard));
    truth.rejects("one segment less", &RenderSettings { max_depth: 4, ..robust(10.0, PartitionName::Hard, true) });
    // Without a threshold nothing is lost: instant radiosity is right where nothing is specular.
    truth.equals("instant radiosity", &dropped(f32::INFINITY, PartitionName::Hard));

    // Rays that end at the partition's reach miss the glass behind.
    let truth = by_path("planted in glass", scenes::build(scenes::glass_ball()), Effort::QUICK);
    let settings = robust(1000.0, PartitionName::Hard, true);
    let scene = AllDiffuse(scenes::build(scenes::glass_ball()));
    let wrong = means_of("rays too short", truth.effort, |seed| {
        let RenderSettings { max_depth, light_paths, rr_depth, .. } = &settings;
        let eye = RobustIgi {
            max_depth: *max_depth,
            roulette: RussianRoulette::PathThroughput { from_length: rr_depth - 1 },
            ..light_paths.robust(&scene, Residual::Scatter).unwrap()
        };
        let light = LightTracing {
            choice: PowerChoice::new(scene.emitters()),
            max_length: max_depth - 2,
            roulette: RussianRoulette::LocalAlbedo { from_length: 0 },
        };
        let estimator = VirtualLights { eye, light, paths: light_paths.light_paths, caustics: None };
        let camera = Shared { estimator, sharing: light_paths.sharing() };
        render_by(&scene, &camera, &OwenSobol::new(seed), truth.effort.samples)
    });
    println!("{}", truth.means.agrees_with(SUITE.twin("rays too short"), &wrong).expect_reject());
}

fn render(scene: &ReferenceScene, settings: &RenderSettings, threads: usize) -> Rendering {
    let settings = RenderSettings { threads, budget: Budget::Samples(4), ..settings.clone() };
    estimate(scene, &settings, |_| ControlFlow::Continue(())).unwrap()
}

#[test]
fn images_do_not_depend_on_threads() {
    let scene = scenes::build(scenes::studio());
    for interleaved in [true, false] {
        let settings = robust(10.0, PartitionName::Hard, interleaved);
        let (one, three) = (render(&scene, &settings, 1), render(&scene, &settings, 3));
        assert_eq!(one.film, three.film);
        assert_eq!(one.rays, three.rays);
    }
}

/// Metres or millimetres: with the normalised threshold the same image and the same rays; the absolute one costs something else.
#[test]
fn cost_does_not_depend_on_the_unit() {
    let metres = scenes::build(scenes::cornell_box());
    // A power of two: round-off scales along.
    let scaled = scenes::build(scenes::scaled(scenes::cornell_box(), 1024.0));
    for interleaved in [true, false] {
        let settings = robust(10.0, PartitionName::Hard, interleaved);
        let (a, b) = (render(&metres, &settings, 1), render(&scaled, &settings, 1));
        assert_eq!(a.rays, b.rays);
        let (a, b) = (a.film.develop(0), b.film.develop(0));
        for (a, b) in a.rgb().unwrap().iter().flatten().zip(b.rgb().unwrap().iter().flatten()) {
            assert!((a - b).abs() <= 1e-4 * a.abs().max(1e-3), "{a} {b}");
        }
        let mut absolute = settings;
        absolute.light_paths.threshold = Some(Threshold::Absolute(10.0));
        assert_ne!(render(&metres, &absolute, 1).rays, render(&scaled, &absolute, 1).rays);
    }
}

/// Rays of the limits: path tracing asks for no visibility, instant radiosity scatters nothing.
#[test]
fn limits_trace_what_they_must() {
    let scene = scenes::build(scenes::cornell_box());
    let pixels = u64::from(scenes::SIZE) * u64::from(scenes::SIZE) * 4;
    let path = render(&scene, &robust(0.0, PartitionName::Hard, true), 1);
    assert_eq!(path.rays.visibility, 0);
    let radiosity = render(&scene, &robust(f32::INFINITY, PartitionName::Hard, true), 1);
    let light_rays = 4 * 9 * 4 * 3;
    assert!(radiosity.rays.visibility > 0);
    assert!(radiosity.rays.closest_hit <= pixels + light_rays, "{:?}", radiosity.rays);
}
