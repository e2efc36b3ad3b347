//! Reuse between pixels against resampling alone, in equal time.

use serde_json::Value;

use super::{Cost, at_least, direct_light, papers_proposals, strong_proposals, with_budget};
use crate::experiments::{Claim, Context, Report, Row, Setup, ratio_of_means};
use crate::program::{EstimatorName, Failure, RenderSettings};
use crate::resampling::{DirectName, ResamplingSettings};

/// Numbers of candidates for resampling alone: reuse has to beat the best of them.
const ALONE: [f32; 4] = [2.0, 8.0, 32.0, 128.0];
/// Rounds of reuse with three neighbours each, number of candidates, and whether visibility is left out of the target.
const WITH_REUSE: [(u32, f32, bool); 5] =
    [(2, 8.0, true), (2, 8.0, false), (3, 2.0, false), (4, 8.0, false), (5, 8.0, false)];
/// Radius in pixels.
const RADIUS: f32 = 8.0;

struct Candidate {
    /// Rounds of reuse; zero is resampling alone.
    rounds: u32,
    candidates: f32,
    unshadowed: bool,
    settings: RenderSettings,
    cost: Cost,
}

/// For the blob under a sky with the paper's proposals, and for many lights with those of the program: the variance times seconds of resampling
/// with several numbers of candidates, with and without reuse, all in turn.
pub(in crate::experiments) fn measure(context: &Context) -> Result<Report, Failure> {
    let mut report = context.report();
    let size = context.effort([64, 48], [160, 120]);
    let mut setups = vec![
        (Setup::builtin(context, "blob-environment", size)?, papers_proposals()),
        (Setup::builtin(context, "blob", size)?, papers_proposals()),
        (Setup::builtin(context, "lantern-field", size)?, ResamplingSettings::default()),
    ];
    let asset = Setup::asset(context, "many-lights/scene.scn", size)?;
    setups.extend(asset.map(|setup| (setup, ResamplingSettings::default())));
    for (setup, proposals) in &setups {
        let settings = direct_light(setup, with_budget(&strong_proposals(), 16.0, 4.0));
        let samples = context.effort(256, 1024);
        let reference = setup.render(&settings, samples, context.seed_of("reference", 0))?.film.develop(0);
        let alone = ALONE.iter().map(|&m| candidate(setup, proposals, (0, m, true)));
        let mut all: Vec<Candidate> = alone.collect();
        all.extend(WITH_REUSE.iter().map(|&with| candidate(setup, proposals, with)));
        for trial in 0..context.effort(8, 16) {
            for candidate in &mut all {
                let what = format!("{}, {}", setup.scene.name(), candidate.label());
                let samples = context.effort(2, 8);
                let rendering = setup.render(&candidate.settings, samples, context.seed_of(&what, trial))?;
                candidate.cost.push(&rendering, &reference)?;
                if trial == 0 {
                    let name = format!("{}-{}", setup.scene.name(), candidate.label());
                    context.save_picture(&name, &rendering.film.develop(0), 0.0)?;
                }
            }
        }
        report_on(setup, &all, &mut report);
    }
    Ok(report)
}

impl Candidate {
    fn label(&self) -> String {
        let visibility = if self.rounds > 0 && !self.unshadowed { "-visibility" } else { "" };
        format!("rounds-{}-m{}{visibility}", self.rounds, self.candidates)
    }
}

fn candidate(
    setup: &Setup,
    proposals: &ResamplingSettings,
    (rounds, candidates, unshadowed): (u32, f32, bool),
) -> Candidate {
    let resampling = ResamplingSettings {
        reuse_rounds: rounds,
        reuse_neighbours: 3,
        reuse_radius: RADIUS,
        reuse_unshadowed: unshadowed,
        direct: DirectName::Ris,
        ..with_budget(proposals, candidates, 1.0)
    };
    let mut settings = direct_light(setup, resampling);
    if rounds > 0 {
        settings.estimator = EstimatorName::RestirDirect;
    }
    Candidate { rounds, candidates, unshadowed, settings, cost: Cost::default() }
}

fn report_on(setup: &Setup, all: &[Candidate], report: &mut Report) {
    let scene = setup.scene.name();
    for candidate in all {
        let params = [
            ("M", Value::from(f64::from(candidate.candidates))),
            ("rounds", candidate.rounds.into()),
            ("visibility in the target", (!candidate.unshadowed).into()),
            ("error times seconds", candidate.cost.by_seconds.mean().into()),
            ("error times rays", candidate.cost.by_rays.mean().into()),
        ];
        let estimator = if candidate.rounds > 0 { "restir-direct" } else { "direct" };
        report.rows.push(candidate.cost.trials.fill(Row::new(scene, estimator, params)));
    }
    let best = |reuses: bool| {
        let some = all.iter().filter(move |candidate| (candidate.rounds > 0) == reuses);
        some.min_by(|a, b| a.cost.by_seconds.mean().total_cmp(&b.cost.by_seconds.mean()))
    };
    let (Some(alone), Some(with)) = (best(false), best(true)) else { return };
    let gain = ratio_of_means(&alone.cost.by_seconds, &with.cost.by_seconds);
    report.claims.push(at_least(format!("{scene}-gain-of-reuse-in-seconds"), gain, 4.0));
    let rays = ratio_of_means(&alone.cost.by_rays, &with.cost.by_rays);
    let id = format!("{scene}-gain-of-reuse-in-rays");
    report.claims.push(Claim { holds: true, ..super::reported(id, rays) });
}
