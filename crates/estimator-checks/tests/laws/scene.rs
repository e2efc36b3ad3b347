//! Scenes, sensors, and all of a renderer at once.

use estimator_checks::laws::scene::{RendererLaws, SensorLaws, check_renderer, check_scene, check_sensor};
use estimator_checks::{Outcome, Report};
use scene_core::builtin::{Builtin, cornell_box, glass_ball};
use scene_core::{ReferenceScene, Scene};

use crate::liar::{LiarScene, SceneLie, SensorLie, VertexLie};
use crate::{SUITE, broken, broken_exactly};

fn builtin(name: &str) -> ReferenceScene {
    ReferenceScene::new(Builtin::named(name).unwrap().description()).unwrap()
}

#[test]
fn scenes_keep_their_laws() {
    for name in ["cornell-box", "glass-ball", "blob-environment", "sphere-row", "conference"] {
        check_scene(name, &builtin(name)).expect_pass();
    }
}

fn run(change: impl Fn(&mut LiarScene)) -> Outcome {
    let mut scene = LiarScene::new(glass_ball());
    change(&mut scene);
    check_scene("liar", &scene)
}

#[test]
fn scenes_that_lie_are_rejected() {
    run(|_| ()).expect_pass();
    for (lie, law) in [
        (SceneLie::FindsTheSecond, "nothing is before what is hit"),
        (SceneLie::IgnoresTheEnd, "nothing is before what is hit"),
        (SceneLie::NeverOccluded, "a ray is occluded if it hits something, and only then"),
        (SceneLie::OcclusionIgnoresTheEnd, "a ray is occluded if it hits something, and only then"),
        (SceneLie::SeesOneWay, "visibility is symmetric"),
        (SceneLie::SeesThroughEverything, "visible is not occluded"),
        (SceneLie::EnvironmentIsALamp, "the environment is at infinity"),
        (SceneLie::EnvironmentDoesNotExist, "the environment is an emitter"),
        (SceneLie::AddsToTheEnvironment, "what comes from outside is the environment's radiance"),
        (SceneLie::SphereIsTooSmall, "the bounding sphere contains all that is hit"),
        (SceneLie::SphereIsNowhere, "the bounding sphere is finite"),
        (SceneLie::SaysDiffuse, "nothing scatters more sharply than the scene says"),
        (SceneLie::Dice, "the same ray finds the same point"),
    ] {
        assert_eq!(broken(run(|scene| scene.lie = lie)), law, "{lie:?}");
    }
    for (lie, law) in [
        (VertexLie::EmitsMore, "a vertex emits what its emitter does"),
        (VertexLie::ForgetsItsEmitter, "a vertex emits what its emitter does"),
        (VertexLie::OtherEmitter, "the emitter of a vertex exists"),
        (VertexLie::WoGoesOn, "wo points back along the ray"),
        (VertexLie::LongNormal, "normals have unit length"),
        (VertexLie::HoversOverTheSurface, "what is hit lies on the ray"),
    ] {
        assert_eq!(broken(run(|scene| scene.vertex_lie = lie)), law, "{lie:?}");
    }
}

#[test]
fn sensors_keep_their_laws() {
    check_sensor("pinhole", builtin("cornell-box").sensor()).expect_pass();
    let mut description = cornell_box();
    description.camera.aperture_radius = 0.05;
    description.camera.focus_distance = 2.5;
    check_sensor("thin lens", ReferenceScene::new(description).unwrap().sensor()).expect_pass();
}

#[test]
fn sensors_that_lie_are_rejected() {
    let run = |lie: SensorLie| -> Report {
        let mut scene = LiarScene::new(cornell_box());
        scene.sensor.lie = lie;
        check_sensor(&format!("{lie:?}"), &scene.sensor)
    };
    run(SensorLie::Nothing).expect_pass();
    for (lie, law) in [
        (SensorLie::NoPixels, "a sensor has pixels"),
        (SensorLie::LongDirections, "rays are finite, of unit direction"),
        (SensorLie::NoWeight, "weights are finite and positive"),
        (SensorLie::Blind, "a point on a ray is seen"),
        (SensorLie::ShiftsTheRaster, "a point on a ray is seen where the ray started"),
        (SensorLie::ShiftsTheLens, "the lens is where the ray started"),
        (SensorLie::LooksAway, "the lens looks towards what it sees"),
        (SensorLie::SameDirection, "the direction to the lens is that of the ray, reversed"),
        (
            SensorLie::WeightOfConnections,
            "the weight of a connection is that of the ray over density and distance squared",
        ),
        (SensorLie::Density, "pdf_ray is the density of rays by solid angle"),
        (SensorLie::DensityOnTheLens, "a pinhole has density 1"),
        (SensorLie::SeesBehind, "what is seen is where rays go"),
    ] {
        assert_eq!(broken_exactly(run(lie)), law, "{lie:?}");
    }
    let report = run(SensorLie::DensityOffTheFilm).expect_reject();
    assert!(report.outcomes[0].passed() && report.outcomes[1].rejected(), "{report}");

    let mut scene = LiarScene::new(cornell_box());
    scene.sensor.lie = SensorLie::Blind;
    SensorLaws::new().without_connections().run("starts paths only", &scene.sensor).expect_pass();

    let mut description = cornell_box();
    description.camera.aperture_radius = 0.05;
    let mut scene = LiarScene::new(description);
    scene.sensor.lie = SensorLie::DensityOnTheLens;
    assert_eq!(
        broken_exactly(check_sensor("lens", &scene.sensor)),
        "pdf_ray is the density of rays by area of the lens"
    );
}

#[test]
fn all_of_a_renderer() {
    let report = check_renderer(SUITE.check("renderer: Cornell box"), &builtin("cornell-box")).expect_pass();
    assert!(report.outcomes.len() > 20, "{report}");
    let mut scene = LiarScene::new(cornell_box());
    scene.vertex_lie = VertexLie::MakesLight;
    let laws = RendererLaws::new().vertices(1).emitters(0);
    let report = laws.run(SUITE.twin("renderer: makes light"), &scene).expect_reject();
    assert!(report.outcomes.iter().any(|outcome| outcome.test.contains("vertex 0: energy")), "{report}");
}
