//! `lichtwerk experiment`.

use super::{ExperimentArguments, Failure, print};
use crate::experiments::{Context, EXPERIMENTS, Experiment};

/// The name that stands for all experiments.
const ALL: &str = "all";

/// Runs one experiment into a folder, or all of them into a folder each.
pub(super) fn run(arguments: &ExperimentArguments) -> Result<(), Failure> {
    if arguments.name == ALL {
        for experiment in EXPERIMENTS {
            let folder = arguments.out.clone().unwrap_or_else(|| "out".into()).join(experiment.name);
            run_one(experiment, arguments, folder)?;
        }
        return Ok(());
    }
    let experiment = Experiment::named(&arguments.name)
        .ok_or_else(|| format!("there is no experiment '{}' (see 'lichtwerk list')", arguments.name))?;
    let folder = arguments.out.clone().unwrap_or_else(|| std::path::Path::new("out").join(experiment.name));
    run_one(&experiment, arguments, folder)
}

fn run_one(experiment: &Experiment, arguments: &ExperimentArguments, out: std::path::PathBuf) -> Result<(), Failure> {
    let (quick, seed, threads) = (arguments.quick, arguments.seed, arguments.threads);
    let report = experiment.run(&Context { experiment: experiment.name, quick, seed, threads, out: out.clone() })?;
    print(&format!("{report}\nwritten to {}\n", out.join("report.json").display()))
}
