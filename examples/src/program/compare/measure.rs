//! The renderings of a comparison.

use std::ops::ControlFlow;

use qmc_sampling::Replications;
use scene_core::ReferenceScene;
use scene_core::film::LayeredImage;

use crate::experiments::{Trials, named_seed};
use crate::output::{Interrupt, Progress};
use crate::program::{Failure, RenderSettings, render_to_image};
use crate::render::Budget;

/// An estimator that takes part.
#[derive(Debug)]
pub(super) struct Contestant {
    /// What it is called.
    pub(super) name: String,
    /// How it renders, apart from seed and budget.
    pub(super) settings: RenderSettings,
}

/// What all renderings have in common.
#[derive(Debug)]
pub(super) struct Plan<'a> {
    pub(super) scene: &'a ReferenceScene,
    pub(super) reference: &'a LayeredImage,
    /// From the smallest to the largest.
    pub(super) budgets: Vec<Budget>,
    pub(super) trials: u64,
    pub(super) seed: u64,
}

/// The renderings of one estimator with one budget: a number for each.
#[derive(Clone, Debug, Default)]
pub(super) struct Measured {
    pub(super) errors: Vec<f64>,
    pub(super) seconds: Vec<f64>,
    pub(super) rays: Vec<f64>,
    pub(super) samples: Vec<f64>,
    /// The moments of their pixels.
    pub(super) trials: Trials,
    /// The first one's image, for what all have in common.
    pub(super) first: Option<LayeredImage>,
}

/// Shares of the whole budget that are rendered with, too: error against cost takes more than one point.
const SHARES: [u64; 3] = [16, 4, 1];

/// The whole budget and its shares, from the smallest; those that are no different are left out.
pub(super) fn budgets(whole: Budget) -> Vec<Budget> {
    let mut budgets: Vec<Budget> = SHARES
        .iter()
        .map(|&share| match whole {
            Budget::Samples(samples) => Budget::Samples((samples / share).max(1)),
            Budget::Seconds(seconds) => Budget::Seconds(seconds / share as f64),
        })
        .collect();
    budgets.dedup();
    budgets
}

impl Plan<'_> {
    /// The seed of a rendering, independent of all others: by the estimator's name, so that it does not depend on who else takes part.
    fn seed_of(&self, name: &str, budget: usize, trial: u64) -> u64 {
        Replications::seed(Replications::seed(named_seed(self.seed, name), budget as u64), trial)
    }

    /// Renders everything: for each estimator, its renderings by budget.
    ///
    /// Trial by trial and budget by budget, all estimators take turns, and each time another one begins: when the machine gets slower, it
    /// does so for all of them. After an interrupt, what is finished is returned.
    pub(super) fn run(&self, contestants: &[Contestant], interrupt: &Interrupt) -> Result<Vec<Vec<Measured>>, Failure> {
        let mut all = vec![vec![Measured::default(); self.budgets.len()]; contestants.len()];
        let progress = Progress::counting(self.trials * (self.budgets.len() * contestants.len()) as u64, "renderings");
        for trial in 0..self.trials {
            for (level, budget) in self.budgets.iter().enumerate() {
                for turn in 0..contestants.len() {
                    let index = (turn + trial as usize) % contestants.len();
                    let contestant = &contestants[index];
                    let seed = self.seed_of(&contestant.name, level, trial);
                    let settings = RenderSettings { budget: *budget, seed, ..contestant.settings.clone() };
                    if !self
                        .render(&settings, &mut all[index][level], interrupt)
                        .map_err(|error| format!("entry '{}': {error}", contestant.name))?
                    {
                        progress.finish();
                        return Ok(all);
                    }
                    progress.add(1);
                }
            }
        }
        progress.finish();
        Ok(all)
    }

    /// Adds one rendering; false if it was interrupted, and is not added.
    fn render(&self, settings: &RenderSettings, into: &mut Measured, interrupt: &Interrupt) -> Result<bool, Failure> {
        let (image, rendering) = render_to_image(self.scene, settings, |_| {
            if interrupt.is_requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })?;
        if interrupt.is_requested() {
            return Ok(false);
        }
        into.errors.push(into.trials.push_image(&image, &rendering, self.reference)?);
        into.seconds.push(rendering.seconds);
        into.rays.push(rendering.rays.total() as f64);
        into.samples.push(rendering.samples as f64);
        into.first.get_or_insert(image);
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use scene_core::builtin::Builtin;

    use super::*;

    #[test]
    fn budgets_grow_up_to_the_whole() {
        let samples = |numbers: &[u64]| numbers.iter().map(|&n| Budget::Samples(n)).collect::<Vec<_>>();
        assert_eq!(budgets(Budget::Samples(64)), samples(&[4, 16, 64]));
        assert_eq!(budgets(Budget::Samples(5)), samples(&[1, 5]));
        assert_eq!(budgets(Budget::Samples(1)), samples(&[1]));
        assert_eq!(budgets(Budget::Seconds(1.6)), [0.1, 0.4, 1.6].map(Budget::Seconds));
    }

    #[test]
    fn renderings_have_seeds_of_their_own_and_stop_at_an_interrupt() {
        let mut description = Builtin::named("furnace").unwrap().description();
        (description.camera.width, description.camera.height) = (4, 3);
        let scene = ReferenceScene::new(description).unwrap();
        let settings = RenderSettings { threads: 1, ..RenderSettings::new(Budget::Samples(1)) };
        let mut reference = LayeredImage::new(4, 3).unwrap();
        reference.set_rgb(&[[0.5; 3]; 12]).unwrap();
        let budgets = budgets(Budget::Samples(4));
        let plan = Plan { scene: &scene, reference: &reference, budgets, trials: 3, seed: 1 };
        let contestants = ["a", "b"].map(|name| Contestant { name: name.into(), settings: settings.clone() });
        let all = plan.run(&contestants, &Interrupt::inactive()).unwrap();
        for measured in all.iter().flatten() {
            assert_eq!((measured.errors.len(), measured.trials.count()), (3, 3));
            assert!(measured.first.is_some());
        }
        assert_eq!(all[0][1].samples, [4.0; 3]);
        let mut seeds: Vec<u64> = ["a", "b"]
            .iter()
            .flat_map(|name| (0..3).flat_map(move |level| (0..3).map(move |trial| (name, level, trial))))
            .map(|(name, level, trial)| plan.seed_of(name, level, trial))
            .collect();
        seeds.sort_unstable();
        seeds.dedup();
        assert_eq!(seeds.len(), 18);

        let interrupt = Interrupt::inactive();
        interrupt.request();
        assert!(
            plan.run(&contestants, &interrupt).unwrap().iter().flatten().all(|measured| measured.errors.is_empty())
        );
    }
}
