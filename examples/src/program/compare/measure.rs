//! The renderings of a comparison.

use std::ops::ControlFlow;

use qmc_sampling::Replications;
use scene_core::ReferenceScene;
use scene_core::film::LayeredImage;

use crate::experiments::{Trials, named_seed};
use crate::output::{Interrupt, Progress};
use crate::program::{Failure, RenderSettings, render_to_image};
use crate::render::{Budget, RenderError, Rendering};

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
        self.run_by(contestants, interrupt, |settings| {
            render_to_image(self.scene, settings, |_| {
                if interrupt.is_requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            })
        })
    }

    /// The same with any renderer: who tests the order need not compile all estimators.
    fn run_by(
        &self,
        contestants: &[Contestant],
        interrupt: &Interrupt,
        mut render: impl FnMut(&RenderSettings) -> Result<(LayeredImage, Rendering), RenderError>,
    ) -> Result<Vec<Vec<Measured>>, Failure> {
        let mut all = vec![vec![Measured::default(); self.budgets.len()]; contestants.len()];
        let progress = Progress::counting(self.trials * (self.budgets.len() * contestants.len()) as u64, "renderings");
        for trial in 0..self.trials {
            for (level, budget) in self.budgets.iter().enumerate() {
                for turn in 0..contestants.len() {
                    let index = (turn + trial as usize) % contestants.len();
                    let contestant = &contestants[index];
                    let seed = self.seed_of(&contestant.name, level, trial);
                    let settings = RenderSettings { budget: *budget, seed, ..contestant.settings.clone() };
                    let refused = |error: Failure| format!("entry '{}': {error}", contestant.name);
                    let (image, rendering) = render(&settings).map_err(|error| refused(error.into()))?;
                    if interrupt.is_requested() {
                        progress.finish();
                        return Ok(all);
                    }
                    all[index][level].push(image, &rendering, self.reference).map_err(refused)?;
                    progress.add(1);
                }
            }
        }
        progress.finish();
        Ok(all)
    }
}

impl Measured {
    /// Adds one rendering.
    fn push(&mut self, image: LayeredImage, rendering: &Rendering, reference: &LayeredImage) -> Result<(), Failure> {
        self.errors.push(self.trials.push_image(&image, rendering, reference)?);
        self.seconds.push(rendering.seconds);
        self.rays.push(rendering.rays.total() as f64);
        self.samples.push(rendering.samples as f64);
        self.first.get_or_insert(image);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use scene_core::builtin::Builtin;

    use super::super::stand_in::grey;
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
        let mut reference = LayeredImage::new(4, 3).unwrap();
        reference.set_rgb(&[[0.5; 3]; 12]).unwrap();
        let plan =
            Plan { scene: &scene, reference: &reference, budgets: budgets(Budget::Samples(4)), trials: 3, seed: 1 };
        let settings = RenderSettings::new(Budget::Samples(1));
        let contestants = ["a", "b"].map(|name| Contestant { name: name.into(), settings: settings.clone() });
        let mut asked = Vec::new();
        let counting = |settings: &RenderSettings| {
            asked.push((settings.seed, settings.budget));
            grey(settings, &mut |_| ControlFlow::Continue(()))
        };
        let all = plan.run_by(&contestants, &Interrupt::inactive(), counting).unwrap();
        for measured in all.iter().flatten() {
            assert_eq!((measured.errors.len(), measured.trials.count()), (3, 3));
            assert!(measured.first.is_some());
        }
        assert_eq!((&all[0][1].samples[..], &all[1][0].rays[..]), (&[4.0; 3][..], &[12.0; 3][..]));

        // Two take turns with each of two budgets, three times, and each begins in turn.
        assert_eq!(asked.len(), 12);
        let order: Vec<Budget> = asked.iter().map(|&(_, budget)| budget).collect();
        assert_eq!(order, [1, 1, 4, 4, 1, 1, 4, 4, 1, 1, 4, 4].map(Budget::Samples));
        let begins = [0, 4, 8].map(|first| asked[first].0 == plan.seed_of("a", 0, first as u64 / 4));
        assert_eq!(begins, [true, false, true]);
        let mut seeds: Vec<u64> = asked.into_iter().map(|(seed, _)| seed).collect();
        seeds.sort_unstable();
        seeds.dedup();
        assert_eq!(seeds.len(), 12);

        let interrupt = Interrupt::inactive();
        interrupt.request();
        let stopped = plan
            .run_by(&contestants, &interrupt, |settings| grey(settings, &mut |_| ControlFlow::Continue(())))
            .unwrap();
        assert!(stopped.iter().flatten().all(|measured| measured.errors.is_empty()));
    }
}
