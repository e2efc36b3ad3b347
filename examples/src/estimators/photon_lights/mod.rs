//! Direct light from many lights: primary photons tell which of them get shadow rays.

mod tracing;

use std::cell::Cell;
use std::time::Instant;

use photon_map::{ContributingLights, Gather, LightSelection, LightTable, PrimaryPhotonMap, ShadowRay, ShadowRays};
use qmc_sampling::{Sampler, SamplerFamily};
use scene_core::{DirectSample, Emitter, RayCounts, Scene, Spectrum, TransportMode, Vertex};

use self::tracing::{powers, starts, trace_share, usual_distance};
use super::direct::DirectLight;
use crate::distributed::Ranks;
use crate::light_photons::{ImportanceName, LightPhotonSettings, LightPhotonsError};

/// Direct light at a vertex by a fixed number of shadow rays, however many lights there are: the lights `C` that primary photons around the
/// vertex came from get `S_con` of them, all others, which are most probably occluded, `S_other`.
///
/// ```text
/// L = sum over rays  f cos L_e V / (e_j p_j)        e_j = E(number of rays to light j)
/// ```
/// **Symbols.** `p_j`: density of the ray on light `j`, by solid angle (1 for Dirac lights). `e_j`: see
/// [`LightSelection`]. The weights of lights in its table are their powers where Keller and Wald 2000 has emission areas, so that lights without an area and the
/// environment take part.
///
/// **Photons** are traced once, before the first pixel, to the first surface: half of them start at lights in proportion to power, half in equal
/// numbers at each. They are stored where light can be searched for, whatever a photon map might keep.
///
/// **Unbiased** for `S_other >= 1`, whatever the photons found. **Biased** for `S_other = 0`: too dark by what the photons missed.
/// All direct light is found here, none by the path's own scattering (but for specular directions).
///
/// **Cost.** A query for photons and at most `S_con + S_other` shadow rays; with [`ImportanceName::Contribution`] an evaluation per contributing light.
/// Nothing at a vertex depends on the number of lights but by its logarithm. Memory: 36 to 52 bytes per photon, and 4 bytes per light and thread.
///
/// **Source.** Keller and Wald 2000, section 3.
#[derive(Clone, Debug)]
pub struct PhotonLights {
    map: PrimaryPhotonMap,
    gather: Gather,
    selection: LightSelection,
    importance: ImportanceName,
    /// Of each light, proportional to the flux of one of its photons.
    flux: Vec<f64>,
    rays: RayCounts,
    seconds: f64,
}

/// The sub-streams of the shadow rays' numbers, one per length.
const LIGHTS_DOMAIN: u32 = 0x7068_6f6c;
/// Share of importance that photons have beside what the middles of lights would contribute.
const BY_PHOTONS: f64 = 0.125;
/// How many times as far as usual photons are looked for where they are rare.
const FARTHEST: f32 = 3.0;

impl PhotonLights {
    /// Traces the photons, on all threads of the pool that this runs in. They are the same on any number of threads. Nothing for a scene
    /// without lights.
    ///
    /// # Errors
    /// Settings out of range.
    pub fn trace<S: Scene + Sync, F: SamplerFamily>(
        scene: &S,
        samplers: &F,
        settings: &LightPhotonSettings,
    ) -> Result<Option<Self>, LightPhotonsError> {
        Self::trace_by(scene, samplers, settings, &Ranks::default())
    }

    /// [`trace`](Self::trace) together with all other ranks: each traces a part of the photons and has all of them, the same
    /// ones as one process; [`rays`](Self::rays) are those of this rank.
    ///
    /// # Errors
    /// Settings out of range, or a rank has failed.
    pub fn trace_by<S: Scene + Sync, F: SamplerFamily>(
        scene: &S,
        samplers: &F,
        settings: &LightPhotonSettings,
        ranks: &Ranks,
    ) -> Result<Option<Self>, LightPhotonsError> {
        let start = Instant::now();
        if scene.emitters().is_empty() {
            return Ok(None);
        }
        let powers = powers(scene);
        let starts = starts(&powers)?;
        let count = settings.photons_for(powers.len());
        let share = ranks.share(u64::from(count));
        let (own, rays) = trace_share(scene, samplers, &starts, count, share.start as u32..share.end as u32);
        let arrivals = ranks.gather(own)?;
        let (primary, positions) = (arrivals.photons(), arrivals.positions());
        drop(arrivals);
        let usual = match settings.light_radius {
            Some(radius) => radius,
            None => usual_distance(&positions, settings.nearest_or_default(), scene.bounding_sphere().1),
        };
        drop(positions);
        let gather = match (settings.light_nearest, settings.light_radius) {
            (None, _) => Gather::within(usual)?,
            (Some(count), Some(radius)) => Gather::nearest(count, radius)?,
            (Some(count), None) => Gather::nearest(count, FARTHEST * usual)?,
        };
        let flux = (0..).zip(&powers).map(|(light, power)| power / starts.probability(light)).collect();
        let table = LightTable::new(&powers)?;
        let (con, other) = (settings.contributing_rays, settings.other_rays);
        let selection = LightSelection::new(table, con, other, settings.light_allocation.allocation())?;
        let map = PrimaryPhotonMap::build(primary, usual)?;
        let (importance, seconds) = (settings.light_importance, start.elapsed().as_secs_f64());
        Ok(Some(Self { map, gather, selection, importance, flux, rays, seconds }))
    }

    /// The photons.
    pub fn map(&self) -> &PrimaryPhotonMap {
        &self.map
    }

    /// How far photons are looked for.
    pub fn gather(&self) -> &Gather {
        &self.gather
    }

    /// The rays that photons took.
    pub fn rays(&self) -> RayCounts {
        self.rays
    }

    /// The time that photons took, in seconds.
    pub fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Chooses the shadow rays for a vertex.
    fn select<S: Scene>(&self, scene: &S, vertex: &S::Vertex<'_>, u: [f64; 2], memory: &mut Memory) {
        let Memory { contributing, unoccluded: by_light, rays } = memory;
        let position = vertex.point().position;
        self.map.contributing(position.to_array(), &self.gather, contributing);
        let flux = |light: u32, photons: u32| f64::from(photons) * self.flux[light as usize];
        match self.importance {
            // A light alone gets all rays anyway.
            _ if contributing.len() == 1 => self.selection.select_by_weight(contributing, u, rays),
            ImportanceName::Power => self.selection.select_by_weight(contributing, u, rays),
            ImportanceName::Photons => self.selection.select(contributing, flux, u, rays),
            ImportanceName::Contribution => {
                let middle = |light: u32| {
                    let light = scene.emitters()[light as usize].sample_direct(position, [0.5; 2]);
                    let value = light.map_or(0.0, |light| f64::from(unoccluded(vertex, &light).luminance()));
                    if value.is_finite() { value.max(0.0) } else { 0.0 }
                };
                by_light.clear();
                by_light.extend(contributing.as_slice().iter().map(|&(light, _)| middle(light)));
                let of_middles = by_light.iter().sum::<f64>();
                let of_photons =
                    contributing.as_slice().iter().map(|&(light, photons)| flux(light, photons)).sum::<f64>();
                let scale = if of_middles > 0.0 { (1.0 - BY_PHOTONS) / of_middles } else { 0.0 };
                let mixed = |light, photons| {
                    let place = contributing.as_slice().binary_search(&(light, photons)).unwrap_or_default();
                    by_light[place] * scale + BY_PHOTONS * flux(light, photons) / of_photons
                };
                self.selection.select(contributing, mixed, u, rays);
            }
        }
    }
}

/// `f cos L_e / p`, without visibility.
#[inline]
fn unoccluded<V: Vertex>(vertex: &V, light: &DirectSample<V::Spectrum>) -> V::Spectrum {
    vertex.eval(light.wi, TransportMode::Radiance) * light.radiance * (1.0 / light.pdf_solid_angle)
}

/// Where on its light a ray ends: a rotated Hammersley set over the rays to one light, each of which is uniform by itself.
#[inline]
fn place(ray: &ShadowRay, rotation: [f32; 2]) -> [f32; 2] {
    let inside = |x: f32| x.clamp(0.0, 1.0 - 0.5 * f32::EPSILON);
    if ray.strata <= 1 {
        return rotation;
    }
    let turned = rotation[1] + ray.stratum.reverse_bits() as f32 * 2.0_f32.powi(-32);
    [inside((ray.stratum as f32 + rotation[0]) / ray.strata as f32), inside(turned - turned.floor())]
}

/// What a thread needs at a vertex.
struct Memory {
    contributing: ContributingLights,
    /// Of each contributing light.
    unoccluded: Vec<f64>,
    rays: ShadowRays,
}

impl Memory {
    fn new(lights: usize) -> Self {
        Self { contributing: ContributingLights::new(lights), unoccluded: Vec::new(), rays: ShadowRays::default() }
    }
}

/// The memory of a thread, with the number of lights that it is for. Nothing in it outlives a vertex.
type Kept = Option<(usize, Box<Memory>)>;

thread_local! {
    static KEPT: Cell<Kept> = const { Cell::new(None) };
}

/// Calls `f` with this thread's memory.
fn with_memory<R>(lights: usize, f: impl FnOnce(&mut Memory) -> R) -> R {
    KEPT.with(|kept| {
        let mut memory = match kept.take() {
            Some((count, memory)) if count == lights => memory,
            _ => Box::new(Memory::new(lights)),
        };
        let result = f(&mut memory);
        kept.set(Some((lights, memory)));
        result
    })
}

impl DirectLight for PhotonLights {
    #[inline]
    fn sample<S: Scene>(
        &self,
        scene: &S,
        vertex: &S::Vertex<'_>,
        length: u32,
        wanted: bool,
        sampler: &mut impl Sampler,
    ) -> S::Spectrum {
        let mut radiance = S::Spectrum::ZERO;
        if !wanted {
            return radiance;
        }
        let mut numbers = sampler.fork(LIGHTS_DOMAIN.wrapping_add(length));
        let u = [f64::from(numbers.next_1d()), finely(&mut numbers)];
        with_memory(scene.emitters().len(), |memory| {
            self.select(scene, vertex, u, memory);
            let point = vertex.point();
            let mut rotation = [0.0; 2];
            for ray in memory.rays.as_slice() {
                if ray.stratum == 0 {
                    rotation = numbers.next_2d();
                }
                let emitter = &scene.emitters()[ray.light as usize];
                let Some(light) = emitter.sample_direct(point.position, place(ray, rotation)) else { continue };
                let value = unoccluded(vertex, &light) * ray.weight as f32;
                if value.is_black() {
                    continue;
                }
                if !scene.occluded(&light.shadow_ray(vertex)) {
                    radiance += value;
                }
            }
        });
        radiance
    }
}

/// A number of 48 bits: among many lights, 24 would choose some too often.
fn finely(numbers: &mut impl Sampler) -> f64 {
    let coarse = f64::from(numbers.next_1d());
    coarse + f64::from(numbers.next_1d()) * 2.0_f64.powi(-24)
}

#[cfg(test)]
mod tests {
    use super::*;
    use photon_map::{Allocation, LightSelection};

    #[test]
    fn rays_to_one_light_are_stratified() {
        let table = LightTable::uniform(1).unwrap();
        let selection = LightSelection::new(table, 8, 1, Allocation::Proportional).unwrap();
        let mut rays = ShadowRays::default();
        selection.select_by_weight(&ContributingLights::from_lights(1, [0]), [0.3, 0.3], &mut rays);
        for rotation in [[0.0, 0.0], [0.3, 0.9], [1.0 - 0.5 * f32::EPSILON; 2]] {
            let mut cells = [[0; 8]; 2];
            for ray in rays.as_slice() {
                let at = place(ray, rotation);
                assert!(at.iter().all(|x| (0.0..1.0).contains(x)), "{at:?}");
                (0..2).for_each(|k| cells[k][(8.0 * at[k]) as usize] += 1);
            }
            // The largest number of all may be rounded up into the next cell.
            assert!(rotation[1] > 0.9999 || cells == [[1; 8]; 2], "{cells:?}");
        }
    }

    #[test]
    fn memory_follows_the_number_of_lights() {
        for lights in [3, 3, 7, 3] {
            with_memory(lights, |memory| {
                memory.contributing.set([0, 2, 6]);
                assert_eq!(memory.contributing.len(), if lights == 7 { 3 } else { 2 });
            });
        }
    }
}
