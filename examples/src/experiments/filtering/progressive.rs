//! Figure 3: input and filtered image by the number of samples.

use super::{Report, Row, Variant, at_least, gain, reported, run};
use crate::experiments::{Context, Setup};
use crate::filters::{FilterSettings, PathFilterName};
use crate::program::{Failure, RenderSettings};

/// Side of the square of pixels as large as the disk: a little more than the program's.
const RADIUS: f32 = 4.0;

/// On the builtin interior, and on the living room if there is one: 1, 4, 16, .. samples per pixel, by range search and by hash. The last number is that of the paper's figure in the quick form.
pub(in crate::experiments) fn measure(context: &Context) -> Result<Report, Failure> {
    let mut report = context.report();
    let size = context.effort([120, 90], [320, 240]);
    let mut setups = vec![(Setup::builtin(context, "interior", size)?, context.effort(4, 6))];
    if let Some(setup) = Setup::asset(context, "living-room/scene_mi3.xml", context.effort([128, 72], [320, 180]))? {
        setups.push((setup, context.effort(3, 5)));
    }
    for (setup, trials) in &setups {
        let reference = setup.reference(context, context.effort(1280, 2048))?;
        for &samples in context.effort(&[1, 4, 16][..], &[1, 4, 16, 64]) {
            let usual = FilterSettings { filter_radius: RADIUS, ..FilterSettings::default() };
            let hash = RenderSettings {
                path_filter: Some(PathFilterName::PsfHash),
                ..super::filtered(&setup.settings, usual.clone())
            };
            let mut variants = [
                Variant::new("input", setup.settings.clone()),
                Variant::filtered("psf", setup, usual),
                Variant::new("psf-hash", hash),
            ];
            run(context, setup, &reference, &mut variants, samples, *trials)?;
            let [input, psf, hash] = &variants;
            let rows: Vec<Row> = variants.iter().map(|variant| variant.row(setup, samples)).collect();
            report.rows.extend(rows);
            let id = |what: &str| format!("{}-gain-{what}-{samples}-spp", setup.scene.name());
            // At 16 samples the paper's picture; elsewhere it may not be worse.
            let limit = if samples == 16 { 5.0 } else { 1.0 };
            report.claims.push(at_least(id("psf"), gain(&psf.trials, &input.trials), limit));
            report.claims.push(reported(id("hash"), gain(&hash.trials, &input.trials)));
        }
    }
    Ok(report)
}
