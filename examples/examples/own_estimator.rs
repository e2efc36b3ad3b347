//! Your own estimator beside ours: errors, rays and time over several renderings, their ratios with intervals, and whether both converge to the same image.
//!
//! Change `Mine`, and run `cargo run --release --example own_estimator -- [SCENE]` (the Cornell box, or a builtin scene that `lichtwerk list` names).
//! As it stands `Mine` scatters until a ray hits a light by chance; ours has next event estimation besides.
#![allow(clippy::print_stdout)]

use std::ops::ControlFlow;

use lichtwerk::estimators::{CameraEstimator, FirstEvent, FirstHit, NextEvent, NoLightPaths, OwnSampling, PathTracer};
use lichtwerk::experiments::{Ratio, Trials, ratio_of_means};
use lichtwerk::render::{Budget, CameraPass, Job, Rendering};
use mis_heuristics::Power;
use qmc_sampling::{OwenSobol, Replications, Sampler};
use scene_core::builtin::Builtin;
use scene_core::film::Filter;
use scene_core::{PowerChoice, Ray, ReferenceScene, RussianRoulette, Scene, Spectrum, TransportMode, Vertex};
use vpl_gi::Observer;

/// Segments of a path at most.
const MAX_DEPTH: u32 = 6;
/// Samples per pixel.
const SAMPLES: u64 = 16;
/// Samples per pixel of the reference.
const REFERENCE: u64 = 1024;
/// Renderings of each.
const TRIALS: u64 = 8;

/// The estimator under test.
struct Mine;

impl CameraEstimator for Mine {
    /// The radiance that arrives along `ray`. Tell the observer about vertices only if the image is to be filtered.
    fn trace<'s, S: Scene, O: Observer<S::Vertex<'s>>>(
        &self,
        scene: &'s S,
        mut ray: Ray,
        sampler: &mut impl Sampler,
        _: &mut O,
    ) -> (S::Spectrum, Option<FirstHit>) {
        let (mut radiance, mut throughput) = (S::Spectrum::ZERO, S::Spectrum::splat(1.0));
        let mut first_hit = None;
        for length in 1..=MAX_DEPTH {
            let Some(vertex) = scene.intersect(&ray) else {
                radiance += throughput * scene.environment_radiance(ray.direction);
                break;
            };
            first_hit.get_or_insert_with(|| FirstHit::new(&ray, &vertex));
            radiance += throughput * vertex.emitted();
            if length == MAX_DEPTH {
                break;
            }
            let (u, [v, w]) = (sampler.next_1d(), sampler.next_2d());
            let Some(sample) = vertex.sample([u, v, w], TransportMode::Radiance) else { break };
            throughput *= sample.throughput;
            ray = vertex.spawn_ray(sample.wi);
        }
        (radiance, first_hit)
    }
}

/// One rendering; the seed decides on all random numbers.
fn render(
    scene: &ReferenceScene,
    camera: &impl CameraPass,
    samples: u64,
    seed: u64,
) -> Result<Rendering, Box<dyn std::error::Error>> {
    let samplers = &OwenSobol::new(seed);
    let (budget, light) = (Budget::Samples(samples), None::<&NoLightPaths>);
    let job = Job { scene, samplers, camera, light, filter: Filter::BOX, budget, first: 0, threads: 0 };
    Ok(job.render(&mut |_| ControlFlow::Continue(()))?)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let name = std::env::args().nth(1).unwrap_or_else(|| "cornell-box".to_owned());
    let mut description = Builtin::named(&name).ok_or(format!("there is no builtin scene '{name}'"))?.description();
    (description.camera.width, description.camera.height) = (64, 64);
    let scene = ReferenceScene::new(description)?;
    let ours = PathTracer {
        direct: NextEvent { heuristic: Power::TWO, choice: PowerChoice::new(scene.emitters()) },
        scattering: OwnSampling,
        max_depth: MAX_DEPTH,
        roulette: RussianRoulette::Never,
        first_event: FirstEvent::Any,
    };

    let reference = render(&scene, &ours, REFERENCE, 1000)?.film.develop(0);
    let mut trials = [Trials::new(), Trials::new()];
    let [mut costs, mut brightness] =
        [[Replications::new(), Replications::new()], [Replications::new(), Replications::new()]];
    for seed in 0..TRIALS {
        // In turn, so that the load of the machine hits both alike.
        for (k, rendering) in [render(&scene, &Mine, SAMPLES, seed)?, render(&scene, &ours, SAMPLES, seed + TRIALS)?]
            .into_iter()
            .enumerate()
        {
            let image = rendering.film.develop(0);
            let error = trials[k].push_image(&image, &rendering, &reference)?;
            costs[k].push(error * rendering.seconds);
            brightness[k].push(image.rgb()?.iter().flatten().map(|&value| f64::from(value)).sum());
        }
    }

    println!("{name}, {SAMPLES} samples per pixel, {TRIALS} renderings each, means:");
    println!("{:<6} {:>10} {:>12} {:>10}", "", "rel. MSE", "rays", "seconds");
    for (who, trials) in ["mine", "ours"].into_iter().zip(&trials) {
        let (error, rays, seconds) = (trials.relative_mse().mean(), trials.rays().mean(), trials.seconds().mean());
        println!("{who:<6} {error:>10.4} {rays:>12.0} {seconds:>10.4}");
    }
    let show = |what: &str, Ratio { value, ci95: [low, high] }: Ratio| {
        println!("{what:<44} {value:.3}   (95 %: {low:.3} to {high:.3})");
    };
    let [mine, ours] = &trials;
    show("error, mine over ours, equal samples", ratio_of_means(mine.relative_mse(), ours.relative_mse()));
    show("error times seconds, mine over ours", ratio_of_means(&costs[0], &costs[1]));
    show("brightness, mine over ours: one if unbiased", ratio_of_means(&brightness[0], &brightness[1]));
    Ok(())
}
