//! Figures 4 and 5: how long eye paths are, and what the strata contribute.

use qmc_sampling::{Interleaved, Replications, Sampler};
use scene_core::film::LayeredImage;
use scene_core::{EmitterChoice, PowerChoice, Ray, RussianRoulette, Scene, Spectrum, Vertex};
use vpl_gi::{Found, LightTracing, Observer, Residual, RobustIgi, VirtualPointLights};

use super::{Cost, interval, mean, render};
use crate::estimators::{FirstHit, VirtualLights};
use crate::experiments::claims::below;
use crate::experiments::{Context, Report, Row, Setup, ratio_of_means};
use crate::light_paths::LightPathSettings;
use crate::program::Failure;
use crate::render::{Shared, Sharing, SharingEstimator};

const SCENE: &str = "office";
/// The paper's longest paths.
const MAX_DEPTH: u32 = 5;

/// What is shown of eye paths.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Shown {
    /// The number of their vertices.
    Length,
    /// Their contributions at vertex number .., by connections there or by emission at the next one.
    Stratum(u32),
}

#[derive(Clone, Copy)]
struct Strata<C> {
    lights: VirtualLights<'static, C>,
    shown: Shown,
}

impl<C: EmitterChoice + Sync> SharingEstimator for Strata<C> {
    type Shared<V: Vertex + Send + Sync> = VirtualPointLights<V>;

    fn paths(&self) -> u32 {
        self.lights.paths
    }

    fn share<'s, S: Scene, R: Sampler>(
        &self,
        scene: &'s S,
        sampler: impl FnMut(u32) -> R,
        used: Option<VirtualPointLights<S::Vertex<'s>>>,
    ) -> VirtualPointLights<S::Vertex<'s>> {
        self.lights.share(scene, sampler, used)
    }

    fn radiance<S, V>(
        &self,
        scene: &S,
        lights: &VirtualPointLights<V>,
        ray: Ray,
        sampler: &mut impl Sampler,
    ) -> (S::Spectrum, Option<FirstHit>)
    where
        S: Scene,
        V: Vertex<Spectrum = S::Spectrum> + Send + Sync,
    {
        let mut seen = Seen { shown: self.shown, length: 0, sum: S::Spectrum::ZERO };
        self.lights.eye.trace(scene, lights, None, ray, sampler, &mut seen);
        match self.shown {
            Shown::Length => (S::Spectrum::splat(seen.length as f32), None),
            Shown::Stratum(_) => (seen.sum, None),
        }
    }
}

struct Seen<S> {
    shown: Shown,
    length: u32,
    sum: S,
}

impl<X: Vertex> Observer<X> for Seen<X::Spectrum> {
    fn vertex(&mut self, length: u32, _: &X, _: X::Spectrum) {
        self.length = length;
    }

    fn contribution(&mut self, eye: u32, found: Found, value: X::Spectrum) {
        // Emission that is hit closes the stratum of the vertex before.
        let stratum = if found != Found::Hit { eye } else { eye.saturating_sub(1) };
        if self.shown == Shown::Stratum(stratum) {
            self.sum += value;
        }
    }
}

/// Pictures `figure-4.png` (from green, one vertex, to red, five) and `figure-5-K.png` (stratum `K`, amplified).
pub(super) fn measure(context: &Context, report: &mut Report) -> Result<(), Failure> {
    let size = context.effort([64, 48], [240, 180]);
    let (samples, trials) = (context.effort(4, 8), context.effort(4, 8));
    let mut setup = Setup::builtin(context, SCENE, size)?;
    setup.settings.max_depth = MAX_DEPTH;
    let eye = LightPathSettings::default().robust(&setup.scene, Residual::Scatter)?;
    let strata = |eye: RobustIgi, shown| -> Result<_, Failure> {
        let light = LightTracing {
            choice: PowerChoice::new(setup.scene.emitters()),
            max_length: MAX_DEPTH - 2,
            roulette: RussianRoulette::LocalAlbedo { from_length: 0 },
        };
        let eye = RobustIgi { max_depth: MAX_DEPTH, roulette: RussianRoulette::Never, ..eye };
        let lights = VirtualLights { eye, light, paths: context.effort(8, 32), caustics: None };
        let estimator = Strata { lights, shown };
        Ok(Shared { estimator, sharing: Sharing::Interleaved(Interleaved::new(3, 3)?) })
    };

    // Figure 4. Eye paths of the classical heuristics go on as if the threshold were zero.
    let path_tracing = RobustIgi { partition: vpl_gi::Partition::hard(0.0)?, ..eye };
    let mut lengths = [(Replications::new(), Cost::default()); 2];
    for trial in 0..trials {
        for ((lengths, cost), (name, eye)) in lengths.iter_mut().zip([("robust", eye), ("classical", path_tracing)]) {
            let camera = strata(eye, Shown::Length)?;
            let seed = context.seed_of(&format!("figure 4, {name}"), trial);
            let rendering = render(&setup, &camera, samples, seed)?;
            cost.push(&rendering);
            let image = rendering.film.develop(0);
            lengths.push(mean(&image)?);
            if trial == 0 && name == "robust" {
                context.save_picture("figure-4", &green_to_red(&image)?, 0.0)?;
            }
        }
    }
    for (name, (lengths, cost)) in ["stratification", "classical"].into_iter().zip(&lengths) {
        let params =
            [("figure", 4.into()), ("heuristic", name.into()), ("mean eye path length", lengths.mean().into())];
        report.rows.push(cost.fill(Row { variance: lengths.variance(), ..Row::new(SCENE, "robust-igi", params) }));
    }
    let ratio = ratio_of_means(&lengths[0].0, &lengths[1].0);
    report.claims.push(below("figure-4-eye-paths-are-shorter", ratio, 1.0));

    // Figure 5.
    let mut before: Option<Replications> = None;
    for stratum in 1..MAX_DEPTH {
        let (mut means, mut cost) = (Replications::new(), Cost::default());
        for trial in 0..trials {
            let camera = strata(eye, Shown::Stratum(stratum))?;
            let seed = context.seed_of(&format!("figure 5, {stratum}"), trial);
            let rendering = render(&setup, &camera, samples, seed)?;
            cost.push(&rendering);
            let image = rendering.film.develop(0);
            means.push(mean(&image)?);
            if trial == 0 {
                context.save_picture(&format!("figure-5-{stratum}"), &image, 2.0 * (stratum - 1) as f32)?;
            }
        }
        let (value, [low, high]) = interval(&means);
        let params = [
            ("figure", 5.into()),
            ("eye path length", stratum.into()),
            ("mean", value.into()),
            ("low", low.into()),
            ("high", high.into()),
        ];
        report.rows.push(cost.fill(Row { variance: means.variance(), ..Row::new(SCENE, "robust-igi", params) }));
        if let Some(before) = before {
            let ratio = ratio_of_means(&means, &before);
            report.claims.push(below(format!("figure-5-stratum-{stratum}-is-smaller"), ratio, 1.0));
        }
        before = Some(means);
    }
    Ok(())
}

/// One vertex is green, the paper's five are red.
fn green_to_red(lengths: &LayeredImage) -> Result<LayeredImage, Failure> {
    let pixels: Vec<[f32; 3]> = lengths
        .rgb()?
        .iter()
        .map(|length| {
            let red = ((length[0] - 1.0) / (MAX_DEPTH - 1) as f32).clamp(0.0, 1.0);
            [red, 1.0 - red, 0.0]
        })
        .collect();
    let mut image = LayeredImage::new(lengths.width(), lengths.height())?;
    image.set_rgb(&pixels)?;
    Ok(image)
}
