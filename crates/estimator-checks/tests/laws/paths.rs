//! Descriptions of paths, and heuristics that weigh them.

use std::cell::Cell;

use estimator_checks::Outcome;
use estimator_checks::laws::paths::{CheckedHeuristic, check_path, check_path_heuristic, check_same_path};
use mis_heuristics::{Balance, Cutoff, Densities, Lazy, Maximum, Power};
use qmc_sampling::{Independent, Sampler, SamplerFamily};
use scene_core::builtin::{cornell_box, glass_ball};
use scene_core::glam::Vec3A;
use scene_core::{ReferenceScene, RussianRoulette, Scene, Sensor, UniformChoice};
use vpl_gi::{
    Bidirectional, Classical, LightPaths, LightTracing, Partition, PathHeuristic, PathTechniques, Stratified,
    TechniqueSet,
};

use crate::broken;

/// A path in numbers.
#[derive(Clone)]
struct Plain {
    positions: Vec<Option<Vec3A>>,
    directions: Vec<Vec3A>,
    squared: Vec<f32>,
    geometry: Vec<f32>,
    specular: Vec<bool>,
    connect: Vec<bool>,
    hit: bool,
    densities: Vec<f64>,
    /// What is added to a density each time that it is asked for.
    drift: f64,
    asked: Cell<f64>,
}

/// Lens, floor, mirror, wall, lamp, seen by technique 1: the wall is connected to the lamp.
fn plain() -> Plain {
    let positions =
        [[0.0, 0.0, 4.0], [0.0, 0.0, 2.0], [1.0, 0.0, 2.0], [1.0, 1.0, 0.0], [2.0, 1.0, 0.0]].map(Vec3A::from);
    let between: Vec<Vec3A> = positions.windows(2).map(|x| x[1] - x[0]).collect();
    Plain {
        directions: between.iter().map(|between| between.normalize()).collect(),
        squared: between.iter().map(|between| between.length_squared()).collect(),
        geometry: vec![0.0, 0.9, 0.1, 1.0],
        positions: positions.map(Some).to_vec(),
        specular: vec![false, false, true, false, false],
        connect: vec![true, false, false, true],
        hit: true,
        densities: vec![0.5, 1.0, 0.0, 0.0, 2e-3],
        drift: 0.0,
        asked: Cell::new(0.0),
    }
}

/// The same with the lamp at infinity.
fn distant() -> Plain {
    let mut path = plain();
    path.positions[4] = None;
    (path.squared[3], path.geometry[3]) = (f32::INFINITY, 0.0);
    path
}

impl PathTechniques for Plain {
    fn segments(&self) -> usize {
        self.geometry.len()
    }
    fn densities(&self) -> impl Densities<f64> {
        Lazy::new(self.densities.len(), |i| {
            self.asked.set(self.asked.get() + self.drift);
            self.densities[i] + self.asked.get()
        })
    }
    fn geometry_term(&self, k: usize) -> f32 {
        self.geometry[k]
    }
    fn position(&self, k: usize) -> Option<Vec3A> {
        self.positions[k]
    }
    fn direction(&self, k: usize) -> Vec3A {
        self.directions[k]
    }
    fn is_specular(&self, k: usize) -> bool {
        self.specular[k]
    }
    fn can_connect(&self, k: usize) -> bool {
        self.connect[k]
    }
    fn can_hit(&self) -> bool {
        self.hit
    }
    fn distance_squared(&self, k: usize) -> f32 {
        self.squared[k]
    }
}

#[test]
fn paths_keep_their_laws() {
    check_path("plain", 1, &plain()).expect_pass();
    check_path("distant", 1, &distant()).expect_pass();
    let without_lens = Plain { densities: vec![0.5, 1.0, 0.0, 0.0], ..plain() };
    check_path("without lens", 1, &without_lens).expect_pass();
}

#[test]
fn paths_that_lie_are_rejected() {
    fn run(base: Plain, technique: usize, lie: impl Fn(&mut Plain)) -> &'static str {
        let mut path = base;
        lie(&mut path);
        broken(check_path("liar", technique, &path))
    }
    let one = |lie: fn(&mut Plain)| run(plain(), 1, lie);
    let count = "a path of l segments has l techniques, or l + 1 with the lens";
    assert_eq!(one(|path| path.densities.truncate(3)), count);
    assert_eq!(one(|path| path.densities.push(0.0)), count);
    let own = "the technique that generated the path is one of its techniques";
    assert_eq!(run(plain(), 5, |_| ()), own);
    let finite = "densities of a path are finite and not negative";
    assert_eq!(one(|path| path.densities[0] = f64::NAN), finite);
    assert_eq!(one(|path| path.densities[4] = f64::INFINITY), finite);
    assert_eq!(one(|path| path.densities[0] = -0.5), finite);
    assert_eq!(one(|path| path.drift = 1e-3), "the same path has the same densities");
    let cannot = "a technique that cannot generate the path has density zero";
    assert_eq!(one(|path| path.densities[2] = 0.1), cannot);
    assert_eq!(one(|path| path.hit = false), cannot);
    assert_eq!(one(|path| path.connect[0] = false), cannot);
    let over = "densities are over that of the technique that generated the path";
    assert_eq!(one(|path| path.densities[1] = 0.3), over);
    // A technique cannot have generated what it cannot generate.
    assert_eq!(run(plain(), 2, |_| ()), over);
    assert_eq!(one(|path| path.specular[4] = true), "a path scatters between its ends");
    let connected = "what scatters by a Dirac delta is never connected";
    assert_eq!(one(|path| path.connect[1] = true), connected);
    assert_eq!(one(|path| path.specular[3] = true), connected);
    let position = "all vertices but the light's have a position";
    assert_eq!(one(|path| path.positions[3] = None), position);
    assert_eq!(one(|path| path.positions[0] = None), position);
    assert_eq!(one(|path| path.positions[4] = Some(Vec3A::NAN)), position);
    assert_eq!(one(|path| path.squared[1] = 1.1), "the squared distance is that of the positions");
    assert_eq!(one(|path| path.geometry[1] = -0.1), "geometry terms are not negative");
    assert_eq!(one(|path| path.geometry[1] = f32::NAN), "geometry terms are not negative");
    assert_eq!(one(|path| path.geometry[1] = 1.1), "cosines are at most one in the geometry term");
    assert_eq!(one(|path| path.directions[2] *= 2.0), "directions have unit length");
    assert_eq!(one(|path| path.directions[2] *= -1.0), "directions lead from each vertex to the next");
    let far = |lie: fn(&mut Plain)| run(distant(), 1, lie);
    assert_eq!(far(|path| path.squared[3] = 1.0), "the way to infinity is infinite");
    assert_eq!(far(|path| path.geometry[3] = 1e-3), "the geometry term vanishes at infinity");
    assert_eq!(far(|path| path.directions[3] *= 0.5), "directions have unit length");
}

#[test]
fn the_same_path_by_two_techniques() {
    /// By technique 0: densities over its own.
    fn by_hitting() -> Plain {
        let mut path = plain();
        path.densities.iter_mut().for_each(|density| *density /= 0.5);
        path
    }
    let run = |lie: fn(&mut Plain)| {
        let mut path = by_hitting();
        lie(&mut path);
        check_same_path("two", (1, &plain()), (0, &path), 1e-4)
    };
    run(|_| ()).expect_pass();
    run(|path| path.densities[4] *= 1.0 + 1e-6).expect_pass();
    let abilities = "the same path has the same abilities";
    assert_eq!(broken(run(|path| path.densities.truncate(4))), "the same path has the same segments and techniques");
    assert_eq!(broken(run(|path| (path.connect[0], path.densities[4]) = (false, 0.0))), abilities);
    assert_eq!(broken(run(|path| (path.connect[3], path.densities[1]) = (false, 0.0))), abilities);
    let geometry = "geometry is a function of the path";
    assert_eq!(broken(run(|path| path.geometry[1] = 0.8)), geometry);
    let function = "densities are a function of the path, up to a common factor";
    // The classic: the number of light paths, or a probability of Russian roulette, in one of the directions only.
    assert_eq!(broken(run(|path| path.densities[4] *= 4.0)), function);
    assert_eq!(broken(run(|path| path.densities[1] = 0.0)), function);
    // The laws of each alone.
    let own = "densities are over that of the technique that generated the path";
    assert_eq!(broken(run(|path| path.densities[0] = 0.5)), own);
}

/// Weights with a bug.
#[derive(Clone, Copy, Debug)]
enum Wrong {
    Nan,
    /// Forgets that a technique cannot connect, or hit.
    Equal,
    /// Does not divide by the number of light paths.
    Twice,
    /// A threshold of densities that have no unit.
    Absolute,
}

impl PathHeuristic for Wrong {
    fn weight(&self, technique: usize, path: &impl PathTechniques) -> f64 {
        let densities = path.densities();
        let balance = Classical(Balance).weight(technique, path);
        match self {
            Self::Nan => balance * f64::NAN,
            Self::Equal => 1.0 / densities.len() as f64,
            Self::Twice => {
                if technique == 0 {
                    balance
                } else {
                    2.0 * balance
                }
            }
            Self::Absolute => {
                let possible = || (0..densities.len()).filter(|&i| densities.density(i) > 0.0);
                let chosen = possible().find(|&i| densities.density(i) > 0.5).or_else(|| possible().last());
                if chosen == Some(technique) { 1.0 } else { 0.0 }
            }
        }
    }
}

const LAWS: [(Wrong, &str); 4] = [
    (Wrong::Nan, "weights of a path are finite"),
    (Wrong::Equal, "a technique that cannot generate the path has weight zero"),
    (Wrong::Twice, "weights of a path sum to one"),
    (Wrong::Absolute, "weights do not depend on the technique that generated the path"),
];

#[test]
fn heuristics_of_paths_keep_their_laws() {
    check_path_heuristic("balance", &Classical(Balance)).expect_pass();
    check_path_heuristic("power", &Classical(Power::TWO)).expect_pass();
    check_path_heuristic("maximum", &Classical(Maximum)).expect_pass();
    check_path_heuristic("cutoff", &Classical(Cutoff::new(0.2).unwrap())).expect_pass();
    for threshold in [0.0, 0.05, 1.0, f32::INFINITY] {
        for partition in [Partition::hard, Partition::soft, Partition::balance, Partition::distance] {
            check_path_heuristic("stratified", &Stratified(partition(threshold).unwrap())).expect_pass();
        }
    }
}

#[test]
fn heuristics_of_paths_that_lie_are_rejected() {
    for (wrong, law) in LAWS {
        assert_eq!(broken(check_path_heuristic("wrong", &wrong)), law, "{wrong:?}");
    }
}

/// A few pixels of bidirectional path tracing by a heuristic that looks on.
fn look<H: PathHeuristic>(scene: &ReferenceScene, heuristic: H, techniques: TechniqueSet) -> H {
    let (choice, roulette) = (UniformChoice::new(scene.emitters().len()), RussianRoulette::Never);
    let tracing = LightTracing { choice, max_length: u32::MAX, roulette };
    let estimator = Bidirectional { heuristic, techniques, tracing, max_depth: 5, roulette };
    let samplers = Independent::new(estimator_checks::seed("paths"));
    let [width, height] = scene.sensor().resolution().map(|n| n as f32);
    let mut lights = LightPaths::new(scene);
    for index in 0..100 {
        estimator.trace_light_paths(scene, &mut lights, 2, |path| samplers.sampler(1 + u64::from(path), index));
        let mut sampler = samplers.sampler(0, index);
        let [x, y] = sampler.next_2d();
        let ray = scene.sensor().sample_ray([x * width, y * height], [0.5; 2]).ray;
        estimator.radiance(scene, &lights, ray, &mut sampler, &mut ());
        estimator.splats(scene, &lights, &mut sampler, |_, _| {});
    }
    estimator.heuristic
}

fn scenes() -> [ReferenceScene; 2] {
    [cornell_box(), glass_ball()].map(|description| ReferenceScene::new(description).unwrap())
}

#[test]
fn real_paths_keep_their_laws() {
    for scene in scenes() {
        for techniques in [TechniqueSet::WithoutLens, TechniqueSet::WithLens { light_paths: 2.0 }] {
            let outcome = look(&scene, CheckedHeuristic::new(Classical(Balance)), techniques).outcome("balance");
            outcome.expect_pass();
            let stratified = Stratified(Partition::soft(1e-3).unwrap());
            look(&scene, CheckedHeuristic::new(stratified), techniques).outcome("stratified").expect_pass();
        }
    }
    let nothing = CheckedHeuristic::new(Classical(Balance)).outcome("nothing seen");
    assert!(!nothing.passed() && !nothing.rejected(), "{nothing}");
}

/// Shows a path with a bug to a heuristic that looks on.
struct Shows<H>(CheckedHeuristic<H>, fn(usize, f64) -> f64);

/// With other densities.
struct Altered<'a, P>(&'a P, fn(usize, f64) -> f64);

impl<H: PathHeuristic> PathHeuristic for Shows<H> {
    fn weight(&self, technique: usize, path: &impl PathTechniques) -> f64 {
        self.0.weight(technique, &Altered(path, self.1))
    }
}

impl<P: PathTechniques> PathTechniques for Altered<'_, P> {
    fn segments(&self) -> usize {
        self.0.segments()
    }
    fn densities(&self) -> impl Densities<f64> {
        let densities = self.0.densities();
        Lazy::new(densities.len(), move |i| (self.1)(i, densities.density(i)))
    }
    fn geometry_term(&self, k: usize) -> f32 {
        self.0.geometry_term(k)
    }
    fn position(&self, k: usize) -> Option<Vec3A> {
        self.0.position(k)
    }
    fn direction(&self, k: usize) -> Vec3A {
        self.0.direction(k)
    }
    fn is_specular(&self, k: usize) -> bool {
        self.0.is_specular(k)
    }
    fn can_connect(&self, k: usize) -> bool {
        self.0.can_connect(k)
    }
    fn can_hit(&self) -> bool {
        self.0.can_hit()
    }
}

#[test]
fn lies_about_real_paths_are_found() {
    let [box_, ball] = scenes();
    let found = |scene: &ReferenceScene, alter: fn(usize, f64) -> f64| -> Outcome {
        let heuristic = Shows(CheckedHeuristic::new(Classical(Balance)), alter);
        look(scene, heuristic, TechniqueSet::WithoutLens).0.outcome("altered")
    };
    found(&ball, |_, density| density).expect_pass();
    let over = "densities are over that of the technique that generated the path";
    assert_eq!(broken(found(&box_, |_, density| 0.5 * density)), over);
    let cannot = "a technique that cannot generate the path has density zero";
    assert_eq!(broken(found(&ball, |_, density| if density == 0.0 { 1e-3 } else { density })), cannot);
    for (wrong, law) in LAWS {
        let outcome = look(&ball, CheckedHeuristic::new(wrong), TechniqueSet::WithoutLens).outcome("wrong");
        assert_eq!(broken(outcome), law, "{wrong:?}");
    }
}
