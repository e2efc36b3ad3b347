//! Primary photons: from lights to the first surface.

use photon_map::{CausticRule, LastBounce, LightTable, LightTableError, Photon, PrimaryPhotons};
use qmc_sampling::{Sampler, SamplerFamily};
use rayon::prelude::*;
use scene_core::{Counting, Emitter, RayCounts, Scene, Spectrum, Vertex};

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

/// All primary photons in order, their positions, and the rays that they took.
pub(super) fn trace_all<S: Scene + Sync, F: SamplerFamily>(
    scene: &S,
    samplers: &F,
    starts: &LightTable,
    count: u32,
) -> (PrimaryPhotons, Vec<[f32; 3]>, RayCounts) {
    let task = |first: u32| {
        let scene = Counting::new(scene);
        let photons: Vec<Photon<f32>> = (first..count.min(first.saturating_add(PHOTONS_PER_TASK)))
            .filter_map(|path| {
                // The lights are stratified, whatever the sampler.
                let (light, _) = starts.sample((f64::from(path) + 0.5) / f64::from(count));
                trace(&scene, light, &mut samplers.sampler(LIGHT_STREAM, u64::from(path)))
            })
            .collect();
        (photons, scene.counts())
    };
    let firsts: Vec<u32> = (0..count).step_by(PHOTONS_PER_TASK as usize).collect();
    let tasks: Vec<_> = firsts.into_par_iter().map(task).collect();
    let (mut primary, mut positions, mut rays) = (PrimaryPhotons::new(), Vec::new(), RayCounts::default());
    for (photons, counts) in &tasks {
        photons.iter().for_each(|photon| primary.offer(photon));
        positions.extend(photons.iter().map(|photon| photon.position));
        rays += *counts;
    }
    (primary, positions, rays)
}

/// A photon from `light`, where it first meets a surface; nothing if one cannot search for light there.
fn trace<S: Scene>(scene: &S, light: u32, sampler: &mut impl Sampler) -> Option<Photon<f32>> {
    let emission = scene.emitters()[light as usize].sample_emission(sampler.next_2d(), sampler.next_2d())?;
    let vertex = scene.intersect(&emission.point.ray_along(emission.direction))?;
    let is_stored = vertex.is_connectible() && vertex.point().position.is_finite();
    let photon = Photon::new(vertex.point().position.to_array(), (-emission.direction).to_array(), 1.0);
    is_stored.then(|| CausticRule::SPECULAR.label(photon.from_light(light), LastBounce::Emission))
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
