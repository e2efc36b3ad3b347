//! Images agree with path and light tracing, whatever the heuristic, the techniques and the light paths; planted bugs do not.

use estimator_checks::{BatchMeans, Suite};
use mis_heuristics::{Balance, Cutoff, Maximum, Power};
use scene_core::{ReferenceScene, Scene};
use vpl_gi::{Classical, Partition, PathHeuristic, Stratified, TechniqueSet};

use crate::planted::{ConnectsSpecular, NotDivided};
use crate::render::{Effort, Sharing, batches, bidirectional, render_with};
use crate::{plain, scenes};

static SUITE: Suite = Suite::with_share("vpl-gi bidirectional", 132, 1e-8);

const EFFORT: Effort = Effort { samples: 3, batches: 48 };
const REFERENCE: Effort = Effort { samples: 24, batches: 48 };
const SHARED: Sharing = Sharing::Shared(6);

fn image<H: PathHeuristic + Copy>(
    name: &str,
    scene: &ReferenceScene,
    heuristic: H,
    techniques: TechniqueSet,
    sharing: Sharing,
) -> BatchMeans {
    let estimator = bidirectional(scene, heuristic, techniques);
    batches(name, EFFORT, |seed| render_with(scene, &estimator, &estimator, sharing, EFFORT.samples, seed))
}

/// A partition that leaves something to both sides.
fn threshold(scene: &ReferenceScene) -> f32 {
    let (_, radius) = scene.bounding_sphere();
    3.0 / (radius * radius)
}

/// Every heuristic with one set of techniques.
fn agrees(scene: &ReferenceScene, expected: &BatchMeans, techniques: TechniqueSet, sharing: Sharing) {
    fn one<H: PathHeuristic + Copy>(
        name: &str,
        heuristic: H,
        (scene, expected): (&ReferenceScene, &BatchMeans),
        (techniques, sharing): (TechniqueSet, Sharing),
    ) {
        let test = format!("{}, {techniques:?}, {sharing:?}, {name}", scene.name());
        let found = image(&test, scene, heuristic, techniques, sharing);
        println!("{}", expected.agrees_with(SUITE.check(&test), &found).expect_pass());
    }
    let (what, how) = ((scene, expected), (techniques, sharing));
    let t = threshold(scene);
    one("balance", Classical(Balance), what, how);
    one("power", Classical(Power::TWO), what, how);
    one("maximum", Classical(Maximum), what, how);
    one("cutoff", Classical(Cutoff::new(0.2).unwrap()), what, how);
    one("hard", Stratified(Partition::hard(t).unwrap()), what, how);
    one("soft", Stratified(Partition::soft(t).unwrap()), what, how);
}

fn agrees_with_path(scene: &ReferenceScene) {
    let expected = plain::path(&format!("{}: path", scene.name()), scene, REFERENCE);
    for sharing in [Sharing::Independent, SHARED] {
        for techniques in [TechniqueSet::WithoutLens, sharing.with_lens()] {
            agrees(scene, &expected, techniques, sharing);
        }
    }
}

#[test]
fn diffuse() {
    agrees_with_path(&scenes::diffuse());
}

#[test]
fn glossy() {
    agrees_with_path(&scenes::glossy());
}

#[test]
fn glass_ball() {
    agrees_with_path(&scenes::glass_ball());
}

#[test]
fn environment() {
    agrees_with_path(&scenes::environment());
}

#[test]
fn delta_lights() {
    agrees_with_path(&scenes::delta_lights());
}

/// Light of a spot by a mirror: the connection to the lens alone finds it where the camera looks.
#[test]
fn mirrored_spot() {
    let scene = scenes::mirrored_spot();
    let expected = plain::light("mirrored spot: light", &scene, REFERENCE);
    for sharing in [Sharing::Independent, SHARED] {
        agrees(&scene, &expected, sharing.with_lens(), sharing);
    }
    let test = "mirrored spot, without what no technique generates";
    let found = image(test, &scene, Classical(Balance), TechniqueSet::WithoutLens, Sharing::Independent);
    expected.agrees_with(SUITE.twin(test), &found).expect_reject();
}

#[test]
fn planted_bug_not_divided_by_the_number_of_light_paths() {
    let scene = scenes::diffuse();
    let test = "1/M forgotten";
    let expected = plain::path(test, &scene, REFERENCE);
    let found = image(test, &scene, NotDivided(Classical(Balance), 6.0), TechniqueSet::WithoutLens, SHARED);
    println!("{}", expected.agrees_with(SUITE.twin(test), &found).expect_reject());
}

/// Eye paths believe that there are as many light paths as pixels, light paths that they are few.
#[test]
fn planted_bug_another_number_of_light_paths_to_the_lens() {
    let scene = scenes::diffuse();
    let test = "light paths to the lens miscounted";
    let expected = plain::path(test, &scene, REFERENCE);
    let sharing = Sharing::Independent;
    let eye = bidirectional(&scene, Classical(Balance), sharing.with_lens());
    let lens = bidirectional(&scene, Classical(Balance), TechniqueSet::WithLens { light_paths: 1.0 });
    let found = batches(test, EFFORT, |seed| render_with(&scene, &eye, &lens, sharing, EFFORT.samples, seed));
    println!("{}", expected.agrees_with(SUITE.twin(test), &found).expect_reject());
}

#[test]
fn planted_bug_specular_vertices_take_a_share() {
    let scene = scenes::glass_ball();
    let test = "specular vertices take a share";
    let expected = plain::path(test, &scene, REFERENCE);
    // Nearly all edges lie below this threshold, those inside the ball too.
    let heuristic = ConnectsSpecular(Stratified(Partition::hard(2.0).unwrap()));
    let found = image(test, &scene, heuristic, TechniqueSet::WithoutLens, Sharing::Independent);
    println!("{}", expected.agrees_with(SUITE.twin(test), &found).expect_reject());
}
