//! Robust instant global illumination.

use glam::Vec3A;
use qmc_sampling::Sampler;
use scene_core::{
    Ray, RussianRoulette, ScatterSample, Scene, Sharpness, Spectrum, SurfacePoint, TransportMode, Vertex,
};

use crate::caustics::CausticMap;
use crate::lights::{VirtualPointLights, geometry_term};
use crate::observer::{Found, Observer};
use crate::partition::{Partition, peak};
use crate::shading::Connections;
use crate::shadow_rays::{Shading, ShadowRays};

/// What becomes of the part of an edge that connections do not take.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Residual {
    /// A scattered ray takes it: unbiased.
    #[default]
    Scatter,
    /// It is dropped: instant radiosity as it is usually done, too dark in corners. Biased, for comparison.
    Drop,
}

/// Final gathering: at the first vertex that is not specular, connections find direct light alone, and `rays` scattered rays
/// the rest; from their next vertices on everything is as usual. Unbiased.
///
/// Source: Kollig and Keller 2004, section 4 ("the scattering step 2.b could be considered as a secondary final gather").
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FinalGathering {
    /// Number of rays; one at least.
    pub rays: u32,
}

/// Robust instant global illumination: virtual point lights where the geometry term is small, scattered rays where it is not.
///
/// ```text
/// a. connect:  L += left_k beta_k  sum over lights j of  s(x_k, y_j) f G V I_j
/// b. scatter:  x_(k+1) along w with density p,  beta_(k+1) = beta_k f |cos| / (p q),  left_(k+1) = left_k (1 - s(x_k, x_(k+1)))
///    emission: L += left_k beta_k L_e(x_k)
///    end:      if nothing is left
/// ```
/// **Symbols.** `x_1`: what the camera sees; `beta`: throughput of the eye path; `s`: share of connections, a [`Partition`] (with the hard
/// one, Kollig and Keller's: 1 where `G < t`); `left`: product of `1 - s`; `I_j`: intensity of light `y_j` over its density and the number of
/// light paths; `q`: probability to survive Russian roulette. `L` in W/(m^2 sr).
///
/// **Assumptions.** A technique that cannot generate a path takes no share of it: edges from or to a Dirac delta go to the
/// scattered ray, whatever their geometry term. To that end each component of a scattering function counts by itself: a coated
/// surface is connected by its diffuse part and scattered by its coat. Dirac emitters, which no ray hits, are always connected, and
/// so are light vertices which they reach by mirrors and glass alone ([`VirtualPointLight::is_last_chance`](crate::VirtualPointLight::is_last_chance));
/// light from infinity has `G = 0` and is connected for any `t > 0`.
///
/// **Unbiased** up to `max_depth`, for every partition, with [`Residual::Scatter`] and without a [`CausticMap`], if light paths may have `max_depth - 2`
/// segments; except for light of Dirac emitters that the camera sees by specular surfaces next to diffuse ones alone (the caustic of a point
/// light in a mirror, seen directly), which no technique generates. Threshold 0 is path tracing without next event
/// estimation, infinity instant radiosity.
///
/// **Cost.** Per eye vertex one shading loop over the lights and their shadow rays. Scattered rays end at `sqrt(|cos| / t)` where
/// [`Partition::reach`] bounds them: in scenes without specular surfaces, or with a caustic map; and without glossy ones, too, if [`peaks`](Self::peaks) count.
///
/// **Source.** Kollig and Keller 2004, sections 2 and 3.2. The weight of the technique with `i` light vertices and `l` segments is
/// `w(l,i) = s(x_(l-i), x_(l-i+1)) prod_(k<l-i) (1 - s(x_k, x_(k+1)))`, `k` from 1, and `w(l,0) = prod_(k<l) (1 - s)`, which the print
/// leaves out. "Attenuated by the colour of the BSDF" means the factor `f |cos| / p`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RobustIgi {
    /// What connections take.
    pub partition: Partition,
    /// What becomes of the rest.
    pub residual: Residual,
    /// Segments of a path, eye and light path and the connection together; `u32::MAX` is unlimited.
    pub max_depth: u32,
    /// How eye paths end by chance.
    pub roulette: RussianRoulette,
    /// Which shadow rays are traced.
    pub shadow_rays: ShadowRays,
    /// Final gathering, if wanted.
    pub gathering: Option<FinalGathering>,
    /// Whether the peaks of scattering functions count as if they were part of the geometry term:
    /// ```text
    /// s(x_k, x_(k+1)) of  G a b,    a = max(1, pi p(x_k -> x_(k+1)) / |cos_k|),    b = max(1, pi p*(x_(k+1) -> x_k) / |cos_(k+1)|)
    /// ```
    /// with the densities `p` and `p*` of scattering on eye and light paths, and cosines with shading normals. Kollig and Keller 2004 looks at `G` alone, which
    /// bounds contributions if surfaces are diffuse (`a = b = 1` then). Where they are glossy, a light that lies in the
    /// direction of a mirror is as bright as one that is too close.
    pub peaks: bool,
}

impl RobustIgi {
    /// Unlimited paths, every shadow ray, Russian roulette from the fifth segment on.
    pub const fn new(partition: Partition) -> Self {
        Self {
            partition,
            residual: Residual::Scatter,
            max_depth: u32::MAX,
            roulette: RussianRoulette::PathThroughput { from_length: 4 },
            shadow_rays: ShadowRays::All,
            gathering: None,
            peaks: true,
        }
    }

    /// An estimate of the radiance that arrives along `ray`.
    pub fn radiance<S, V>(
        &self,
        scene: &S,
        lights: &VirtualPointLights<V>,
        ray: Ray,
        sampler: &mut impl Sampler,
    ) -> S::Spectrum
    where
        S: Scene,
        V: Vertex<Spectrum = S::Spectrum>,
    {
        self.trace(scene, lights, None, ray, sampler, &mut ())
    }

    /// [`radiance`](Self::radiance) with a caustic map, and somebody who looks on.
    ///
    /// With a map, scattered rays look for no caustics: specular surfaces that they hit end the path. (The map's contribution does not
    /// know `max_depth`.)
    pub fn trace<'s, S, V, O>(
        &self,
        scene: &'s S,
        lights: &VirtualPointLights<V>,
        caustics: Option<&dyn CausticMap<S::Vertex<'s>>>,
        ray: Ray,
        sampler: &mut impl Sampler,
        observer: &mut O,
    ) -> S::Spectrum
    where
        S: Scene,
        V: Vertex<Spectrum = S::Spectrum>,
        O: Observer<S::Vertex<'s>>,
    {
        // With a caustic map nothing specular is looked for.
        let sharpness = if caustics.is_some() { scene.sharpness().min(Sharpness::Glossy) } else { scene.sharpness() };
        let rays_may_end = match sharpness {
            Sharpness::Diffuse => true,
            Sharpness::Glossy => !self.peaks,
            Sharpness::Specular => false,
        };
        let walk = Walk { settings: self, scene, lights, caustics, rays_may_end };
        let start = EyeRay {
            ray,
            throughput: S::Spectrum::splat(1.0),
            eta: 1.0,
            length: 1,
            left: 1.0,
            edge: None,
            gathers: self.gathering.is_some(),
        };
        walk.follow(start, sampler, observer)
    }
}

/// Everything that stays the same along an eye path.
struct Walk<'a, 's, S: Scene, V: Vertex> {
    settings: &'a RobustIgi,
    scene: &'s S,
    lights: &'a VirtualPointLights<V>,
    caustics: Option<&'a dyn CausticMap<S::Vertex<'s>>>,
    /// Whether scattered rays are not needed beyond the partition's reach.
    rays_may_end: bool,
}

/// An eye path on its way to its next vertex.
struct EyeRay<S> {
    ray: Ray,
    throughput: S,
    eta: f32,
    /// Number of the next vertex.
    length: u32,
    /// Product of `1 - s` over the edges before this one.
    left: f32,
    /// Where it comes from, if a connection could have been made there.
    edge: Option<Edge>,
    /// Whether final gathering is still to come.
    gathers: bool,
}

struct Edge {
    from: SurfacePoint,
    /// How much `from` peaks towards the next vertex.
    peak: f32,
    /// Whether connections at `from` were made to emission points only.
    gathered: bool,
}

/// What is left at a vertex, by what the path does there.
#[derive(Clone, Copy)]
struct Left {
    /// The path ends: the vertex emits.
    emission: f32,
    /// It is connected or scatters without a Dirac delta, in a direction without a peak.
    smooth: f32,
    /// It scatters by a Dirac delta.
    specular: f32,
    /// If peaks count and the vertex is not diffuse: what the edge is, so that more is left in directions of a peak.
    term: Option<Term>,
    /// One over the number of paths that go on from here.
    part: f32,
}

/// An edge whose share depends on where the path goes on.
#[derive(Clone, Copy)]
struct Term {
    /// Product of `1 - s` over the edges before.
    before: f32,
    /// Geometry term, times the peak at the vertex before.
    g: f32,
    d2: f32,
}

impl Left {
    /// Whether anything may be left for a direction without a Dirac delta.
    fn is_any_smooth(&self) -> bool {
        self.smooth > 0.0 || self.term.is_some_and(|term| term.before > 0.0)
    }
}

impl<'s, S, V> Walk<'_, 's, S, V>
where
    S: Scene,
    V: Vertex<Spectrum = S::Spectrum>,
{
    fn follow<R: Sampler, O: Observer<S::Vertex<'s>>>(
        &self,
        mut eye: EyeRay<S::Spectrum>,
        sampler: &mut R,
        observer: &mut O,
    ) -> S::Spectrum {
        let mut radiance = S::Spectrum::ZERO;
        loop {
            let Some(vertex) = self.scene.intersect(&eye.ray) else {
                let left = self.left_at_infinity(&eye);
                if left > 0.0 && self.scene.environment().is_some() {
                    let value = eye.throughput * self.scene.environment_radiance(eye.ray.direction) * left;
                    observer.contribution(eye.length, Found::Hit, value);
                    radiance += value;
                }
                return radiance;
            };
            observer.vertex(eye.length, &vertex, eye.throughput);
            let left = self.left_at(&eye, &vertex);

            // Emission, on direct hits.
            if left.emission > 0.0 && vertex.emitter().is_some() {
                let value = eye.throughput * vertex.emitted() * left.emission;
                if !value.is_black() {
                    observer.contribution(eye.length, Found::Hit, value);
                    radiance += value;
                }
            }
            if eye.length >= self.settings.max_depth {
                return radiance;
            }

            // 2a: connect.
            let gathers = eye.gathers && vertex.is_connectible();
            if left.is_any_smooth() && vertex.is_connectible() {
                let value = eye.throughput * self.connect(&vertex, &left, eye.length, gathers, sampler);
                observer.contribution(eye.length, Found::Connections, value);
                radiance += value;
                if let Some(caustics) = self.caustics {
                    let value = eye.throughput * caustics.radiance(&vertex) * left.smooth;
                    observer.contribution(eye.length, Found::Photons, value);
                    radiance += value;
                }
            }

            // 2b: scatter.
            if !left.is_any_smooth() && left.specular <= 0.0 {
                return radiance;
            }
            if gathers {
                return radiance + self.gather(&eye, &vertex, &left, sampler, observer);
            }
            match self.scatter(&eye, &vertex, &left, false, sampler, observer) {
                Some(next) => eye = next,
                None => return radiance,
            }
        }
    }

    /// Shares of the edge that the eye path came along.
    fn left_at(&self, eye: &EyeRay<S::Spectrum>, vertex: &S::Vertex<'s>) -> Left {
        let Some(edge) = &eye.edge else {
            return Left { emission: eye.left, smooth: eye.left, specular: eye.left, term: None, part: 1.0 };
        };
        let at = vertex.point();
        let g = edge.peak * geometry_term(edge.from.position, edge.from.normal, at.position, at.normal);
        let d2 = edge.from.position.distance_squared(at.position);
        let rest = match self.settings.residual {
            Residual::Scatter => eye.left * (1.0 - self.settings.partition.share(g, d2)),
            Residual::Drop => 0.0,
        };
        let depends = self.settings.peaks && self.settings.residual == Residual::Scatter && !edge.gathered;
        let term = (depends && vertex.lambertian().is_none()).then_some(Term { before: eye.left, g, d2 });
        Left {
            emission: rest,
            smooth: if edge.gathered { eye.left } else { rest },
            specular: if self.caustics.is_some() { 0.0 } else { eye.left },
            term,
            part: 1.0,
        }
    }

    /// What is left for going on from `vertex` in the direction `wi`, without a Dirac delta. The light path that would have come
    /// that way has a peak at `vertex`, too.
    fn left_towards(&self, left: &Left, vertex: &S::Vertex<'s>, wi: Vec3A) -> f32 {
        let Some(term) = left.term else { return left.smooth };
        let pdf = vertex.reversed(wi).pdf_solid_angle(vertex.wo(), TransportMode::Importance);
        let g = term.g * peak(pdf, vertex.shading_normal().dot(vertex.wo()));
        term.before * (1.0 - self.settings.partition.share(g, term.d2))
    }

    fn left_at_infinity(&self, eye: &EyeRay<S::Spectrum>) -> f32 {
        match (&eye.edge, self.settings.residual) {
            (None, _) => eye.left,
            (Some(_), Residual::Scatter) => eye.left * (1.0 - self.settings.partition.share_at_infinity()),
            (Some(_), Residual::Drop) => 0.0,
        }
    }

    /// What the virtual point lights contribute at eye vertex number `length`, before attenuation.
    fn connect(
        &self,
        vertex: &S::Vertex<'s>,
        left: &Left,
        length: u32,
        gathers: bool,
        sampler: &mut impl Sampler,
    ) -> S::Spectrum {
        let longest_last_chance = self.settings.max_depth - length - 1;
        let longest = if gathers { 0 } else { longest_last_chance };
        let (scene, lights, settings) = (self.scene, self.lights, self.settings);
        let towards = |wi: Vec3A| self.left_towards(left, vertex, wi);
        let connections = Connections {
            partition: &settings.partition,
            longest,
            longest_last_chance,
            mapped: self.caustics.is_some(),
            peaks: settings.peaks,
            left: left.term.is_some().then_some(&towards),
        };
        let shading = Shading { scene, x: vertex, lights, connections };
        let mut reflected = shading.radiance(settings.shadow_rays, sampler);
        if left.term.is_none() {
            reflected *= S::Spectrum::splat(left.smooth);
        }
        reflected
    }

    /// Goes on in several directions.
    fn gather<R: Sampler, O: Observer<S::Vertex<'s>>>(
        &self,
        eye: &EyeRay<S::Spectrum>,
        vertex: &S::Vertex<'s>,
        left: &Left,
        sampler: &mut R,
        observer: &mut O,
    ) -> S::Spectrum {
        let rays = self.settings.gathering.map_or(1, |gathering| gathering.rays.max(1));
        let left = Left { part: 1.0 / rays as f32, ..*left };
        let mut radiance = S::Spectrum::ZERO;
        for ray in 0..rays {
            let mut child = sampler.fork(GATHER_DOMAIN ^ ray);
            if let Some(next) = self.scatter(eye, vertex, &left, true, &mut child, observer) {
                radiance += self.follow(next, &mut child, observer);
            }
        }
        radiance
    }

    /// How much `vertex` peaks in the direction that was sampled, if that counts.
    fn peak_of(&self, vertex: &S::Vertex<'s>, sample: &ScatterSample<S::Spectrum>) -> f32 {
        if !self.settings.peaks || vertex.lambertian().is_some() {
            return 1.0;
        }
        peak(sample.pdf_solid_angle, vertex.shading_normal().dot(sample.wi))
    }

    /// The way to the next vertex; nothing if the path ends here.
    fn scatter<O: Observer<S::Vertex<'s>>>(
        &self,
        eye: &EyeRay<S::Spectrum>,
        vertex: &S::Vertex<'s>,
        left: &Left,
        gathered: bool,
        sampler: &mut impl Sampler,
        observer: &mut O,
    ) -> Option<EyeRay<S::Spectrum>> {
        let (lobe, [u, v]) = (sampler.next_1d(), sampler.next_2d());
        let sample = vertex.sample([lobe, u, v], TransportMode::Radiance)?;
        let mut throughput = eye.throughput * sample.throughput;
        let eta = eye.eta * sample.eta;
        let left =
            if sample.is_specular { left.specular } else { self.left_towards(left, vertex, sample.wi) } * left.part;
        if left <= 0.0 || throughput.is_black() {
            return None;
        }

        // Where the next vertex may lie.
        let mut ray = vertex.spawn_ray(sample.wi);
        let edge = (!sample.is_specular).then(|| Edge {
            from: *vertex.point(),
            peak: self.peak_of(vertex, &sample),
            gathered,
        });
        if let Some(edge) = &edge
            && self.rays_may_end
            && !gathered
        {
            let reach = match self.settings.residual {
                Residual::Scatter => self.settings.partition.reach(edge.from.normal.dot(sample.wi).abs()),
                Residual::Drop => 0.0,
            };
            if reach <= 0.0 {
                return None;
            }
            // The bound holds up to rounding, and the ray starts off the surface.
            ray = ray.up_to(reach * 1.0001 + 2.0 * edge.from.error);
        }

        // Survive.
        let survival = self.settings.roulette.survival_probability(eye.length, sample.throughput, throughput, eta);
        if survival < 1.0 {
            if sampler.next_1d() >= survival {
                return None;
            }
            throughput *= S::Spectrum::splat(1.0 / survival);
        }
        observer.scattered(eye.length, vertex, &sample);
        let gathers = eye.gathers && !gathered;
        Some(EyeRay { ray, throughput, eta, length: eye.length + 1, left, edge, gathers })
    }
}

/// Sub-streams of the rays of final gathering.
const GATHER_DOMAIN: u32 = 0x6761_7468;
