//! Primary photons: from lights to the first surface.

use std::ops::Range;

use photon_map::{CausticRule, LastBounce, LightTable, LightTableError, Photon, PrimaryPhotons};
use qmc_sampling::{Sampler, SamplerFamily};
use rayon::prelude::*;
use scene_core::{Counting, Emitter, RayCounts, Scene, Spectrum, Vertex};

use crate::distributed::Portable;
use crate::render::LIGHT_STREAM;

/// Photons that one task traces.
const PHOTONS_PER_TASK: u32 = 4096;
/// Share of photons that start in proportion to power.
const BY_POWER: f64 = 0.5;
/// Photons at which their usual distances are measured.
const PROBES: usize = 64;

/// Power of each light, positive and finite: a light whose power is unknown or zero keeps a little.
pub(super) fn powers<S: Scene>(scene: &S) -> Vec<f64> {
    let powers = scene.emitters().iter().map(|emitter| f64::from(emitter.power().luminance()));
    let mut powers: Vec<f64> =
        powers.map(|power| if power > 0.0 { power.min(f64::from(f32::MAX)) } else { 0.0 }).collect();
    let largest = powers.iter().copied().fold(0.0, f64::max);
    let least = if largest > 0.0 { 1e-6 * largest } else { 1.0 };
    powers.iter_mut().for_each(|power| *power = power.max(least));
    powers
}

/// Where photons start.
pub(super) fn starts(powers: &[f64]) -> Result<LightTable, LightTableError> {
    LightTable::guided(powers, &vec![1.0; powers.len()], 1.0 - BY_POWER)
}

/// Where primary photons arrived, and of which light they are.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Arrivals(Vec<([f32; 3], u32)>);

/// Of `count` photons those with the given numbers that arrive, in order, and the rays that they took.
pub(super) fn trace_share<S: Scene + Sync, F: SamplerFamily>(
    scene: &S,
    samplers: &F,
    starts: &LightTable,
    count: u32,
    share: Range<u32>,
) -> (Arrivals, RayCounts) {
    let task = |first: u32| {
        let scene = Counting::new(scene);
        let arrivals: Vec<_> = (first..share.end.min(first.saturating_add(PHOTONS_PER_TASK)))
            .filter_map(|path| {
                // The lights are stratified, whatever the sampler.
                let (light, _) = starts.sample((f64::from(path) + 0.5) / f64::from(count));
                trace(&scene, light, &mut samplers.sampler(LIGHT_STREAM, u64::from(path)))
            })
            .collect();
        (arrivals, scene.counts())
    };
    let firsts: Vec<u32> = share.clone().step_by(PHOTONS_PER_TASK as usize).collect();
    let tasks: Vec<_> = firsts.into_par_iter().map(task).collect();
    let (mut all, mut rays) = (Vec::new(), RayCounts::default());
    for (arrivals, counts) in tasks {
        all.extend(arrivals);
        rays += counts;
    }
    (Arrivals(all), rays)
}

impl Arrivals {
    /// The photons in order.
    pub(super) fn photons(&self) -> PrimaryPhotons {
        let mut primary = PrimaryPhotons::new();
        for &(position, light) in &self.0 {
            // Neither direction nor flux is asked for.
            let photon = Photon::new(position, [0.0, 0.0, 1.0], 1.0_f32).from_light(light);
            primary.offer(&CausticRule::SPECULAR.label(photon, LastBounce::Emission));
        }
        primary
    }

    /// Their positions.
    pub(super) fn positions(&self) -> Vec<[f32; 3]> {
        self.0.iter().map(|&(position, _)| position).collect()
    }
}

impl Portable for Arrivals {
    const NAME: &'static str = "photons from lights";

    fn to_bytes(&self) -> Vec<u8> {
        let words = |&([x, y, z], light): &([f32; 3], u32)| [x.to_bits(), y.to_bits(), z.to_bits(), light];
        self.0.iter().flat_map(words).flat_map(u32::to_le_bytes).collect()
    }

    fn from_bytes(bytes: &[u8]) -> Result<Self, String> {
        let (photons, rest) = bytes.as_chunks::<16>();
        if !rest.is_empty() {
            return Err(format!("{} bytes too many", rest.len()));
        }
        let photon = |bytes: &[u8; 16]| {
            let [x, y, z, light] = std::array::from_fn(|k| {
                u32::from_le_bytes([bytes[4 * k], bytes[4 * k + 1], bytes[4 * k + 2], bytes[4 * k + 3]])
            });
            ([x, y, z].map(f32::from_bits), light)
        };
        Ok(Self(photons.iter().map(photon).collect()))
    }

    fn join(&mut self, behind: Self) -> Result<(), String> {
        self.0.extend(behind.0);
        Ok(())
    }
}

/// Where a photon from `light` first meets a surface; nothing if one cannot search for light there.
fn trace<S: Scene>(scene: &S, light: u32, sampler: &mut impl Sampler) -> Option<([f32; 3], u32)> {
    let emission = scene.emitters()[light as usize].sample_emission(sampler.next_2d(), sampler.next_2d())?;
    let vertex = scene.intersect(&emission.point.ray_along(emission.direction))?;
    let is_stored = vertex.is_connectible() && vertex.point().position.is_finite();
    is_stored.then(|| (vertex.point().position.to_array(), light))
}

/// The median over some photons of the distance to the `nearest`-th around them; the scene's `radius` if there are not so many.
pub(super) fn usual_distance(positions: &[[f32; 3]], nearest: usize, radius: f32) -> f32 {
    // Every so many photons will do, as long as eight or more of them make up the neighbourhood.
    let stride = (nearest / 8).max(1);
    let neighbour = nearest / stride;
    let some: Vec<[f32; 3]> = positions.iter().copied().step_by(stride).collect();
    let fallback = if radius > 0.0 && radius.is_finite() { radius.clamp(1e-12, 1e15) } else { 1.0 };
    if some.len() <= neighbour {
        return fallback;
    }
    let probes: Vec<usize> = (0..PROBES).map(|probe| probe * some.len() / PROBES).collect();
    let distance = |&probe: &usize| {
        let square = |at: &[f32; 3]| (0..3).map(|k| (at[k] - some[probe][k]).powi(2)).sum::<f32>();
        let mut squares: Vec<f32> = some.iter().map(square).collect();
        // Itself is the nearest.
        squares.select_nth_unstable_by(neighbour, f32::total_cmp).1.sqrt()
    };
    let mut distances: Vec<f32> = probes.par_iter().map(distance).collect();
    let median = *distances.select_nth_unstable_by(PROBES / 2, f32::total_cmp).1;
    if median > 0.0 { median.clamp(1e-12, 1e15) } else { fallback }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrivals_come_back_in_order() {
        let mut all = Arrivals(vec![([0.1, -0.0, 1e-30], 7), ([1.0, 2.0, 3.0], u32::MAX)]);
        let bytes = all.to_bytes();
        assert_eq!(Arrivals::from_bytes(&bytes).as_ref(), Ok(&all));
        assert!(Arrivals::from_bytes(&bytes[1..]).is_err());
        all.join(Arrivals(vec![([4.0; 3], 1)])).unwrap();
        assert_eq!(all.positions()[2], [4.0; 3]);
        // The second one's light is out of range for a photon, but primary photons keep whatever they are told.
        assert_eq!(all.photons().len(), 3);
    }

    #[test]
    fn the_usual_distance_is_that_of_the_nearest() {
        // A grid of step 0.1: 4 neighbours at 0.1, 4 at 0.1414, 4 at 0.2.
        let grid: Vec<[f32; 3]> = (0..2500).map(|i| [0.1 * (i % 50) as f32, 0.1 * (i / 50) as f32, 0.0]).collect();
        assert!((usual_distance(&grid, 8, 5.0) - 0.2_f32.sqrt() * 0.1_f32.sqrt()).abs() < 1e-4);
        // Every twelfth of them, in any arrangement: the area of 96 steps.
        let estimate = usual_distance(&grid, 96, 5.0);
        assert!((0.3..1.1).contains(&estimate), "{estimate}");
        assert_eq!(usual_distance(&grid[..8], 8, 5.0), 5.0);
        assert_eq!(usual_distance(&[[0.0; 3]; 100], 8, 5.0), 5.0);
        assert_eq!(usual_distance(&[], 8, f32::NAN), 1.0);
    }
}
