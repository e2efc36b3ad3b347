//! Emitters, and how to choose among them.

use estimator_checks::Report;
use estimator_checks::laws::scene::{check_emitter, check_emitter_choice};
use scene_core::builtin::{Builtin, SceneBuilder, cornell_box};
use scene_core::glam::Vec3A;
use scene_core::reference::Light;
use scene_core::{
    ChosenEmitter, Emitter, EmitterChoice, EmitterId, PowerChoice, ReferenceScene, Rgb, Scene, SurfacePoint,
    UniformChoice,
};

use crate::liar::{EmitterLie as Lie, LiarScene};
use crate::{SUITE, broken_exactly, rejects};

/// A place on the floor of the Cornell box, off the middle.
fn place(scene: &impl Scene) -> Vec3A {
    let (center, radius) = scene.bounding_sphere();
    center + radius * Vec3A::new(0.2, -0.3, 0.1)
}

/// A sphere that shines, a lamp at a point, one far away, and a sky.
fn lamps() -> ReferenceScene {
    let mut b = SceneBuilder::new("lamps");
    let black = b.diffuse(0.0, 0.0, 0.0);
    b.sphere(black, Vec3A::ZERO, 0.5).emit(Rgb::new(3.0, 2.0, 1.0));
    b.light(Light::Point { position: Vec3A::new(1.0, 2.0, 3.0), intensity: Rgb::splat(5.0) });
    b.light(Light::Directional { direction: Vec3A::new(0.3, -1.0, 0.2), irradiance: Rgb::splat(2.0) });
    ReferenceScene::new(b.finish()).unwrap()
}

#[test]
fn emitters_keep_their_laws() {
    let scene = ReferenceScene::new(cornell_box()).unwrap();
    let report = check_emitter(SUITE.check("emitter: lamp"), &scene, EmitterId(0), place(&scene)).expect_pass();
    assert_eq!(report.outcomes.len(), 5, "{report}");
    let scene = lamps();
    for (i, name) in ["sphere", "point", "directional"].into_iter().enumerate() {
        let check = SUITE.check(&format!("emitter: {name}"));
        check_emitter(check, &scene, EmitterId(i as u32), Vec3A::new(1.0, -0.8, 0.6)).expect_pass();
    }
    let sky = ReferenceScene::new(Builtin::named("blob-environment").unwrap().description()).unwrap();
    let id = sky.environment().unwrap();
    check_emitter(SUITE.check("emitter: sky"), &sky, id, Vec3A::new(0.1, 3.0, 0.2)).expect_pass();
    let none = check_emitter(SUITE.twin("emitter: none"), &sky, EmitterId(9), Vec3A::ZERO);
    assert_eq!(broken_exactly(none), "an emitter is one of the scene");
}

fn run(lie: Lie) -> Report {
    let scene = LiarScene::new(cornell_box()).with_emitter(lie);
    check_emitter(SUITE.twin(&format!("emitter: {lie:?}")), &scene, EmitterId(0), place(&scene))
}

#[test]
fn emitters_that_lie_are_rejected() {
    run(Lie::Nothing).expect_pass();
    for (lie, law) in [
        (Lie::NegativePower, "power is finite and not negative"),
        (Lie::LongDirections, "directions have unit length"),
        (Lie::NegativeRadiance, "radiance is finite and not negative"),
        (Lie::NoDensityOfSamples, "the density of a sample is finite and positive"),
        (Lie::SaysDelta, "samples are Dirac deltas if the emitter is"),
        (Lie::StartsNowhere, "light from infinity, and no other, starts nowhere"),
        (Lie::OtherDistance, "wi leads to the point at its distance"),
        (Lie::DirectDensity, "pdf_direct is the density of the sample"),
        (Lie::DirectRadiance, "radiance is that of the sample"),
        (Lie::Dice, "the same numbers give the same sample"),
        (Lie::NegativeFlux, "flux is finite and not negative"),
        (Lie::EmissionDensity, "pdf_emission is the densities of the ray of light"),
        (Lie::Flux, "flux is radiance over densities"),
        (Lie::DarkHalf, "where light arrives, its density is positive"),
        (Lie::NotLambertian, "is_lambertian: one radiance in front, none behind"),
    ] {
        assert_eq!(broken_exactly(run(lie)), law, "{lie:?}");
    }
    rejects(run(Lie::DirectDistribution), "direct light");
    rejects(run(Lie::EmissionDistribution), "emission");
    rejects(run(Lie::MorePower), "power");
    rejects(run(Lie::Positions), "fluence");
}

#[test]
fn deltas_that_lie_are_rejected() {
    let run = |lie: Lie| {
        let mut b = SceneBuilder::new("point");
        let black = b.diffuse(0.0, 0.0, 0.0);
        b.sphere(black, Vec3A::ZERO, 0.5);
        b.light(Light::Point { position: Vec3A::new(1.0, 2.0, 3.0), intensity: Rgb::splat(5.0) });
        let scene = LiarScene::new(b.finish()).with_emitter(lie);
        check_emitter(SUITE.twin(&format!("delta: {lie:?}")), &scene, EmitterId(0), Vec3A::new(1.0, -0.8, 0.6))
    };
    run(Lie::Nothing).expect_pass();
    assert_eq!(broken_exactly(run(Lie::DeltaCanBeFound)), "no ray finds a Dirac delta");
    assert_eq!(broken_exactly(run(Lie::DensityOfDelta)), "a Dirac delta has density 1");
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum ChoiceLie {
    Nothing,
    SumsToMore,
    Negative,
    OtherProbability,
    ChoosesNobody,
    ChoosesNothing,
    ForgetsTheFirst,
    OtherDistribution,
}

struct LiarChoice(UniformChoice, u32, ChoiceLie);

impl EmitterChoice for LiarChoice {
    fn choose(&self, from: Option<&SurfacePoint>, u: f32) -> Option<ChosenEmitter> {
        let u = if self.2 == ChoiceLie::OtherDistribution { u * u } else { u };
        let mut chosen = self.0.choose(from, u)?;
        match self.2 {
            ChoiceLie::OtherProbability => chosen.probability *= 0.9,
            ChoiceLie::ChoosesNobody => chosen.id = EmitterId(self.1),
            ChoiceLie::ChoosesNothing if u > 0.9 => return None,
            ChoiceLie::ForgetsTheFirst => {
                let id = 1 + (u * (self.1 - 1) as f32) as u32;
                chosen = ChosenEmitter { id: EmitterId(id), probability: self.probability(from, EmitterId(id)) };
            }
            _ => {}
        }
        Some(chosen)
    }

    fn probability(&self, from: Option<&SurfacePoint>, id: EmitterId) -> f32 {
        let probability = self.0.probability(from, id);
        match self.2 {
            ChoiceLie::SumsToMore => 1.1 * probability,
            ChoiceLie::Negative => probability * if id.0 == 0 { -1.0 } else { 1.0 },
            ChoiceLie::ForgetsTheFirst => {
                if id.0 == 0 {
                    0.0
                } else {
                    1.0 / (self.1 - 1) as f32
                }
            }
            _ => probability,
        }
    }
}

#[test]
fn choices() {
    let scene = lamps();
    let (emitters, from) = (scene.emitters(), SurfacePoint::in_space(Vec3A::new(1.0, -0.8, 0.6)));
    let uniform = UniformChoice::new(emitters.len());
    check_emitter_choice(SUITE.check("choice: uniform"), &uniform, Some(&from), emitters).expect_pass();
    let power = PowerChoice::new(emitters);
    check_emitter_choice(SUITE.check("choice: power"), &power, None, emitters).expect_pass();
    // Nobody to choose from.
    let none: &[<ReferenceScene as Scene>::Emitter] = &[];
    check_emitter_choice(SUITE.twin("choice: none"), &UniformChoice::new(0), None, none).expect_pass();

    let run = |lie: ChoiceLie| {
        let choice = LiarChoice(uniform, emitters.len() as u32, lie);
        check_emitter_choice(SUITE.twin(&format!("choice: {lie:?}")), &choice, Some(&from), emitters)
    };
    run(ChoiceLie::Nothing).expect_pass();
    for (lie, law) in [
        (ChoiceLie::SumsToMore, "probabilities sum to one, or to zero"),
        (ChoiceLie::Negative, "probabilities lie in [0, 1]"),
        (ChoiceLie::OtherProbability, "the chosen emitter comes with its probability"),
        (ChoiceLie::ChoosesNobody, "the chosen emitter exists"),
        (ChoiceLie::ChoosesNothing, "something is chosen if there is anything"),
        (ChoiceLie::ForgetsTheFirst, "what shines may be chosen"),
    ] {
        assert_eq!(broken_exactly(run(lie)), law, "{lie:?}");
    }
    rejects(run(ChoiceLie::OtherDistribution), "");
    assert!(emitters[0].power()[0] > 0.0);
}
