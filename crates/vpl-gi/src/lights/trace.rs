//! Where virtual point lights come from: light paths, or a cloud of photons.

use core::ops::ControlFlow;

use qmc_sampling::Sampler;
use scene_core::{
    EmissionSample, Emitter, EmitterChoice, EmitterId, RussianRoulette, Scene, Spectrum, TransportMode, Vertex,
    WalkStart, WalkVertex, random_walk,
};

use super::{LightKind, VirtualPointLight, VirtualPointLights};

/// How light paths are traced.
///
/// ```text
/// start:   emitter with probability q, point and direction with densities p_A, p_w,  flux = L_e |cos| / (q p_A p_w)
/// vertex:  flux *= f |cos| / p, over the probability of survival
/// ```
/// The walk is `scene-core`'s [`random_walk`]: photons and virtual point lights have the same vertices.
///
/// **Unbiased** up to `max_length`. **Cost.** One closest hit per segment. **Source.** Kollig and Keller 2004, section 2, step 1; Keller, "Instant
/// Radiosity", 1997.
#[derive(Clone, Copy, Debug)]
pub struct LightTracing<C> {
    /// Chooses the emitter.
    pub choice: C,
    /// Largest number of segments of a light path: 0 keeps the emission points alone.
    pub max_length: u32,
    /// How walks end by chance. With [`RussianRoulette::LocalAlbedo`] the flux of diffuse walks stays about constant, so that all
    /// lights are about equally bright.
    pub roulette: RussianRoulette,
}

/// The start of a light path.
pub(crate) struct Start<S> {
    pub(crate) emitter: EmitterId,
    pub(crate) probability: f32,
    pub(crate) emission: EmissionSample<S>,
}

impl<C: EmitterChoice> LightTracing<C> {
    /// Five numbers choose an emitter, a point on it and a direction.
    pub(crate) fn emit<S: Scene>(&self, scene: &S, sampler: &mut impl Sampler) -> Option<Start<S::Spectrum>> {
        let choose = sampler.next_1d();
        let (u_position, u_direction) = (sampler.next_2d(), sampler.next_2d());
        let chosen = self.choice.choose(None, choose)?;
        let emission = scene.emitters()[chosen.id.index()].sample_emission(u_position, u_direction)?;
        Some(Start { emitter: chosen.id, probability: chosen.probability, emission })
    }

    /// Follows a light path and shows its vertices.
    pub(crate) fn follow<'s, S: Scene>(
        &self,
        scene: &'s S,
        start: &Start<S::Spectrum>,
        sampler: &mut impl Sampler,
        visit: impl FnMut(WalkVertex<'_, S::Vertex<'s>, S::Spectrum>) -> ControlFlow<()>,
    ) {
        let emission = &start.emission;
        let walk = WalkStart {
            ray: emission.point.ray_along(emission.direction),
            throughput: emission.flux * (1.0 / start.probability),
            mode: TransportMode::Importance,
            max_length: self.max_length,
            roulette: self.roulette,
        };
        random_walk(scene, walk, sampler, visit);
    }
}

/// The virtual point light where a light path starts, of `paths`.
pub(crate) fn light_of_start<'s, S: Scene>(
    scene: &'s S,
    start: &Start<S::Spectrum>,
    paths: u32,
) -> VirtualPointLight<S::Vertex<'s>> {
    let (emitter, emission) = (start.emitter, &start.emission);
    let source = &scene.emitters()[emitter.index()];
    let (kind, pdf) = if source.is_delta() {
        (LightKind::Delta { emitter }, 1.0)
    } else if source.is_infinite() {
        (LightKind::Distant { emitter, towards: -emission.direction }, emission.pdf_solid_angle)
    } else {
        (LightKind::Emission { emitter, point: emission.point }, emission.pdf_area)
    };
    let scale = S::Spectrum::splat(1.0 / (start.probability * pdf * paths as f32));
    VirtualPointLight::start(kind, scale)
}

/// The virtual point light at a vertex of a walk, of `paths`.
pub(crate) fn light_of_vertex<V: Vertex>(walk: &WalkVertex<'_, V, V::Spectrum>, paths: u32) -> VirtualPointLight<V> {
    VirtualPointLight {
        kind: LightKind::Surface(walk.vertex.clone()),
        scale: walk.throughput * (1.0 / paths as f32),
        length: walk.length,
        pdf_solid_angle: walk.pdf_solid_angle,
        after_specular: walk.after_specular,
        is_last_chance: false,
    }
}

impl<V: Vertex> VirtualPointLights<V> {
    /// Traces `paths` light paths, one per sampler that `sampler(path)` returns: random numbers, or the points of a quasi-Monte
    /// Carlo sequence.
    ///
    /// Emission points are lights, and all vertices that connections can reach. Dirac emitters are not sampled if there are at most
    /// `paths` of them: each is one light with its full intensity; if there are more, those that were chosen are, with as many
    /// light paths as started there.
    pub fn trace<'s, S, C, R>(
        scene: &'s S,
        tracing: &LightTracing<C>,
        paths: u32,
        sampler: impl FnMut(u32) -> R,
    ) -> Self
    where
        S: Scene<Spectrum = V::Spectrum, Vertex<'s> = V>,
        C: EmitterChoice,
        R: Sampler,
    {
        let mut lights = Self::new(paths);
        lights.retrace(scene, tracing, paths, sampler);
        lights
    }

    /// [`trace`](Self::trace) in place of what is there, whose memory is used again.
    pub fn retrace<'s, S, C, R>(
        &mut self,
        scene: &'s S,
        tracing: &LightTracing<C>,
        paths: u32,
        mut sampler: impl FnMut(u32) -> R,
    ) where
        S: Scene<Spectrum = V::Spectrum, Vertex<'s> = V>,
        C: EmitterChoice,
        R: Sampler,
    {
        let lights = self;
        lights.clear(paths);
        let mut deltas = DeltaStarts::new(scene, paths);
        for path in 0..paths {
            let mut sampler = sampler(path);
            let Some(start) = tracing.emit(scene, &mut sampler) else { continue };
            let light = light_of_start(scene, &start, paths);
            let mut edges = Edges::new(matches!(light.kind, LightKind::Delta { .. }));
            match light.kind {
                LightKind::Delta { emitter } => deltas.add(emitter, start.probability),
                _ => lights.push(scene, light),
            }
            tracing.follow(scene, &start, &mut sampler, |walk| {
                let is_last_chance = edges.step(walk.length, walk.after_specular);
                if walk.vertex.is_connectible() {
                    lights.push(scene, VirtualPointLight { is_last_chance, ..light_of_vertex(&walk, paths) });
                }
                ControlFlow::Continue(())
            });
        }
        for (emitter, weight) in deltas.finish() {
            let scale = V::Spectrum::splat(weight);
            let kind = LightKind::Delta { emitter };
            lights.push(scene, VirtualPointLight::start(kind, scale));
        }
    }
}

/// Looks along a light path from a Dirac emitter for a segment that a connection could replace.
pub(crate) struct Edges {
    from_delta: bool,
    found: bool,
    /// Whether the vertex before the last scattered without a Dirac delta.
    smooth_before: bool,
}

impl Edges {
    pub(crate) fn new(from_delta: bool) -> Self {
        Self { from_delta, found: false, smooth_before: false }
    }

    /// At vertex number `length`; whether it is the last chance to connect.
    pub(crate) fn step(&mut self, length: u32, after_specular: bool) -> bool {
        // A Dirac emitter itself can be connected to.
        let smooth = length == 1 || !after_specular;
        self.found |= self.smooth_before && smooth;
        self.smooth_before = smooth;
        self.from_delta && !self.found && !smooth
    }
}

/// Puts a start at a Dirac emitter together with the others that started there; `weights` is sorted by emitter.
pub(crate) fn add_start(weights: &mut Vec<(EmitterId, f32)>, emitter: EmitterId, weight: f32) {
    match weights.binary_search_by_key(&emitter, |(id, _)| *id) {
        Ok(index) => weights[index].1 += weight,
        Err(index) => weights.insert(index, (emitter, weight)),
    }
}

/// Starts at Dirac emitters, put together.
struct DeltaStarts {
    /// Emitter and weight, sorted by emitter.
    weights: Vec<(EmitterId, f32)>,
    each_once: bool,
    paths: u32,
}

impl DeltaStarts {
    fn new<S: Scene>(scene: &S, paths: u32) -> Self {
        let ids = scene.emitters().iter().enumerate().filter(|(_, emitter)| emitter.is_delta());
        let ids: Vec<_> = ids.map(|(index, _)| (EmitterId(index as u32), 1.0)).take(paths as usize + 1).collect();
        let each_once = ids.len() <= paths as usize;
        Self { weights: if each_once { ids } else { Vec::new() }, each_once, paths }
    }

    fn add(&mut self, emitter: EmitterId, probability: f32) {
        if self.each_once {
            return;
        }
        add_start(&mut self.weights, emitter, 1.0 / (probability * self.paths as f32));
    }

    fn finish(self) -> Vec<(EmitterId, f32)> {
        self.weights
    }
}

/// Virtual point lights from a cloud of photons: each `(vertex, flux, length)`, where the flux is that of one light path, not
/// divided by their number, and `length` counts the segments of its light path. `starts` light paths are traced anew for the
/// emission points, which photon maps do not store.
///
/// What photons do not tell is taken for not so: [`VirtualPointLight::is_last_chance`] is false, hence some of the light that
/// point lights send by mirrors alone is lost where the partition is not infinite.
///
/// A sparse cloud is made by keeping each photon with a probability, and dividing its flux by it.
///
/// **Source.** Kollig and Keller 2004, section 2: "a very sparse global photon map".
pub fn photon_cloud<'s, S, C, R>(
    scene: &'s S,
    tracing: &LightTracing<C>,
    paths: u32,
    photons: impl IntoIterator<Item = (S::Vertex<'s>, S::Spectrum, u32)>,
    starts: u32,
    sampler: impl FnMut(u32) -> R,
) -> VirtualPointLights<S::Vertex<'s>>
where
    S: Scene,
    C: EmitterChoice + Clone,
    R: Sampler,
{
    let emission_alone = LightTracing { choice: tracing.choice.clone(), max_length: 0, roulette: tracing.roulette };
    let mut lights = VirtualPointLights::trace(scene, &emission_alone, starts, sampler);
    for (vertex, flux, length) in photons {
        if vertex.is_connectible() {
            let (kind, scale) = (LightKind::Surface(vertex), flux * (1.0 / paths as f32));
            lights.push(scene, VirtualPointLight { length, ..VirtualPointLight::start(kind, scale) });
        }
    }
    lights.paths = paths;
    lights
}
