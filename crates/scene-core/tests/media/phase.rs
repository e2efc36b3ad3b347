//! The phase function: samples against the density, and its mean cosine.

use estimator_checks::{Check, ChiSquare, Moments, Outcome, Sphere, mean_is};
use scene_core::glam::Vec3A;
use scene_core::medium::HenyeyGreenstein;

use super::SUITE;

const G: [f32; 4] = [-0.7, 0.0, 0.35, 0.9];
const BEFORE: Vec3A = Vec3A::new(0.48, 0.6, -0.64);

fn phase(g: f32) -> HenyeyGreenstein {
    HenyeyGreenstein::new(g).unwrap()
}

fn follows(check: Check, sampled: HenyeyGreenstein, density: impl Fn(Vec3A) -> f32) -> Outcome {
    let sample = |[u, v, _]: [f64; 3]| Some(sampled.sample(BEFORE, [u as f32, v as f32]).to_array());
    let density = |w: [f64; 3]| f64::from(density(Vec3A::from(w.map(|x| x as f32))));
    ChiSquare::on(Sphere).samples(60_000).run(check, sample, density)
}

#[test]
fn directions_follow_the_density() {
    for g in G {
        follows(SUITE.check(&format!("phase {g}")), phase(g), |w| phase(g).pdf(BEFORE, w)).expect_pass();
    }
    follows(SUITE.twin("phase 0.35: density forgotten"), phase(0.35), |_| phase(0.0).eval(0.0)).expect_reject();
    follows(SUITE.twin("phase 0.35: sign of g"), phase(0.35), |w| phase(-0.35).pdf(BEFORE, w)).expect_reject();
    follows(SUITE.twin("phase 0.35: angle from behind"), phase(0.35), |w| phase(0.35).pdf(-BEFORE, w)).expect_reject();
}

#[test]
fn g_is_the_mean_cosine() {
    let cosines = |check: &Check, g: f32| -> Moments {
        let mut uniforms = check.uniforms();
        (0..40_000)
            .map(|_| {
                let [u, v] = uniforms.array::<2>().map(|x| x as f32);
                f64::from(phase(g).sample(BEFORE, [u, v]).dot(BEFORE))
            })
            .collect()
    };
    for g in G {
        let check = SUITE.check(&format!("mean cosine {g}"));
        let moments = cosines(&check, g);
        mean_is(check, &moments, estimator_checks::Truth { value: f64::from(g), error: 1e-5 }).expect_pass();
    }
    let twin = SUITE.twin("mean cosine 0.35: g squared");
    let moments = cosines(&twin, 0.35);
    mean_is(twin, &moments, 0.35 * 0.35).expect_reject();
}
