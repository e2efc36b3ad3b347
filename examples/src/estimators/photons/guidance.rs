//! Where light paths begin and how they go on: as emitters and materials have it, or towards importance.

use glam::Vec3A;
use photon_map::{
    DensityEstimation, DirectionalHistogram, Gather, GatherPoint, Guide, ImportanceMap, Kernel, LightTable, Photons,
    Scratch,
};
use qmc_sampling::{Sampler, SamplerFamily};
use scene_core::{
    Emitter, EmitterChoice, EmitterId, Onward, Ray, RayCounts, ScatterSample, Scene, Spectrum, TransportMode, Vertex,
};

use super::ImportonTracing;
use super::importons::{Purpose, sorted};
use super::maps::gather_point;
use crate::distributed::{Ranks, RanksError};
use crate::render::PassContext;

/// How light paths begin and go on.
///
/// # Laws
/// - The expectation of the flux that leaves in any solid angle is that of [`Emitter::sample_emission`] with an emitter
///   of the choice.
/// - The expectation of the throughput in any solid angle is that of [`Vertex::sample`], and so is that of `own` over the
///   material's own sampling.
pub trait PathGuidance: Sync {
    /// Memory of a thread.
    type Scratch;

    /// Such memory.
    fn scratch(&self) -> Self::Scratch;

    /// A ray of light and its flux, by an emitter of the choice or by another.
    fn emit<S: Scene>(
        &self,
        scene: &S,
        choice: &impl EmitterChoice,
        scratch: &mut Self::Scratch,
        sampler: &mut impl Sampler,
    ) -> Option<(Ray, S::Spectrum)>;

    /// A direction for a light path, or nothing if it is absorbed.
    fn scatter<V: Vertex>(
        &self,
        vertex: &V,
        scratch: &mut Self::Scratch,
        sampler: &mut impl Sampler,
    ) -> Option<Onward<V::Spectrum>>;
}

/// Emitters and materials sample by themselves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Unguided;

impl PathGuidance for Unguided {
    type Scratch = ();

    fn scratch(&self) {}

    fn emit<S: Scene>(
        &self,
        scene: &S,
        choice: &impl EmitterChoice,
        (): &mut (),
        sampler: &mut impl Sampler,
    ) -> Option<(Ray, S::Spectrum)> {
        let choose = sampler.next_1d();
        let (u_position, u_direction) = (sampler.next_2d(), sampler.next_2d());
        let chosen = choice.choose(None, choose)?;
        let emission = scene.emitters()[chosen.id.index()].sample_emission(u_position, u_direction)?;
        Some((emission.point.ray_along(emission.direction), emission.flux * (1.0 / chosen.probability)))
    }

    fn scatter<V: Vertex>(&self, vertex: &V, (): &mut (), sampler: &mut impl Sampler) -> Option<Onward<V::Spectrum>> {
        Onward::unguided(vertex, TransportMode::Importance, sampler)
    }
}

/// Importons that guide light paths: what, and with which share.
///
/// The histogram of directions is that of the 64 nearest importons within the radius of [`ImportonTracing`]; the cells are
/// 0.4 sr each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GuidanceTracing {
    /// The paths from the sensor; they go on beyond where eye paths ask for photons.
    pub importons: ImportonTracing,
    /// The share of directions and emitters that importons choose.
    pub guide: Guide,
    /// Whether they guide scattering.
    pub scattering: bool,
    /// Whether they guide emission.
    pub emission: bool,
}

/// Light paths that go where importance comes from, mixed with what emitters and materials do by themselves.
///
/// ```text
/// P(j) = (1 - b) P_0(j) + b I_j / sum I              which emitter
/// p(w) = (1 - b) p_0(w) + b h(w)                     which direction, at an emitter and where light scatters
/// flux_1 = L_e |cos| / (P p_area p),                 flux_(k+1) = flux_k f* |cos| / (p q)
/// ```
/// **Symbols.** `b`: share of [`Guide`]; `P_0`, `p_0`: probability and density without guidance; `I_j`: what the
/// importons that arrived at emitter `j` see there, importance times radiance; `h`: [`DirectionalHistogram`] of the
/// importons around the point, on its side of the surface; `q`: survival of Russian roulette, which goes by `f* cos /
/// p_0` as it would without guidance.
///
/// The *place* on the emitter is not guided. Emitters that importons cannot arrive at (points, parallel light,
/// surroundings) are chosen with `(1 - b) P_0` if there are others, and emit as they do by themselves. Dirac deltas and
/// surfaces that scatter by them alone are never guided; beside other light a delta counts `1 / (1 - b)` times when it is
/// drawn.
///
/// **Unbiased** for any importons: every path keeps at least `1 - b` of its density at each of its vertices. For the same
/// reason flux grows by at most `1 / (1 - b)` at each.
///
/// **Source.** I. Peter and G. Pietrek, "Importance driven construction of photon maps", 1998; the mixture is ours.
#[derive(Clone, Debug)]
pub struct ImportonGuidance {
    guide: Guide,
    surfaces: Option<ImportanceMap>,
    emitters: Option<GuidedEmitters>,
}

/// Memory for directions of importance.
#[derive(Clone, Debug)]
pub struct GuideScratch {
    histogram: DirectionalHistogram,
    scratch: Scratch,
}

impl GuideScratch {
    fn fill(&mut self, map: &ImportanceMap, at: &GatherPoint) {
        map.directions(at, &mut self.histogram, &mut self.scratch);
    }
}

/// Importance at emitters.
#[derive(Clone, Debug)]
struct GuidedEmitters {
    map: ImportanceMap,
    /// Which emitters are chosen how often; nothing if none shines.
    table: Option<(LightTable, Vec<u32>)>,
}

/// Importons of a histogram: more of them cost more than they help.
const NEAREST: usize = 64;
/// Columns and rows of a histogram.
const CELLS: [u32; 2] = [8, 4];

impl GuidanceTracing {
    /// Traces importons; the rays are those of this rank. `choice`: which emitters light paths begin at without guidance.
    ///
    /// # Errors
    /// If a rank has failed.
    pub fn trace<S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'_, S, F>,
        choice: &impl EmitterChoice,
        ranks: &Ranks,
    ) -> Result<(ImportonGuidance, RayCounts), RanksError> {
        let (left, rays) = self.importons.paths(context, ranks, Purpose::Guidance, 0, self.importons.paths.max(1))?;
        let emitters = self.emission.then(|| {
            let mut importance = vec![0.0; context.scene.emitters().len()];
            for importon in left.emitters.as_slice() {
                if let Some(sum) = importon.unpack().light.and_then(|id| importance.get_mut(id as usize)) {
                    *sum += f64::from(importon.flux());
                }
            }
            let table = emitter_table(choice, &importance, self.guide.share());
            GuidedEmitters { map: self.sorted(left.emitters), table }
        });
        let surfaces = self.scattering.then(|| self.sorted(left.surfaces));
        Ok((ImportonGuidance { guide: self.guide, surfaces, emitters }, rays))
    }

    fn sorted(&self, importons: Photons<f32>) -> ImportanceMap {
        let radius = self.importons.estimation.gather.max_radius();
        let gather = Gather::nearest(NEAREST, radius).expect("the radius of a gather");
        // Where importons are dense, the nearest are near.
        sorted(importons, DensityEstimation { gather, kernel: Kernel::Constant }, 0.25 * radius)
    }
}

/// The emitters that light paths may begin at, and how often they do.
fn emitter_table(choice: &impl EmitterChoice, importance: &[f64], share: f64) -> Option<(LightTable, Vec<u32>)> {
    let probability = |id: u32| f64::from(choice.probability(None, EmitterId(id)));
    let ids: Vec<u32> = (0..importance.len() as u32).filter(|&id| probability(id) > 0.0).collect();
    let powers: Vec<f64> = ids.iter().map(|&id| probability(id)).collect();
    let importance: Vec<f64> = ids.iter().map(|&id| importance[id as usize]).collect();
    Some((LightTable::guided(&powers, &importance, share).ok()?, ids))
}

impl PathGuidance for ImportonGuidance {
    type Scratch = GuideScratch;

    fn scratch(&self) -> GuideScratch {
        let histogram = DirectionalHistogram::new(CELLS[0], CELLS[1]).expect("some cells, and not too many");
        GuideScratch { histogram, scratch: Scratch::default() }
    }

    fn emit<S: Scene>(
        &self,
        scene: &S,
        choice: &impl EmitterChoice,
        directions: &mut GuideScratch,
        sampler: &mut impl Sampler,
    ) -> Option<(Ray, S::Spectrum)> {
        let Some(guided) = &self.emitters else { return Unguided.emit(scene, choice, &mut (), sampler) };
        let (table, ids) = guided.table.as_ref()?;
        let (place, probability) = table.sample(f64::from(sampler.next_1d()));
        let emitter = &scene.emitters()[ids[place as usize] as usize];
        let (u_position, u_direction) = (sampler.next_2d(), sampler.next_2d());
        let choose = f64::from(sampler.next_1d());
        let own = emitter.sample_emission(u_position, u_direction)?;
        let per_choice = (1.0 / probability) as f32;

        let (point, normal) = (own.point, own.point.normal);
        if !emitter.is_delta() && !emitter.is_infinite() {
            let at = GatherPoint::on(point.position.to_array(), normal.to_array());
            directions.fill(&guided.map, &at);
        } else {
            directions.histogram.clear();
        }
        let histogram = &directions.histogram;
        let share = self.guide.share_at(histogram);
        if share == 0.0 {
            return Some((point.ray_along(own.direction), own.flux * per_choice));
        }
        let direction = if choose < share { guided_direction(histogram, u_direction)? } else { own.direction };
        let own_pdf = f64::from(emitter.pdf_emission(Some(&point), direction).1);
        let pdf = self.guide.pdf_solid_angle(histogram, direction.to_array(), own_pdf);
        let per_area = normal.dot(direction).abs() / own.pdf_area;
        let flux = emitter.radiance(Some(&point), direction) * ((f64::from(per_area) / pdf) as f32 * per_choice);
        (!flux.is_black() && flux.is_finite()).then(|| (point.ray_along(direction), flux))
    }

    fn scatter<V: Vertex>(
        &self,
        vertex: &V,
        directions: &mut GuideScratch,
        sampler: &mut impl Sampler,
    ) -> Option<Onward<V::Spectrum>> {
        let Some(map) = self.surfaces.as_ref().filter(|_| vertex.is_connectible()) else {
            return Unguided.scatter(vertex, &mut (), sampler);
        };
        directions.fill(map, &gather_point(vertex));
        let histogram = &directions.histogram;
        let share = self.guide.share_at(histogram);
        if share == 0.0 {
            return Unguided.scatter(vertex, &mut (), sampler);
        }
        let (lobe, [u, v], choose) = (sampler.next_1d(), sampler.next_2d(), f64::from(sampler.next_1d()));
        let wi = if choose < share {
            guided_direction(histogram, [u, v])?
        } else {
            let sample = vertex.sample([lobe, u, v], TransportMode::Importance)?;
            if sample.is_specular {
                let throughput = sample.throughput * (1.0 / (1.0 - share)) as f32;
                return Some(Onward { own: sample.throughput, sample: ScatterSample { throughput, ..sample } });
            }
            sample.wi
        };
        let (f_cos, own_pdf) = vertex.eval_pdf(wi, TransportMode::Importance);
        let pdf = self.guide.pdf_solid_angle(histogram, wi.to_array(), f64::from(own_pdf));
        // Where the material never goes, it does not scatter.
        (own_pdf > 0.0).then(|| Onward {
            sample: ScatterSample {
                wi,
                throughput: f_cos * (1.0 / pdf) as f32,
                pdf_solid_angle: own_pdf,
                is_specular: false,
                eta: 1.0,
            },
            own: f_cos * (1.0 / own_pdf),
        })
    }
}

fn guided_direction(histogram: &DirectionalHistogram, u: [f32; 2]) -> Option<Vec3A> {
    histogram.sample(u.map(f64::from)).map(|direction| Vec3A::from(direction).normalize())
}
