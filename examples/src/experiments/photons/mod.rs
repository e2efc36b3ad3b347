//! Figures and claims of Keller and Wald 2000: which photons a map keeps, and how caustics get more of them.

mod comparison;
mod deposition;
mod places;
mod slit;
mod split;
mod top_view;

pub(super) use deposition::measure as deposition;
pub(super) use slit::measure as slit;
pub(super) use split::measure as split;

use std::time::Instant;

use photon_map::{Deposition, MapPartition, PhotonMaps};
use qmc_sampling::OwenSobol;
use scene_core::{PowerChoice, RayCounts, ReferenceScene, RussianRoulette, Scene};

use super::Setup;
use super::claims::{about_one, at_least, at_most, reported};
use crate::estimators::{PathGuidance, PhotonTracing, Storing};
use crate::photons::{PathLimits, PhotonError, PhotonSettings};
use crate::program::Failure;
use crate::render::PassContext;

/// What an experiment traces: a scene, light paths, numbers.
struct Tracer<'a> {
    scene: &'a ReferenceScene,
    samplers: OwenSobol,
    filter: scene_core::film::Filter,
    light: PhotonTracing<PowerChoice>,
}

/// Photons that were kept.
struct Traced {
    photons: PhotonMaps<[f32; 3]>,
    paths: u64,
    seconds: f64,
    rays: RayCounts,
}

/// Light paths are traced in such portions until enough photons are kept.
const PORTION: u64 = 16 * 4096;
/// More paths than this are not traced.
const MAX_PATHS: u64 = 1 << 28;

impl<'a> Tracer<'a> {
    fn new(setup: &'a Setup, settings: &PhotonSettings, seed: u64) -> Result<Self, PhotonError> {
        let light = settings.tracing(PowerChoice::new(setup.scene.emitters()), limits())?;
        Ok(Self { scene: &setup.scene, samplers: OwenSobol::new(seed), filter: setup.settings.filter, light })
    }

    fn context(&self) -> PassContext<'_, ReferenceScene, OwenSobol> {
        PassContext { scene: self.scene, samplers: &self.samplers, filter: self.filter }
    }

    /// Traces so many paths.
    fn paths<D: Deposition + Sync>(&self, storing: &Storing<D>, paths: u64) -> Traced {
        let (mut photons, start) = (PhotonMaps::new(), Instant::now());
        let rays = storing.trace(&self.context(), &self.light, 0, 0..paths, &mut photons);
        photons.add_paths(&storing.partition, paths);
        Traced { photons, paths, seconds: start.elapsed().as_secs_f64(), rays }
    }

    /// Traces until this number of photons is kept, or a little more.
    fn until<D: Deposition + Sync, G: PathGuidance>(
        &self,
        light: &PhotonTracing<PowerChoice, G>,
        storing: &Storing<D>,
        stored: usize,
    ) -> Traced {
        let (mut photons, start) = (PhotonMaps::new(), Instant::now());
        let (mut paths, mut rays) = (0, RayCounts::default());
        while photons.global.len() + photons.caustic.len() < stored && paths < MAX_PATHS {
            rays += storing.trace(&self.context(), light, 0, paths..paths + PORTION, &mut photons);
            paths += PORTION;
        }
        photons.add_paths(&storing.partition, paths);
        Traced { photons, paths, seconds: start.elapsed().as_secs_f64(), rays }
    }
}

/// Paths of any length.
fn limits() -> PathLimits {
    PathLimits { max_depth: u32::MAX, roulette: RussianRoulette::PathThroughput { from_length: 4 } }
}

/// Keeps what a rule decides, in one map; direct light is found otherwise.
fn storing<D>(deposition: D) -> Result<Storing<D>, Failure> {
    Ok(Storing { partition: MapPartition::one_number(1.0)?, deposition, primary: false, global: true })
}
