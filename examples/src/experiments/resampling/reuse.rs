//! Reuse between pixels against resampling alone, in equal time.

use qmc_sampling::Replications;
use ris::Budget;
use scene_core::film::Filter;
use serde_json::Value;

use super::{at_least, direct_light, papers_proposals, with_budget};
use crate::experiments::{Context, Report, Row, Setup, Trials, ratio_of_means};
use crate::program::{EstimatorName, Failure, RenderSettings};
use crate::resampling::{DirectName, ResamplingSettings};

/// Numbers of candidates for resampling alone: reuse has to beat the best of them.
const ALONE: [f32; 4] = [4.0, 16.0, 64.0, 256.0];
/// Rounds of reuse with three neighbours each, number of candidates, and whether visibility is left out of the target.
const WITH_REUSE: [(u32, f32, bool); 5] =
    [(2, 128.0, true), (3, 32.0, false), (4, 64.0, false), (4, 128.0, false), (5, 64.0, false)];
/// Radius in pixels.
const RADIUS: f32 = 6.0;
/// Radius of the reconstruction filter, in pixels.
const NARROW: f32 = 1e-3;

/// Groups of renderings: each gives an estimate of the variance, from so many of so many samples per pixel.
const GROUPS: u64 = 4;
const TRIALS: u64 = 2;
const SAMPLES: u64 = 4;

struct Candidate {
    /// Rounds of reuse; zero is resampling alone.
    rounds: u32,
    candidates: f32,
    unshadowed: bool,
    settings: RenderSettings,
    last: Trials,
    variance: Replications,
    by_seconds: Replications,
    by_rays: Replications,
}

/// For the blob under a sky with the paper's proposals, and for many lights with those of the program: the variance times seconds of resampling
/// with several numbers of candidates, with and without reuse, all in turn. Rays go through the centres of the pixels, so that nothing but the light
/// varies; the variance of a pixel is that over its squared value plus 0.01, by path tracing.
pub(in crate::experiments) fn measure(context: &Context) -> Result<Report, Failure> {
    let mut report = context.report();
    let size = context.effort([120, 90], [400, 300]);
    let mut setups = vec![
        (Setup::builtin(context, "blob-environment", size)?, papers_proposals()),
        (Setup::builtin(context, "lantern-field", size)?, ResamplingSettings::default()),
    ];
    if !context.quick {
        setups.push((Setup::builtin(context, "blob", size)?, papers_proposals()));
        let asset = Setup::asset(context, "many-lights/scene.scn", size)?;
        setups.extend(asset.map(|setup| (setup, ResamplingSettings::default())));
    }
    for (setup, proposals) in &setups {
        let path = RenderSettings { max_depth: 2, filter: Filter::tent(NARROW)?, ..setup.settings.clone() };
        let samples = context.effort(64, 256);
        let reference = setup.render(&path, samples, context.seed_of("reference", 0))?.film.develop(0).rgb()?;
        let alone = ALONE.iter().map(|&m| candidate(setup, proposals, (0, m, true)));
        let mut all = alone.collect::<Result<Vec<Candidate>, Failure>>()?;
        for &with in &WITH_REUSE {
            all.push(candidate(setup, proposals, with)?);
        }
        for group in 0..GROUPS {
            for candidate in &mut all {
                let mut trials = Trials::new();
                for trial in 0..TRIALS {
                    let what = format!("{}, {}", setup.scene.name(), candidate.label());
                    let seed = context.seed_of(&what, group * TRIALS + trial);
                    let rendering = setup.render(&candidate.settings, SAMPLES, seed)?;
                    let image = rendering.film.develop(0);
                    trials.push(&rendering, &image)?;
                    if group == 0 && trial == 0 {
                        let name = format!("{}-{}", setup.scene.name(), candidate.label());
                        context.save_picture(&name, &image, 0.0)?;
                    }
                }
                candidate.push(&trials, &reference);
            }
        }
        report_on(setup, &all, &mut report);
    }
    Ok(report)
}

impl Candidate {
    fn push(&mut self, trials: &Trials, reference: &[[f32; 3]]) {
        let variance = trials.relative_variance(reference);
        self.variance.push(variance);
        self.by_seconds.push(variance * trials.seconds().mean());
        self.by_rays.push(variance * trials.rays().mean());
        self.last = trials.clone();
    }

    fn label(&self) -> String {
        let visibility = if self.rounds > 0 && !self.unshadowed { "-visibility" } else { "" };
        format!("rounds-{}-m{}{visibility}", self.rounds, self.candidates)
    }
}

fn candidate(
    setup: &Setup,
    proposals: &ResamplingSettings,
    (rounds, candidates, unshadowed): (u32, f32, bool),
) -> Result<Candidate, Failure> {
    let resampling = ResamplingSettings {
        reuse_rounds: rounds,
        reuse_neighbours: 3,
        reuse_radius: RADIUS,
        reuse_unshadowed: unshadowed,
        direct: DirectName::Ris,
        ..with_budget(proposals, Budget::new(candidates.into(), 1.0))
    };
    let mut settings = direct_light(setup, resampling);
    if rounds > 0 {
        settings.estimator = EstimatorName::RestirDirect;
    }
    settings.filter = Filter::tent(NARROW)?;
    let (last, variance) = (Trials::new(), Replications::new());
    let (by_seconds, by_rays) = (Replications::new(), Replications::new());
    Ok(Candidate { rounds, candidates, unshadowed, settings, last, variance, by_seconds, by_rays })
}

fn report_on(setup: &Setup, all: &[Candidate], report: &mut Report) {
    let scene = setup.scene.name();
    for candidate in all {
        let params = [
            ("M", Value::from(f64::from(candidate.candidates))),
            ("rounds", candidate.rounds.into()),
            ("visibility in the target", (!candidate.unshadowed).into()),
            ("relative variance", candidate.variance.mean().into()),
            ("times seconds", candidate.by_seconds.mean().into()),
            ("times rays", candidate.by_rays.mean().into()),
        ];
        let estimator = if candidate.rounds > 0 { "restir-direct" } else { "direct" };
        report.rows.push(Row { rel_mse: 0.0, ..candidate.last.fill(Row::new(scene, estimator, params)) });
    }
    let best = |reuses: bool| {
        let some = all.iter().filter(move |candidate| (candidate.rounds > 0) == reuses);
        some.min_by(|a, b| a.by_seconds.mean().total_cmp(&b.by_seconds.mean()))
    };
    let (Some(alone), Some(with)) = (best(false), best(true)) else { return };
    let gain = ratio_of_means(&alone.by_seconds, &with.by_seconds);
    let claim = at_least(format!("{scene}-gain-of-reuse-in-seconds"), gain, 4.0);
    report.claims.push(claim.because(
        "Reuse pays for candidates, which cost time and hardly any rays. Where occlusion is what varies (blob: two area lights, of which more \
         candidates find nothing new), or where neighbours see other lamps (many-lights: small balls in each other's way), each round's shadow \
         rays eat the gain.",
    ));
    let rays = ratio_of_means(&alone.by_rays, &with.by_rays);
    let id = format!("{scene}-gain-of-reuse-in-rays");
    report.claims.push(super::reported(id, rays));
}
