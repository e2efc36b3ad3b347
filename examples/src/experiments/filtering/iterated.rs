//! Figure 2: averages of averages.

use qmc_sampling::Replications;

use super::{Claim, Report, Variant, at_least, gain, reported, run};
use crate::experiments::{Context, Ratio, Setup, ratio_of_means};
use crate::filters::FilterSettings;
use crate::program::Failure;

/// In the Cornell box, whose noise has no fireflies, at 4 samples per pixel: noise and error by the number of iterations, and the radius that smooths as much at once.
pub(in crate::experiments) fn measure(context: &Context) -> Result<Report, Failure> {
    let mut report = context.report();
    let setup = Setup::builtin(context, "cornell-box", context.effort([96, 96], [256, 256]))?;
    let reference = setup.reference(context, context.effort(768, 4096))?;
    let (samples, groups, trials) = (4, 3, context.effort(2, 4));
    let of = |iterations, radius| FilterSettings {
        filter_iterations: iterations,
        filter_radius: radius,
        ..FilterSettings::default()
    };
    let make = || {
        [
            Variant::new("input", setup.settings.clone()),
            Variant::filtered("once", &setup, of(1, 3.0)),
            Variant::filtered("twice", &setup, of(2, 3.0)),
            Variant::filtered("four-times", &setup, of(4, 3.0)),
            Variant::filtered("once-twice-as-far", &setup, of(1, 6.0)),
        ]
    };
    let mut all = make();
    let mut noise: [Replications; 5] = Default::default();
    // Variances of a few renderings each, relative to the truth: those of the edges of the lamp would hide all others.
    let truth = reference.rgb()?;
    for group in 0..groups {
        let mut variants = make();
        let of_group = Context { seed: context.seed_of("group", group), ..context.clone() };
        run(&of_group, &setup, &reference, &mut variants, samples, trials)?;
        for ((noise, variant), all) in noise.iter_mut().zip(&variants).zip(&mut all) {
            noise.push(variant.trials.relative_variance(&truth));
            if group == 0 {
                all.trials = variant.trials.clone();
            }
        }
    }
    report.rows.extend(all.iter().map(|variant| variant.row(&setup, samples)));
    let [input, once, twice, four, far] = &noise;
    let less = |id: &str, worse: &Replications, better: &Replications| -> Claim {
        let ratio: Ratio = ratio_of_means(worse, better);
        at_least(format!("cornell-box-noise-{id}"), ratio, 1.0)
    };
    report.claims.push(less("input-over-once", input, once));
    report.claims.push(less("once-over-twice", once, twice));
    report.claims.push(less("twice-over-four-times", twice, four));
    report.claims.push(less("once-over-once-twice-as-far", once, far));
    let [input, once, _, four, _] = &all;
    report.claims.push(at_least(
        "cornell-box-gain-of-four-iterations".to_owned(),
        gain(&four.trials, &input.trials),
        1.0,
    ));
    report.claims.push(reported("cornell-box-gain-of-three-more-iterations", gain(&four.trials, &once.trials)));
    Ok(report)
}
