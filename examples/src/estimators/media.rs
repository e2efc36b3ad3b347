//! Paths through participating media.

use qmc_sampling::Sampler;
use scene_core::medium::{Medium, MediumExit};
use scene_core::{Ray, Scene};

/// The sub-streams of the numbers for walks through media, one per length of the path: so many numbers are taken as
/// there are scatterings, and the path keeps its own.
const MEDIUM_DOMAIN: u32 = 0x6d65_6469;

/// What `ray` finds beyond `medium`; nothing if the path ends in there. Out of line: the loop of paths without media
/// stays short.
#[inline(never)]
pub(super) fn through<'s, S: Scene>(
    scene: &'s S,
    medium: &Medium<S::Spectrum>,
    ray: Ray,
    throughput: S::Spectrum,
    length: u32,
    sampler: &impl Sampler,
) -> Option<MediumExit<S::Vertex<'s>, S::Spectrum>> {
    medium.walk(scene, ray, throughput, &mut sampler.fork(MEDIUM_DOMAIN.wrapping_add(length)))
}

#[cfg(test)]
mod tests {
    use qmc_sampling::{OwenSobol, SamplerFamily};
    use scene_core::builtin::furnace;
    use scene_core::material::Material;
    use scene_core::{ReferenceScene, Rgb, RussianRoulette, Sensor, UniformChoice};

    use super::*;
    use crate::choices::AnyHeuristic;
    use crate::estimators::{CameraEstimator, FirstEvent, NextEvent, OwnSampling, PathTracer};

    /// A ball of glass in uniform light, of index 1.4, filled, and 400 paths through it.
    fn values(medium: Medium<Rgb>, max_depth: u32) -> Vec<Rgb> {
        let glass = Material::glass(1.4);
        let scene = ReferenceScene::new(furnace(glass.filled_with(medium))).unwrap();
        let direct = NextEvent { heuristic: AnyHeuristic::Power, choice: UniformChoice::new(scene.emitters().len()) };
        let roulette = RussianRoulette::Never;
        let path = PathTracer { direct, scattering: OwnSampling, max_depth, roulette, first_event: FirstEvent::Any };
        let ray = scene.sensor().sample_ray([70.0, 60.0], [0.5; 2]).ray;
        (0..400).map(|i| path.radiance(&scene, ray, &mut OwenSobol::new(1).sampler(0, i)).0).collect()
    }

    #[test]
    fn without_absorption_every_path_brings_the_light_around() {
        let medium = Medium::new(Rgb::ZERO, Rgb::splat(6.0), 0.5).unwrap();
        for value in values(medium, u32::MAX) {
            assert!((value[0] - 1.0).abs() < 1e-3, "{value:?}");
        }
        // However often it scatters, the way through is one segment, and no path is longer here than is likely.
        let found = values(medium, 3).into_iter().filter(|value| (value[0] - 1.0).abs() < 1e-3).count();
        assert!((100..400).contains(&found), "{found}");
    }

    #[test]
    fn absorption_is_not_ignored() {
        let medium = Medium::new(Rgb::new(0.0, 1.0, 100.0), Rgb::ZERO, 0.0).unwrap();
        let values = values(medium, u32::MAX);
        let mean = |i: usize| values.iter().map(|value| value[i]).sum::<f32>() / values.len() as f32;
        assert!((mean(0) - 1.0).abs() < 1e-3 && mean(1) < 0.5 && mean(2) < 0.1, "{} {} {}", mean(0), mean(1), mean(2));
    }
}
