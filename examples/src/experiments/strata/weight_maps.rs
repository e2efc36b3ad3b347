//! Figure 3: what each technique contributes to direct light, weighted by each heuristic.

use qmc_sampling::{Interleaved, Replications, Sampler};
use scene_core::film::LayeredImage;
use scene_core::{EmitterChoice, PowerChoice, Ray, RussianRoulette, Scene, Spectrum, Vertex};
use vpl_gi::{Bidirectional, Found, LightPaths, LightTracing, Observer, TechniqueSet, Threshold};

use super::{Cost, mean, render};
use crate::choices::{AnyHeuristic, AnyPathHeuristic};
use crate::estimators::{BidirectionalPaths, FirstHit};
use crate::experiments::claims::equals;
use crate::experiments::{Context, Report, Row, Setup, ratio_of_means};
use crate::light_paths::PartitionName;
use crate::program::Failure;
use crate::render::{Shared, Sharing, SharingEstimator};

const SCENE: &str = "plane-light";
/// In units of 1/R^2.
const THRESHOLD: f32 = 10.0;

/// The contributions of one technique for direct light.
struct Technique<C> {
    all: BidirectionalPaths<AnyPathHeuristic, C>,
    /// Whether of the one that samples the light; otherwise of the one that samples a direction.
    samples_light: bool,
}

impl<C: EmitterChoice + Sync> SharingEstimator for Technique<C> {
    type Shared<V: Vertex + Send + Sync> = LightPaths<V>;

    fn paths(&self) -> u32 {
        self.all.paths()
    }

    fn share<'s, S: Scene, R: Sampler>(
        &self,
        scene: &'s S,
        sampler: impl FnMut(u32) -> R,
        used: Option<LightPaths<S::Vertex<'s>>>,
    ) -> LightPaths<S::Vertex<'s>> {
        self.all.share(scene, sampler, used)
    }

    fn radiance<S, V>(
        &self,
        scene: &S,
        lights: &LightPaths<V>,
        ray: Ray,
        sampler: &mut impl Sampler,
    ) -> (S::Spectrum, Option<FirstHit>)
    where
        S: Scene,
        V: Vertex<Spectrum = S::Spectrum> + Send + Sync,
    {
        let mut sum = OfTechnique { samples_light: self.samples_light, sum: S::Spectrum::ZERO };
        self.all.paths.radiance(scene, lights, ray, sampler, &mut sum);
        (sum.sum, None)
    }
}

/// Adds up direct light by one technique; light that is seen directly is left out.
struct OfTechnique<S> {
    samples_light: bool,
    sum: S,
}

impl<X: Vertex> Observer<X> for OfTechnique<X::Spectrum> {
    fn contribution(&mut self, eye: u32, found: Found, value: X::Spectrum) {
        let direct = if self.samples_light { (1, Found::Connection { light: 0 }) } else { (2, Found::Hit) };
        if (eye, found) == direct {
            self.sum += value;
        }
    }
}

/// Pictures `figure-3-HEURISTIC-light.png`, `-direction.png` and `-sum.png`; the sum is what path tracing finds.
pub(super) fn measure(context: &Context, report: &mut Report) -> Result<(), Failure> {
    let size = context.effort([80, 60], [160, 120]);
    let (samples, trials) = (context.effort(64, 96), context.effort(6, 8));
    let mut setup = Setup::builtin(context, SCENE, size)?;
    setup.settings.max_depth = 2;

    // Direct light by path tracing, without what is seen directly.
    let mut truth = Replications::new();
    for trial in 0..trials {
        let rendering = setup.render(&setup.settings, 4 * samples, context.seed_of("figure 3, path", trial))?;
        let mut visible = setup.settings.clone();
        visible.max_depth = 1;
        let seen = setup.render(&visible, 4 * samples, context.seed_of("figure 3, path", trial))?;
        truth.push(mean(&rendering.film.develop(0))? - mean(&seen.film.develop(0))?);
    }

    for heuristic in [AnyHeuristic::Stratification, AnyHeuristic::Balance, AnyHeuristic::Power, AnyHeuristic::Maximum] {
        let name = format!("{heuristic:?}").to_lowercase();
        let mut sums = Replications::new();
        let mut parts = [Replications::new(); 2];
        let (mut pictures, mut cost) = (Vec::new(), Cost::default());
        for trial in 0..trials {
            let mut sum = 0.0;
            for (part, samples_light) in parts.iter_mut().zip([true, false]) {
                let camera = technique(&setup, heuristic, samples_light)?;
                let seed = context.seed_of(&format!("figure 3, {name}, {samples_light}"), trial);
                let rendering = render(&setup, &camera, samples, seed)?;
                cost.push(&rendering);
                let image = rendering.film.develop(0);
                part.push(mean(&image)?);
                sum += mean(&image)?;
                if trial == 0 {
                    pictures.push(image);
                }
            }
            sums.push(sum);
        }
        for (picture, label) in pictures.iter().zip(["light", "direction"]) {
            context.save_picture(&format!("figure-3-{name}-{label}"), picture, 0.0)?;
        }
        context.save_picture(&format!("figure-3-{name}-sum"), &sum_of(&pictures)?, 0.0)?;
        let params = [
            ("figure", 3.into()),
            ("heuristic", name.clone().into()),
            ("light", (parts[0].mean() / sums.mean()).into()),
            ("direction", (parts[1].mean() / sums.mean()).into()),
        ];
        report
            .rows
            .push(cost.fill(Row { variance: variance_of(&parts), ..Row::new(SCENE, "bdpt, direct light", params) }));
        let ratio = ratio_of_means(&sums, &truth);
        report.claims.push(equals(format!("figure-3-{name}-adds-up"), ratio, 1.0, 0.01));
    }
    Ok(())
}

/// Of the sum of the means, from one rendering to another.
fn variance_of(parts: &[Replications; 2]) -> f64 {
    parts.iter().map(Replications::variance).sum()
}

fn technique(
    setup: &Setup,
    heuristic: AnyHeuristic,
    samples_light: bool,
) -> Result<Shared<Technique<PowerChoice>>, Failure> {
    let radius = setup.scene.bounding_sphere().1;
    let partition = PartitionName::Hard.partition(Threshold::Normalised(THRESHOLD).resolve(radius))?;
    let tracing = LightTracing {
        choice: PowerChoice::new(setup.scene.emitters()),
        max_length: 0,
        roulette: RussianRoulette::Never,
    };
    let paths = Bidirectional {
        heuristic: AnyPathHeuristic { name: heuristic, partition },
        techniques: TechniqueSet::WithoutLens,
        tracing,
        max_depth: 2,
        roulette: RussianRoulette::Never,
    };
    let estimator = Technique { all: BidirectionalPaths { paths, count: 1, resampled: None }, samples_light };
    Ok(Shared { estimator, sharing: Sharing::Interleaved(Interleaved::new(3, 3)?) })
}

fn sum_of(images: &[LayeredImage]) -> Result<LayeredImage, Failure> {
    let mut sum: Vec<[f32; 3]> = Vec::new();
    for image in images {
        let pixels = image.rgb()?;
        sum.resize(pixels.len(), [0.0; 3]);
        for (sum, pixel) in sum.iter_mut().flatten().zip(pixels.iter().flatten()) {
            *sum += pixel;
        }
    }
    let first = images.first().ok_or("no images to add up")?;
    let mut image = LayeredImage::new(first.width(), first.height())?;
    image.set_rgb(&sum)?;
    Ok(image)
}
