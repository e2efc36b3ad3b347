//! Experiments: each reproduces a figure or a claim, and writes down what was measured.
//!
//! An experiment is a function from a [`Context`] to a [`Report`]. `lichtwerk experiment NAME` runs it and writes the report
//! as `report.json`; what else it makes (pictures) it saves through the context. To add one: a file here, a line in
//! [`EXPERIMENTS`].
//!
//! - [`Context`]: how much effort, which seeds, which folder.
//! - [`Report`], [`Row`], [`Claim`]: the contents of `report.json`.
//! - [`Setup`]: a builtin scene with settings, rendered with one seed after the other.
//! - [`Trials`]: renderings of one setting with several seeds, against a reference; [`ratio_of_means`] compares two.

mod claims;
mod context;
mod filtering;
mod many_lights;
mod photons;
mod report;
mod resampling;
mod samplers;
mod setup;
mod strata;
mod stratification_efficiency;
mod trials;

use crate::program::Failure;
use crate::report::Overview;

pub use context::Context;
pub(crate) use context::named_seed;
pub use report::{Claim, Report, Row};
pub use setup::Setup;
pub use trials::{Ratio, Trials, ratio_of_means};

/// What `lichtwerk experiment` can run.
#[derive(Clone, Copy, Debug)]
pub struct Experiment {
    /// The name by which it is asked for.
    pub name: &'static str,
    /// What it shows, in a line.
    pub about: &'static str,
    measure: fn(&Context) -> Result<Report, Failure>,
}

/// All experiments.
pub const EXPERIMENTS: &[Experiment] = &[
    Experiment {
        name: "samplers",
        about: "what each sampler gains over independent numbers, on the Cornell box at 64 samples per pixel",
        measure: samplers::measure,
    },
    Experiment {
        name: "strata",
        about: "figures 2 to 5 of Kollig and Keller 2004: weights, lengths of eye paths, contributions of strata",
        measure: strata::measure,
    },
    Experiment {
        name: "stratification-efficiency",
        about: "figure 6 of Kollig and Keller 2004: cost at equal error by heuristic and threshold",
        measure: stratification_efficiency::measure,
    },
    Experiment {
        name: "ris-density",
        about: "figure 1 of Talbot, Cline and Egbert 2005: the density of what resampling selects",
        measure: resampling::density,
    },
    Experiment {
        name: "ris-ratio",
        about: "figure 3 of Talbot, Cline and Egbert 2005: where more candidates pay, and where more samples; variances predicted and measured",
        measure: resampling::ratio,
    },
    Experiment {
        name: "ris-direct",
        about: "figure 4 of Talbot, Cline and Egbert 2005: direct light in equal time, the robust choice of M and N against the best",
        measure: resampling::direct,
    },
    Experiment {
        name: "ris-brdf",
        about: "figure 5 of Talbot, Cline and Egbert 2005: any scattering function by resampling of uniform directions",
        measure: resampling::brdf,
    },
    Experiment {
        name: "ris-reuse",
        about: "reuse of samples between pixels against resampling alone, in equal time",
        measure: resampling::reuse,
    },
    Experiment {
        name: "many-lights",
        about: "figure 5 of Keller and Wald 2000: lights selected by photons, in equal time and by the number of lights",
        measure: many_lights::measure,
    },
    Experiment {
        name: "importance-deposition",
        about: "figures 1 and 2 of Keller and Wald 2000: photons are kept in the room that the camera sees",
        measure: photons::deposition,
    },
    Experiment {
        name: "caustic-split",
        about: "figure 3 of Keller and Wald 2000: more photons for caustics, without and with a projection map",
        measure: photons::split,
    },
    Experiment {
        name: "door-slit",
        about: "figure 4 of Keller and Wald 2000: a room that is lit by a slit, with photons where importance is",
        measure: photons::slit,
    },
    Experiment {
        name: "psf-progressive",
        about: "figure 3 of Keller, Dahm and Binder 2014: the error of path space filtering by the number of samples",
        measure: filtering::progressive,
    },
    Experiment {
        name: "psf-weights",
        about: "figure 4 of Keller, Dahm and Binder 2014: what each similarity weight gains",
        measure: filtering::weights,
    },
    Experiment {
        name: "psf-iterated",
        about: "figure 2 of Keller, Dahm and Binder 2014: averages of averages, noise against detail",
        measure: filtering::iterated,
    },
    Experiment {
        name: "psf-applications",
        about: "figure 6 of Keller, Dahm and Binder 2014: occlusion, shadows, indirect light, leaves, translucency, several cameras",
        measure: filtering::applications,
    },
    Experiment {
        name: "psf-antialias",
        about: "figure 7 of Keller, Dahm and Binder 2014: a fence with one light path per pixel and three more camera samples",
        measure: filtering::antialias,
    },
];

impl Experiment {
    /// The experiment of this name.
    pub fn named(name: &str) -> Option<Self> {
        EXPERIMENTS.iter().copied().find(|experiment| experiment.name == name)
    }

    /// Runs it, and writes `report.json` and the page `report.html` into the context's folder, or reads what is there if that is to
    /// be kept.
    ///
    /// # Errors
    /// What the experiment fails of, or a file that cannot be written.
    pub fn run(&self, context: &Context) -> Result<Report, Failure> {
        context.prepare_folder()?;
        let report = match context.kept_report() {
            Some(kept) => kept,
            None => {
                let report = (self.measure)(context)?;
                context.write_report(&report)?;
                report
            }
        };
        let mut overview = Overview::new();
        overview.push(self.about, report.clone(), &context.out);
        overview.write(&context.out)?;
        Ok(report)
    }
}

// Whoever names `EXPERIMENTS` here compiles them all: its test is in `tests/program.rs`.
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reports_are_kept_if_they_are_of_the_same_form_and_seed() {
        let measure = |context: &Context| Ok(Report { rows: vec![Row::default()], ..context.report() });
        let experiment = Experiment { name: "e", about: "nothing", measure };
        let folder = tempfile::tempdir().unwrap();
        let context =
            Context { experiment: "e", quick: true, seed: 3, threads: 1, out: folder.path().to_path_buf(), keep: true };
        let rows = |context: &Context| experiment.run(context).unwrap().rows.len();
        assert_eq!(rows(&context), 1, "there was none");
        let other = Report { experiment: "e".into(), seed: 3, quick: true, ..Report::default() };
        context.write_report(&other).unwrap();
        assert_eq!(rows(&context), 0, "the one of the folder");
        assert_eq!(rows(&Context { keep: false, ..context.clone() }), 1);
        for changed in [
            Report { quick: false, ..other.clone() },
            Report { seed: 4, ..other.clone() },
            Report { experiment: "f".into(), ..other },
        ] {
            context.write_report(&changed).unwrap();
            assert_eq!(rows(&context), 1, "{changed:?} is another one");
        }
        std::fs::write(folder.path().join("report.json"), "{").unwrap();
        assert_eq!(rows(&context), 1, "half of a file is none");
    }
}
