//! Photon maps: progressive passes converge as theory says, one pair of maps is as far from path tracing as its radius
//! allows, and which photons are kept changes no expectation.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::ops::{ControlFlow, Range};

use estimator_checks::{BatchMeans, Moments, Suite, Truth, slope_is};
use lichtwerk::distributed::Ranks;
use lichtwerk::estimators::{
    DirectLight, GuideScratch, ImportonGuidance, Maps, NextEvent, PathGuidance, PhotonMapping, PhotonView,
    ProgressivePhotons, Sharpness, Storing,
};
use lichtwerk::light_paths::LightPathSettings;
use lichtwerk::photons::{DepositionName, GuideName, PartitionVariant, PathLimits, PhotonSettings, Radius};
use lichtwerk::program::{EstimatorName, RenderSettings, estimate};
use lichtwerk::render::{Budget, CameraPass, PassContext, PassCounts, Rendering};
use lichtwerk::samplers::SamplerName;
use lichtwerk_tests::{Effort, block_means, means_of, render_by, scenes};
use mis_heuristics::Power;
use photon_map::{
    CausticRule, DensityEstimation, Gather, KeepAll, Kernel, MapPartition, PhotonMaps, ProgressiveRadius,
};
use qmc_sampling::{Independent, Sampler, SamplerFamily};
use scene_core::builtin::SceneBuilder;
use scene_core::film::{Film, FilmError};
use scene_core::glam::Vec3A;
use scene_core::material::Material;
use scene_core::{
    Emitter, EmitterChoice, Onward, PowerChoice, Ray, ReferenceScene, Rgb, RussianRoulette, Scene, SceneDescription,
    Spectrum, Vertex,
};

static SUITE: Suite = Suite::with_share("workspace photon maps", 24, 2e-8);

const MAX_DEPTH: u32 = 6;

fn path() -> RenderSettings {
    RenderSettings { max_depth: MAX_DEPTH, ..RenderSettings::new(Budget::Samples(0)) }
}

/// A radius large enough for few photons, small beside what the blocks of pixels show.
fn photons() -> PhotonSettings {
    PhotonSettings {
        photons: 20_000,
        photon_radius: Radius::Relative(0.03),
        caustic_radius: Radius::Relative(0.02),
        gather_rays: 2,
        ..PhotonSettings::default()
    }
}

fn mapped(photons: PhotonSettings) -> RenderSettings {
    RenderSettings { estimator: EstimatorName::PhotonMap, photons, ..path() }
}

/// Maps do not get better with more samples: more batches instead.
const EFFORT: Effort = Effort { samples: 8, batches: 32, block: 6 };

// --- Convergence -----------------------------------------------------------------------------------------------------

/// Width and height of the images of the caustic.
const SIDE: u32 = 16;

/// A glass ball below a small lamp, and the middle of its caustic on the floor, seen from below the ball: all light
/// that is not direct.
fn caustic() -> ReferenceScene {
    let mut b = SceneBuilder::new("caustic");
    let ground = b.diffuse(0.6, 0.6, 0.6);
    b.quad(ground, Vec3A::new(-4.0, 0.0, -4.0), Vec3A::Z * 8.0, Vec3A::X * 8.0);
    let glass = b.material(Material::glass(1.5));
    b.sphere(glass, Vec3A::new(0.0, 1.7, 0.0), 0.6);
    let lamp = b.diffuse(0.0, 0.0, 0.0);
    b.quad(lamp, Vec3A::new(-0.15, 4.0, -0.15), Vec3A::X * 0.3, Vec3A::Z * 0.3).emit(Rgb::splat(60.0));
    b.look(Vec3A::new(0.0, 0.95, 0.02), Vec3A::ZERO, 55.0, SIDE, SIDE);
    scenes::build(b.finish())
}

/// Leaves direct light out.
#[derive(Clone, Copy)]
struct NoDirectLight;

impl DirectLight for NoDirectLight {
    fn sample<S: Scene>(&self, _: &S, _: &S::Vertex<'_>, _: u32, _: bool, _: &mut impl Sampler) -> S::Spectrum {
        S::Spectrum::ZERO
    }
}

fn limits() -> PathLimits {
    PathLimits { max_depth: MAX_DEPTH, roulette: RussianRoulette::PathThroughput { from_length: 4 } }
}

const FIRST_RADIUS: f32 = 0.16;
const ALPHA: f64 = 2.0 / 3.0;

type Progressive = ProgressivePhotons<NoDirectLight, PowerChoice>;

fn progressive(scene: &ReferenceScene, paths: u64) -> Progressive {
    let settings = PhotonSettings { photons: paths, photon_radius: Radius::Absolute(FIRST_RADIUS), ..photons() };
    settings.progressive(scene, NoDirectLight, PowerChoice::new(scene.emitters()), limits()).unwrap()
}

/// Independent numbers: the laws of variance are theirs.
fn render(scene: &ReferenceScene, camera: &impl CameraPass, passes: u64, seed: u64) -> Rendering {
    render_by(scene, camera, &Independent::new(seed), passes)
}

fn pixels(rendering: &Rendering) -> Vec<f64> {
    rendering.film.develop(rendering.light_paths).rgb().unwrap().iter().map(|rgb| f64::from(rgb[1])).collect()
}

/// The middle of the caustic.
fn middle(pixels: &[f64]) -> f64 {
    let side = SIDE as usize;
    let inside = |i: usize| (side / 2 - 2..side / 2 + 2).contains(&i);
    let chosen: Vec<f64> =
        (0..side * side).filter(|i| inside(i % side) && inside(i / side)).map(|i| pixels[i]).collect();
    chosen.iter().sum::<f64>() / chosen.len() as f64
}

/// The squared radii of the passes, in units of the first one.
fn squared_radii(passes: u64) -> Vec<f64> {
    let mut radius = ProgressiveRadius::new(1.0, ALPHA).unwrap();
    let next = |_| {
        let squared = radius.radius_squared();
        radius.advance();
        squared
    };
    (0..passes).map(next).collect()
}

/// Numbers of passes; twice each.
const PASSES: [u64; 20] = [1, 1, 2, 2, 3, 3, 4, 4, 6, 6, 8, 8, 11, 11, 16, 16, 22, 22, 32, 32];

/// Variance of the pixels over seeds, over what theory says: `1/n^2 sum 1/r_i^2`.
fn variances(name: &str, scene: &ReferenceScene, camera: &impl CameraPass) -> Vec<(f64, f64)> {
    let mut seed = estimator_checks::seed(name);
    let mut variance = |passes: u64| {
        let mut moments = vec![Moments::new(); (SIDE * SIDE) as usize];
        for _ in 0..60 {
            seed = seed.wrapping_add(1);
            let values = pixels(&render(scene, camera, passes, seed));
            moments.iter_mut().zip(values).for_each(|(pixel, value)| pixel.push(value));
        }
        let theory = squared_radii(passes).iter().map(|r2| 1.0 / r2).sum::<f64>() / (passes * passes) as f64;
        (passes as f64, moments.iter().map(Moments::variance).sum::<f64>() / theory)
    };
    PASSES.map(&mut variance).to_vec()
}

/// Bias of the middle of the caustic, over what theory says: `1/n sum r_i^2`.
fn biases(name: &str, scene: &ReferenceScene, camera: &impl CameraPass, truth: f64) -> Vec<(f64, f64)> {
    let mut seed = estimator_checks::seed(name);
    let mut bias = |passes: u64| {
        let replicates = 64 / passes;
        let mut mean = 0.0;
        for _ in 0..replicates {
            seed = seed.wrapping_add(1);
            mean += middle(&pixels(&render(scene, camera, passes, seed))) / replicates as f64;
        }
        let theory = squared_radii(passes).iter().sum::<f64>() / passes as f64;
        (passes as f64, (truth - mean).abs() / theory)
    };
    PASSES.map(&mut bias).to_vec()
}

/// What the laws leave out: densities are not the same within all radii, and bias has terms beyond the leading order.
const VARIANCE_SLOPE: Truth = Truth { value: 0.0, error: 0.02 };
const BIAS_SLOPE: Truth = Truth { value: 0.0, error: 0.06 };

/// Slopes `-alpha` of the variance and `alpha - 1` of the bias, divided out exactly for finitely many passes.
#[test]
fn variance_of_progressive_passes_falls_as_theory_says() {
    let scene = caustic();
    let points = variances("variance", &scene, &progressive(&scene, 300));
    println!("{}", slope_is(SUITE.check("variance"), &points, VARIANCE_SLOPE).expect_pass());
    // A radius that stays has a variance of 1/n.
    let points = variances("fixed radius", &scene, &FixedRadius(progressive(&scene, 300)));
    println!("{}", slope_is(SUITE.twin("fixed radius"), &points, VARIANCE_SLOPE).expect_reject());
}

#[test]
fn bias_of_progressive_passes_falls_as_theory_says() {
    let scene = caustic();
    // Light tracing without direct light.
    let light = |max_depth, samples| {
        let settings = RenderSettings { estimator: EstimatorName::Light, max_depth, ..path() };
        let settings = RenderSettings { budget: Budget::Samples(samples), threads: 0, ..settings };
        let seed = estimator_checks::seed("bias, light tracing");
        let rendering = estimate(&scene, &RenderSettings { seed, ..settings }, |_| ControlFlow::Continue(()));
        middle(&pixels(&rendering.unwrap()))
    };
    let truth = light(MAX_DEPTH, 16_384) - light(2, 16_384);
    let points = biases("bias", &scene, &progressive(&scene, 4000), truth);
    println!("truth {truth}, bias over theory {points:?}");
    println!("{}", slope_is(SUITE.check("bias"), &points, BIAS_SLOPE).expect_pass());
    let points = biases("bias, fixed", &scene, &FixedRadius(progressive(&scene, 4000)), truth);
    println!("{}", slope_is(SUITE.twin("fixed radius, bias"), &points, BIAS_SLOPE).expect_reject());
    let points = biases("bias, all paths", &scene, &CountsAllPaths(progressive(&scene, 4000)), truth);
    println!("{}", slope_is(SUITE.twin("all paths, bias"), &points, BIAS_SLOPE).expect_reject());
}

/// Makes maps by hand, as progressive passes do, with what can go wrong there.
fn pass_with<S: Scene + Sync, F: SamplerFamily, D: DirectLight, C: EmitterChoice + Sync>(
    camera: &ProgressivePhotons<D, C>,
    context: &PassContext<'_, S, F>,
    film: &mut Film,
    index: u64,
    radius: f32,
    counted: u64,
) -> PassCounts {
    let partition = MapPartition::one_number(1.0).unwrap();
    let storing = Storing { partition, deposition: KeepAll, primary: false, global: true };
    let mut photons = PhotonMaps::new();
    let first = index * camera.paths;
    let mut rays = storing.trace(context, &camera.light, first, first..first + camera.paths, &mut photons);
    let mut all = photons.global;
    all.append(photons.caustic);
    all.add_paths(counted);
    let estimation = DensityEstimation { gather: Gather::within(radius).unwrap(), kernel: Kernel::Epanechnikov };
    let maps = Maps { global: PhotonView::new(all, estimation), caustic: None };
    rays += context.add_all(film, index..index + 1, |scene, scratch, ray, sampler| {
        camera.eye.trace(scene, &maps, scratch, ray, sampler, &mut ())
    });
    PassCounts { rays, light_paths: 0 }
}

/// The radius never shrinks.
struct FixedRadius<P>(P);

impl<D: DirectLight, C: EmitterChoice + Sync> CameraPass for FixedRadius<ProgressivePhotons<D, C>> {
    fn add_samples<S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'_, S, F>,
        film: &mut Film,
        samples: Range<u64>,
    ) -> Result<PassCounts, FilmError> {
        let radius = self.0.radius.radius();
        let rays = samples.map(|index| pass_with(&self.0, context, film, index, radius, self.0.paths).rays).sum();
        Ok(PassCounts { rays, light_paths: 0 })
    }
}

/// From the second pass on flux is divided by the paths of all passes so far, though the photons are those of one.
struct CountsAllPaths<P>(P);

impl<D: DirectLight, C: EmitterChoice + Sync> CameraPass for CountsAllPaths<ProgressivePhotons<D, C>> {
    fn add_samples<S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'_, S, F>,
        film: &mut Film,
        samples: Range<u64>,
    ) -> Result<PassCounts, FilmError> {
        let mut radius = self.0.radius;
        let mut rays = scene_core::RayCounts::default();
        (0..samples.start).for_each(|_| radius.advance());
        for index in samples {
            rays += pass_with(&self.0, context, film, index, radius.radius(), self.0.paths * (index + 1)).rays;
            radius.advance();
        }
        Ok(PassCounts { rays, light_paths: 0 })
    }
}

/// The whole of it, direct light included, where light comes through a pane and a ball of glass.
#[test]
fn progressive_passes_converge_to_path_tracing() {
    let scene = scenes::build(scenes::glass_ball());
    let sppm = PhotonSettings { photons: 2000, photon_radius: Radius::Relative(0.04), ..photons() };
    let settings = RenderSettings { estimator: EstimatorName::Sppm, photons: sppm.clone(), ..path() };
    let effort = Effort { samples: 48, ..EFFORT };
    let truth = truth("progressive", &scene).allowance(0.05);
    let means = block_means("sppm", &scene, &settings, effort);
    println!("{}", truth.agrees_with(SUITE.check("progressive"), &means).expect_pass());
    let choice = || PowerChoice::new(scene.emitters());
    let direct = NextEvent { heuristic: Power::TWO, choice: choice() };
    let wrong = CountsAllPaths(sppm.progressive(&scene, direct, choice(), limits()).unwrap());
    let means = means_of("all paths", effort, |seed| render(&scene, &wrong, effort.samples, seed));
    println!("{}", truth.agrees_with(SUITE.twin("all paths"), &means).expect_reject());
}

// --- One pair of maps ------------------------------------------------------------------------------------------------

fn truth(test: &str, scene: &ReferenceScene) -> BatchMeans {
    block_means(&format!("{test}: path"), scene, &path(), Effort { samples: 128, ..EFFORT })
}

/// Final gathering sees the bias of the maps averaged over its rays: a few percent of a block.
fn gathered_equals_path(test: &str, description: SceneDescription) {
    let scene = scenes::build(description);
    let means = block_means(test, &scene, &mapped(photons()), EFFORT);
    println!("{}", truth(test, &scene).allowance(0.04).agrees_with(SUITE.check(test), &means).expect_pass());
}

#[test]
fn gathered_photons_equal_path_in_the_cornell_box() {
    gathered_equals_path("cornell box", scenes::cornell_box());
}

#[test]
fn gathered_photons_equal_path_on_rough_materials() {
    gathered_equals_path("rough materials", scenes::rough_materials());
}

#[test]
fn gathered_photons_equal_path_through_glass() {
    gathered_equals_path("glass", scenes::glass_ball());
}

#[test]
fn gathered_photons_equal_path_from_delta_lights() {
    gathered_equals_path("delta lights", scenes::delta_lights());
}

/// What is sharp to the eye and not to the light is counted twice; caustics that are thrown away are missing.
#[test]
fn planted_bugs_are_rejected() {
    let scene = scenes::build(scenes::rough_materials());
    let choice = || PowerChoice::new(scene.emitters());
    let direct = NextEvent { heuristic: Power::TWO, choice: choice() };
    let mapping = |photons: &PhotonSettings| photons.mapping(&scene, direct.clone(), choice(), limits()).unwrap();
    let wide = PhotonSettings { caustic_roughness: 0.4, ..photons() };
    let confused = |seed| {
        let mut camera: PhotonMapping<_, _> = mapping(&wide);
        camera.light.sharpness = Sharpness { rule: CausticRule::SPECULAR };
        render(&scene, &camera, EFFORT.samples, seed)
    };
    let truth = truth("planted", &scene).allowance(0.04);
    let right = means_of("wide", EFFORT, |seed| render(&scene, &mapping(&wide), EFFORT.samples, seed));
    println!("{}", truth.agrees_with(SUITE.check("wide"), &right).expect_pass());
    let wrong = means_of("confused", Effort { batches: 80, ..EFFORT }, confused);
    println!("{}", truth.agrees_with(SUITE.twin("confused"), &wrong).expect_reject());
}

/// Within a fixed radius estimates are linear in the photons: which ones are kept changes no expectation, and the bias
/// is the same.
#[test]
fn what_is_kept_changes_no_expectation() {
    let scene = scenes::build(scenes::glass_ball());
    let means = |what: &str, photons: PhotonSettings| {
        block_means(&format!("kept: {what}"), &scene, &mapped(PhotonSettings { gather_rays: 0, ..photons }), EFFORT)
    };
    let all = means("all", photons());
    for (name, partition_variant) in [
        ("one number", PartitionVariant::OneNumber),
        ("two numbers", PartitionVariant::TwoNumbers),
        ("trajectories", PartitionVariant::Trajectories),
    ] {
        let split = PhotonSettings { partition_variant, global_ratio: 0.2, ..photons() };
        println!("{}", all.agrees_with(SUITE.check(name), &means(name, split)).expect_pass());
    }
    let importance = PhotonSettings { deposition: DepositionName::Importance, importons: 4000, ..photons() };
    println!("{}", all.agrees_with(SUITE.check("importance"), &means("importance", importance.clone())).expect_pass());
    let cutoff = PhotonSettings {
        deposition_cutoff: true,
        deposition_floor: 0.5,
        importons: 300,
        importon_radius: Radius::Relative(0.01),
        ..importance
    };
    println!("{}", all.agrees_with(SUITE.twin("cutoff"), &means("cutoff", cutoff)).expect_reject());
}

/// A corner of a room with a lamp, and far away another one of the kind, which sees nothing of it.
fn corner() -> ReferenceScene {
    let mut b = SceneBuilder::new("corner");
    let (grey, red, dark) = (b.diffuse(0.7, 0.7, 0.7), b.diffuse(0.7, 0.3, 0.2), b.diffuse(0.0, 0.0, 0.0));
    for x in [0.0, 12.0] {
        let at = |x0: f32, y: f32, z: f32| Vec3A::new(x + x0, y, z);
        b.quad(grey, at(-2.0, 0.0, -2.0), Vec3A::Z * 4.0, Vec3A::X * 4.0);
        b.quad(grey, at(-2.0, 0.0, -2.0), Vec3A::X * 4.0, Vec3A::Y * 4.0);
        b.quad(red, at(-2.0, 0.0, 2.0), Vec3A::Z * -4.0, Vec3A::Y * 4.0);
        b.quad(dark, at(-0.5, 3.5, -0.5), Vec3A::X, Vec3A::Z).emit(Rgb::splat(10.0));
    }
    b.look(Vec3A::new(2.5, 2.5, 4.0), Vec3A::new(-1.0, 0.8, -1.0), 50.0, scenes::SIZE, scenes::SIZE);
    scenes::build(b.finish())
}

/// The same where importons tell light paths where to go: each way alone, together with deposition, and past rough
/// surfaces, coats and lights of all kinds.
#[test]
fn where_light_paths_go_changes_no_expectation() {
    let scene = corner();
    let direct = PhotonSettings {
        gather_rays: 0,
        photon_radius: Radius::Absolute(0.2),
        importons: 4000,
        importon_radius: Radius::Absolute(0.2),
        guide_share: 0.6,
        ..photons()
    };
    let means = |what: &str, photons| block_means(&format!("sent: {what}"), &scene, &mapped(photons), EFFORT);
    let all = means("by nobody", direct.clone());
    let guided = |guide| PhotonSettings { guide, ..direct.clone() };
    let deposited = PhotonSettings { deposition: DepositionName::Importance, ..guided(GuideName::Both) };
    for (name, photons) in [
        ("guided scattering", guided(GuideName::Scattering)),
        ("guided emission", guided(GuideName::Emission)),
        ("guidance and deposition", deposited),
    ] {
        println!("{}", all.agrees_with(SUITE.check(name), &means(name, photons)).expect_pass());
    }
    for (name, forgets) in [("density of scattering", Forgets::Scattering), ("density of emission", Forgets::Emission)]
    {
        let wrong = means_of(name, EFFORT, |seed| {
            let choice = || PowerChoice::new(scene.emitters());
            let direct_light = NextEvent { heuristic: Power::TWO, choice: choice() };
            let mapping = guided(GuideName::Both).mapping(&scene, direct_light, choice(), limits()).unwrap();
            render(&scene, &Forgetful { mapping, forgets }, EFFORT.samples, seed)
        });
        println!("{}", all.agrees_with(SUITE.twin(name), &wrong).expect_reject());
    }
}

#[test]
fn guidance_changes_no_expectation_among_lights_and_materials_of_all_kinds() {
    let scene = scenes::build(scenes::studio());
    let means = |what: &str, guide| {
        let photons = PhotonSettings { guide, importons: 4000, ..photons() };
        block_means(&format!("studio: {what}"), &scene, &mapped(photons), EFFORT)
    };
    let all = means("unguided", GuideName::None);
    println!("{}", all.agrees_with(SUITE.check("studio"), &means("guided", GuideName::Both)).expect_pass());
}

/// What is forgotten where importons choose.
#[derive(Clone, Copy, PartialEq)]
enum Forgets {
    /// The density of the direction that was scattered to.
    Scattering,
    /// That of the emitter and the direction.
    Emission,
}

/// Goes where importons say, with the flux of paths that go by themselves.
struct Forgetting {
    guidance: ImportonGuidance,
    forgets: Forgets,
}

impl PathGuidance for Forgetting {
    type Scratch = GuideScratch;

    fn scratch(&self) -> GuideScratch {
        self.guidance.scratch()
    }

    fn emit<S: Scene>(
        &self,
        scene: &S,
        choice: &impl EmitterChoice,
        scratch: &mut GuideScratch,
        sampler: &mut impl Sampler,
    ) -> Option<(Ray, S::Spectrum)> {
        let (ray, flux) = self.guidance.emit(scene, choice, scratch, sampler)?;
        // What any ray of a diffuse lamp carries whose direction goes by its cosine.
        let power = scene.emitters().iter().fold(S::Spectrum::ZERO, |sum, emitter| sum + emitter.power());
        Some((ray, if self.forgets == Forgets::Emission { power } else { flux }))
    }

    fn scatter<V: Vertex>(
        &self,
        vertex: &V,
        scratch: &mut GuideScratch,
        sampler: &mut impl Sampler,
    ) -> Option<Onward<V::Spectrum>> {
        let mut onward = self.guidance.scatter(vertex, scratch, sampler)?;
        if self.forgets == Forgets::Scattering {
            onward.sample.throughput = onward.own;
        }
        Some(onward)
    }
}

/// Photon mapping with maps of such photons.
struct Forgetful<D, C> {
    mapping: PhotonMapping<D, C>,
    forgets: Forgets,
}

impl<D: DirectLight, C: EmitterChoice + Clone + Sync> CameraPass for Forgetful<D, C> {
    fn add_samples<S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'_, S, F>,
        film: &mut Film,
        samples: Range<u64>,
    ) -> Result<PassCounts, FilmError> {
        let PhotonMapping { light, guidance, partition, paths, global, caustic, .. } = &self.mapping;
        self.mapping.maps.get_or_init(|| {
            let guidance = guidance.unwrap().trace(context, &light.choice, &Ranks::default()).unwrap().0;
            let light = light.clone().guided(Forgetting { guidance, forgets: self.forgets });
            let storing = Storing { partition: *partition, deposition: KeepAll, primary: false, global: true };
            let mut photons = PhotonMaps::new();
            storing.trace(context, &light, 0, 0..*paths, &mut photons);
            photons.add_paths(partition, *paths);
            let caustic = Some(PhotonView::new(photons.caustic, *caustic));
            Maps { global: PhotonView::new(photons.global, *global), caustic }
        });
        self.mapping.add_samples(context, film, samples)
    }
}

// --- The complement of connections -----------------------------------------------------------------------------------

#[test]
fn caustics_complement_robust_igi() {
    let scene = scenes::build(scenes::glass_ball());
    let robust = |caustic_radius| RenderSettings {
        estimator: EstimatorName::RobustIgi,
        photons: PhotonSettings { caustics: true, photons: 4000, caustic_radius, ..photons() },
        light_paths: LightPathSettings { light_paths: 4, ..LightPathSettings::default() },
        ..path()
    };
    let effort = Effort { samples: 16, ..EFFORT };
    let truth = truth("complement", &scene).allowance(0.04);
    let means = block_means("complemented", &scene, &robust(Radius::Relative(0.02)), effort);
    println!("{}", truth.agrees_with(SUITE.check("complement"), &means).expect_pass());
    let means = block_means("blurred away", &scene, &robust(Radius::Relative(0.5)), effort);
    println!("{}", truth.agrees_with(SUITE.twin("blurred away"), &means).expect_reject());
}

// --- Exact -----------------------------------------------------------------------------------------------------------

#[test]
fn images_do_not_depend_on_threads() {
    let scene = scenes::build(scenes::glass_ball());
    let few = PhotonSettings { photons: 9000, importons: 3000, ..photons() };
    let importance = PhotonSettings { deposition: DepositionName::Importance, global_ratio: 0.3, ..few.clone() };
    let guided = PhotonSettings { guide: GuideName::Both, ..importance.clone() };
    let nearest = PhotonSettings { nearest: Some(20), gather_rays: 0, ..few.clone() };
    let caustics = PhotonSettings { caustics: true, ..few };
    let cases = [
        (EstimatorName::PhotonMap, importance, SamplerName::Sobol),
        (EstimatorName::PhotonMap, guided, SamplerName::Sobol),
        (EstimatorName::PhotonMap, nearest.clone(), SamplerName::GlobalHalton),
        (EstimatorName::Sppm, nearest, SamplerName::Independent),
        (EstimatorName::RobustIgi, caustics, SamplerName::Sobol),
    ];
    for (estimator, photons, sampler) in cases {
        let rendered = |threads| {
            let budget = Budget::Samples(3);
            let settings = RenderSettings { estimator, threads, budget, sampler, photons: photons.clone(), ..path() };
            estimate(&scene, &settings, |_| ControlFlow::Continue(())).unwrap()
        };
        let (one, three) = (rendered(1), rendered(3));
        assert_eq!(one.film, three.film, "{estimator:?}");
        assert_eq!(one.rays, three.rays, "{estimator:?}");
    }
}

/// Settings that are out of range are refused before anything is traced.
#[test]
fn impossible_settings_are_errors() {
    let scene = scenes::build(scenes::cornell_box());
    let refused = |estimator, photons| {
        let settings = RenderSettings { estimator, photons, budget: Budget::Samples(1), ..path() };
        estimate(&scene, &settings, |_| ControlFlow::Continue(())).is_err()
    };
    let sppm = |photons| refused(EstimatorName::Sppm, photons);
    let map = |photons| refused(EstimatorName::PhotonMap, photons);
    for radius in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        let radius = PhotonSettings { photon_radius: Radius::Absolute(radius), ..photons() };
        assert!(sppm(radius.clone()) && map(radius));
    }
    assert!(sppm(PhotonSettings { alpha: 1.0, ..photons() }) && map(PhotonSettings { nearest: Some(1), ..photons() }));
    assert!(map(PhotonSettings { global_ratio: 1e-9, ..photons() }));
    for guide_share in [1.0, -0.5, f64::NAN] {
        assert!(map(PhotonSettings { guide: GuideName::Both, guide_share, ..photons() }));
    }
    assert!(map(PhotonSettings { caustic_roughness: f32::NAN, ..photons() }));
}
