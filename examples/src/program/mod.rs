//! The `lichtwerk` program: its subcommands as functions.

mod arguments;
mod attributes;
mod command_line;
mod compare;
mod diff;
mod done;
mod experiment;
mod filtered;
mod finish;
mod frames;
mod idle;
mod list;
mod load;
mod parts;
mod prepare;
mod render;
mod showcase;

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::FromArgMatches;
use serde::Serialize;

pub use arguments::{
    Arguments, Command, CompareArguments, DiffArguments, ExperimentArguments, FramesArguments, MergeArguments,
    RenderArguments, ShowcaseArguments,
};
use command_line::command_line;
pub use compare::RenderOptions;
pub use load::{LoadError, load_description};
pub use parts::Shard;
pub use render::{EstimatorName, RenderSettings, estimate, estimate_in, render_to_image};

use crate::distributed::{self, Ranks, StartError, launched_rank};
use crate::output::{check_writable, write_json};
pub use crate::samplers::SamplerName;

/// Why a subcommand failed: one line for the user.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Parses the command line and runs; returns the process's exit code: 0 for success, 1 for failure, 2 for a wrong
/// command line.
pub fn main() -> std::process::ExitCode {
    let parsed = command_line().try_get_matches();
    let parsed = parsed.and_then(|matches| {
        let arguments = Arguments::from_arg_matches(&matches)?;
        of_render(&arguments, &matches).map_or(Ok(()), |(render, matches)| idle::check(matches, render))?;
        Ok((arguments, matches))
    });
    let arguments = match parsed {
        Ok((arguments, matches)) => {
            if let Some((render, matches)) = of_render(&arguments, &matches) {
                warn_of_idle(matches, render);
            }
            arguments
        }
        Err(error) => {
            // clap's own text, once; if even that cannot be written, the exit code still tells.
            if is_first_launched() {
                let _ = error.print();
            }
            return std::process::ExitCode::from(if error.use_stderr() { 2 } else { 0 });
        }
    };
    match run(arguments) {
        Ok(()) => std::process::ExitCode::SUCCESS,
        Err(error) => {
            if !error.is::<Told>() {
                report(&format!("error: {error}"));
            }
            std::process::ExitCode::FAILURE
        }
    }
}

/// Whether this process is the first that a launcher started, or the only one: the others would say the same.
fn is_first_launched() -> bool {
    launched_rank().unwrap_or(0) == 0
}

/// The arguments of `render`, if it is called, and how they were given.
fn of_render<'a>(
    arguments: &'a Arguments,
    matches: &'a clap::ArgMatches,
) -> Option<(&'a RenderArguments, &'a clap::ArgMatches)> {
    match (&arguments.command, matches.subcommand()) {
        (Some(Command::Render(render)), Some((_, matches))) => Some((render, matches)),
        _ => None,
    }
}

fn warn_of_idle(matches: &clap::ArgMatches, render: &RenderArguments) {
    if is_first_launched() {
        idle::warnings(matches, render).iter().for_each(|line| tell(&format!("warning: {line}")));
    }
}

/// Runs a subcommand; without one, the showcase.
///
/// # Errors
/// Whatever went wrong, in one line.
pub fn run(arguments: Arguments) -> Result<(), Failure> {
    match arguments.command {
        None => showcase::run(&ShowcaseArguments::default()),
        Some(Command::Showcase(arguments)) => showcase::run(&arguments),
        Some(Command::Render(arguments)) => render::run(&arguments),
        Some(Command::Frames(arguments)) => frames::run(&arguments),
        Some(Command::Merge(arguments)) => parts::merge(&arguments),
        Some(Command::Diff(arguments)) => diff::run(&arguments),
        Some(Command::Compare(arguments)) => compare::run(&arguments),
        Some(Command::Experiment(arguments)) => experiment::run(&arguments),
        Some(Command::List) => list::run(),
    }
}

/// A failure of which the user knows.
#[derive(Debug, thiserror::Error)]
#[error("it has been told")]
struct Told;

/// Whether another process says what all have to say.
static IS_SILENT: AtomicBool = AtomicBool::new(false);

/// Finds the other processes that render; only the first one [reports](report).
fn find_ranks(has_part: bool) -> Result<Ranks, StartError> {
    let ranks = distributed::start(has_part);
    let rank = ranks.as_ref().map_or_else(|_| launched_rank().unwrap_or(0), Ranks::rank);
    IS_SILENT.store(rank > 0, Ordering::Relaxed);
    ranks
}

/// A line to standard error, from one process.
fn report(line: &str) {
    if !IS_SILENT.load(Ordering::Relaxed) {
        tell(line);
    }
}

/// A line to standard error that only this process has to say. A closed pipe is no reason to fail.
fn tell(line: &str) {
    use std::io::Write;
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

/// Whether a file is called as standard output is.
fn is_standard_output(path: &Path) -> bool {
    path == Path::new("-")
}

/// Finds out now whether [`write_numbers`] will be able to write.
///
/// # Errors
/// If the file cannot be written.
fn check_numbers(path: &Path) -> Result<(), Failure> {
    if is_standard_output(path) { Ok(()) } else { Ok(check_writable(path)?) }
}

/// Numbers as JSON, to a file or, if it is called `-`, to standard output.
///
/// # Errors
/// When they cannot be written.
fn write_numbers(path: &Path, numbers: &impl Serialize) -> Result<(), Failure> {
    if is_standard_output(path) {
        return print(&serde_json::to_string_pretty(numbers)?);
    }
    Ok(write_json(path, numbers)?)
}

/// Text to standard output.
///
/// # Errors
/// When it cannot be written, except into a closed pipe.
fn print(text: &str) -> Result<(), Failure> {
    use std::io::{ErrorKind, Write};
    match writeln!(std::io::stdout().lock(), "{text}") {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(format!("cannot write to standard output: {error}").into())
        }
        _ => Ok(()),
    }
}
