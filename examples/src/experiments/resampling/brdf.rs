//! Figure 5: any scattering function by resampling of uniform directions.

use qmc_sampling::{Independent, Replications, SamplerFamily};
use scene_core::{ReferenceScene, RussianRoulette, Scene, Sensor, Spectrum};

use super::{equals, reported};
use crate::estimators::{
    Directions, FirstEvent, NoLightPaths, PathTracer, ResampledScattering, ScatterSampling, ScatteringAlone,
};
use crate::experiments::{Context, Report, Row, Setup, ratio_of_means};
use crate::program::Failure;
use crate::render::{Budget, Job};

/// Numbers of candidates; the figure has the first and the last.
const CANDIDATES: [f32; 4] = [1.0, 2.0, 5.0, 20.0];
/// What the four spheres of the scene are made of, from left to right.
const MATERIALS: [&str; 4] = ["diffuse", "cook-torrance", "rough gold", "phong"];

/// Directions are resampled at what camera rays hit, with candidates uniform over the hemisphere, and the light is found by scattering: the
/// variance of `f cos L W` over the hits on each sphere. Uniform light falls on convex objects, so there is nothing else to it.
pub(in crate::experiments) fn measure(context: &Context) -> Result<Report, Failure> {
    let mut report = context.report();
    let size = context.effort([96, 32], [192, 64]);
    let setup = Setup::builtin(context, "sphere-row", size)?;
    let batches = 8;
    let repeats = context.effort(24, 200);
    for (column, material) in MATERIALS.iter().enumerate() {
        let mut by_count = Vec::new();
        for candidates in CANDIDATES {
            let scattering =
                ResampledScattering { candidates, directions: Directions::Hemisphere, has_specular: false };
            let mut variance = Replications::new();
            for batch in 0..batches {
                let seed = context.seed_of(&format!("{material}, {candidates}"), batch);
                variance.push(mean_variance(&setup.scene, &scattering, column, repeats, seed));
            }
            let params = [("M", f64::from(candidates).into()), ("material", (*material).into())];
            report.rows.push(Row { variance: variance.mean(), ..Row::new("sphere-row", "ris, directions", params) });
            by_count.push(variance);
        }
        let [first, .., last] = &by_count[..] else { continue };
        let factor = ratio_of_means(first, last);
        let id = format!("figure-5-{}-variance-factor-of-20-candidates", material.replace(' ', "-"));
        report.claims.push(if column == 0 { equals(id, factor, 20.0, 0.01) } else { reported(id, factor) });
    }
    pictures(context, &setup)?;
    Ok(report)
}

/// The variance of the light that is scattered at a hit, mean over the hits in one of four columns of the image.
fn mean_variance(
    scene: &ReferenceScene,
    scattering: &ResampledScattering,
    column: usize,
    repeats: u64,
    seed: u64,
) -> f64 {
    let samplers = Independent::new(seed);
    let [width, height] = scene.sensor().resolution();
    let columns = column as u32 * width / 4..(column as u32 + 1) * width / 4;
    let (mut sum, mut count) = (0.0, 0);
    for (x, y) in columns.flat_map(|x| (0..height).map(move |y| (x, y))) {
        let ray = scene.sensor().sample_ray([x as f32 + 0.5, y as f32 + 0.5], [0.5; 2]).ray;
        let Some(vertex) = scene.intersect(&ray) else { continue };
        let mut values = Replications::new();
        for index in 0..repeats {
            let mut sampler = samplers.sampler(u64::from(y * width + x), index);
            let light = scattering
                .scatter(&vertex, 1, &mut sampler)
                .map_or(0.0, |sample| (sample.throughput * scene.environment_radiance(sample.wi)).luminance());
            values.push(f64::from(light));
        }
        sum += values.variance();
        count += 1;
    }
    sum / f64::from(count.max(1))
}

/// The row of spheres with one and with twenty candidates.
fn pictures(context: &Context, setup: &Setup) -> Result<(), Failure> {
    for candidates in [1.0, 20.0] {
        let camera = PathTracer {
            direct: ScatteringAlone,
            scattering: ResampledScattering { candidates, directions: Directions::Hemisphere, has_specular: false },
            max_depth: 2,
            roulette: RussianRoulette::Never,
            first_event: FirstEvent::Any,
        };
        let job = Job {
            scene: &setup.scene,
            samplers: &Independent::new(context.seed_of("picture", 0)),
            camera: &camera,
            light: None::<&NoLightPaths>,
            filter: setup.settings.filter,
            first: 0,
            budget: Budget::Samples(context.effort(4, 16)),
            threads: context.threads,
        };
        let rendering = job.render(&mut |_| std::ops::ControlFlow::Continue(()))?;
        context.save_picture(&format!("figure-5-m{candidates}"), &rendering.film.develop(0), 0.0)?;
    }
    Ok(())
}
