//! Path space filtering (Keller, Dahm and Binder 2014): figures 2, 3, 4, 6 and 7.
//!
//! All errors are relative mean squared errors against path tracing with many samples, by another seed; gains are ratios of their means.

mod antialias;
mod applications;
mod iterated;
mod progressive;
mod weights;

use scene_core::film::LayeredImage;

use super::claims::{at_least, reported};
use super::{Claim, Context, Ratio, Report, Row, Setup, Trials, ratio_of_means};
use crate::filters::{FilterSettings, PathFilterName};
use crate::program::{Failure, RenderSettings};

pub(super) use antialias::measure as antialias;
pub(super) use applications::measure as applications;
pub(super) use iterated::measure as iterated;
pub(super) use progressive::measure as progressive;
pub(super) use weights::measure as weights;

/// A setting with its renderings.
struct Variant {
    name: &'static str,
    settings: RenderSettings,
    trials: Trials,
}

impl Variant {
    fn new(name: &'static str, settings: RenderSettings) -> Self {
        Self { name, settings, trials: Trials::new() }
    }

    /// The setup's settings, filtered.
    fn filtered(name: &'static str, setup: &Setup, filtering: FilterSettings) -> Self {
        Self::new(name, filtered(&setup.settings, filtering))
    }

    fn row(&self, setup: &Setup, samples: u64) -> Row {
        let estimator = if self.settings.path_filter.is_some() { "filtered" } else { "input" };
        let params = [("variant", self.name.into()), ("spp", samples.into())];
        self.trials.fill(Row::new(setup.scene.name(), estimator, params))
    }
}

/// Settings with path space filtering.
fn filtered(settings: &RenderSettings, filtering: FilterSettings) -> RenderSettings {
    RenderSettings { path_filter: Some(PathFilterName::Psf), filtering, ..settings.clone() }
}

/// Renders all variants in turn, several times with other seeds, and keeps a picture of each.
fn run(
    context: &Context,
    setup: &Setup,
    reference: &LayeredImage,
    variants: &mut [Variant],
    samples: u64,
    trials: u64,
) -> Result<(), Failure> {
    for trial in 0..trials {
        for variant in &mut *variants {
            let seed = context.seed_of(&format!("{} {} {samples}", setup.scene.name(), variant.name), trial);
            let rendering = setup.render(&variant.settings, samples, seed)?;
            variant.trials.push(&rendering, reference)?;
            if trial == 0 {
                let name = format!("{}-{}-{samples}", setup.scene.name(), variant.name);
                context.save_picture(&name, &rendering.film.develop(rendering.light_paths), 0.0)?;
            }
        }
    }
    Ok(())
}

/// How many times smaller the error of the second is.
fn gain(of: &Trials, over: &Trials) -> Ratio {
    ratio_of_means(over.relative_mse(), of.relative_mse())
}
