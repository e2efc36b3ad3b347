//! Figure 3: where more candidates pay, and where more samples do.

use std::time::Instant;

use qmc_sampling::{Independent, Replications};
use ris::{Budget, CostModel, Objective};
use scene_core::film::LayeredImage;
use serde_json::Value;

use super::{at_centres, at_least, direct_light, equals, models, papers_proposals, predicted, reported, with_budget};
use crate::estimators::{EnvironmentSampling, ResampledDirect, measure_cost};
use crate::experiments::{Claim, Context, Ratio, Report, Row, Setup};
use crate::program::Failure;
use crate::resampling::ResamplingSettings;

/// The two settings of the figure, of equal time in the paper.
const FEW: Budget = Budget::new(1.0, 20.0);
const MANY: Budget = Budget::new(60.0, 1.0);
/// Neighbours whose candidates a pixel's model takes in.
const POOL: usize = 1;

/// Variance models of all pixels from candidates with their visibility, the map of the optimal M, and renderings with M = 1, N = 20 and M = 60, N = 1
/// whose variances per pixel the models predict.
pub(in crate::experiments) fn measure(context: &Context) -> Result<Report, Failure> {
    let mut report = context.report();
    let size = context.effort([48, 36], [160, 120]);
    let setup = Setup::builtin(context, "blob-environment", size)?;
    // With uniform directions the sun would be found so seldom that no estimate of a pixel's e1, e2, e3 would be worth anything.
    let environment_candidates = EnvironmentSampling::Importance;
    let resampling = ResamplingSettings { environment_candidates, ..papers_proposals() };
    let samplers = Independent::new(context.seed_of("models", 0));
    let direct = resampling.resampled(&setup.scene, &samplers, None)?;
    let cost = measure_cost(&setup.scene, &samplers, &direct)?;
    let map = models(&setup, &direct, &direct, &samplers, context.effort(1024, 4096));
    let optimal = map.candidates(POOL, cost, Objective::Weighted([1.0]));
    context.save_picture("figure-3-map", &picture(&optimal, size)?, 0.0)?;

    // Each pixel's ray goes through its centre, as those of the models.
    let trials = context.effort(200, 800);
    let mut measured = Vec::new();
    for (budget, name) in [(FEW, "few"), (MANY, "many")] {
        let direct = ResampledDirect { budget, ..direct.clone() };
        let mut pixels = vec![Replications::new(); optimal.len()];
        let start = Instant::now();
        for trial in 0..trials {
            let values = at_centres(&setup, &direct, context.seed_of(name, trial));
            pixels.iter_mut().zip(values).for_each(|(pixel, value)| pixel.push(value));
        }
        let seconds = start.elapsed().as_secs_f64() / trials as f64;
        let settings = direct_light(&setup, with_budget(&resampling, budget));
        let rendering = setup.render(&settings, 1, context.seed_of("picture", 0))?;
        context.save_picture(&format!("figure-3-{name}"), &rendering.film.develop(0), 0.0)?;
        let params = [
            ("M", Value::from(budget.candidates())),
            ("N", budget.samples().into()),
            ("predicted variance", (predicted(&map, budget).iter().sum::<f64>() / optimal.len() as f64).into()),
        ];
        let variances: Vec<f64> = pixels.iter().map(Replications::variance).collect();
        let variance = variances.iter().sum::<f64>() / variances.len() as f64;
        let row = Row::new("blob-environment", "direct", params);
        report.rows.push(Row { variance, seconds, rays: rendering.rays.total(), ..row });
        report.claims.push(agreement(budget, &variances, &predicted(&map, budget), size[0] as usize));
        measured.push(variances);
    }
    compare(&optimal, cost, &measured[0], &measured[1], &mut report);
    Ok(report)
}

/// Measured over predicted variance, from eight interleaved sets of rows.
fn agreement(budget: Budget, measured: &[f64], predicted: &[f64], width: usize) -> Claim {
    const SETS: usize = 8;
    let mut ratios = Replications::new();
    for set in 0..SETS {
        let sum = |values: &[f64]| values.chunks(width).skip(set).step_by(SETS).flatten().sum::<f64>();
        ratios.push(sum(measured) / sum(predicted));
    }
    let ratio = Ratio { value: ratios.mean(), ci95: ratios.confidence_interval(0.95) };
    equals(format!("figure-3-m{}-measured-over-predicted-variance", budget.candidates()), ratio, 1.0, 0.05)
}

/// Among the pixels where one of the two settings is clearly better: does the map say which? The two have the same variance where
///
/// ```text
/// a/(M_1 N_1) + b/N_1 = a/(M_2 N_2) + b/N_2,     a = e3 - e2,  b = e2 - e1
/// ```
/// and the map's M is `sqrt(a/b T_Y/T_X)`.
fn compare(optimal: &[f64], cost: CostModel, few: &[f64], many: &[f64], report: &mut Report) {
    let inverse = |budget: Budget| {
        let (m, n) = (budget.candidates(), budget.samples());
        (1.0 / (m * n), 1.0 / n)
    };
    let ((few_product, few_samples), (many_product, many_samples)) = (inverse(FEW), inverse(MANY));
    let balance = (many_samples - few_samples) / (few_product - many_product);
    let middle = (balance * cost.sample() / cost.candidate()).sqrt();
    for (name, better, worse, prefers_many) in [("n20", few, many, false), ("m60", many, few, true)] {
        let clear: Vec<usize> = (0..optimal.len()).filter(|&pixel| worse[pixel] > 1.5 * better[pixel]).collect();
        let right = clear.iter().filter(|&&pixel| (optimal[pixel] > middle) == prefers_many).count() as f64;
        let count = (clear.len() as f64).max(1.0);
        let share = right / count;
        let error = 1.96 * (share * (1.0 - share) / count).sqrt();
        let share = Ratio { value: share, ci95: [share - error, share + error] };
        report.claims.push(at_least(format!("figure-3-share-of-right-pixels-where-{name}-is-better"), share, 0.8));
    }
    let better = many.iter().zip(few).filter(|(many, few)| many < few).count() as f64 / many.len() as f64;
    let better = Ratio { value: better, ci95: [better; 2] };
    report.claims.push(reported("figure-3-share-of-pixels-where-m60-has-less-variance", better));
}

/// Green where candidates pay, red where samples do, on the scale of the logarithm of M from 1 to 3600.
fn picture(optimal: &[f64], [width, height]: [u32; 2]) -> Result<LayeredImage, Failure> {
    let colour = |m: &f64| {
        let share = (m.ln() / MANY.candidates().powi(2).ln()).clamp(0.0, 1.0) as f32;
        [1.0 - share, share, 0.05]
    };
    let mut image = LayeredImage::new(width, height)?;
    image.set_rgb(&optimal.iter().map(colour).collect::<Vec<_>>())?;
    Ok(image)
}
