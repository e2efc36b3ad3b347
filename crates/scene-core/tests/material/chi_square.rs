//! Samplers against their densities by chi-square tests of `estimator-checks`. (Throughputs and values are compared in
//! `robust` and `quadrature`, exactly.)

use estimator_checks::{Check, ChiSquare, FALSE_POSITIVE_RATE, Outcome, Sphere, Suite};
use scene_core::TransportMode;
use scene_core::glam::Vec3A;
use scene_core::material::{Bsdf, Distribution};

use crate::cases::{self, compiled};
use crate::laws::direction;

const COSINES: [f32; 3] = [0.9, 0.25, -0.5];

static SUITE: Suite =
    Suite::with_share("scene-core materials", cases::SCATTERING.len() * COSINES.len(), FALSE_POSITIVE_RATE / 10.0);

fn check(check: Check, sampled: &Bsdf<'_>, evaluated: &Bsdf<'_>, wo: Vec3A) -> Outcome {
    let mode = TransportMode::Importance;
    let sample = |u: [f64; 3]| {
        let u = u.map(|x| (x as f32).min(1.0 - f32::EPSILON / 2.0));
        sampled.sample(wo, u, mode).filter(|s| !s.is_specular).map(|s| s.wi.to_array())
    };
    let density = |w: [f64; 3]| f64::from(evaluated.pdf(wo, Vec3A::from(w.map(|x| x as f32)), mode));
    ChiSquare::on(Sphere).samples(60_000).run(check, sample, density)
}

#[test]
fn samplers_follow_their_densities() {
    for name in cases::SCATTERING {
        let material = compiled(name);
        let bsdf = material.resolve([0.3, 0.4]);
        for cos in COSINES {
            if cos > 0.0 || material.is_two_sided() {
                check(SUITE.check(&format!("{name} {cos}")), &bsdf, &bsdf, direction(cos, 0.2)).expect_pass();
            }
        }
    }
}

/// The planted bug: the sampler believes the surface to be a little smoother.
#[test]
fn other_roughness_is_noticed() {
    for distribution in [Distribution::Ggx, Distribution::Beckmann] {
        let [right, wrong] =
            [0.3, 0.28].map(|alpha| cases::rough_conductor("Cu", distribution, [alpha; 2]).compile().unwrap());
        let (right, wrong) = (right.resolve([0.0; 2]), wrong.resolve([0.0; 2]));
        let twin = SUITE.twin(&format!("{distribution:?} of other roughness"));
        check(twin, &wrong, &right, direction(0.6, 0.2)).expect_reject();
    }
}

/// The planted bug: the sampler takes the surface for a little less metallic, and so chooses the lobes otherwise.
#[test]
fn other_metalness_is_noticed() {
    let [right, wrong] =
        [0.5, 0.4].map(|metallic| cases::metallic_roughness(cases::RED, metallic, 0.5).compile().unwrap());
    let (right, wrong) = (right.resolve([0.0; 2]), wrong.resolve([0.0; 2]));
    check(SUITE.twin("other metalness"), &wrong, &right, direction(0.6, 0.2)).expect_reject();
}
