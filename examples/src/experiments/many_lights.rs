//! Figure 5 of Keller and Wald 2000: direct light from many lamps, most of which are occluded.

use qmc_sampling::Replications;
use scene_core::film::LayeredImage;
use serde_json::Value;

use super::claims::{at_least, at_most, reported};
use super::{Context, Ratio, Report, Row, Setup, Trials, ratio_of_means};
use crate::choices::LightSelection;
use crate::light_photons::LightPhotonSettings;
use crate::program::{EstimatorName, Failure, RenderSettings};
use crate::render::Rendering;
use crate::samplers::SamplerName;

/// The scenes with their numbers of lamps.
const SCENES: [(&str, u32); 3] = [("rooms", 100), ("rooms-1000", 1000), ("rooms-10000", 10_000)];

/// A way to choose lights.
struct Way {
    name: &'static str,
    /// What its pictures are called.
    picture: &'static str,
    lights: LightSelection,
    /// Shadow rays for contributing lights, and for all others.
    rays: [u32; 2],
}

const fn way(name: &'static str, picture: &'static str, lights: LightSelection, rays: [u32; 2]) -> Way {
    Way { name, picture, lights, rays }
}

/// What is compared in equal time; the first is what others are compared with.
const WAYS: [Way; 6] = [
    way("uniform", "figure-5-a-uniform", LightSelection::Uniform, [1, 1]),
    way("power", "power", LightSelection::Power, [1, 1]),
    way("ris", "ris", LightSelection::Ris, [1, 1]),
    way("photons", "figure-5-b-photons", LightSelection::Photons, [1, 1]),
    way("photons, 4 + 1 rays", "photons-4-rays", LightSelection::Photons, [4, 1]),
    way("photons, biased", "figure-5-c-photons-biased", LightSelection::Photons, [1, 0]),
];
const UNIFORM: usize = 0;
const RIS: usize = 2;
const PHOTONS: usize = 3;
const SEVERAL_RAYS: usize = 4;
const BIASED: usize = 5;

impl Way {
    /// Direct light with independent numbers: errors then fall as one over the time.
    fn settings(&self, setup: &Setup) -> RenderSettings {
        let [contributing_rays, other_rays] = self.rays;
        RenderSettings {
            estimator: EstimatorName::Direct,
            sampler: SamplerName::Independent,
            max_depth: 2,
            lights: self.lights,
            light_photons: LightPhotonSettings { contributing_rays, other_rays, ..LightPhotonSettings::default() },
            ..setup.settings.clone()
        }
    }
}

/// What was measured of a way to choose lights in a scene.
#[derive(Default)]
struct Measured {
    trials: Trials,
    /// Error times seconds: in equal time, the error.
    cost: Replications,
    /// Seconds per sample of a pixel, without the photons.
    per_sample: Replications,
    /// Seconds that the photons took.
    preparation: Replications,
    /// Mean of the image over that of the reference.
    brightness: Replications,
    samples: u64,
}

impl Measured {
    fn push(&mut self, rendering: &Rendering, reference: &LayeredImage, pixels: u32) -> Result<(), Failure> {
        let mut one = Trials::new();
        one.push(rendering, reference)?;
        self.cost.push(one.relative_mse().mean() * rendering.seconds);
        self.trials.push(rendering, reference)?;
        let samples = rendering.samples as f64 * f64::from(pixels);
        self.per_sample.push((rendering.seconds - rendering.preparation_seconds) / samples);
        self.preparation.push(rendering.preparation_seconds);
        self.brightness.push(mean(&rendering.film.develop(0))? / mean(reference)?);
        self.samples = rendering.samples;
        Ok(())
    }

    fn row(&self, scene: &str, lights: u32, way: &Way, part: &str) -> Row {
        let params = [
            ("part", Value::from(part)),
            ("lamps", lights.into()),
            ("lights", way.name.into()),
            ("spp", self.samples.into()),
            ("error times seconds", self.cost.mean().into()),
            ("microseconds per sample", (1e6 * self.per_sample.mean()).into()),
            ("seconds for photons", self.preparation.mean().into()),
            ("brightness", self.brightness.mean().into()),
        ];
        self.trials.fill(Row::new(scene, "direct", params))
    }
}

/// The mean over pixels and channels.
fn mean(image: &LayeredImage) -> Result<f64, Failure> {
    let pixels = image.rgb()?;
    let sum: f64 = pixels.iter().flatten().map(|value| f64::from(*value)).sum();
    Ok(sum / (3 * pixels.len()) as f64)
}

/// In `rooms`, all ways in equal time, which includes the time for photons; then, in all three scenes, time per sample and error with equal numbers
/// of samples, without the time for photons, which is reported by itself. All renderings take turns, so that the load of the machine hits all alike.
pub(super) fn measure(context: &Context) -> Result<Report, Failure> {
    let mut report = context.report();
    let size = context.effort([64, 48], [160, 120]);
    let pixels = size[0] * size[1];
    let mut scenes = Vec::new();
    for (name, lights) in SCENES {
        let setup = Setup::builtin(context, name, size)?;
        let reference = reference(context, &setup)?;
        scenes.push((setup, reference, lights));
    }
    let (rooms, of_rooms, lights) = &scenes[0];
    let equal_time = in_equal_time(context, rooms, of_rooms, pixels)?;
    for (way, measured) in WAYS.iter().zip(&equal_time) {
        report.rows.push(measured.row(rooms.scene.name(), *lights, way, "equal time"));
    }
    claim_errors(&equal_time, &mut report);

    // The number of lights.
    let chosen = [&WAYS[UNIFORM], &WAYS[PHOTONS]];
    let mut by_lights: Vec<[Measured; 2]> = scenes.iter().map(|_| Default::default()).collect();
    for trial in 0..context.effort(8, 16) {
        for ((setup, reference, _), both) in scenes.iter().zip(&mut by_lights) {
            for (way, measured) in chosen.iter().zip(both) {
                let what = format!("{}, {}, equal samples", setup.scene.name(), way.name);
                let samples = context.effort(8, 16);
                let rendering = setup.render(&way.settings(setup), samples, context.seed_of(&what, trial))?;
                measured.push(&rendering, reference, pixels)?;
                if trial == 0 {
                    let name = format!("{}-{}", setup.scene.name(), way.name);
                    context.save_picture(&name, &rendering.film.develop(0), 0.0)?;
                }
            }
        }
    }
    for ((setup, _, lights), both) in scenes.iter().zip(&by_lights) {
        for (way, measured) in chosen.iter().zip(both) {
            report.rows.push(measured.row(setup.scene.name(), *lights, way, "equal samples"));
        }
    }
    claim_times(&by_lights, &mut report);
    Ok(report)
}

/// With photons of its own and several rays: the error of the reference counts as an error of what is compared with it, and no other way has so small
/// a one in this time. That it is unbiased is tested elsewhere.
fn reference(context: &Context, setup: &Setup) -> Result<LayeredImage, Failure> {
    let settings = RenderSettings { sampler: SamplerName::Sobol, ..WAYS[SEVERAL_RAYS].settings(setup) };
    let what = format!("{}, reference", setup.scene.name());
    Ok(setup.render(&settings, context.effort(256, 1024), context.seed_of(&what, 0))?.film.develop(0))
}

/// All ways in `rooms`, with as many samples as fit in the time.
fn in_equal_time(
    context: &Context,
    setup: &Setup,
    reference: &LayeredImage,
    pixels: u32,
) -> Result<Vec<Measured>, Failure> {
    let seconds = context.effort(0.4, 2.0);
    let mut samples = Vec::new();
    for way in &WAYS {
        // The second of two renderings finds everything in the caches.
        let settings = way.settings(setup);
        setup.render(&settings, 4, context.seed_of("pilot", 0))?;
        let pilot = setup.render(&settings, 4, context.seed_of("pilot", 1))?;
        let each = (pilot.seconds - pilot.preparation_seconds) / 4.0;
        samples.push((((seconds - pilot.preparation_seconds) / each) as u64).max(1));
    }
    let mut all: Vec<Measured> = WAYS.iter().map(|_| Measured::default()).collect();
    for trial in 0..context.effort(8, 16) {
        for ((way, measured), &samples) in WAYS.iter().zip(&mut all).zip(&samples) {
            let what = format!("{}, equal time", way.name);
            let rendering = setup.render(&way.settings(setup), samples, context.seed_of(&what, trial))?;
            measured.push(&rendering, reference, pixels)?;
            if trial == 0 {
                context.save_picture(way.picture, &rendering.film.develop(0), 0.0)?;
            }
        }
    }
    context.save_picture("reference", reference, 0.0)?;
    Ok(all)
}

fn claim_errors(all: &[Measured], report: &mut Report) {
    let gain = |over: usize, of: usize| ratio_of_means(&all[over].cost, &all[of].cost);
    report.claims.push(at_least("gain-over-uniform-selection-in-equal-time", gain(UNIFORM, PHOTONS), 5.0));
    report.claims.push(reported("gain-over-selection-by-power-in-equal-time", gain(1, PHOTONS)));
    report.claims.push(reported("gain-over-resampling-in-equal-time", gain(RIS, PHOTONS)));
    report.claims.push(reported("gain-of-the-biased-variant-in-equal-time", gain(PHOTONS, BIASED)));
    let brightness = &all[BIASED].brightness;
    let ratio = Ratio { value: brightness.mean(), ci95: brightness.confidence_interval(0.95) };
    report.claims.push(reported("brightness-of-the-biased-variant", ratio));
}

fn claim_times(by_lights: &[[Measured; 2]], report: &mut Report) {
    let of = |scene: usize, way: usize| &by_lights[scene][way].per_sample;
    for (scene, limit) in [(1, None), (2, Some(2.0))] {
        let lights = SCENES[scene].1;
        let time = ratio_of_means(of(scene, 1), of(0, 1));
        let id = format!("time-per-pixel-at-{lights}-over-100-lamps");
        report.claims.push(match limit {
            Some(limit) => at_most(id, time, limit),
            None => reported(id, time),
        });
        // What the scene itself costs.
        let id = format!("time-per-pixel-at-{lights}-over-100-lamps-with-uniform-selection");
        report.claims.push(reported(id, ratio_of_means(of(scene, 0), of(0, 0))));
        let [uniform, photons] = &by_lights[scene];
        let gain = ratio_of_means(uniform.trials.relative_mse(), photons.trials.relative_mse());
        report.claims.push(reported(format!("gain-at-{lights}-lamps-with-equal-samples"), gain));
    }
}
