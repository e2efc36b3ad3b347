//! `lichtwerk experiment`.

use std::path::{Path, PathBuf};

use super::{ExperimentArguments, Failure, print};
use crate::experiments::{Context, EXPERIMENTS, Experiment, Report};
use crate::report::Overview;

/// The name that stands for all experiments.
const ALL: &str = "all";

/// Runs one experiment into a folder, or all of them into a folder each and a page of all beside those.
pub(super) fn run(arguments: &ExperimentArguments) -> Result<(), Failure> {
    if arguments.name == ALL {
        let out = arguments.out.clone().unwrap_or_else(|| "out".into());
        let mut overview = Overview::new();
        for experiment in EXPERIMENTS {
            let folder = out.join(experiment.name);
            let report = run_one(experiment, arguments, folder.clone())?;
            // After each of them: all may take a night, and what is there should be seen in between.
            overview.push(experiment.about, report, &folder);
            overview.write(&out)?;
        }
        return Ok(());
    }
    let experiment = Experiment::named(&arguments.name)
        .ok_or_else(|| format!("there is no experiment '{}' (see 'lichtwerk list')", arguments.name))?;
    let folder = arguments.out.clone().unwrap_or_else(|| Path::new("out").join(experiment.name));
    run_one(&experiment, arguments, folder).map(drop)
}

fn run_one(experiment: &Experiment, arguments: &ExperimentArguments, out: PathBuf) -> Result<Report, Failure> {
    let ExperimentArguments { quick, seed, threads, keep, .. } = *arguments;
    let context = Context { experiment: experiment.name, quick, seed, threads, out: out.clone(), keep };
    let report = experiment.run(&context)?;
    print(&format!("{report}\nwritten to {}\n", out.join("report.json").display()))?;
    Ok(report)
}
