//! What an experiment is given.

use std::path::PathBuf;

use qmc_sampling::Replications;
use scene_core::film::LayeredImage;

use super::Report;
use crate::output::{OutputError, Progress, check_writable, save_image, write_json};
use crate::program::Failure;

/// A seed for something that has a name, independent of those of all other names.
pub(crate) fn named_seed(seed: u64, name: &str) -> u64 {
    name.bytes().fold(seed, |hash, byte| Replications::seed(hash, u64::from(byte)))
}

/// How to run an experiment.
#[derive(Clone, Debug)]
pub struct Context {
    /// Name of the experiment.
    pub experiment: &'static str,
    /// Whether to be done within a minute on two cores.
    pub quick: bool,
    /// All random numbers follow from it.
    pub seed: u64,
    /// Number of threads; zero is one per core.
    pub threads: usize,
    /// Folder for everything that is written.
    pub out: PathBuf,
    /// Whether a report that is there already, of the same experiment, form and seed, is taken for this one.
    pub keep: bool,
}

impl Context {
    /// One of two efforts.
    pub fn effort<T>(&self, quick: T, full: T) -> T {
        if self.quick { quick } else { full }
    }

    /// The seed of trial number `trial` of `what`, independent of all others.
    pub fn seed_of(&self, what: &str, trial: u64) -> u64 {
        Replications::seed(named_seed(self.seed, what), trial)
    }

    /// An empty report of this experiment.
    pub fn report(&self) -> Report {
        Report { experiment: self.experiment.to_owned(), seed: self.seed, quick: self.quick, ..Report::default() }
    }

    /// Shows on a terminal how far the experiment is, counted in trials.
    pub fn progress(&self, trials: u64) -> Progress {
        Progress::counting(trials, "trials")
    }

    /// Writes the picture `NAME.png`, brightened by `exposure` stops.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn save_picture(&self, name: &str, image: &LayeredImage, exposure: f32) -> Result<(), OutputError> {
        save_image(&self.out.join(format!("{name}.png")), image, exposure)
    }

    fn report_file(&self) -> PathBuf {
        self.out.join("report.json")
    }

    /// Creates the folder and finds out whether the report can be written, before any work is done.
    pub(super) fn prepare_folder(&self) -> Result<(), Failure> {
        std::fs::create_dir_all(&self.out).map_err(|error| format!("cannot create {}: {error}", self.out.display()))?;
        Ok(check_writable(&self.report_file())?)
    }

    /// The report that is in the folder already, if it is to be kept and is one of the same experiment, form and seed.
    pub(super) fn kept_report(&self) -> Option<Report> {
        if !self.keep {
            return None;
        }
        let text = std::fs::read(self.report_file()).ok()?;
        let report: Report = serde_json::from_slice(&text).ok()?;
        let is_same = report.experiment == self.experiment && report.quick == self.quick && report.seed == self.seed;
        is_same.then_some(report)
    }

    pub(super) fn write_report(&self, report: &Report) -> Result<(), OutputError> {
        write_json(&self.report_file(), report)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_differ_and_repeat() {
        let context =
            |seed| Context { experiment: "e", quick: true, seed, threads: 1, out: PathBuf::new(), keep: false };
        let mut seeds: Vec<u64> = Vec::new();
        for seed in [0, 1] {
            for what in ["", "a", "b", "ab", "ba"] {
                seeds.extend((0..3).map(|trial| context(seed).seed_of(what, trial)));
            }
        }
        assert_eq!(seeds[1], context(0).seed_of("", 1));
        seeds.sort_unstable();
        seeds.dedup();
        assert_eq!(seeds.len(), 2 * 5 * 3);
    }
}
