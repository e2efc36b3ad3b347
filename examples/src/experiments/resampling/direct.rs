//! Figure 4: direct light in equal time.

use qmc_sampling::Independent;
use ris::Budget;
use serde_json::Value;

use super::{
    Cost, at_least, at_most, blob_hdr, direct_light, papers_proposals, reduction, reported, strong_proposals,
    with_budget,
};
use crate::estimators::measure_cost;
use crate::experiments::{Context, Report, Row, Setup, ratio_of_means};
use crate::program::{Failure, RenderSettings};
use crate::resampling::{DirectName, ResamplingSettings};

/// Samples of direct light at each hit of a primary ray, by importance sampling.
const SAMPLES: f64 = 20.0;

/// One choice of M and N.
struct Candidate {
    label: String,
    budget: Budget,
    settings: RenderSettings,
    cost: Cost,
}

/// For the blob without and with an environment: importance sampling with N = 20, the robust choice of M and N of equal time, and a sweep of M with
/// the N of equal time. All take turns, so that the load of the machine hits all alike, and error times seconds is compared, so that what the
/// cost model gets wrong is counted.
pub(in crate::experiments) fn measure(context: &Context) -> Result<Report, Failure> {
    let mut report = context.report();
    let size = context.effort([48, 36], [160, 120]);
    let mut setups = vec![Setup::builtin(context, "blob", size)?, Setup::builtin(context, "blob-environment", size)?];
    setups.extend(blob_hdr(context, size)?);
    for setup in &setups {
        let reference_settings = direct_light(setup, with_budget(&strong_proposals(), 8.0, 8.0));
        let samples = context.effort(256, 1024);
        let reference = setup.render(&reference_settings, samples, context.seed_of("reference", 0))?.film.develop(0);
        for (proposals, resampling) in [("paper", papers_proposals()), ("strong", strong_proposals())] {
            let mut all = candidates(context, setup, proposals, &resampling)?;
            let trials = context.effort(12, 16);
            for trial in 0..trials {
                for candidate in &mut all {
                    let what = format!("{}, {proposals}, {}", setup.scene.name(), candidate.label);
                    let seed = context.seed_of(&what, trial);
                    let rendering = setup.render(&candidate.settings, context.effort(1, 20), seed)?;
                    candidate.cost.push(&rendering, &reference)?;
                    if trial == 0 && proposals == "paper" && candidate.label != "sweep" {
                        let name = format!("figure-4-{}-{}", setup.scene.name(), candidate.label);
                        context.save_picture(&name, &rendering.film.develop(0), 0.0)?;
                    }
                }
            }
            report_on(setup, proposals, &all, &mut report);
        }
    }
    Ok(report)
}

/// Importance sampling first, then the robust choice, the sweep, and next event estimation.
fn candidates(
    context: &Context,
    setup: &Setup,
    proposals: &str,
    resampling: &ResamplingSettings,
) -> Result<Vec<Candidate>, Failure> {
    let samplers = Independent::new(context.seed_of("cost", 0));
    let direct = resampling.resampled(&setup.scene, &samplers, None)?;
    let cost = measure_cost(&setup.scene, &samplers, &direct)?;
    let time = SAMPLES * (cost.candidate + cost.sample);
    let candidate = |label: &str, budget: Budget| Candidate {
        label: label.to_owned(),
        budget,
        settings: direct_light(setup, with_budget(resampling, budget.candidates, budget.samples)),
        cost: Cost::default(),
    };
    let mut all = vec![
        candidate("importance-sampling", Budget { candidates: 1.0, samples: SAMPLES as f32 }),
        candidate("robust", Budget::within(f64::from(cost.robust().candidates), cost, time)),
    ];
    for m in context.effort(&[2.0, 4.0, 8.0, 16.0, 32.0][..], &[2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0]) {
        all.push(candidate("sweep", Budget::within(*m, cost, time)));
    }
    if proposals == "strong" {
        // The usual way: one emitter, one scattered ray, the power heuristic; as often as importance sampling samples.
        let mut nee = candidate("next-event", Budget { candidates: 1.0, samples: 1.0 });
        nee.settings.resampling = ResamplingSettings { direct: DirectName::Nee, ..ResamplingSettings::default() };
        all.push(nee);
    }
    Ok(all)
}

fn report_on(setup: &Setup, proposals: &str, all: &[Candidate], report: &mut Report) {
    let scene = setup.scene.name();
    for candidate in all {
        let params = [
            ("proposals", Value::from(proposals)),
            ("choice", candidate.label.clone().into()),
            ("M", f64::from(candidate.budget.candidates).into()),
            ("N", f64::from(candidate.budget.samples).into()),
            ("error times seconds", candidate.cost.by_seconds.mean().into()),
            ("error times rays", candidate.cost.by_rays.mean().into()),
        ];
        report.rows.push(candidate.cost.trials.fill(Row::new(scene, "direct", params)));
    }
    let importance = &all[0].cost.by_seconds;
    let robust = &all[1].cost.by_seconds;
    let of_resampling = all.iter().filter(|candidate| candidate.label != "next-event");
    let Some(best) = of_resampling.min_by(|a, b| a.cost.by_seconds.mean().total_cmp(&b.cost.by_seconds.mean())) else {
        return;
    };
    let gain = reduction(ratio_of_means(robust, importance));
    let id = format!("{scene}-{proposals}-variance-reduction-of-the-robust-choice");
    report.claims.push(match (proposals, scene) {
        ("paper", "blob") => at_least(id, gain, 0.1),
        ("paper", _) => at_least(id, gain, 0.7),
        _ => reported(id, gain),
    });
    let id = format!("{scene}-{proposals}-robust-over-best-choice");
    report.claims.push(at_most(id, ratio_of_means(robust, &best.cost.by_seconds), 2.0));
    if let Some(nee) = all.iter().find(|candidate| candidate.label == "next-event") {
        let gain = reduction(ratio_of_means(robust, &nee.cost.by_seconds));
        report
            .claims
            .push(reported(format!("{scene}-{proposals}-variance-reduction-over-next-event-estimation"), gain));
    }
}
