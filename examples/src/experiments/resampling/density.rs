//! Figure 1: the density of what resampling selects.

use core::f64::consts::FRAC_PI_2;

use qmc_sampling::{Independent, Replications, Sampler, SamplerFamily};
use ris::Reservoir;
use scene_core::film::LayeredImage;

use super::at_most;
use crate::experiments::{Context, Ratio, Report, Row, ratio_of_means};
use crate::program::Failure;

/// Cells of the angle, of which there are so many in `[0, pi/2]`.
const CELLS: usize = 90;
/// Numbers of candidates: those of the figure, and more.
const CANDIDATES: [u32; 4] = [1, 2, 8, 32];
/// Height of a picture, in pixels; a cell is four wide.
const HEIGHT: usize = 160;
const CELL_WIDTH: usize = 4;

/// `g(theta) = cos(theta) + sin^4(6 theta)`, up to a factor: the paper's target.
fn target(theta: f64) -> f64 {
    theta.cos() + (6.0 * theta).sin().powi(4)
}

/// Draws many samples for each number of candidates, with candidates uniform in the angle, and compares their histogram with the target:
/// the squared distance, without the part that is due to the finite number of samples, falls as the number grows. The paper explains low values at the left end for M = 2 and 8 by its density
/// estimation; in a histogram there are none, see the picture.
pub(in crate::experiments) fn measure(context: &Context) -> Result<Report, Failure> {
    let mut report = context.report();
    let cell = FRAC_PI_2 / CELLS as f64;
    // Masses of the cells, by the midpoint rule in each.
    let mass = |k: usize| (0..16).map(|j| target((k as f64 + (f64::from(j) + 0.5) / 16.0) * cell)).sum::<f64>();
    let masses: Vec<f64> = (0..CELLS).map(mass).collect();
    let total: f64 = masses.iter().sum();
    let limit: Vec<f64> = masses.iter().map(|mass| mass / total).collect();

    let samples = context.effort(1_600_000_u64, 16_000_000);
    let mut distances = Vec::new();
    for count in CANDIDATES {
        let mut mean = vec![0.0; CELLS];
        let mut distance = Replications::new();
        let batches = 8;
        for batch in 0..batches {
            let mut sampler = Independent::new(context.seed_of("figure 1", batch)).sampler(u64::from(count), 0);
            let mut counts = vec![0.0; CELLS];
            for _ in 0..samples / batches {
                let mut reservoir = Reservoir::new();
                for _ in 0..count {
                    let theta = f64::from(sampler.next_1d()) * FRAC_PI_2;
                    reservoir.update(theta, target(theta), FRAC_PI_2, f64::from(sampler.next_1d()));
                }
                if let Some(&theta) = reservoir.finish().sample() {
                    counts[((theta / cell) as usize).min(CELLS - 1)] += 1.0;
                }
            }
            let n = (samples / batches) as f64;
            let histogram: Vec<f64> = counts.iter().map(|count| count / n).collect();
            // (p^ - q)^2 is too large by the variance of p^.
            let square = |(p, q): (&f64, &f64)| (p - q).powi(2) - p * (1.0 - p) / (n - 1.0);
            distance.push(histogram.iter().zip(&limit).map(square).sum::<f64>() * CELLS as f64);
            mean.iter_mut().zip(&histogram).for_each(|(mean, part)| *mean += part / batches as f64);
        }
        context.save_picture(&format!("figure-1-m{count}"), &picture(&mean, &limit)?, 0.0)?;
        let params = [("M", count.into()), ("squared distance", distance.mean().into())];
        report.rows.push(Row::new("cos + sin^4", "ris", params));
        distances.push(distance);
    }

    // Uniform candidates, and nothing selected among them: the distance is that of the target from uniform.
    let uniform = limit.iter().map(|mass| (mass - 1.0 / CELLS as f64).powi(2)).sum::<f64>() * CELLS as f64;
    let [first, .., last] = &distances[..] else { return Ok(report) };
    let of_uniform =
        Ratio { value: first.mean() / uniform, ci95: first.confidence_interval(0.95).map(|x| x / uniform) };
    report.claims.push(at_most("figure-1-m1-is-the-source", of_uniform, 1.02));
    for (pair, counts) in distances.windows(2).zip(CANDIDATES.windows(2)) {
        let id = format!("figure-1-m{}-is-closer-than-m{}", counts[1], counts[0]);
        report.claims.push(at_most(id, ratio_of_means(&pair[1], &pair[0]), 1.0));
    }
    report.claims.push(at_most("figure-1-m32-is-nearly-the-target", ratio_of_means(last, first), 0.02));
    Ok(report)
}

/// A histogram in grey, the target as a line in red.
fn picture(histogram: &[f64], limit: &[f64]) -> Result<LayeredImage, Failure> {
    let (width, scale) = (CELLS * CELL_WIDTH, 0.9 / limit.iter().copied().fold(0.0, f64::max));
    let mut pixels = vec![[0.95; 3]; width * HEIGHT];
    for (k, (&bar, &line)) in histogram.iter().zip(limit).enumerate() {
        let row = |value: f64| HEIGHT - 1 - ((value * scale * HEIGHT as f64) as usize).min(HEIGHT - 1);
        for x in k * CELL_WIDTH..(k + 1) * CELL_WIDTH {
            for y in row(bar)..HEIGHT {
                pixels[y * width + x] = [0.35; 3];
            }
            for y in [row(line), (row(line) + 1).min(HEIGHT - 1)] {
                pixels[y * width + x] = [0.8, 0.05, 0.02];
            }
        }
    }
    let mut image = LayeredImage::new(width as u32, HEIGHT as u32)?;
    image.set_rgb(&pixels)?;
    Ok(image)
}
