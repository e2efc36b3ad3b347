//! The laws of `vpl-gi`'s traits, on what the renderers implement them with.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use estimator_checks::laws::paths::{
    CausticLaws, caustic_by_brute_force, check_connection_tests, check_path_heuristic,
};
use estimator_checks::{Check, Report, Suite};
use lichtwerk::choices::{AnyHeuristic, AnyPathHeuristic};
use lichtwerk::estimators::{
    PhotonCaustics, PhotonTracing, PhotonView, ResampledConnections, Sharpness, Storing, Unguided,
};
use lichtwerk::render::PassContext;
use lichtwerk_tests::scenes;
use photon_map::{CausticRule, DensityEstimation, Gather, KeepAll, Kernel, MapPartition, PhotonMaps};
use qmc_sampling::{Independent, Sampler, SamplerFamily};
use scene_core::builtin::SceneBuilder;
use scene_core::film::Filter;
use scene_core::glam::Vec3A;
use scene_core::material::Material;
use scene_core::{PowerChoice, Ray, ReferenceScene, Rgb, RussianRoulette, Scene, Vertex};
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

const DEPTH: u32 = 6;

/// A glass ball between a large lamp and the floor.
fn caustic() -> ReferenceScene {
    let mut b = SceneBuilder::new("caustic");
    let ground = b.diffuse(0.6, 0.5, 0.4);
    b.quad(ground, Vec3A::new(-3.0, 0.0, -3.0), Vec3A::Z * 6.0, Vec3A::X * 6.0);
    let glass = b.material(Material::glass(1.5));
    b.sphere(glass, Vec3A::new(0.0, 0.8, 0.0), 0.6);
    let lamp = b.diffuse(0.0, 0.0, 0.0);
    b.sphere(lamp, Vec3A::new(0.2, 3.2, 0.0), 1.2).emit(Rgb::new(8.0, 6.0, 4.0));
    b.look(Vec3A::new(0.0, 2.0, 3.5), Vec3A::new(0.0, 0.0, 0.2), 45.0, 8, 8);
    scenes::build(b.finish())
}

/// Photons of the caustic alone, or all that arrive.
fn photon_map(scene: &ReferenceScene, seed: u64, all: bool) -> PhotonCaustics {
    const PATHS: u64 = 100_000;
    let context = PassContext { scene, samplers: &Independent::new(seed), filter: Filter::BOX };
    let partition = MapPartition::one_number(1.0).unwrap();
    let storing = Storing { partition, deposition: KeepAll, primary: all, global: all };
    let tracing = PhotonTracing {
        choice: PowerChoice::new(scene.emitters()),
        max_length: DEPTH,
        roulette: RussianRoulette::Never,
        sharpness: Sharpness { rule: CausticRule::SPECULAR },
        guidance: Unguided,
    };
    let mut maps = PhotonMaps::new();
    storing.trace(&context, &tracing, 0, 0..PATHS, &mut maps);
    let mut photons = maps.caustic;
    if all {
        photons.append(maps.global);
    }
    photons.add_paths(PATHS);
    let estimation = DensityEstimation { gather: Gather::within(0.1).unwrap(), kernel: Kernel::Epanechnikov };
    PhotonCaustics(PhotonView::new(photons, estimation))
}

#[test]
fn photons_are_the_caustic() {
    let scene = caustic();
    let run = |check: Check, x: f32, all: bool| -> Report {
        let x = scene.intersect(&Ray::new(Vec3A::new(x, 0.1, 0.05), -Vec3A::Y)).unwrap();
        let truth = |numbers: &mut _| caustic_by_brute_force(&scene, &x, DEPTH, numbers);
        let laws = CausticLaws::new().maps(32).samples(200_000).bias(0.03);
        laws.run(check, &x, |seed| photon_map(&scene, seed, all), truth)
    };
    println!("{}", run(SUITE.check("caustic photons"), 0.05, false).expect_pass());
    // Beside the ball, where the lamp is seen.
    run(SUITE.twin("all photons"), 1.5, true).expect_reject();

    let ball = scene.intersect(&Ray::new(Vec3A::new(0.0, 1.8, 0.0), -Vec3A::Y)).unwrap();
    assert!(!ball.is_connectible());
    let map = photon_map(&scene, 1, true);
    let nothing = CausticLaws::new().maps(1);
    nothing.run(SUITE.twin("on the ball"), &ball, |_| PhotonCaustics(map.0.clone()), |_| Rgb::splat(1.0)).expect_pass();
}
