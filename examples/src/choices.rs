//! Choices that are made on the command line, behind the traits that the estimators take.

use mis_heuristics::{Balance, Cutoff, Densities, Float, Heuristic, Maximum, Power};
use scene_core::{ChosenEmitter, Emitter, EmitterChoice, EmitterId, PowerChoice, SurfacePoint, UniformChoice};
use vpl_gi::{Classical, Partition, PathHeuristic, PathTechniques, Stratified};

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
    /// Balance among those with at least a tenth of the largest density.
    Cutoff,
    /// By the geometry terms of whole paths: for `bdpt` alone.
    Stratification,
}

impl AnyHeuristic {
    /// Whether it is one of densities. The stratification heuristic is not: it needs whole paths.
    pub fn is_of_densities(self) -> bool {
        self != Self::Stratification
    }
}

/// What [`AnyHeuristic::Cutoff`] leaves out: densities below this part of the largest.
const CUTOFF: f64 = 0.1;

impl<F: Float> Heuristic<F> for AnyHeuristic {
    /// # Panics
    /// With the stratification heuristic, which knows no densities: see [`is_of_densities`](Self::is_of_densities).
    #[inline]
    fn weight(&self, technique: usize, densities: &(impl Densities<F> + ?Sized)) -> F {
        match self {
            Self::Balance => Balance.weight(technique, densities),
            Self::Power => Power::TWO.weight(technique, densities),
            Self::Maximum => Maximum.weight(technique, densities),
            Self::Cutoff => Cutoff::new(CUTOFF).expect("a cutoff between 0 and 1").weight(technique, densities),
            Self::Stratification => panic!("the stratification heuristic is not one of densities"),
        }
    }
}

/// A heuristic for whole paths, by name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnyPathHeuristic {
    /// Its name.
    pub name: AnyHeuristic,
    /// What stratification goes by.
    pub partition: Partition,
}

impl PathHeuristic for AnyPathHeuristic {
    #[inline]
    fn weight(&self, technique: usize, path: &impl PathTechniques) -> f64 {
        match self.name {
            AnyHeuristic::Stratification => Stratified(self.partition).weight(technique, path),
            name => Classical(name).weight(technique, path),
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
    /// By resampling candidates, as with `--direct ris`; where that does not apply, in proportion to their power.
    Ris,
    /// The lights whose photons arrived near by; see `--light-photons` and the options with it. Where that does not apply, in proportion
    /// to their power.
    Photons,
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
            LightSelection::Power | LightSelection::Ris | LightSelection::Photons => {
                Self::Power(PowerChoice::new(emitters))
            }
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
