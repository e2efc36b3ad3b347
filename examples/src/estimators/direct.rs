//! Direct light: what a path tracer does about the emitters at each vertex.

use mis_heuristics::{Densities, Float, Heuristic};
use qmc_sampling::Sampler;
use scene_core::{Emitter, EmitterChoice, EmitterId, Ray, Scene, Spectrum, SurfacePoint, TransportMode, Vertex};

/// Position of next event estimation among the two techniques that find light.
const LIGHT: usize = 0;
/// Position of scattering.
const SCATTERING: usize = 1;

/// Where the last scattering that other techniques could have generated happened, and its density.
#[derive(Clone, Copy, Debug)]
pub struct Scattered<'a> {
    /// Where.
    pub point: &'a SurfacePoint,
    /// Density by solid angle of the ray that left; zero if it is not known.
    pub pdf_solid_angle: f32,
}

/// A way to find the light that emitters send directly to a vertex, and its share against scattering into them.
///
/// # Laws
/// The expectation of [`sample`](Self::sample), plus that of the light which a scattered ray hits times
/// [`scattering_weight`](Self::scattering_weight), is the direct light that the vertex scatters towards `wo`.
pub trait DirectLight: Sync {
    /// An estimate of `integral of f cos L_e V` at a path's vertex of this `length`, without the share that is left to scattering. Always
    /// takes the same number of numbers from the sampler; not `wanted` where only the numbers count.
    fn sample<S: Scene>(
        &self,
        scene: &S,
        vertex: &S::Vertex<'_>,
        length: u32,
        wanted: bool,
        sampler: &mut impl Sampler,
    ) -> S::Spectrum;

    /// The share of light of emitter `id` that `ray`, scattered at `from`, hits `at` this point (`None`: at infinity). None by default: all
    /// direct light is found by [`sample`](Self::sample).
    #[inline]
    fn scattering_weight<S: Scene>(
        &self,
        scene: &S,
        from: Scattered<'_>,
        ray: &Ray,
        id: EmitterId,
        at: Option<&SurfacePoint>,
    ) -> f32 {
        let _ = (scene, from, ray, id, at);
        0.0
    }

    /// The share of what emitters send along `ray` that is left to it: all if it did not leave by a scattering that other techniques could have
    /// generated. `hit` is what the ray hit, `factor` multiplies.
    #[inline]
    fn emission<S: Scene>(
        &self,
        scene: &S,
        ray: &Ray,
        hit: Option<&S::Vertex<'_>>,
        from: Option<Scattered<'_>>,
        factor: S::Spectrum,
    ) -> S::Spectrum {
        let Some(id) = hit.map_or_else(|| scene.environment(), Vertex::emitter) else { return S::Spectrum::ZERO };
        let emitted = hit.map_or_else(|| scene.environment_radiance(ray.direction), Vertex::emitted);
        if emitted.is_black() {
            return emitted;
        }
        let weight = from.map_or(1.0, |from| self.scattering_weight(scene, from, ray, id, hit.map(Vertex::point)));
        factor * emitted * weight
    }
}

/// Next event estimation: one emitter is chosen, one point on it, and one shadow ray is traced; combined with scattering by a heuristic.
///
/// ```text
/// w_l f cos L_e V / (p_choice p_l)
/// ```
/// Light without area (Dirac deltas) has `w_l = 1`. Source: Veach and Guibas 1995.
#[derive(Clone, Copy, Debug)]
pub struct NextEvent<H, C> {
    /// Combines the two techniques.
    pub heuristic: H,
    /// Chooses the emitter.
    pub choice: C,
}

impl<H: Heuristic<f32> + Sync, C: EmitterChoice + Sync> DirectLight for NextEvent<H, C> {
    #[inline]
    fn sample<S: Scene>(
        &self,
        scene: &S,
        vertex: &S::Vertex<'_>,
        _: u32,
        wanted: bool,
        sampler: &mut impl Sampler,
    ) -> S::Spectrum {
        // The numbers are drawn at every vertex, so that each keeps its dimensions of a quasi-Monte Carlo point.
        let (choose, u) = (sampler.next_1d(), sampler.next_2d());
        let unlit = S::Spectrum::ZERO;
        if !wanted {
            return unlit;
        }
        let point = vertex.point();
        let Some(chosen) = self.choice.choose(Some(point), choose) else { return unlit };
        let emitter = &scene.emitters()[chosen.id.index()];
        let Some(light) = emitter.sample_direct(point.position, u) else { return unlit };
        let (scattered, pdf_scattering) = vertex.eval_pdf(light.wi, TransportMode::Radiance);
        if scattered.is_black() {
            return unlit;
        }
        let pdf_light = chosen.probability * light.pdf_solid_angle;
        let weight = if light.is_delta { 1.0 } else { self.heuristic.weight(LIGHT, &[pdf_light, pdf_scattering]) };
        let value = scattered * light.radiance * (weight / pdf_light);
        if value.is_black() {
            return unlit;
        }
        if scene.occluded(&light.shadow_ray(vertex)) { unlit } else { value }
    }

    #[inline]
    fn scattering_weight<S: Scene>(
        &self,
        scene: &S,
        from: Scattered<'_>,
        ray: &Ray,
        id: EmitterId,
        at: Option<&SurfacePoint>,
    ) -> f32 {
        let probability = self.choice.probability(Some(from.point), id);
        let pdf = scene.emitters()[id.index()].pdf_direct(from.point.position, ray.direction, at);
        self.heuristic.weight(SCATTERING, &[probability * pdf, from.pdf_solid_angle])
    }
}

/// The heuristic that gives next event estimation everything: for scattering whose density is not known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LightAlone;

impl<F: Float> Heuristic<F> for LightAlone {
    #[inline]
    fn weight(&self, technique: usize, _: &(impl Densities<F> + ?Sized)) -> F {
        if technique == LIGHT { F::ONE } else { F::ZERO }
    }
}

/// No search for emitters: light is found by scattering into it. Dirac emitters are never found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ScatteringAlone;

impl DirectLight for ScatteringAlone {
    #[inline]
    fn sample<S: Scene>(&self, _: &S, _: &S::Vertex<'_>, _: u32, _: bool, _: &mut impl Sampler) -> S::Spectrum {
        S::Spectrum::ZERO
    }

    #[inline]
    fn scattering_weight<S: Scene>(
        &self,
        _: &S,
        _: Scattered<'_>,
        _: &Ray,
        _: EmitterId,
        _: Option<&SurfacePoint>,
    ) -> f32 {
        1.0
    }
}
