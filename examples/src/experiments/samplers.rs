//! What each sampler gains over independent numbers.

use serde_json::Value;

use super::claims::above;
use super::{Context, Report, Row, Setup, Trials, ratio_of_means};
use crate::program::{Failure, RenderSettings};
use crate::samplers::SamplerName;

const SCENE: &str = "cornell-box";
/// Samples per pixel of `independent`, and of all others where samples are equal.
const SAMPLES: u64 = 64;
/// What all others are compared with.
const BASELINE: SamplerName = SamplerName::Independent;

/// Why large bases may not pay.
const DEAR_NUMBERS: &str = "A path of this scene takes a microsecond, beside which the numbers are dear: radical inverses in large bases double its time.";

/// Renders the Cornell box by path tracing with every sampler and several seeds, at equal samples per pixel and in equal time.
///
/// The gain of a sampler is the relative mean squared error of [`BASELINE`] over its own: above one, it is better. In
/// equal time, a sampler takes as many samples as it can in the time that the baseline needs for [`SAMPLES`], by the
/// times measured at equal samples; renderings of all samplers take turns, so that the load of the machine hits all
/// of them alike.
pub(super) fn measure(context: &Context) -> Result<Report, Failure> {
    let trials = context.effort(8, 16);
    let side = context.effort(48, 96);
    let setup = Setup::builtin(context, SCENE, [side; 2])?;
    let names = SamplerName::all();
    let progress = context.progress(2 * trials * names.len() as u64);
    let reference = setup.reference(context, context.effort(4096, 8192))?;

    // Render all samplers in turn, each with its number of samples.
    let compare = |stage: &str, samples: &[u64], pictures: bool| -> Result<Vec<Trials>, Failure> {
        let mut all = vec![Trials::new(); names.len()];
        for trial in 0..trials {
            for ((&sampler, &samples), of_sampler) in names.iter().zip(samples).zip(&mut all) {
                let settings = RenderSettings { sampler, ..setup.settings.clone() };
                let seed = context.seed_of(&format!("{stage}, {}", sampler.name()), trial);
                let rendering = setup.render(&settings, samples, seed)?;
                of_sampler.push(&rendering, &reference)?;
                if trial == 0 && pictures {
                    context.save_picture(&sampler.name(), &rendering.film.develop(rendering.light_paths), 0.0)?;
                }
                progress.add(1);
            }
        }
        Ok(all)
    };
    let equal_samples = compare("equal samples", &vec![SAMPLES; names.len()], true)?;
    let baseline = names.iter().position(|&name| name == BASELINE).ok_or("the baseline is no sampler")?;
    let cost = |trials: &Trials| trials.seconds().mean() / equal_samples[baseline].seconds().mean();
    let affordable: Vec<u64> =
        equal_samples.iter().map(|trials| ((SAMPLES as f64 / cost(trials)).round() as u64).max(1)).collect();
    let equal_time = compare("equal time", &affordable, false)?;
    progress.finish();

    // Report.
    let mut report = context.report();
    for (stage, all, samples) in
        [("samples", &equal_samples, vec![SAMPLES; names.len()]), ("time", &equal_time, affordable)]
    {
        for ((&sampler, trials), samples) in names.iter().zip(all).zip(samples) {
            let params = [
                ("equal", Value::from(stage)),
                ("sampler", sampler.name().into()),
                ("spp", samples.into()),
                ("size", format!("{side}x{side}").into()),
            ];
            report.rows.push(trials.fill(Row::new(setup.scene.name(), "path", params)));
            if sampler != BASELINE {
                let gain = ratio_of_means(all[baseline].relative_mse(), trials.relative_mse());
                let claim = above(format!("gain-of-{}-at-equal-{stage}", sampler.name()), gain, 1.0);
                report.claims.push(match (sampler, stage) {
                    (SamplerName::GlobalHalton, "time") => claim.because(DEAR_NUMBERS),
                    _ => claim,
                });
            }
        }
    }
    Ok(report)
}
