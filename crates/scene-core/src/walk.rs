//! The random walk that photons, importons and virtual point lights share.

use core::ops::ControlFlow;

use qmc_sampling::Sampler;

use crate::ray::Ray;
use crate::traits::{ScatterSample, Scene, Spectrum, TransportMode, Vertex};

/// How a walk ends by chance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RussianRoulette {
    /// Never: only absorption and the length limit end the walk.
    Never,
    /// At every vertex beyond `from_length` segments the walk goes on with the probability of the largest component
    /// of the local throughput factor (the albedo, for photons), clamped to one: the throughput stays about constant.
    /// Kollig and Keller 2004, section 3.
    LocalAlbedo {
        /// Walks up to this number of segments go on surely.
        from_length: u32,
    },
    /// At every vertex beyond `from_length` segments the walk goes on with the probability of the largest component
    /// of the throughput of the whole path, undone by refraction's squared scaling and clamped to 0.95.
    PathThroughput {
        /// Walks up to this number of segments go on surely.
        from_length: u32,
    },
}

impl RussianRoulette {
    /// The probability with which a walk survives its vertex number `length`.
    ///
    /// `local` is the throughput factor of the last scattering, `path` that of the path so far relative to its start,
    /// `eta` the product of the ratios of refractive indices.
    #[inline]
    pub fn survival_probability<S: Spectrum>(&self, length: u32, local: S, path: S, eta: f32) -> f32 {
        let probability = match *self {
            Self::LocalAlbedo { from_length } if length > from_length => local.max_component().min(1.0),
            Self::PathThroughput { from_length } if length > from_length => {
                (path.max_component() * eta * eta).min(0.95)
            }
            _ => 1.0,
        };
        // NaN ends the walk.
        if probability > 0.0 { probability } else { 0.0 }
    }
}

/// Where a walk starts, and how far it may go.
#[derive(Clone, Copy, Debug)]
pub struct WalkStart<S> {
    /// The first ray.
    pub ray: Ray,
    /// Flux or importance that it carries.
    pub throughput: S,
    /// What is transported: [`TransportMode::Importance`] for walks from emitters.
    pub mode: TransportMode,
    /// Largest number of segments.
    pub max_length: u32,
    /// How it ends by chance.
    pub roulette: RussianRoulette,
}

/// A vertex of a walk, shown to the visitor before the walk scatters there.
#[derive(Clone, Copy, Debug)]
pub struct WalkVertex<'v, V, S> {
    /// The surface, seen from where the walk came.
    pub vertex: &'v V,
    /// Flux (or importance) that arrives, before scattering: the collision estimator counts it at every vertex.
    pub throughput: S,
    /// Number of segments so far; 1 at the first hit.
    pub length: u32,
    /// Length of the last segment.
    pub distance: f32,
    /// Density of the last direction by solid angle; zero if it was specular or the walk's first.
    pub pdf_solid_angle: f32,
    /// Whether the last direction was specular.
    pub after_specular: bool,
    /// Whether any scattering so far was not specular.
    pub scattered_diffusely: bool,
}

/// How a walk goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Onward<S> {
    /// The direction. Its throughput is `f cos` over the density that it was drawn with; its density is the material's
    /// own, which tells how sharp the bounce is.
    pub sample: ScatterSample<S>,
    /// `f cos` over the material's own density, which is what Russian roulette goes by: by the throughput, it would undo
    /// what guidance does, and end many of the paths that were sent where they are wanted.
    pub own: S,
}

impl<S: Spectrum> Onward<S> {
    /// As the material has it: a direction by [`Vertex::sample`].
    pub fn unguided<V: Vertex<Spectrum = S>>(
        vertex: &V,
        mode: TransportMode,
        sampler: &mut impl Sampler,
    ) -> Option<Self> {
        let (lobe, [u, v]) = (sampler.next_1d(), sampler.next_2d());
        let sample = vertex.sample([lobe, u, v], mode)?;
        Some(Self { own: sample.throughput, sample })
    }
}

/// Walks through the scene and shows every vertex to `visit`, with the flux that arrives there.
///
/// The estimator `sum over vertices of throughput * W(vertex)` is the **collision estimator** of the measurement of
/// `W`: at each vertex the walk scatters by [`Vertex::sample`], whose factor `f |cos| / pdf` multiplies the throughput, and
/// survives [`RussianRoulette`], whose probability divides it. Unbiased if `max_length` is unlimited.
///
/// Returns the number of segments traced. The visitor ends the walk with [`ControlFlow::Break`].
///
/// Source: Kollig and Keller 2004, "On the Efficiency of Multiple Importance Sampling: Robust Instant Global
/// Illumination", section 3; Veach 1997, chapter 4.
pub fn random_walk<'s, S: Scene>(
    scene: &'s S,
    start: WalkStart<S::Spectrum>,
    sampler: &mut impl Sampler,
    visit: impl FnMut(WalkVertex<'_, S::Vertex<'s>, S::Spectrum>) -> ControlFlow<()>,
) -> u32 {
    guided_walk(scene, start, sampler, |vertex, sampler| Onward::unguided(vertex, start.mode, sampler), visit)
}

/// [`random_walk`] with directions by `scatter`, which may send it where it is wanted: unbiased if the expectation of the throughput in any solid
/// angle is that of [`Vertex::sample`], and so is that of [`Onward::own`] over the material's own sampling.
pub fn guided_walk<'s, S: Scene, R: Sampler>(
    scene: &'s S,
    start: WalkStart<S::Spectrum>,
    sampler: &mut R,
    mut scatter: impl FnMut(&S::Vertex<'s>, &mut R) -> Option<Onward<S::Spectrum>>,
    mut visit: impl FnMut(WalkVertex<'_, S::Vertex<'s>, S::Spectrum>) -> ControlFlow<()>,
) -> u32 {
    let WalkStart { mut ray, mut throughput, mode, max_length, roulette } = start;
    let mut relative = S::Spectrum::splat(1.0);
    let mut eta = 1.0;
    let (mut pdf_solid_angle, mut after_specular, mut scattered_diffusely) = (0.0, false, false);
    for length in 1..=max_length {
        let Some(vertex) = scene.intersect(&ray) else { return length };
        let distance = (vertex.point().position - ray.origin).length();
        let shown = WalkVertex {
            vertex: &vertex,
            throughput,
            length,
            distance,
            pdf_solid_angle,
            after_specular,
            scattered_diffusely,
        };
        if visit(shown).is_break() || length == max_length {
            return length;
        }
        // Scatter.
        let Some(Onward { sample, own }) = scatter(&vertex, sampler) else { return length };
        relative *= sample.throughput;
        if mode == TransportMode::Radiance {
            eta *= sample.eta;
        }
        // Survive.
        let survival = roulette.survival_probability(length, own, relative, eta);
        if survival < 1.0 && sampler.next_1d() >= survival {
            return length;
        }
        throughput *= sample.throughput * (1.0 / survival);
        relative *= S::Spectrum::splat(1.0 / survival);
        if throughput.is_black() || !throughput.is_finite() {
            return length;
        }
        (pdf_solid_angle, after_specular) = (sample.pdf_solid_angle, sample.is_specular);
        scattered_diffusely |= !sample.is_specular;
        ray = vertex.spawn_ray(sample.wi);
    }
    max_length
}
