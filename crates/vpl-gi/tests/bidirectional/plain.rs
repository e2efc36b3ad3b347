//! What bidirectional path tracing is compared with: path tracing with next event estimation, and light tracing, as simple as can be.

use std::ops::ControlFlow;

use estimator_checks::BatchMeans;
use mis_heuristics::{Balance, Heuristic};
use qmc_sampling::{Independent, Sampler, SamplerFamily};
use scene_core::{
    Emitter, EmitterChoice, EmitterId, Ray, ReferenceScene, Rgb, RussianRoulette, Scene, Sensor, Spectrum,
    SurfacePoint, TransportMode, UniformChoice, Vertex, WalkStart, random_walk,
};

use crate::render::{Effort, MAX_DEPTH, Pixels, batches, sensor_ray};
use crate::scenes::SIZE;

/// Path tracing.
pub(crate) fn path(name: &str, scene: &ReferenceScene, effort: Effort) -> BatchMeans {
    batches(name, effort, |seed| {
        let family = Independent::new(seed);
        let mut pixels = Pixels::new();
        for pixel in 0..u64::from(SIZE * SIZE) {
            for sample in 0..effort.samples {
                let mut sampler = family.sampler(pixel, sample);
                let (raster, ray) = sensor_ray(scene, pixel, &mut sampler);
                pixels.add(raster, radiance(scene, ray, &mut sampler), 1.0 / effort.samples as f64);
            }
        }
        pixels
    })
}

fn radiance(scene: &ReferenceScene, mut ray: Ray, sampler: &mut impl Sampler) -> Rgb {
    let choice = UniformChoice::new(scene.emitters().len());
    let (mut radiance, mut throughput) = (Rgb::ZERO, Rgb::ONE);
    let mut last: Option<(SurfacePoint, f32)> = None;
    for length in 1..=MAX_DEPTH {
        let found = |last: &Option<(SurfacePoint, f32)>, id: EmitterId, at: Option<&SurfacePoint>| {
            let Some((from, pdf)) = last else { return 1.0 };
            let light = scene.emitters()[id.index()].pdf_direct(from.position, ray.direction, at);
            Balance.weight(1, &[light * choice.probability(Some(from), id), *pdf])
        };
        let Some(x) = scene.intersect(&ray) else {
            if let Some(id) = scene.environment() {
                radiance += throughput * scene.environment_radiance(ray.direction) * found(&last, id, None);
            }
            break;
        };
        if let Some(id) = x.emitter() {
            radiance += throughput * x.emitted() * found(&last, id, Some(x.point()));
        }
        if length == MAX_DEPTH {
            break;
        }
        let (u, u_light) = (sampler.next_1d(), sampler.next_2d());
        if let Some(chosen) = choice.choose(Some(x.point()), u)
            && let Some(light) = scene.emitters()[chosen.id.index()].sample_direct(x.point().position, u_light)
        {
            let (f, pdf) = x.eval_pdf(light.wi, TransportMode::Radiance);
            let density = chosen.probability * light.pdf_solid_angle;
            let weight = if light.is_delta { 1.0 } else { Balance.weight(0, &[density, pdf]) };
            let ray = light.at.map_or(x.spawn_ray(light.wi), |(at, _)| x.point().ray_to(&at));
            if !f.is_black() && !scene.occluded(&ray) {
                radiance += throughput * f * light.radiance * (weight / density);
            }
        }
        let (lobe, [u, v]) = (sampler.next_1d(), sampler.next_2d());
        let Some(sample) = x.sample([lobe, u, v], TransportMode::Radiance) else { break };
        throughput *= sample.throughput;
        last = (!sample.is_specular).then(|| (*x.point(), sample.pdf_solid_angle));
        ray = x.spawn_ray(sample.wi);
    }
    radiance
}

/// Light tracing: all paths but light that is seen directly or by specular surfaces.
pub(crate) fn light(name: &str, scene: &ReferenceScene, effort: Effort) -> BatchMeans {
    let choice = UniformChoice::new(scene.emitters().len());
    batches(name, effort, |seed| {
        let family = Independent::new(seed);
        let mut pixels = Pixels::new();
        let paths = effort.samples * u64::from(SIZE * SIZE);
        for path in 0..paths {
            let mut sampler = family.sampler(0, path);
            let (u, u_position, u_direction) = (sampler.next_1d(), sampler.next_2d(), sampler.next_2d());
            let Some(chosen) = choice.choose(None, u) else { continue };
            let Some(emission) = scene.emitters()[chosen.id.index()].sample_emission(u_position, u_direction) else {
                continue;
            };
            let start = WalkStart {
                ray: emission.point.ray_along(emission.direction),
                throughput: emission.flux * (1.0 / chosen.probability),
                mode: TransportMode::Importance,
                max_length: MAX_DEPTH - 1,
                roulette: RussianRoulette::Never,
            };
            let mut lens = sampler.fork(1);
            random_walk(scene, start, &mut sampler, |walk| {
                let u_lens = lens.next_2d();
                if let Some(connection) = scene.sensor().connect(walk.vertex.point().position, u_lens) {
                    let f = walk.vertex.eval(connection.wi, TransportMode::Importance);
                    let value = walk.throughput * f * connection.weight;
                    if !value.is_black() && scene.visible(walk.vertex.point(), &connection.lens) {
                        pixels.add(connection.raster, value, 1.0 / paths as f64);
                    }
                }
                ControlFlow::Continue(())
            });
        }
        pixels
    })
}
