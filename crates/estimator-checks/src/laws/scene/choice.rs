//! The laws of `EmitterChoice`.

use scene_core::{Emitter, EmitterChoice, EmitterId, Spectrum, SurfacePoint};

use crate::laws::{Law, hold, near};
use crate::outcome::{Outcome, Report};
use crate::pearson::chi_square_counts;
use crate::suite::Check;

/// Numbers that choose.
const CHOICES: usize = 40_000;
/// Directions in which an emitter is asked for light.
const DIRECTIONS: usize = 64;

/// Checks the laws of an [`EmitterChoice`] among `emitters`, for the point `from` or for the start of a light path.
///
/// ```text
/// (1)  probabilities lie in [0, 1] and sum to one, or nothing is ever chosen and all are zero
/// (2)  the chosen emitter exists, and comes with its probability
/// (3)  an emitter that shines on `from`, were nothing in the way, has a positive probability
/// (4)  emitters are chosen with their probabilities                                     chi-square
/// ```
///
/// (1) to (3) are exact, but for round-off. The report has two outcomes, or one if nothing is ever chosen.
/// Cost: 40 000 choices.
///
/// ```
/// use estimator_checks::{Check, laws::scene::check_emitter_choice};
/// use scene_core::{ReferenceScene, Scene, UniformChoice, builtin::Builtin};
///
/// let scene = ReferenceScene::new(Builtin::named("cornell-box").expect("it is one").description())?;
/// let choice = UniformChoice::new(scene.emitters().len());
/// check_emitter_choice(Check::new("uniform", 1e-6)?, &choice, None, scene.emitters()).expect_pass();
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn check_emitter_choice<E: Emitter>(
    check: Check,
    choice: &impl EmitterChoice,
    from: Option<&SurfacePoint>,
    emitters: &[E],
) -> Report {
    let ids = (0..emitters.len()).map(|i| EmitterId(i as u32));
    let probabilities: Vec<f32> = ids.map(|id| choice.probability(from, id)).collect();
    let mut uniforms = check.uniforms();
    let mut counts = vec![0; emitters.len()];
    let mut laws = || {
        let sum = sums_to_one(&probabilities)?;
        for i in 0..CHOICES {
            let u = [0.0, 1.0_f32.next_down()].get(i).copied().unwrap_or_else(|| uniforms.next_f32());
            let chosen = choice.choose(from, u);
            let shown = || format!("{chosen:?} of {u}, and the probabilities sum to {sum}");
            hold("something is chosen if there is anything", chosen.is_some() == (sum > 0.0), shown)?;
            let Some(chosen) = chosen else { continue };
            let expected = probabilities.get(chosen.id.index());
            hold("the chosen emitter exists", expected.is_some(), || format!("{chosen:?} of {}", emitters.len()))?;
            let same = expected.is_some_and(|&p| p > 0.0 && near(chosen.probability.into(), p.into(), 1e-4));
            let shown = || format!("{chosen:?} of {u}, probability() is {expected:?}");
            hold("the chosen emitter comes with its probability", same, shown)?;
            counts[chosen.id.index()] += 1;
        }
        shines(&probabilities, from, emitters)
    };
    let exact = Outcome::of_laws(check.test(), laws());
    let mut outcomes = vec![exact];
    let sum: f64 = probabilities.iter().map(|&p| f64::from(p)).sum();
    // A single emitter is chosen for certain.
    if outcomes[0].passed() && sum > 0.0 && probabilities.iter().filter(|&&p| p > 0.0).count() > 1 {
        let probabilities: Vec<f64> = probabilities.iter().map(|&p| f64::from(p) / sum).collect();
        outcomes.push(chi_square_counts(check, &counts, &probabilities));
    }
    Report { outcomes }
}

/// (1): the sum, zero or one.
fn sums_to_one(probabilities: &[f32]) -> Result<f64, crate::Violation> {
    for (i, p) in probabilities.iter().enumerate() {
        hold("probabilities lie in [0, 1]", (0.0..=1.0).contains(p), || format!("that of emitter {i} is {p}"))?;
    }
    let sum: f64 = probabilities.iter().map(|&p| f64::from(p)).sum();
    let shown = || format!("their sum is {sum}, of {} emitters", probabilities.len());
    hold("probabilities sum to one, or to zero", sum == 0.0 || (sum - 1.0).abs() < 1e-4, shown)?;
    Ok(sum)
}

/// (3)
fn shines<E: Emitter>(probabilities: &[f32], from: Option<&SurfacePoint>, emitters: &[E]) -> Law {
    for (i, emitter) in emitters.iter().enumerate() {
        let has_light = match from {
            None => !emitter.power().is_black(),
            Some(point) => (0..DIRECTIONS).any(|k| {
                let u = [(k % 8) as f32 / 8.0 + 0.05, (k / 8) as f32 / 8.0 + 0.05];
                emitter.sample_direct(point.position, u).is_some_and(|sample| !sample.radiance.is_black())
            }),
        };
        let shown = || format!("emitter {i} shines on {from:?}");
        hold("what shines may be chosen", !has_light || probabilities[i] > 0.0, shown)?;
    }
    Ok(())
}
