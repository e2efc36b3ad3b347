//! Figure 6 of Kollig and Keller 2004: what heuristics cost at equal error.

use qmc_sampling::{Interleaved, Replications};
use scene_core::film::LayeredImage;
use serde_json::Value;
use vpl_gi::Threshold;

use super::claims::{at_least, at_most};
use super::{Context, Ratio, Report, Row, Setup, Trials, ratio_of_means};
use crate::choices::AnyHeuristic;
use crate::light_paths::LightPathSettings;
use crate::program::{EstimatorName, Failure, RenderSettings};
use crate::render::Rendering;

/// Longest paths, in segments.
const MAX_DEPTH: u32 = 6;
/// The classical heuristics: the better of the first two is what stratification is compared with.
const CLASSICAL: [AnyHeuristic; 3] = [AnyHeuristic::Balance, AnyHeuristic::Power, AnyHeuristic::Maximum];

/// Stratification by the geometry term and the peaks of scattering functions.
const STRATIFICATION: &str = "stratification";
/// Stratification by the geometry term alone, as in the paper.
const GEOMETRY_ALONE: &str = "stratification, geometry term alone";

/// Why the geometry term alone may not do.
const PEAKS: &str = "Glossy surfaces scatter in peaks that the geometry term alone does not bound: a few connections of very large value make up the error. \
     The factor for scattering functions is what takes them away.";
/// Why rays and seconds may decide differently.
const RAYS_DIFFER: &str = "The factor for scattering functions is evaluated at both ends of each connection, so that a ray costs 3 to 30 % more than \
     one of the classical heuristics: seconds show that. With the geometry term alone it costs the same.";

/// Something whose efficiency is measured.
struct Candidate {
    estimator: &'static str,
    label: String,
    settings: RenderSettings,
    threshold: Option<f32>,
    samples: u64,
    trials: Trials,
    /// Error times cost, of each trial.
    by_rays: Replications,
    by_seconds: Replications,
}

impl Candidate {
    fn new(estimator: &'static str, label: String, settings: RenderSettings, threshold: Option<f32>) -> Self {
        let trials = Trials::new();
        let (by_rays, by_seconds) = (Replications::new(), Replications::new());
        Self { estimator, label, settings, threshold, samples: 1, trials, by_rays, by_seconds }
    }

    fn push(&mut self, rendering: &Rendering, reference: &LayeredImage) -> Result<(), Failure> {
        let before = *self.trials.relative_mse();
        self.trials.push(rendering, reference)?;
        let count = self.trials.count() as f64;
        let error = self.trials.relative_mse().mean() * count - before.mean() * (count - 1.0);
        self.by_rays.push(error * rendering.rays.total() as f64);
        self.by_seconds.push(error * rendering.seconds);
        Ok(())
    }
}

/// For every scene, with interleaved and with independent light paths: renderings by the classical heuristics and by
/// stratification over a sweep of the threshold, in turn, so that the load of the machine hits all alike. The measure is relative mean
/// squared error times cost, which does not depend on the number of samples; cost is counted in rays, and in seconds.
pub(super) fn measure(context: &Context) -> Result<Report, Failure> {
    let mut report = context.report();
    let size = context.effort([40, 30], [64, 48]);
    let mut setups = Vec::new();
    for name in ["office", "conference"] {
        setups.push(Setup::builtin(context, name, size)?);
    }
    setups.extend(Setup::asset(context, "modern-hall/scene_mi3.xml", size)?);

    let mut sweeps = Vec::new();
    for setup in &mut setups {
        setup.settings.max_depth = MAX_DEPTH;
        let reference = reference(context, setup)?;
        for interleaved in [true, false] {
            let mut candidates = candidates(context, setup, interleaved)?;
            compare(context, setup, &mut candidates, &reference)?;
            report_scene(setup, interleaved, &candidates, &mut report);
            if interleaved {
                sweeps.push(candidates);
            }
        }
    }
    fixed_threshold(&sweeps, &mut report);
    Ok(report)
}

/// In units of 1/R^2.
fn thresholds(context: &Context) -> &'static [f32] {
    context.effort(&[10.0, 30.0, 100.0, 300.0, 1000.0], &[3.0, 10.0, 30.0, 100.0, 300.0, 1000.0, 3000.0])
}

fn light_paths(context: &Context, interleaved: bool, threshold: f32) -> Result<LightPathSettings, Failure> {
    let interleave = if interleaved { Some(Interleaved::new(3, 3)?) } else { None };
    Ok(LightPathSettings {
        threshold: Some(Threshold::Normalised(threshold)),
        light_paths: if interleaved { context.effort(8, 32) } else { 1 },
        interleave,
        without_lens: true,
        ..LightPathSettings::default()
    })
}

fn robust(context: &Context, setup: &Setup, interleaved: bool, threshold: f32) -> Result<RenderSettings, Failure> {
    let light_paths = light_paths(context, interleaved, threshold)?;
    Ok(RenderSettings { estimator: EstimatorName::RobustIgi, light_paths, ..setup.settings.clone() })
}

/// By robust instant global illumination, of which the tests show that it is unbiased: path tracing needs longer.
fn reference(context: &Context, setup: &Setup) -> Result<LayeredImage, Failure> {
    let settings = robust(context, setup, true, 100.0)?;
    let rendering = setup.render(&settings, context.effort(192, 256), context.seed_of("reference", 0))?;
    Ok(rendering.film.develop(0))
}

fn candidates(context: &Context, setup: &Setup, interleaved: bool) -> Result<Vec<Candidate>, Failure> {
    let mut all = Vec::new();
    for heuristic in CLASSICAL {
        let light_paths = light_paths(context, interleaved, 0.0)?;
        let settings =
            RenderSettings { estimator: EstimatorName::Bdpt, heuristic, light_paths, ..setup.settings.clone() };
        all.push(Candidate::new("bdpt", format!("{heuristic:?}").to_lowercase(), settings, None));
    }
    for &threshold in thresholds(context) {
        let settings = robust(context, setup, interleaved, threshold)?;
        all.push(Candidate::new("robust-igi", STRATIFICATION.to_owned(), settings, Some(threshold)));
    }
    // Kollig and Keller's own form.
    for &threshold in context.effort(&[100.0][..], thresholds(context)) {
        let mut settings = robust(context, setup, interleaved, threshold)?;
        settings.light_paths.geometry_alone = true;
        all.push(Candidate::new("robust-igi", GEOMETRY_ALONE.to_owned(), settings, Some(threshold)));
    }
    if interleaved {
        all.push(Candidate::new("path", "power".to_owned(), setup.settings.clone(), None));
    }
    Ok(all)
}

/// Takes about as long for each candidate as for the first with `samples`.
fn compare(
    context: &Context,
    setup: &Setup,
    candidates: &mut [Candidate],
    reference: &LayeredImage,
) -> Result<(), Failure> {
    let trials = context.effort(24, 16);
    let progress = context.progress(trials * candidates.len() as u64);
    let is_cheap =
        |candidate: &Candidate| candidate.estimator == "path" || candidate.settings.light_paths.interleave.is_none();
    for candidate in candidates.iter_mut() {
        let (cheap, dear) = context.effort((4, 1), (16, 2));
        candidate.samples = if is_cheap(candidate) { cheap } else { dear };
    }
    for trial in 0..trials {
        for candidate in candidates.iter_mut() {
            let what = format!(
                "{}, {}, {}, {:?}, {:?}",
                setup.scene.name(),
                candidate.estimator,
                candidate.label,
                candidate.threshold,
                candidate.settings.light_paths.interleave
            );
            let rendering = setup.render(&candidate.settings, candidate.samples, context.seed_of(&what, trial))?;
            candidate.push(&rendering, reference)?;
            progress.add(1);
        }
    }
    progress.finish();
    Ok(())
}

fn best<'a>(candidates: impl Iterator<Item = &'a Candidate>, cost: Cost) -> Option<&'a Candidate> {
    candidates.min_by(|a, b| cost(a).mean().total_cmp(&cost(b).mean()))
}

/// Error times cost, of each trial.
type Cost = fn(&Candidate) -> &Replications;

/// The two ways to count cost.
const COSTS: [(&str, Cost); 2] =
    [("rays", |candidate| &candidate.by_rays), ("seconds", |candidate| &candidate.by_seconds)];

fn report_scene(setup: &Setup, interleaved: bool, candidates: &[Candidate], report: &mut Report) {
    let scene = setup.scene.name();
    let sharing = if interleaved { "interleaved" } else { "independent" };
    for candidate in candidates {
        let mut params = vec![
            ("heuristic", Value::from(candidate.label.clone())),
            ("light paths", sharing.into()),
            ("spp", candidate.samples.into()),
            ("error times rays", candidate.by_rays.mean().into()),
            ("error times seconds", candidate.by_seconds.mean().into()),
        ];
        params.extend(candidate.threshold.map(|threshold| ("threshold", f64::from(threshold).into())));
        let mut row = Row::new(scene, candidate.estimator, []);
        row.params = params.into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
        report.rows.push(candidate.trials.fill(row));
    }
    let limit = if interleaved { 0.8 } else { 1.2 };
    for (name, cost) in COSTS {
        let classical = best(candidates.iter().filter(|c| c.estimator == "bdpt" && c.label != "maximum"), cost);
        let strata = best(candidates.iter().filter(|c| c.label == STRATIFICATION), cost);
        let alone = best(candidates.iter().filter(|c| c.label == GEOMETRY_ALONE), cost);
        let (Some(classical), Some(strata)) = (classical, strata) else { continue };
        let ratio = ratio_of_means(cost(strata), cost(classical));
        let claim = at_most(format!("{scene}-{sharing}-cost-in-{name}"), ratio, limit);
        report.claims.push(if name == "seconds" { claim.because(RAYS_DIFFER) } else { claim });
        if let Some(alone) = alone {
            let ratio = ratio_of_means(cost(alone), cost(classical));
            let id = format!("{scene}-{sharing}-geometry-alone-cost-in-{name}");
            report.claims.push(at_most(id, ratio, limit).because(PEAKS));
        }
        let path = candidates.iter().find(|c| c.estimator == "path");
        if let (Some(path), "office") = (path, scene) {
            let gain = ratio_of_means(cost(path), cost(strata));
            report.claims.push(at_least(format!("{scene}-gain-over-path-in-{name}"), gain, 4.0));
        }
    }
}

/// The threshold that is best for all scenes together: how much worse is it than the best of each?
fn fixed_threshold(sweeps: &[Vec<Candidate>], report: &mut Report) {
    let (name, cost) = COSTS[0];
    let strata = |candidates: &'_ [Candidate]| -> Vec<usize> {
        (0..candidates.len()).filter(|&k| candidates[k].label == STRATIFICATION).collect()
    };
    let Some(first) = sweeps.first() else { return };
    let worst = |k: usize| -> Option<Ratio> {
        let ratios = sweeps.iter().filter_map(|candidates| {
            let best = best(candidates.iter().filter(|c| c.label == STRATIFICATION), cost)?;
            Some(ratio_of_means(cost(&candidates[k]), cost(best)))
        });
        ratios.max_by(|a, b| a.value.total_cmp(&b.value))
    };
    let choices = strata(first).into_iter().filter_map(|k| Some((k, worst(k)?)));
    if let Some((k, ratio)) = choices.min_by(|a, b| a.1.value.total_cmp(&b.1.value)) {
        let threshold = first[k].threshold.unwrap_or(f32::NAN);
        report.claims.push(at_most(format!("one-threshold-{threshold}-for-all-in-{name}"), ratio, 1.15));
    }
}
