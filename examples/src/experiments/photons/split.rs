//! Figure 3: caustics get more photons than the rest, without a projection map.

use core::ops::ControlFlow;

use photon_map::{Deposition, KeepAll, MapPartition, ProjectionMap};
use qmc_sampling::{Independent, Replications, Sampler, SamplerFamily};
use scene_core::{Emitter, ReferenceScene, Scene, Vertex};
use serde_json::Value;

use super::{Traced, Tracer, about_one, at_least, at_most, reported};
use crate::estimators::Storing;
use crate::experiments::{Context, Ratio, Report, Row, Setup, ratio_of_means};
use crate::photons::{PartitionVariant, PhotonSettings};
use crate::program::Failure;

/// Ratios of the global and the caustic map: 1, 1/5, 1/20.
const RATIOS: [(&str, f64); 3] = [("1", 1.0), ("1/5", 0.2), ("1/20", 0.05)];
const VARIANTS: [PartitionVariant; 3] =
    [PartitionVariant::OneNumber, PartitionVariant::TwoNumbers, PartitionVariant::Trajectories];

/// Number of trials of a ratio and a variant: sizes of the two maps.
#[derive(Default)]
struct Sizes {
    global: Replications,
    caustic: Replications,
    seconds: Replications,
    rays: Replications,
}

/// In `caustic-room`, where caustics have an indirect source, and in `glass-ball`, where they have a direct one: sizes
/// of the maps by ratio `q`, and what a projection map at the lamp finds of the caustics.
pub(in crate::experiments) fn measure(context: &Context) -> Result<Report, Failure> {
    let mut report = context.report();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(context.threads).build()?;
    pool.install(|| {
        for scene in ["caustic-room", "glass-ball"] {
            let setup = Setup::builtin(context, scene, [16, 12])?;
            ratios(context, &setup, &mut report)?;
            projection(context, &setup, &mut report)?;
        }
        Ok(report)
    })
}

fn ratios(context: &Context, setup: &Setup, report: &mut Report) -> Result<(), Failure> {
    let (paths, trials) = (context.effort(60_000, 400_000), context.effort(4, 8));
    for variant in VARIANTS {
        let mut all = Vec::new();
        for (name, ratio) in RATIOS {
            let mut sizes = Sizes::default();
            let photons = (paths as f64 / ratio).round() as u64;
            let settings = PhotonSettings {
                photons,
                global_ratio: ratio,
                partition_variant: variant,
                caustic_roughness: 0.0,
                ..PhotonSettings::default()
            };
            for trial in 0..trials {
                let tracer = Tracer::new(setup, &settings, context.seed_of(&format!("{variant:?} {name}"), trial))?;
                let traced = tracer.paths(&storing_all(settings.partition()?, KeepAll), photons);
                sizes.push(&traced);
            }
            report.rows.push(sizes.row(setup, name, variant, photons));
            all.push((name, ratio, sizes));
        }
        let (_, _, first) = &all[0];
        for (name, ratio, sizes) in &all[1..] {
            let id = |what: &str| format!("{}-{variant:?}-q-{name}-{what}", setup.scene.name()).to_lowercase();
            let global = ratio_of_means(&sizes.global, &first.global);
            report.claims.push(about_one(id("global-size"), global, 0.1));
            let gain = ratio_of_means(&sizes.caustic, &first.caustic);
            let gain = Ratio { value: gain.value * ratio, ci95: gain.ci95.map(|x| x * ratio) };
            report.claims.push(about_one(id("caustic-size-times-q"), gain, 0.1));
        }
    }
    Ok(())
}

fn storing_all<D: Deposition>(partition: MapPartition, deposition: D) -> Storing<D> {
    Storing { partition, deposition, primary: true, global: true }
}

impl Sizes {
    fn push(&mut self, traced: &Traced) {
        self.global.push(traced.photons.global.len() as f64);
        self.caustic.push(traced.photons.caustic.len() as f64);
        self.seconds.push(traced.seconds);
        self.rays.push(traced.rays.total() as f64);
    }

    fn row(&self, setup: &Setup, name: &str, variant: PartitionVariant, paths: u64) -> Row {
        let params = [
            ("q", Value::from(name)),
            ("variant", format!("{variant:?}").into()),
            ("paths", paths.into()),
            ("global photons", self.global.mean().round().into()),
            ("caustic photons", self.caustic.mean().round().into()),
        ];
        let (seconds, rays) = (self.seconds.mean(), self.rays.mean().round() as u64);
        Row { seconds, rays, ..Row::new(setup.scene.name(), "photon-map", params) }
    }
}

// --- The projection map ----------------------------------------------------------------------------------------------

/// Cells of the projection map, and rays that test each.
const CELLS: [u32; 2] = [64, 64];
const TESTS: u64 = 16;

/// Numbers of a path whose emission is confined to the cells of a projection map.
#[derive(Clone)]
struct Projected<'a, R> {
    sampler: R,
    map: &'a ProjectionMap,
    pairs: u32,
}

impl<R: Sampler> Sampler for Projected<'_, R> {
    fn next_1d(&mut self) -> f32 {
        self.sampler.next_1d()
    }

    /// The second pair is the direction of emission.
    fn next_2d(&mut self) -> [f32; 2] {
        let pair = self.sampler.next_2d();
        self.pairs += 1;
        if self.pairs != 2 {
            return pair;
        }
        let confined = self.map.sample(pair.map(f64::from));
        confined.map_or(pair, |u| u.map(|x| (x as f32).min(1.0 - 0.5 * f32::EPSILON)))
    }

    fn fork(&self, domain: u32) -> Self {
        Self { sampler: self.sampler.fork(domain), ..self.clone() }
    }
}

/// Cells from which a ray meets a mirror or glass first, whatever point of the lamp it leaves.
fn projection_map(scene: &ReferenceScene, seed: u64) -> Result<ProjectionMap, Failure> {
    let numbers = Independent::new(seed);
    let mut cell_number = 0;
    let map = ProjectionMap::new(CELLS[0], CELLS[1], |cell| {
        cell_number += 1;
        (0..TESTS).any(|test| {
            let mut sampler = numbers.sampler(cell_number, test);
            let (position, within) = (sampler.next_2d(), sampler.next_2d().map(f64::from));
            let direction = cell.at(within).map(|x| x as f32);
            let emission = scene.emitters().first().and_then(|lamp| lamp.sample_emission(position, direction));
            let hit = emission.and_then(|e| scene.intersect(&e.point.ray_along(e.direction)));
            hit.is_some_and(|vertex| !vertex.is_connectible())
        })
    })?;
    Ok(map)
}

/// Flux of caustic photons per path, with all paths and with those of the projection map alone: what it finds of the
/// caustics, and with how many photons per path.
fn projection(context: &Context, setup: &Setup, report: &mut Report) -> Result<(), Failure> {
    let (paths, trials) = (context.effort(40_000, 400_000), context.effort(4, 8));
    let map = projection_map(&setup.scene, context.seed_of("cells", 0))?;
    let settings = PhotonSettings { caustic_roughness: 0.0, ..PhotonSettings::default() };
    let tracer = Tracer::new(setup, &settings, context.seed_of("projection", 0))?;
    let [mut plain, mut projected, mut plain_count, mut projected_count] = [Replications::new(); 4];
    for trial in 0..trials {
        let numbers = Independent::new(context.seed_of("projection", trial));
        let sum = |confined: bool| {
            let (mut flux, mut count) = (0.0, 0.0);
            for path in 0..paths {
                let sampler = numbers.sampler(u64::from(confined), path);
                let arrive = |photon: photon_map::Photon<[f32; 3]>| {
                    if photon.caustic {
                        flux += photon.flux.iter().copied().map(f64::from).sum::<f64>();
                        count += 1.0;
                    }
                    ControlFlow::Continue(())
                };
                if confined {
                    let mut sampler = Projected { sampler, map: &map, pairs: 0 };
                    tracer.light.trace(&setup.scene, &mut (), &mut sampler, arrive);
                } else {
                    let mut sampler = sampler;
                    tracer.light.trace(&setup.scene, &mut (), &mut sampler, arrive);
                }
            }
            (flux / paths as f64, count / paths as f64)
        };
        let (flux, count) = sum(false);
        plain.push(flux);
        plain_count.push(count);
        // Without any cell there is nothing to emit.
        let (flux, count) = if map.share() > 0.0 { sum(true) } else { (0.0, 0.0) };
        projected.push(flux * map.share());
        projected_count.push(count);
    }
    let name = setup.scene.name();
    let params = [
        ("share of the emission", Value::from(map.share())),
        ("caustic photons per path, plain", plain_count.mean().into()),
        ("caustic photons per path, projected", projected_count.mean().into()),
    ];
    report.rows.push(Row::new(name, "projection-map", params));
    let found = Ratio { value: projected.mean() / plain.mean(), ..interval(&projected, &plain) };
    // Keller and Wald 2000: a projection map finds no caustics of indirect light.
    report.claims.push(match name {
        "caustic-room" => at_most("caustic-room-share-of-caustic-flux-that-a-projection-map-finds", found, 0.1),
        _ => at_least(format!("{name}-share-of-caustic-flux-that-a-projection-map-finds"), found, 0.5),
    });
    let gain = Ratio { value: projected_count.mean() / plain_count.mean(), ..interval(&projected_count, &plain_count) };
    report.claims.push(reported(format!("{name}-caustic-photons-per-path-projected-over-plain"), gain));
    Ok(())
}

/// The interval of a ratio; nothing is exact, too.
fn interval(numerator: &Replications, denominator: &Replications) -> Ratio {
    if numerator.mean() > 0.0 { ratio_of_means(numerator, denominator) } else { Ratio { value: 0.0, ci95: [0.0; 2] } }
}
