//! Weights and densities, path by path, without statistics.

use std::cell::RefCell;

use estimator_checks::Uniforms;
use mis_heuristics::{Balance, Counting, Cutoff, Densities, Heuristic, Maximum, Power};
use qmc_sampling::{Independent, SamplerFamily};
use scene_core::glam::Vec3A;
use scene_core::{ReferenceScene, Scene, UniformChoice};
use vpl_gi::{Classical, LightPaths, Partition, PathHeuristic, PathTechniques, RobustIgi, Stratified, TechniqueSet};

use crate::oracle::{Counts, Flat};
use crate::render::{Sharing, bidirectional, sensor_ray};
use crate::scenes::{self, SIZE};

/// Looks at every path whose weight is asked for.
struct Inspector<F> {
    look: RefCell<F>,
}

/// What an [`Inspector`] calls. (A closure cannot be generic.)
trait Look {
    fn look(&mut self, technique: usize, path: &impl PathTechniques);
}

impl<L: Look> PathHeuristic for Inspector<L> {
    fn weight(&self, technique: usize, path: &impl PathTechniques) -> f64 {
        self.look.borrow_mut().look(technique, path);
        Balance.weight(technique, &path.densities())
    }
}

/// Shows all paths of a few eye and light paths.
fn inspect<L: Look>(scene: &ReferenceScene, techniques: TechniqueSet, sharing: Sharing, look: L) -> L {
    let heuristic = Inspector { look: RefCell::new(look) };
    let estimator = bidirectional(scene, heuristic, techniques);
    let family = Independent::new(estimator_checks::seed("paths to look at"));
    let mut lights = LightPaths::new(scene);
    let count = u64::from(SIZE * SIZE);
    for index in 0..4 * count {
        let (pixel, sample) = (index % count, index / count);
        let paths = if let Sharing::Shared(paths) = sharing { paths } else { 1 };
        let first = index * u64::from(paths);
        estimator.trace_light_paths(scene, &mut lights, paths, |path| family.sampler(1 << 40, first + u64::from(path)));
        let mut sampler = family.sampler(pixel, sample);
        let (_, ray) = sensor_ray(scene, pixel, &mut sampler);
        estimator.radiance(scene, &lights, ray, &mut sampler, &mut ());
        estimator.splats(scene, &lights, &mut sampler, |_, _| {});
    }
    estimator.heuristic.look.into_inner()
}

/// Compares with the oracle.
struct AgreesWithOracle<'s> {
    scene: &'s ReferenceScene,
    counts: Counts,
    /// Paths seen, by technique: hit, connected to `y_0`, to later ones, to the lens.
    seen: [u32; 4],
    with_specular: u32,
    errors: Vec<f64>,
}

impl Look for AgreesWithOracle<'_> {
    fn look(&mut self, technique: usize, path: &impl PathTechniques) {
        let Some(flat) = Flat::of(self.scene, path) else { return };
        let choice = UniformChoice::new(self.scene.emitters().len());
        let expected = flat.densities(self.scene, &choice, self.counts);
        let densities = path.densities();
        assert_eq!(densities.len(), expected.len());
        for (i, &density) in expected.iter().enumerate() {
            let (found, expected) = (densities.density(i), density / expected[technique]);
            let error = if expected == 0.0 { found } else { found / expected - 1.0 };
            self.errors.push(error.abs());
            assert!(error.abs() < 2e-2, "technique {technique}, density {i}: {found} instead of {expected}");
        }
        let l = path.segments();
        self.seen[if technique == l { 3 } else { technique.min(2) }] += 1;
        self.with_specular += u32::from((1..l).any(|k| path.is_specular(k)));
    }
}

#[test]
fn densities_equal_the_oracles() {
    for (name, scene, has_specular, can_hit) in [
        ("diffuse", scenes::diffuse(), false, true),
        ("glossy", scenes::glossy(), false, true),
        ("glass ball", scenes::glass_ball(), true, true),
        ("environment", scenes::environment(), false, true),
        ("delta lights", scenes::delta_lights(), false, false),
        ("delta caustics", scenes::delta_caustics(), true, false),
    ] {
        for sharing in [Sharing::Independent, Sharing::Shared(4)] {
            for techniques in [TechniqueSet::WithoutLens, sharing.with_lens()] {
                let to_lens = match techniques {
                    TechniqueSet::WithLens { light_paths } => Some(light_paths),
                    TechniqueSet::WithoutLens => None,
                };
                let paths = if let Sharing::Shared(paths) = sharing { paths } else { 1 };
                let deltas = scene.emitters().iter().filter(|e| scene_core::Emitter::is_delta(*e)).count();
                let counts = Counts {
                    per_eye_path: f64::from(paths),
                    to_lens,
                    deltas_once: deltas <= paths as usize,
                    max_light_segments: if to_lens.is_some() { 4 } else { 3 },
                };
                let look =
                    AgreesWithOracle { scene: &scene, counts, seen: [0; 4], with_specular: 0, errors: Vec::new() };
                let look = inspect(&scene, techniques, sharing, look);
                // The oracle's rays start beside the surface, hence its vertices lie beside the path's.
                let mut errors = look.errors;
                errors.sort_by(f64::total_cmp);
                let [median, most] = [errors.len() / 2, errors.len() * 9 / 10].map(|i| errors[i]);
                println!("{name}, {sharing:?}: {:?}, {} specular, {median:e} {most:e}", look.seen, look.with_specular);
                assert!(median < 1e-4 && most < 1e-3, "{name}: {median}, {most}");
                assert!(look.seen[1] > 20 && look.seen[2] > 20, "{name}: {:?}", look.seen);
                assert_eq!(look.seen[0] > 5, can_hit, "{name}: {:?}", look.seen);
                assert_eq!(look.seen[3] > 20, to_lens.is_some(), "{name}: {:?}", look.seen);
                assert_eq!(look.with_specular > 5, has_specular, "{name}: {}", look.with_specular);
            }
        }
    }
}

/// All heuristics, and the sums of their weights.
struct SumsToOne {
    partitions: [Partition; 3],
    seen: u32,
}

impl Look for SumsToOne {
    fn look(&mut self, technique: usize, path: &impl PathTechniques) {
        fn sum(heuristic: &impl PathHeuristic, path: &impl PathTechniques, techniques: usize) -> f64 {
            let weights = (0..techniques).map(|i| heuristic.weight(i, path));
            let weights: Vec<f64> = weights.collect();
            for (i, weight) in weights.iter().enumerate() {
                assert!((0.0..=1.0 + 1e-9).contains(weight), "{weights:?}");
                let is_possible = path.densities().density(i) > 0.0;
                assert!(is_possible || *weight == 0.0, "technique {i} cannot generate the path: {weights:?}");
            }
            weights.iter().sum()
        }
        let (l, techniques) = (path.segments(), path.densities().len());
        assert!(technique < techniques && (techniques == l || techniques == l + 1));
        let mut sums = vec![
            sum(&Classical(Balance), path, techniques),
            sum(&Classical(Power::TWO), path, techniques),
            sum(&Classical(Power::new(3.5).unwrap()), path, techniques),
            sum(&Classical(Maximum), path, techniques),
            sum(&Classical(Cutoff::new(0.2).unwrap()), path, techniques),
        ];
        sums.extend(self.partitions.iter().map(|&partition| sum(&Stratified(partition), path, techniques)));
        assert!(sums.iter().all(|sum| (sum - 1.0).abs() < 1e-6), "{sums:?}");
        self.seen += 1;
    }
}

#[test]
fn weights_sum_to_one_for_every_heuristic() {
    for scene in [
        scenes::diffuse(),
        scenes::glossy(),
        scenes::glass_ball(),
        scenes::environment(),
        scenes::delta_lights(),
        scenes::delta_caustics(),
    ] {
        let (_, radius) = scene.bounding_sphere();
        let threshold = 2.0 / (radius * radius);
        for sharing in [Sharing::Independent, Sharing::Shared(3)] {
            for techniques in [TechniqueSet::WithoutLens, sharing.with_lens()] {
                let partitions = [
                    Partition::hard(threshold).unwrap(),
                    Partition::soft(threshold).unwrap(),
                    Partition::distance(threshold).unwrap(),
                ];
                let look = inspect(&scene, techniques, sharing, SumsToOne { partitions, seen: 0 });
                assert!(look.seen > 200, "{}: {}", scene.name(), look.seen);
            }
        }
    }
}

/// A path whose densities count how often they are asked for.
struct CountingPath<'a, P, D> {
    path: &'a P,
    densities: &'a Counting<D>,
}

impl<P: PathTechniques, D: Densities<f64>> PathTechniques for CountingPath<'_, P, D> {
    fn segments(&self) -> usize {
        self.path.segments()
    }
    fn densities(&self) -> impl Densities<f64> {
        self.densities
    }
    fn geometry_term(&self, k: usize) -> f32 {
        self.path.geometry_term(k)
    }
    fn position(&self, k: usize) -> Option<Vec3A> {
        self.path.position(k)
    }
    fn direction(&self, k: usize) -> Vec3A {
        self.path.direction(k)
    }
    fn is_specular(&self, k: usize) -> bool {
        self.path.is_specular(k)
    }
    fn can_connect(&self, k: usize) -> bool {
        self.path.can_connect(k)
    }
    fn can_hit(&self) -> bool {
        self.path.can_hit()
    }
}

#[derive(Default)]
struct Asked {
    stratified: u64,
    balance: u64,
    techniques: u64,
}

impl Look for Asked {
    fn look(&mut self, technique: usize, path: &impl PathTechniques) {
        let densities = Counting::new(path.densities());
        let counting = CountingPath { path, densities: &densities };
        Stratified(Partition::soft(0.5).unwrap()).weight(technique, &counting);
        self.stratified += densities.take();
        Classical(Balance).weight(technique, &counting);
        self.balance += densities.take();
        self.techniques += densities.len() as u64;
    }
}

#[test]
fn stratification_asks_for_no_density_and_balance_for_all() {
    let scene = scenes::glass_ball();
    let asked = inspect(&scene, Sharing::Independent.with_lens(), Sharing::Independent, Asked::default());
    assert_eq!(asked.stratified, 0);
    assert_eq!(asked.balance, asked.techniques);
    assert!(asked.techniques > 1000);
}

/// The same eye path with the same light paths gives the same radiance, however often memory was used before.
#[test]
fn light_paths_can_be_traced_again() {
    let scene = scenes::glass_ball();
    let estimator = bidirectional(&scene, Classical(Balance), TechniqueSet::WithoutLens);
    let family = Independent::new(1);
    let radiance = |lights: &LightPaths<_>| {
        let mut sampler = family.sampler(7, 0);
        let (_, ray) = sensor_ray(&scene, 120, &mut sampler);
        estimator.radiance(&scene, lights, ray, &mut sampler, &mut ())
    };
    let mut used = LightPaths::new(&scene);
    for paths in [5, 64, 1, 8] {
        estimator.trace_light_paths(&scene, &mut used, paths, |path| family.sampler(1 << 40, u64::from(path)));
    }
    let mut fresh = LightPaths::new(&scene);
    estimator.trace_light_paths(&scene, &mut fresh, 8, |path| family.sampler(1 << 40, u64::from(path)));
    assert_eq!(used.lights().len(), fresh.lights().len());
    assert_eq!((used.paths(), used.max_length()), (8, 3));
    assert_eq!(radiance(&used), radiance(&fresh));
}

/// Nothing to connect to, nothing to see.
#[test]
fn no_light_paths() {
    let scene = scenes::delta_lights();
    let estimator = bidirectional(&scene, Classical(Power::TWO), Sharing::Independent.with_lens());
    let mut lights = LightPaths::new(&scene);
    let family = Independent::new(Uniforms::new(1).next_u64());
    estimator.trace_light_paths(&scene, &mut lights, 0, |_| family.sampler(0, 0));
    let mut sampler = family.sampler(1, 0);
    let (_, ray) = sensor_ray(&scene, 100, &mut sampler);
    let radiance = estimator.radiance(&scene, &lights, ray, &mut sampler, &mut ());
    assert_eq!(radiance, scene_core::Rgb::ZERO);
    estimator.splats(&scene, &lights, &mut sampler, |_, _| panic!("there is nothing to connect"));
}

/// Robust instant global illumination is the stratification heuristic with what it weighs zero left out: with the same numbers and the
/// same light paths, the radiance along every ray is the same.
#[test]
fn stratified_is_robust_instant_global_illumination() {
    for scene in [
        scenes::diffuse(),
        scenes::glossy(),
        scenes::glass_ball(),
        scenes::environment(),
        scenes::delta_lights(),
        scenes::delta_caustics(),
        scenes::mirrored_spot(),
    ] {
        let threshold = 3.0 / scene.bounding_sphere().1.powi(2);
        for partition in [Partition::hard(threshold), Partition::soft(threshold), Partition::distance(threshold)] {
            let partition = partition.unwrap();
            let estimator = bidirectional(&scene, Stratified(partition), TechniqueSet::WithoutLens);
            let (max_depth, roulette) = (estimator.max_depth, estimator.roulette);
            let robust = RobustIgi { max_depth, roulette, peaks: false, ..RobustIgi::new(partition) };
            let family = Independent::new(estimator_checks::seed("robust"));
            let mut lights = LightPaths::new(&scene);
            let mut lit = 0;
            for pixel in 0..u64::from(SIZE * SIZE) {
                estimator.trace_light_paths(&scene, &mut lights, 5, |path| {
                    family.sampler(1 << 40, 5 * pixel + u64::from(path))
                });
                let mut sampler = family.sampler(pixel, 0);
                let (_, ray) = sensor_ray(&scene, pixel, &mut sampler);
                let expected = robust.radiance(&scene, lights.lights(), ray, &mut sampler.clone());
                let found = estimator.radiance(&scene, &lights, ray, &mut sampler, &mut ());
                let difference = (found - expected).0.abs().max_element();
                let scale = expected.0.max_element();
                assert!(difference <= 1e-4 * scale, "{}, {partition:?}: {found:?} {expected:?}", scene.name());
                lit += u32::from(scale > 0.0);
            }
            assert!(lit > 100, "{}: {lit}", scene.name());
        }
    }
}

/// Zero light paths to the lens are no technique: nothing is divided by zero.
#[test]
fn no_light_paths_to_the_lens() {
    let scene = scenes::diffuse();
    let family = Independent::new(5);
    let radiance = |techniques| {
        let mut estimator = bidirectional(&scene, Classical(Balance), techniques);
        estimator.tracing.max_length = 2;
        let mut lights = LightPaths::new(&scene);
        estimator.trace_light_paths(&scene, &mut lights, 2, |path| family.sampler(0, u64::from(path)));
        let mut sampler = family.sampler(1, 0);
        let (_, ray) = sensor_ray(&scene, 100, &mut sampler);
        estimator.splats(&scene, &lights, &mut sampler.clone(), |_, _| panic!("there are none"));
        estimator.radiance(&scene, &lights, ray, &mut sampler, &mut ())
    };
    for light_paths in [0.0, -1.0, f64::NAN] {
        assert_eq!(radiance(TechniqueSet::WithLens { light_paths }), radiance(TechniqueSet::WithoutLens));
    }
}
