//! Direct light with lights selected by photons equals path tracing, whatever the photons found, as long as other lights get a ray.
//!
//! The long forms: `cargo test --release --workspace -- --ignored`.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::ops::ControlFlow;

use estimator_checks::Suite;
use lichtwerk::choices::LightSelection;
use lichtwerk::estimators::{DirectLight, FirstEvent, OwnSampling, PathTracer, PhotonLights, Scattered};
use lichtwerk::light_photons::{AllocationName, ImportanceName, LightPhotonSettings};
use lichtwerk::program::{EstimatorName, RenderSettings, SamplerName, estimate};
use lichtwerk::render::{Budget, Rendering};
use lichtwerk::resampling::{ResamplingSettings, ScatteringName};
use lichtwerk_tests::{Effort, Truth, block_means, both_forms, means_of, render_by, scenes};
use qmc_sampling::{Independent, Sampler};
use scene_core::{EmitterId, Ray, ReferenceScene, RussianRoulette, Scene, SceneDescription, SurfacePoint, builtin};

/// Quick and long forms count: both may run.
static SUITE: Suite = Suite::with_share("workspace photon lights", 80, 2e-8);

fn direct() -> RenderSettings {
    RenderSettings { estimator: EstimatorName::Direct, max_depth: 2, ..RenderSettings::new(Budget::Samples(0)) }
}

fn path() -> RenderSettings {
    RenderSettings { max_depth: 5, ..RenderSettings::new(Budget::Samples(0)) }
}

/// With lights selected by photons.
fn by_photons(light_photons: LightPhotonSettings, settings: RenderSettings) -> RenderSettings {
    RenderSettings { lights: LightSelection::Photons, light_photons, ..settings }
}

/// Nine rooms with a lamp each, seen from the one in the middle.
fn rooms() -> SceneDescription {
    scenes::resized(builtin::rooms(3, 3), scenes::SIZE, scenes::SIZE)
}

/// Ways to choose, from few photons and rays to many.
fn choices() -> [(&'static str, LightPhotonSettings); 6] {
    let default = LightPhotonSettings::default;
    [
        ("as it comes", default()),
        (
            "few photons, one ray each",
            LightPhotonSettings { light_photons: Some(60), light_nearest: Some(2), ..default() },
        ),
        ("one photon, two rays to others", LightPhotonSettings { light_photons: Some(1), other_rays: 2, ..default() }),
        (
            "many rays by the nearest photons",
            LightPhotonSettings {
                light_nearest: Some(32),
                contributing_rays: 7,
                other_rays: 3,
                light_importance: ImportanceName::Photons,
                ..default()
            },
        ),
        (
            "two rays by power, a fixed radius",
            LightPhotonSettings {
                light_photons: Some(500),
                light_nearest: None,
                light_radius: Some(0.4),
                contributing_rays: 2,
                light_importance: ImportanceName::Power,
                light_allocation: AllocationName::Proportional,
                ..default()
            },
        ),
        (
            "all photons in a large radius",
            LightPhotonSettings {
                light_photons: Some(500),
                light_nearest: None,
                light_radius: Some(20.0),
                light_allocation: AllocationName::Proportional,
                ..default()
            },
        ),
    ]
}

fn direct_light(test: &str, description: SceneDescription, effort: Effort) {
    let truth = Truth::new(&SUITE, test, scenes::build(description), &direct(), effort);
    for (what, light_photons) in choices() {
        truth.equals(what, &by_photons(light_photons, direct()));
    }
}

fn whole_paths(test: &str, description: SceneDescription, effort: Effort) {
    let truth = Truth::new(&SUITE, test, scenes::build(description), &path(), effort);
    let [(default, as_it_comes), (few, few_photons), ..] = choices();
    truth.equals(default, &by_photons(as_it_comes.clone(), path()));
    truth.equals(few, &by_photons(few_photons, path()));
    let resampling = ResamplingSettings {
        bsdf_sampling: ScatteringName::Ris,
        bsdf_candidates: 4.5,
        ..ResamplingSettings::default()
    };
    truth.equals("with resampled directions", &by_photons(as_it_comes, RenderSettings { resampling, ..path() }));
}

both_forms! {
    direct_light_in_rooms => |test, effort| direct_light(test, rooms(), effort);
    direct_light_of_points => |test, effort| direct_light(test, scenes::delta_lights(), effort);
    direct_light_of_an_environment => |test, effort| direct_light(test, scenes::environment_map(), effort);
    direct_light_of_all_kinds => |test, effort| direct_light(test, scenes::studio(), effort);
    whole_paths_in_rooms => |test, effort| whole_paths(test, rooms(), effort);
    whole_paths_in_the_studio => |test, effort| whole_paths(test, scenes::studio(), effort);
    whole_paths_through_glass => |test, effort| whole_paths(test, scenes::glass_ball(), effort);
}

#[test]
fn without_rays_to_others_light_that_photons_missed_is_lost() {
    let few = LightPhotonSettings {
        light_photons: Some(60),
        light_nearest: Some(2),
        other_rays: 0,
        ..LightPhotonSettings::default()
    };
    for (test, description) in [("no other rays in rooms", rooms()), ("no other rays in the studio", scenes::studio())]
    {
        let truth = Truth::new(&SUITE, test, scenes::build(description), &direct(), Effort::QUICK);
        let means =
            block_means(&format!("{test}: biased"), &truth.scene, &by_photons(few.clone(), direct()), truth.effort);
        println!("{}", truth.means.agrees_with(SUITE.twin(test), &means).expect_reject());
    }
}

/// A planted bug: light that scattering finds counts a second time.
struct CountsTwice(PhotonLights);

impl DirectLight for CountsTwice {
    fn sample<S: Scene>(
        &self,
        scene: &S,
        vertex: &S::Vertex<'_>,
        length: u32,
        wanted: bool,
        sampler: &mut impl Sampler,
    ) -> S::Spectrum {
        self.0.sample(scene, vertex, length, wanted, sampler)
    }

    fn scattering_weight<S: Scene>(
        &self,
        _: &S,
        _: Scattered<'_>,
        _: &Ray,
        _: EmitterId,
        _: Option<&SurfacePoint>,
    ) -> f32 {
        1.0
    }
}

#[test]
fn counting_light_twice_is_rejected() {
    let test = "light that scattering finds counts twice";
    let truth = Truth::new(&SUITE, test, scenes::build(rooms()), &direct(), Effort::QUICK);
    let scene = &truth.scene;
    let settings = LightPhotonSettings::default();
    let photons = PhotonLights::trace(scene, &Independent::new(0), &settings).unwrap().unwrap();
    let camera = PathTracer {
        direct: CountsTwice(photons),
        scattering: OwnSampling,
        max_depth: 2,
        roulette: RussianRoulette::Never,
        first_event: FirstEvent::Any,
    };
    let render = |seed| render_by(scene, &camera, &Independent::new(seed), Effort::QUICK.samples);
    let means = means_of(test, Effort::QUICK, render);
    println!("{}", truth.means.agrees_with(SUITE.twin(test), &means).expect_reject());
}

fn render(scene: &ReferenceScene, settings: &RenderSettings, threads: usize) -> Rendering {
    let settings = RenderSettings { threads, budget: Budget::Samples(3), ..settings.clone() };
    estimate(scene, &settings, |_| ControlFlow::Continue(())).unwrap()
}

#[test]
fn images_do_not_depend_on_the_number_of_threads() {
    // Several tasks of photons, several tiles.
    let scene = scenes::build(scenes::resized(builtin::rooms(3, 3), 40, 35));
    for &sampler in SamplerName::all() {
        for settings in [direct(), path()] {
            let settings = by_photons(LightPhotonSettings::default(), RenderSettings { sampler, ..settings });
            let serial = render(&scene, &settings, 1);
            for threads in [2, 5] {
                let parallel = render(&scene, &settings, threads);
                assert!(serial.film == parallel.film, "{sampler:?}, {threads} threads");
                assert_eq!(serial.rays, parallel.rays);
            }
        }
    }
}

#[test]
fn shadow_rays_are_as_many_whatever_the_number_of_lights() {
    for size in [2, 40] {
        let scene = scenes::build(scenes::resized(builtin::rooms(size, size), 24, 24));
        let rays = |contributing_rays: u32, other_rays: u32| {
            let light_photons = LightPhotonSettings { contributing_rays, other_rays, ..LightPhotonSettings::default() };
            render(&scene, &by_photons(light_photons, direct()), 0).rays.visibility
        };
        let vertices = 3 * 24 * 24;
        for (contributing, other) in [(1, 0), (1, 1), (5, 2)] {
            let (count, most) = (rays(contributing, other), vertices * u64::from(contributing + other));
            assert!(count > most / 3 && count <= most, "{size}: {contributing}, {other}: {count}");
        }
    }
}

#[test]
fn photons_count_among_the_rays_and_the_seconds() {
    let scene = scenes::build(rooms());
    let light_photons = LightPhotonSettings { light_photons: Some(50_000), ..LightPhotonSettings::default() };
    let rendering = render(&scene, &by_photons(light_photons, direct()), 0);
    // All start at lamps.
    assert!(rendering.rays.closest_hit >= 50_000 + 3 * 24 * 24);
    assert!(rendering.preparation_seconds > 0.0 && rendering.preparation_seconds < rendering.seconds);
    assert_eq!(render(&scene, &direct(), 0).preparation_seconds, 0.0);
}

#[test]
fn nothing_comes_of_no_lights_and_of_settings_out_of_range() {
    let scene = scenes::build(scenes::below_a_ceiling());
    let trace = |scene: &ReferenceScene, settings: &LightPhotonSettings| {
        PhotonLights::trace(scene, &Independent::new(0), settings)
    };
    assert!(trace(&scene, &LightPhotonSettings::default()).unwrap().is_none());
    let dark = render(&scene, &by_photons(LightPhotonSettings::default(), direct()), 1);
    assert!(dark.film.develop(0).rgb().unwrap().iter().flatten().all(|value| *value == 0.0));
    let scene = scenes::build(rooms());
    for settings in [
        LightPhotonSettings { light_radius: Some(f32::NAN), ..LightPhotonSettings::default() },
        LightPhotonSettings { light_radius: Some(0.0), light_nearest: None, ..LightPhotonSettings::default() },
        LightPhotonSettings { light_nearest: Some(1), ..LightPhotonSettings::default() },
        LightPhotonSettings { contributing_rays: 0, ..LightPhotonSettings::default() },
    ] {
        assert!(trace(&scene, &settings).is_err(), "{settings:?}");
    }
}
