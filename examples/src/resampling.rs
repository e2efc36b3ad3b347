//! Resampled importance sampling by the names of the command line: of direct light, of directions, between pixels.

use std::ops::RangeInclusive;

use clap::{Args, ValueEnum};
use qmc_sampling::{Sampler, SamplerFamily};
use ris::{Budget, CostError};
use scene_core::{EmitterId, Ray, ScatterSample, Scene, Sharpness, SurfacePoint, Vertex};

use crate::choices::{AnyChoice, AnyHeuristic, LightSelection};
use crate::estimators::{
    DirectLight, Directions, EnvironmentSampling, LightAlone, NextEvent, OwnSampling, PhotonLights, ResampledDirect,
    ResampledScattering, RestirDirect, ScatterSampling, Scattered, ScatteringAlone, SourceMix, TargetName,
    VisibilityProbes, measure_cost,
};
use crate::values::{real, whole};

/// How a path finds direct light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum DirectName {
    /// Next event estimation, combined with scattering by the heuristic.
    #[default]
    Nee,
    /// Resampled importance sampling.
    Ris,
    /// By scattering alone: point lights are not found.
    Scattering,
}

/// How directions are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ScatteringName {
    /// Each material's own sampling.
    #[default]
    Own,
    /// Resampled from a distribution that knows no material: materials need only be evaluated.
    Ris,
}

/// Number of candidates per sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Candidates {
    /// So many.
    Count(f32),
    /// `T_Y / T_X`, measured: the image then depends on the machine.
    Robust,
}

/// Settings of resampling.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Resampling (direct, path, restir-direct, photon-map, sppm)")]
pub struct ResamplingSettings {
    /// How direct light is found; `--lights ris` is the same as `--direct ris`.
    #[arg(long, value_enum, default_value_t)]
    pub direct: DirectName,
    /// How directions are chosen. With `ris` direct light is left to `--direct`.
    #[arg(long, value_enum, default_value_t)]
    pub bsdf_sampling: ScatteringName,
    /// Candidates per sample of direct light, a number from 1 that need not be an integer; or `robust`, the ratio of costs, measured (the
    /// image then depends on the machine).
    #[arg(long, default_value = "16", value_parser = parse_candidates)]
    pub candidates: Candidates,
    /// Samples of direct light per vertex, each with its shadow ray (for samples per pixel see --spp); a number from 1 that need not be
    /// an integer. With --direct ris, and restir-direct.
    #[arg(long, default_value_t = 1.0, value_parser = real::<f32>(COUNTS, 1.0))]
    pub samples: f32,
    /// How the emitter of a candidate is chosen: `uniform` or `power`.
    #[arg(long, default_value = "power", value_parser = parse_candidate_lights)]
    pub candidate_lights: LightSelection,
    /// Shares of the candidates: emitters, the environment alone, what scattered rays hit (a ray each).
    #[arg(long, value_name = "LIGHTS,ENVIRONMENT,SCATTERING", default_value = "2,1,0", value_parser = parse_mix)]
    pub candidate_mix: SourceMix,
    /// How candidates of the environment are drawn.
    #[arg(long, value_enum, default_value_t)]
    pub environment_candidates: EnvironmentSampling,
    /// What candidates are selected by: scattering F, geometry G, emission L, visibility V.
    #[arg(long, value_enum, default_value_t)]
    pub target: TargetName,
    /// Candidates per direction with `--bsdf-sampling ris`.
    #[arg(long, default_value_t = 8.0, value_parser = real::<f32>(COUNTS, 8.0))]
    pub bsdf_candidates: f32,
    /// Rounds in which pixels take over samples of their neighbours, with `restir-direct`.
    #[arg(long, default_value_t = 3, value_parser = whole::<u32>(0..=8, 3))]
    pub reuse_rounds: u32,
    /// Neighbours per round.
    #[arg(long, default_value_t = 3, value_parser = whole::<u32>(1..=64, 3))]
    pub reuse_neighbours: u32,
    /// How far away neighbours may be, in pixels.
    #[arg(long, default_value_t = 10.0, value_parser = real::<f32>(COUNTS, 10.0))]
    pub reuse_radius: f32,
    /// Choose among the samples of neighbours without regard to visibility: no shadow ray for each of them, more noise where something occludes.
    #[arg(long)]
    pub reuse_unshadowed: bool,
}

impl Default for ResamplingSettings {
    fn default() -> Self {
        Self {
            direct: DirectName::Nee,
            bsdf_sampling: ScatteringName::Own,
            candidates: Candidates::Count(16.0),
            samples: 1.0,
            candidate_lights: LightSelection::Power,
            candidate_mix: SourceMix::new(2.0, 1.0, 0.0).expect("a mixture"),
            environment_candidates: EnvironmentSampling::Importance,
            target: TargetName::Unshadowed,
            bsdf_candidates: 8.0,
            reuse_rounds: 3,
            reuse_neighbours: 3,
            reuse_radius: 10.0,
            reuse_unshadowed: false,
        }
    }
}

impl ResamplingSettings {
    /// Whether paths are traced in the usual way, without any resampling.
    pub fn is_plain(&self) -> bool {
        self.direct == DirectName::Nee && self.bsdf_sampling == ScatteringName::Own
    }

    /// Probes for the target that guesses visibility.
    pub fn probes<S: Scene>(&self, scene: &S) -> Option<VisibilityProbes> {
        (self.target == TargetName::GuessedVisibility).then(|| VisibilityProbes::new(scene))
    }

    /// Resampled direct light. The robust number of candidates is measured here.
    ///
    /// # Errors
    /// If it cannot be measured.
    pub fn resampled<'a, S: Scene, F: SamplerFamily>(
        &self,
        scene: &S,
        samplers: &F,
        probes: Option<&'a VisibilityProbes>,
    ) -> Result<ResampledDirect<'a, AnyChoice>, CostError> {
        let mut direct = ResampledDirect {
            budget: Budget::new(1.0, self.samples.into()),
            choice: AnyChoice::new(self.candidate_lights, scene.emitters()),
            mix: self.candidate_mix,
            environment: self.environment_candidates,
            target: self.target,
            probes,
        };
        direct.budget = direct.budget.with_candidates(match self.candidates {
            Candidates::Count(count) => count.into(),
            Candidates::Robust => measure_cost(scene, samplers, &direct)?.robust().candidates(),
        });
        Ok(direct)
    }

    /// Reuse between pixels.
    pub fn restir<'a>(&self, direct: ResampledDirect<'a, AnyChoice>) -> RestirDirect<'a, AnyChoice> {
        let (rounds, neighbours, radius) = (self.reuse_rounds, self.reuse_neighbours, self.reuse_radius);
        RestirDirect { direct, rounds, neighbours, radius, tests_visibility: !self.reuse_unshadowed }
    }

    /// The way to find direct light.
    pub fn direct<'a>(
        &self,
        heuristic: AnyHeuristic,
        choice: AnyChoice,
        resampled: ResampledDirect<'a, AnyChoice>,
    ) -> AnyDirect<'a> {
        match (self.direct, self.bsdf_sampling) {
            (DirectName::Nee, ScatteringName::Own) => AnyDirect::NextEvent(NextEvent { heuristic, choice }),
            (DirectName::Nee, ScatteringName::Ris) => {
                AnyDirect::LightAlone(NextEvent { heuristic: LightAlone, choice })
            }
            (DirectName::Ris, _) => AnyDirect::Resampled(resampled),
            (DirectName::Scattering, _) => AnyDirect::Scattering(ScatteringAlone),
        }
    }

    /// The way to choose directions.
    pub fn scattering<S: Scene>(&self, scene: &S) -> AnyScattering {
        match self.bsdf_sampling {
            ScatteringName::Own => AnyScattering::Own(OwnSampling),
            ScatteringName::Ris => AnyScattering::Resampled(ResampledScattering {
                candidates: self.bsdf_candidates,
                directions: Directions::General,
                has_specular: scene.sharpness() == Sharpness::Specular,
            }),
        }
    }
}

/// Numbers of candidates and samples.
const COUNTS: RangeInclusive<f32> = 1.0..=1e6;

fn parse_candidate_lights(text: &str) -> Result<LightSelection, String> {
    match text {
        "uniform" => Ok(LightSelection::Uniform),
        "power" => Ok(LightSelection::Power),
        _ => Err("expected how to choose candidates: 'uniform' or 'power'".to_owned()),
    }
}

fn parse_candidates(text: &str) -> Result<Candidates, String> {
    match text {
        "robust" => Ok(Candidates::Robust),
        count => real(COUNTS, 16.0)(count).map(Candidates::Count).map_err(|error| format!("{error}, or `robust`")),
    }
}

fn parse_mix(text: &str) -> Result<SourceMix, String> {
    let parts: Vec<f32> = text.split(',').map(|part| part.trim().parse().unwrap_or(f32::NAN)).collect();
    let mix = match parts[..] {
        [lights, environment, scattering] => SourceMix::new(lights, environment, scattering),
        _ => None,
    };
    mix.ok_or_else(|| "expected three shares, the first one positive, as in 2,1,1".to_owned())
}

/// A way to find direct light, by name.
#[derive(Clone, Debug)]
pub enum AnyDirect<'a> {
    /// Next event estimation.
    NextEvent(NextEvent<AnyHeuristic, AnyChoice>),
    /// Next event estimation without a share for scattering.
    LightAlone(NextEvent<LightAlone, AnyChoice>),
    /// Resampling.
    Resampled(ResampledDirect<'a, AnyChoice>),
    /// Scattering alone.
    Scattering(ScatteringAlone),
    /// The lights whose photons arrived near by.
    Photons(&'a PhotonLights),
}

impl DirectLight for AnyDirect<'_> {
    #[inline]
    fn sample<S: Scene>(
        &self,
        scene: &S,
        vertex: &S::Vertex<'_>,
        length: u32,
        wanted: bool,
        sampler: &mut impl Sampler,
    ) -> S::Spectrum {
        match self {
            Self::NextEvent(direct) => direct.sample(scene, vertex, length, wanted, sampler),
            Self::LightAlone(direct) => direct.sample(scene, vertex, length, wanted, sampler),
            Self::Resampled(direct) => direct.sample(scene, vertex, length, wanted, sampler),
            Self::Scattering(direct) => direct.sample(scene, vertex, length, wanted, sampler),
            Self::Photons(direct) => direct.sample(scene, vertex, length, wanted, sampler),
        }
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
        match self {
            Self::NextEvent(direct) => direct.scattering_weight(scene, from, ray, id, at),
            Self::LightAlone(direct) => direct.scattering_weight(scene, from, ray, id, at),
            Self::Resampled(direct) => direct.scattering_weight(scene, from, ray, id, at),
            Self::Scattering(direct) => direct.scattering_weight(scene, from, ray, id, at),
            Self::Photons(direct) => direct.scattering_weight(scene, from, ray, id, at),
        }
    }
}

/// A way to choose directions, by name.
#[derive(Clone, Copy, Debug)]
pub enum AnyScattering {
    /// Each material's own.
    Own(OwnSampling),
    /// Resampling.
    Resampled(ResampledScattering),
}

impl ScatterSampling for AnyScattering {
    #[inline]
    fn scatter<V: Vertex>(
        &self,
        vertex: &V,
        length: u32,
        sampler: &mut impl Sampler,
    ) -> Option<ScatterSample<V::Spectrum>> {
        match self {
            Self::Own(scattering) => scattering.scatter(vertex, length, sampler),
            Self::Resampled(scattering) => scattering.scatter(vertex, length, sampler),
        }
    }
}
