//! Choices that are made on the command line, behind the traits that the estimators take.

use mis_heuristics::{Balance, Densities, Heuristic, Maximum, Power};
use scene_core::{ChosenEmitter, Emitter, EmitterChoice, EmitterId, PowerChoice, SurfacePoint, UniformChoice};

/// A heuristic of `mis-heuristics` by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum AnyHeuristic {
    /// Weights proportional to the densities.
    Balance,
    /// Weights proportional to the squared densities.
    #[default]
    Power,
    /// All weight to the largest density.
    Maximum,
}

impl Heuristic<f32> for AnyHeuristic {
    #[inline]
    fn weight(&self, technique: usize, densities: &impl Densities<f32>) -> f32 {
        match self {
            Self::Balance => Balance.weight(technique, densities),
            Self::Power => Power::TWO.weight(technique, densities),
            Self::Maximum => Maximum.weight(technique, densities),
        }
    }
}

/// How to choose an emitter, by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum LightSelection {
    /// All with the same probability.
    Uniform,
    /// In proportion to their power.
    #[default]
    Power,
}

/// A choice of `scene-core` by name.
#[derive(Clone, Debug)]
pub enum AnyChoice {
    /// All with the same probability.
    Uniform(UniformChoice),
    /// In proportion to their power.
    Power(PowerChoice),
}

impl AnyChoice {
    /// Among the emitters of a scene.
    pub fn new<E: Emitter>(selection: LightSelection, emitters: &[E]) -> Self {
        match selection {
            LightSelection::Uniform => Self::Uniform(UniformChoice::new(emitters.len())),
            LightSelection::Power => Self::Power(PowerChoice::new(emitters)),
        }
    }
}

impl EmitterChoice for AnyChoice {
    #[inline]
    fn choose(&self, from: Option<&SurfacePoint>, u: f32) -> Option<ChosenEmitter> {
        match self {
            Self::Uniform(choice) => choice.choose(from, u),
            Self::Power(choice) => choice.choose(from, u),
        }
    }

    #[inline]
    fn probability(&self, from: Option<&SurfacePoint>, id: EmitterId) -> f32 {
        match self {
            Self::Uniform(choice) => choice.probability(from, id),
            Self::Power(choice) => choice.probability(from, id),
        }
    }
}
