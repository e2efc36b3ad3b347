//! Figure 7: a fence with one light path per pixel and three more camera samples.

use super::{Report, Variant, at_least, gain, reported, run};
use crate::experiments::{Context, Setup};
use crate::filters::FilterSettings;
use crate::program::Failure;

/// One path per pixel: the input, filtered, and filtered with three more camera samples; beside the input with four paths.
pub(in crate::experiments) fn measure(context: &Context) -> Result<Report, Failure> {
    let mut report = context.report();
    let setup = Setup::builtin(context, "fence", context.effort([160, 120], [400, 300]))?;
    let reference = setup.reference(context, context.effort(512, 4096))?;
    let trials = context.effort(6, 16);
    let extra = FilterSettings { filter_extra: 3, ..FilterSettings::default() };
    let mut variants = [
        Variant::new("input", setup.settings.clone()),
        Variant::filtered("psf", &setup, FilterSettings::default()),
        Variant::filtered("psf-3-more", &setup, extra),
    ];
    run(context, &setup, &reference, &mut variants, 1, trials)?;
    let mut four = [Variant::new("input", setup.settings.clone())];
    run(context, &setup, &reference, &mut four, 4, trials)?;
    report.rows.extend(variants.iter().map(|variant| variant.row(&setup, 1)));
    report.rows.extend(four.iter().map(|variant| variant.row(&setup, 4)));
    let [input, psf, more] = &variants;
    report.claims.push(at_least("fence-gain-psf", gain(&psf.trials, &input.trials), 1.0));
    report.claims.push(at_least(
        "fence-gain-of-three-more-camera-samples".to_owned(),
        gain(&more.trials, &psf.trials),
        1.5,
    ));
    report.claims.push(at_least("fence-gain-over-the-input", gain(&more.trials, &input.trials), 2.0));
    report.claims.push(reported("fence-gain-over-four-paths", gain(&more.trials, &four[0].trials)));
    Ok(report)
}
