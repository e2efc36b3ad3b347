//! Maps of caustics.

use std::cell::RefCell;

use estimator_checks::laws::paths::{CausticLaws, WithoutDeltas, caustic_by_brute_force};
use estimator_checks::{Report, Uniforms};
use scene_core::builtin::SceneBuilder;
use scene_core::glam::Vec3A;
use scene_core::material::Material;
use scene_core::reference::SceneVertex;
use scene_core::{Ray, ReferenceScene, Rgb, Scene, TransportMode, Vertex};
use vpl_gi::{CausticMap, NoCaustics};

use crate::{SUITE, broken_exactly, rejects};

const DEPTH: u32 = 6;
/// Rays of a map at a vertex.
const RAYS: u32 = 1500;

/// A glass ball between a large lamp and the floor, and a coated block beside it.
fn scene() -> ReferenceScene {
    let mut b = SceneBuilder::new("caustic");
    let ground = b.diffuse(0.6, 0.5, 0.4);
    b.quad(ground, Vec3A::new(-3.0, 0.0, -3.0), Vec3A::Z * 6.0, Vec3A::X * 6.0);
    let glass = b.material(Material::glass(1.5));
    b.sphere(glass, Vec3A::new(0.0, 0.8, 0.0), 0.6);
    let coated = b.material(Material::Plastic {
        int_ior: 1.5,
        ext_ior: 1.0,
        diffuse_reflectance: Rgb::new(0.2, 0.3, 0.7).into(),
        specular_reflectance: 1.0.into(),
        nonlinear: false,
    });
    b.cuboid(coated, Vec3A::new(1.0, 0.3, 0.0), Vec3A::splat(0.3), 0.0);
    let lamp = b.diffuse(0.0, 0.0, 0.0);
    b.sphere(lamp, Vec3A::new(0.2, 3.2, 0.0), 1.2).emit(Rgb::new(8.0, 6.0, 4.0));
    b.look(Vec3A::new(0.0, 2.0, 3.5), Vec3A::new(0.0, 0.0, 0.2), 45.0, 8, 8);
    ReferenceScene::new(b.finish()).unwrap()
}

/// The point at `to`, seen from the side of `from`.
fn seen(scene: &ReferenceScene, to: Vec3A, from: Vec3A) -> SceneVertex<'_> {
    let from = from.normalize();
    scene.intersect(&Ray::new(to + from * 0.05, -from)).unwrap()
}

/// Under the ball.
fn on_the_floor(scene: &ReferenceScene) -> SceneVertex<'_> {
    seen(scene, Vec3A::new(0.1, 0.0, 0.05), Vec3A::Y)
}

/// The coating mirrors the ball.
fn on_the_block(scene: &ReferenceScene) -> SceneVertex<'_> {
    seen(scene, Vec3A::new(1.0, 0.6, 0.0), Vec3A::new(1.0, 0.3, 0.0))
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Lie {
    None,
    Twice,
    Nan,
    Negative,
    /// Says at specular vertices what it says elsewhere.
    AtMirrors,
    /// Light that comes by a Dirac delta of the vertex itself.
    CountsItsDeltas,
}

/// A map by many random rays.
struct Rays<'s> {
    scene: &'s ReferenceScene,
    numbers: RefCell<Uniforms>,
    lie: Lie,
}

impl<X: Vertex<Spectrum = Rgb>> CausticMap<X> for Rays<'_> {
    fn radiance(&self, x: &X) -> Rgb {
        let mut numbers = self.numbers.borrow_mut();
        let mut sum = Rgb::ZERO;
        for _ in 0..RAYS {
            sum += caustic_by_brute_force(self.scene, x, DEPTH, &mut numbers);
            if self.lie == Lie::CountsItsDeltas
                && let Some(sample) = x.sample(numbers.array().map(|u| u as f32), TransportMode::Radiance)
                && sample.is_specular
                && let Some(next) = self.scene.intersect(&x.spawn_ray(sample.wi))
                && !next.is_connectible()
            {
                sum += sample.throughput * Rgb::splat(1.0);
            }
        }
        let mean = sum * (1.0 / RAYS as f32);
        match self.lie {
            Lie::Twice => mean * 2.0,
            Lie::Nan => mean * f32::NAN,
            Lie::Negative => Rgb::ZERO - mean,
            Lie::AtMirrors => mean + Rgb::splat(0.1),
            Lie::None | Lie::CountsItsDeltas => mean,
        }
    }
}

fn map<'s>(scene: &'s ReferenceScene, lie: Lie) -> impl Fn(u64) -> Rays<'s> {
    move |seed| Rays { scene, numbers: RefCell::new(Uniforms::new(seed)), lie }
}

#[test]
fn maps_of_caustics_keep_their_laws() {
    let scene = scene();
    let (floor, block) = (on_the_floor(&scene), on_the_block(&scene));
    assert!(floor.is_connectible() && block.is_connectible());
    let laws = CausticLaws::new();
    let truth = |x: &SceneVertex<'_>, numbers: &mut Uniforms| caustic_by_brute_force(&scene, x, DEPTH, numbers);
    let honest = map(&scene, Lie::None);
    laws.run(SUITE.check("caustics: floor"), &floor, &honest, |numbers| truth(&floor, numbers)).expect_pass();
    laws.run(SUITE.check("caustics: block"), &block, &honest, |numbers| truth(&block, numbers)).expect_pass();
    laws.without_deltas(SUITE.check("caustics: coating"), &block, &honest).expect_pass();
    let ball = seen(&scene, Vec3A::new(0.0, 1.4, 0.0), Vec3A::new(0.2, 1.0, 0.3));
    assert!(!ball.is_connectible());
    laws.run(SUITE.twin("caustics: ball"), &ball, &honest, |_| Rgb::ZERO).expect_pass();
    laws.without_deltas(SUITE.twin("no caustics: coating"), &block, |_| NoCaustics).expect_pass();
    // The same with a vertex of the caller's own.
    let bare = WithoutDeltas(block);
    laws.run(SUITE.check("caustics: no coating"), &bare, &honest, |numbers| truth(&bare.0, numbers)).expect_pass();
}

#[test]
fn maps_of_caustics_that_lie_are_rejected() {
    let scene = scene();
    let (floor, block) = (on_the_floor(&scene), on_the_block(&scene));
    let laws = CausticLaws::new();
    let run = |lie: Lie, x: &SceneVertex<'_>| -> Report {
        let truth = |numbers: &mut Uniforms| caustic_by_brute_force(&scene, x, DEPTH, numbers);
        laws.run(SUITE.twin(&format!("caustics: {lie:?}")), x, map(&scene, lie), truth)
    };
    let finite = "the radiance of caustics is finite and not negative";
    assert_eq!(broken_exactly(run(Lie::Nan, &floor)), finite);
    assert_eq!(broken_exactly(run(Lie::Negative, &floor)), finite);
    rejects(run(Lie::Twice, &floor), "component 1");
    rejects(run(Lie::CountsItsDeltas, &block), "component 0");
    let ball = seen(&scene, Vec3A::new(0.0, 1.4, 0.0), Vec3A::Y);
    let dark = "there are no caustics where there is nothing but Dirac deltas";
    assert_eq!(broken_exactly(run(Lie::AtMirrors, &ball)), dark);

    let coating = laws.without_deltas(SUITE.twin("caustics: coating"), &block, map(&scene, Lie::CountsItsDeltas));
    rejects(coating, "component 2");
    // Light is missing.
    let truth = |numbers: &mut Uniforms| caustic_by_brute_force(&scene, &floor, DEPTH, numbers);
    rejects(laws.run(SUITE.twin("no caustics"), &floor, |_| NoCaustics, truth), "component 0");
    // A bias is forgiven only where it is allowed.
    let biased = CausticLaws::new().bias(1.2);
    biased.run(SUITE.twin("caustics: biased"), &floor, map(&scene, Lie::Twice), truth).expect_pass();
}
