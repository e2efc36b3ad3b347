//! Eye paths that ask for photons.

use photon_map::Scratch;
use qmc_sampling::Sampler;
use scene_core::{Ray, RussianRoulette, ScatterSample, Scene, Spectrum, SurfacePoint, TransportMode, Vertex};

use vpl_gi::{Found, Observer};

use super::{Maps, Sharpness};
use crate::estimators::{DirectLight, FirstHit, Scattered};

/// Eye paths that follow sharp bounces, and at every vertex ask for light that is scattered less sharply: directly from
/// the emitters, and from photons.
///
/// ```text
/// L = sum over vertices k of beta_k ( L_e + direct light + caustic photons + indirect light )
/// beta_(k+1) = beta_k f cos / (p q)   by sharp bounces
/// indirect light = global photons at x_k,   or with final gathering   1/M sum over rays of f cos / p (photons at y)
/// ```
/// **Symbols.** `beta`: throughput; `y`: what a gather ray hits. At `y` photons of both maps count, primary ones
/// included, but not in directions that make them caustics at `x`.
///
/// Both kinds of light of a vertex partition the directions: [`Sharpness`] says which ones the path follows. So nothing
/// is lost or counted twice on surfaces that are a bit of both.
///
/// **Biased** by density estimation alone: the maps blur what arrives within their radius (`1/2 mu_2 r^2` times the
/// Laplacian), lose light at edges of surfaces, where a part of the disk has no photons, and leak a little around
/// corners. Final gathering sees this bias averaged over its rays, direct visualisation as it is. With radius zero and
/// infinitely many photons it is path tracing.
///
/// **Cost.** Per vertex what direct light takes and a query per map; `M` rays and two queries each with final
/// gathering.
///
/// **Source.** Jensen, *Realistic Image Synthesis Using Photon Mapping*, 2001; the partition by direction is ours.
#[derive(Clone, Copy, Debug)]
pub struct PhotonEye<D> {
    /// Finds emitters.
    pub direct: D,
    /// Rays of final gathering; 0 looks at the global map directly.
    pub gather: u32,
    /// Which bounces are followed.
    pub sharpness: Sharpness,
    /// Segments of a whole path.
    pub max_depth: u32,
    /// How eye paths end by chance.
    pub roulette: RussianRoulette,
}

/// Numbers of the first gather ray; those of the others, and of later vertices, follow.
const GATHER_DOMAIN: u32 = 0x6761_0000;

impl<D: DirectLight> PhotonEye<D> {
    /// An estimate of the radiance that arrives along `ray`, and what the ray hit first; `observer` looks on.
    ///
    /// Density estimates at vertices of the eye path are [`Found::Photons`]; what gather rays find, photons at their ends among them, is
    /// [`Found::Connections`].
    pub fn trace<'s, S: Scene, O: Observer<S::Vertex<'s>>>(
        &self,
        scene: &'s S,
        maps: &Maps,
        scratch: &mut Scratch,
        mut ray: Ray,
        sampler: &mut impl Sampler,
        observer: &mut O,
    ) -> (S::Spectrum, Option<FirstHit>) {
        let mut radiance = S::Spectrum::ZERO;
        let mut throughput = S::Spectrum::splat(1.0);
        let (mut eta, mut first_hit, mut last) = (1.0, None, None);
        for length in 1..=self.max_depth {
            let vertex = scene.intersect(&ray);
            let emission = self.direct.emission(scene, &ray, vertex.as_ref(), scattered(&last), throughput);
            if let Some(vertex) = &vertex {
                observer.vertex(length, vertex, throughput);
            }
            observer.contribution(length, Found::Hit, emission);
            radiance += emission;
            let Some(vertex) = vertex else { break };
            if length == 1 {
                first_hit = Some(FirstHit::new(&ray, &vertex));
            }
            if length == self.max_depth {
                break;
            }

            // Light that is not scattered sharply.
            let connects = vertex.is_connectible();
            let direct = self.direct.sample(scene, &vertex, length, connects, sampler);
            if connects {
                let photons = throughput * self.photons(maps, scratch, &vertex, length);
                observer.contribution(length, Found::Photons, photons);
                let gathered = self.gathered(scene, maps, scratch, &vertex, length, sampler);
                let others = throughput * (direct + gathered);
                observer.contribution(length, Found::Connections, others);
                radiance += photons + others;
            }

            // Scatter. With final gathering there may be nothing to follow.
            let (lobe, [u, v]) = (sampler.next_1d(), sampler.next_2d());
            if self.gather > 0 && vertex.lambertian().is_some() {
                break;
            }
            let Some(sample) = vertex.sample([lobe, u, v], TransportMode::Radiance) else { break };
            let from = origin(&vertex, &sample);
            if !self.sharpness.is_followed(&vertex, &sample) {
                // Its share of direct light, unless gather rays have it.
                if self.gather == 0 {
                    let ray = vertex.spawn_ray(sample.wi);
                    let hit = scene.intersect(&ray);
                    let throughput = throughput * sample.throughput;
                    let emission = self.direct.emission(scene, &ray, hit.as_ref(), scattered(&from), throughput);
                    observer.contribution(length + 1, Found::Hit, emission);
                    radiance += emission;
                }
                break;
            }
            throughput *= sample.throughput;
            eta *= sample.eta;

            // Survive.
            let survival = self.roulette.survival_probability(length, sample.throughput, throughput, eta);
            if survival < 1.0 {
                if sampler.next_1d() >= survival {
                    break;
                }
                throughput *= S::Spectrum::splat(1.0 / survival);
            }
            observer.scattered(length, &vertex, &sample);
            last = from;
            ray = vertex.spawn_ray(sample.wi);
        }
        (radiance, first_hit)
    }

    /// What photons contribute at a vertex of this length: caustics, and all else unless it is gathered.
    fn photons<V: Vertex>(&self, maps: &Maps, scratch: &mut Scratch, vertex: &V, length: u32) -> V::Spectrum {
        // The lengths of both paths add up.
        let longest = self.longest(length);
        let counts = |wi| !self.sharpness.is_left_to_eye_path(vertex, wi);
        let caustics = match &maps.caustic {
            Some(caustic) => caustic.radiance(vertex, longest, scratch, counts),
            None => V::Spectrum::ZERO,
        };
        if self.gather > 0 {
            return caustics;
        }
        caustics + maps.global.radiance(vertex, longest, scratch, counts)
    }

    /// What final gathering finds at a vertex of this length.
    fn gathered<S: Scene>(
        &self,
        scene: &S,
        maps: &Maps,
        scratch: &mut Scratch,
        vertex: &S::Vertex<'_>,
        length: u32,
        sampler: &impl Sampler,
    ) -> S::Spectrum {
        let mut sum = S::Spectrum::ZERO;
        if self.gather == 0 {
            return sum;
        }
        for ray in 0..self.gather {
            let domain = GATHER_DOMAIN.wrapping_add(length.wrapping_mul(self.gather)).wrapping_add(ray);
            sum += self.gather_ray(scene, maps, scratch, vertex, length, &mut sampler.fork(domain));
        }
        sum * (1.0 / self.gather as f32)
    }

    /// One ray of final gathering.
    fn gather_ray<S: Scene>(
        &self,
        scene: &S,
        maps: &Maps,
        scratch: &mut Scratch,
        vertex: &S::Vertex<'_>,
        length: u32,
        sampler: &mut impl Sampler,
    ) -> S::Spectrum {
        let dark = S::Spectrum::ZERO;
        let (lobe, [u, v]) = (sampler.next_1d(), sampler.next_2d());
        let Some(sample) = vertex.sample([lobe, u, v], TransportMode::Radiance) else { return dark };
        if self.sharpness.is_followed(vertex, &sample) {
            return dark;
        }
        let ray = vertex.spawn_ray(sample.wi);
        let hit = scene.intersect(&ray);
        let (from, all) = (origin(vertex, &sample), S::Spectrum::splat(1.0));
        let mut arriving = self.direct.emission(scene, &ray, hit.as_ref(), scattered(&from), all);
        if let Some(y) = hit.filter(|y| y.is_connectible() && length + 1 < self.max_depth) {
            let longest = self.longest(length + 1);
            let counts = |wi| !self.sharpness.is_left_to_caustics(&y, wi);
            for map in core::iter::once(&maps.global).chain(&maps.caustic) {
                arriving += map.radiance(&y, longest, scratch, counts);
            }
        }
        sample.throughput * arriving
    }

    /// Longest light paths that count at an eye vertex of this length.
    fn longest(&self, length: u32) -> u32 {
        if self.max_depth == u32::MAX { u32::MAX } else { self.max_depth - length }
    }
}

/// From where emitters could have been found, too.
fn origin<V: Vertex>(vertex: &V, sample: &ScatterSample<V::Spectrum>) -> Option<(SurfacePoint, f32)> {
    (!sample.is_specular).then(|| (*vertex.point(), sample.pdf_solid_angle))
}

fn scattered(from: &Option<(SurfacePoint, f32)>) -> Option<Scattered<'_>> {
    from.as_ref().map(|(point, pdf)| Scattered { point, pdf_solid_angle: *pdf })
}
