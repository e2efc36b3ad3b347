//! The `lichtwerk` program: its subcommands as functions.

mod arguments;
mod compare;
mod diff;
mod experiment;
mod filtered;
mod finish;
mod frames;
mod list;
mod load;
mod parts;
mod prepare;
mod render;
mod showcase;

use clap::Parser;

pub use arguments::{
    Arguments, Command, CompareArguments, DiffArguments, ExperimentArguments, FramesArguments, MergeArguments,
    RenderArguments, ShowcaseArguments,
};
pub use compare::RenderOptions;
pub use load::{LoadError, load_description};
pub use parts::Shard;
pub use render::{EstimatorName, RenderSettings, estimate, estimate_in, render_to_image};

pub use crate::samplers::SamplerName;

/// Why a subcommand failed: one line for the user.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Parses the command line and runs; returns the process's exit code: 0 for success, 1 for failure, 2 for a wrong
/// command line.
pub fn main() -> std::process::ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            // clap's own text; if even that cannot be written, the exit code still tells.
            let _ = error.print();
            return std::process::ExitCode::from(if error.use_stderr() { 2 } else { 0 });
        }
    };
    match run(arguments) {
        Ok(()) => std::process::ExitCode::SUCCESS,
        Err(error) => {
            report(&format!("error: {error}"));
            std::process::ExitCode::FAILURE
        }
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

/// A line to standard error. A closed pipe is no reason to fail.
fn report(line: &str) {
    use std::io::Write;
    let _ = writeln!(std::io::stderr().lock(), "{line}");
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
