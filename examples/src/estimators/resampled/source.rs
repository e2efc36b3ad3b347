//! Where candidates for light come from.

use core::f32::consts::FRAC_1_PI;

use clap::ValueEnum;
use qmc_sampling::warp::sample_uniform_sphere;
use ris::{Proposal, Source, Uniform};
use scene_core::{DirectSample, Emitter, EmitterChoice, EmitterId, Scene, Spectrum, TransportMode, Vertex};

use super::LightCandidate;

/// How directions to the environment are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum EnvironmentSampling {
    /// Uniformly over the sphere of directions.
    Uniform,
    /// In proportion to the radiance.
    #[default]
    Importance,
}

/// Shares of the sources among the candidates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SourceMix {
    /// Emitters as they are chosen, the environment among them.
    lights: f32,
    /// The environment alone.
    environment: f32,
    /// Directions of the scattering function, traced.
    scattering: f32,
}

impl SourceMix {
    /// Emitters alone.
    pub const LIGHTS: Self = Self { lights: 1.0, environment: 0.0, scattering: 0.0 };

    /// In proportion to these numbers; `None` if one is negative or not finite, or if there are no lights (nothing else finds Dirac
    /// emitters, or all the others).
    pub fn new(lights: f32, environment: f32, scattering: f32) -> Option<Self> {
        let sum = lights + environment + scattering;
        let share = |part: f32| part / sum;
        let is_usable = share(lights) > 0.0 && environment >= 0.0 && scattering >= 0.0 && sum.is_finite();
        is_usable.then(|| Self {
            lights: share(lights),
            environment: share(environment),
            scattering: share(scattering),
        })
    }

    /// The same without the environment, which a scene does not have.
    fn without_environment(self) -> Self {
        let rest = self.lights + self.scattering;
        Self { lights: self.lights / rest, environment: 0.0, scattering: self.scattering / rest }
    }

    /// The same without scattering.
    #[must_use]
    pub fn without_scattering(self) -> Self {
        let rest = self.lights + self.environment;
        Self { lights: self.lights / rest, environment: self.environment / rest, scattering: 0.0 }
    }
}

/// The source of candidates for one vertex: a mixture.
///
/// The density of a candidate is that of the whole mixture, whichever part drew it. The scattering part only draws what is visible, so
/// for occluded candidates the density is too large; they contribute nothing, so that does not matter here, but it would where the candidates
/// are reused for other vertices.
#[derive(Clone, Copy, Debug)]
pub struct LightSource<'a, S, V, C> {
    /// The scene.
    pub scene: &'a S,
    /// The vertex.
    pub vertex: &'a V,
    /// Chooses emitters.
    pub choice: &'a C,
    /// Shares of the parts.
    pub mix: SourceMix,
    /// How directions to the environment are drawn.
    pub environment: EnvironmentSampling,
    /// Whether the scattering function is evaluated for every candidate; otherwise only where it is asked for.
    pub evaluates: bool,
}

impl<S, V, C> LightSource<'_, S, V, C>
where
    S: Scene,
    V: Vertex<Spectrum = S::Spectrum>,
    C: EmitterChoice,
{
    #[inline]
    fn mix(&self) -> SourceMix {
        if self.mix.environment > 0.0 && self.scene.environment().is_none() {
            self.mix.without_environment()
        } else {
            self.mix
        }
    }

    /// A point on, or a direction to, an emitter.
    #[inline]
    fn sample_emitter(&self, id: EmitterId, u: [f32; 2]) -> Option<LightCandidate<S::Spectrum>> {
        if self.environment == EnvironmentSampling::Uniform && self.scene.environment() == Some(id) {
            return Some(self.sample_sphere(id, u));
        }
        let light = self.scene.emitters()[id.index()].sample_direct(self.vertex.point().position, u)?;
        Some(LightCandidate { emitter: id, light, is_seen: false, scattered: None })
    }

    /// A direction to the environment, uniform over the sphere. Its radiance is looked up only where the vertex scatters it: not for the half of the
    /// directions that are below an opaque surface.
    #[inline]
    fn sample_sphere(&self, id: EmitterId, u: [f32; 2]) -> LightCandidate<S::Spectrum> {
        let wi = sample_uniform_sphere(u).into();
        let scattered = self.evaluates.then(|| self.vertex.eval(wi, TransportMode::Radiance));
        let is_lost = scattered.is_some_and(|scattered| scattered.is_black());
        let radiance = if is_lost { S::Spectrum::ZERO } else { self.scene.environment_radiance(wi) };
        let light = DirectSample { wi, at: None, radiance, pdf_solid_angle: UNIFORM, is_delta: false };
        LightCandidate {
            emitter: id,
            light,
            is_seen: false,
            scattered: scattered.map(|scattered| scattered * radiance),
        }
    }

    /// What a scattered ray hits.
    #[inline]
    fn scatter(&self, u: [f32; 3]) -> Option<LightCandidate<S::Spectrum>> {
        let sample = self.vertex.sample(u, TransportMode::Radiance)?;
        if sample.is_specular {
            return None;
        }
        let (from, wi) = (self.vertex.point().position, sample.wi);
        let (emitter, at, radiance) = match self.scene.intersect(&self.vertex.spawn_ray(wi)) {
            Some(hit) => {
                let distance = (hit.point().position - from).length();
                (hit.emitter()?, Some((*hit.point(), distance)), hit.emitted())
            }
            None => (self.scene.environment()?, None, self.scene.environment_radiance(wi)),
        };
        if radiance.is_black() {
            return None;
        }
        let pdf_solid_angle = self.pdf_of_emitter(emitter, wi, at.as_ref().map(|(at, _)| at));
        let light = DirectSample { wi, at, radiance, pdf_solid_angle, is_delta: false };
        Some(LightCandidate { emitter, light, is_seen: true, scattered: None })
    }

    /// The density with which this source would have drawn a candidate of another one for the same vertex.
    pub fn density_of_other(&self, candidate: &LightCandidate<S::Spectrum>) -> f32 {
        let mut own = *candidate;
        if !own.light.is_delta {
            let at = own.light.at.as_ref().map(|(at, _)| at);
            own.light.pdf_solid_angle = self.pdf_of_emitter(own.emitter, own.light.wi, at);
        }
        self.density(&own)
    }

    /// Density by solid angle of `sample_emitter`.
    #[inline]
    fn pdf_of_emitter(&self, id: EmitterId, wi: glam::Vec3A, at: Option<&scene_core::SurfacePoint>) -> f32 {
        if self.environment == EnvironmentSampling::Uniform && self.scene.environment() == Some(id) {
            UNIFORM
        } else {
            self.scene.emitters()[id.index()].pdf_direct(self.vertex.point().position, wi, at)
        }
    }
}

/// Density of uniform directions.
const UNIFORM: f32 = 0.25 * FRAC_1_PI;

impl<S, V, C> Source<LightCandidate<S::Spectrum>, f32> for LightSource<'_, S, V, C>
where
    S: Scene,
    V: Vertex<Spectrum = S::Spectrum>,
    C: EmitterChoice,
{
    #[inline]
    fn propose(&self, uniform: &mut impl Uniform<f32>) -> Option<Proposal<LightCandidate<S::Spectrum>, f32>> {
        let mix = self.mix();
        // One number chooses the part and, stretched, the emitter.
        let choose = uniform.next_uniform();
        let u = [uniform.next_uniform(), uniform.next_uniform()];
        let candidate = if choose < mix.lights {
            let chosen = self.choice.choose(Some(self.vertex.point()), (choose / mix.lights).min(BELOW_ONE))?;
            self.sample_emitter(chosen.id, u)?
        } else if choose < mix.lights + mix.environment || mix.scattering == 0.0 {
            self.sample_emitter(self.scene.environment()?, u)?
        } else {
            let lobe = (choose - mix.lights - mix.environment) / mix.scattering;
            self.scatter([lobe.clamp(0.0, BELOW_ONE), u[0], u[1]])?
        };
        let density = self.density(&candidate);
        let sample = if self.evaluates { candidate.evaluated(self.vertex) } else { candidate };
        Some(Proposal { sample, density })
    }

    #[inline]
    fn density(&self, candidate: &LightCandidate<S::Spectrum>) -> f32 {
        let mix = self.mix();
        let LightCandidate { emitter, light, .. } = candidate;
        let mut density =
            mix.lights * self.choice.probability(Some(self.vertex.point()), *emitter) * light.pdf_solid_angle;
        if light.is_delta {
            return density;
        }
        if mix.environment > 0.0 && self.scene.environment() == Some(*emitter) {
            density += mix.environment * light.pdf_solid_angle;
        }
        if mix.scattering > 0.0 {
            density += mix.scattering * self.vertex.pdf_solid_angle(light.wi, TransportMode::Radiance);
        }
        density
    }
}

/// The largest number below one.
const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;
