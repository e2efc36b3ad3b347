//! What all options of the command line have in common.

use clap::{Arg, Command, CommandFactory};

use super::Arguments;
use super::arguments::headings::OF_ALL;

/// The command line as the program reads it.
///
/// `-h` tells what all estimators have, `--help` everything. Negative numbers are values: their option says that it takes none.
pub(super) fn command_line() -> Command {
    Arguments::command().mut_subcommands(|command| {
        // What `frames` is for is the path space filter: there it is nothing special.
        let hides = command.get_name() != "frames";
        let has_more = hides && command.get_arguments().any(is_special);
        let command = command.mut_args(|argument| refined(argument, hides));
        match has_more {
            true => command.after_help(MORE).after_long_help(NAMES),
            false => command,
        }
    })
}

const MORE: &str = "Options of single estimators and filters: --help. Scenes, estimators, samplers: lichtwerk list.";
const NAMES: &str = "Scenes, estimators, heuristics, samplers and filters, with a line for each: lichtwerk list.";

/// Whether some estimators or filters have it alone.
fn is_special(argument: &Arg) -> bool {
    argument.get_help_heading().is_some_and(|heading| !OF_ALL.contains(&heading))
}

fn refined(argument: Arg, hides: bool) -> Arg {
    let is_option_with_value = argument.get_long().is_some() && argument.get_action().takes_values();
    let is_hidden = hides && is_special(&argument);
    argument.hide_short_help(is_hidden).allow_negative_numbers(is_option_with_value)
}

#[cfg(test)]
mod tests {
    use clap::FromArgMatches;

    use super::*;

    /// Standard output of this line.
    fn help(words: &[&str]) -> String {
        let line = ["lichtwerk"].iter().chain(words);
        command_line().try_get_matches_from(line).unwrap_err().to_string()
    }

    fn headings(help: &str) -> Vec<&str> {
        let is_heading = |line: &&str| line.ends_with(':') && !line.starts_with(' ');
        help.lines().filter(is_heading).map(|line| line.split(" (").next().unwrap().trim_end_matches(':')).collect()
    }

    #[test]
    fn the_command_line_is_consistent() {
        command_line().debug_assert();
    }

    #[test]
    fn help_is_in_groups_with_the_most_used_first() {
        let groups = [
            "Estimator, paths, lights",
            "Samples and time",
            "Image and output",
            "Scene",
            "Resampling",
            "Light selection by photons",
            "Virtual point lights and bidirectional path tracing",
            "Photon maps",
            "Path space filter",
            "Checkpoints and parts",
        ];
        let render = help(&["render", "--help"]);
        assert_eq!(headings(&render), [&["Arguments", "Options"][..], &groups].concat());
        let compare = help(&["compare", "--help"]);
        assert_eq!(headings(&compare), [&["Arguments", "Options"][..], &groups[..9]].concat());
        let command = command_line();
        for name in ["render", "compare"] {
            let arguments = command.find_subcommand(name).unwrap().get_arguments();
            let options: Vec<_> = arguments.filter_map(|argument| argument.get_help_heading()).collect();
            for group in groups {
                let count = options.iter().filter(|heading| heading.starts_with(group)).count();
                assert!(count <= 20, "{group} has {count} options");
            }
        }
    }

    #[test]
    fn the_short_help_has_what_all_estimators_have() {
        for name in ["render", "compare"] {
            let (short, long) = (help(&[name, "-h"]), help(&[name, "--help"]));
            assert!(short.lines().count() < 60 && 3 * short.lines().count() < long.lines().count(), "{short}");
            for option in ["--spp", "--size", "--seed", "--max-depth"] {
                assert!(short.contains(option) && long.contains(option), "{option}");
            }
            for option in ["--filter-memory", "--photon-radius", "--candidates", "--interleave"] {
                assert!(!short.contains(option) && long.contains(option), "{option}");
            }
            assert!(short.contains(MORE) && long.contains(NAMES));
        }
        let frames = help(&["frames", "-h"]);
        assert!(frames.contains("--filter-memory") && !frames.contains(MORE), "{frames}");
    }

    /// What a subcommand cannot do without.
    fn least(name: &str) -> &'static [&'static str] {
        match name {
            "render" => &["office", "--filter=psf"],
            "frames" | "experiment" => &["office"],
            "compare" => &["office", "--estimators=path"],
            "merge" => &["a.part", "--out=a.exr"],
            "diff" => &["a.exr", "b.exr"],
            _ => &[],
        }
    }

    fn parse(name: &str, option: &str) -> Result<Arguments, String> {
        let line = [&["lichtwerk", name], least(name), &[option]].concat();
        let matches = command_line().try_get_matches_from(line).map_err(|error| error.to_string())?;
        Arguments::from_arg_matches(&matches).map_err(|error| error.to_string())
    }

    /// Nonsense for each option of each subcommand: the answer says what would make sense, and its example does.
    #[test]
    fn every_option_says_what_it_expects() {
        let mut count = 0;
        for command in command_line().get_subcommands() {
            let (name, options) = (command.get_name(), command.get_arguments());
            for long in options.filter(|argument| argument.get_action().takes_values()).filter_map(Arg::get_long) {
                // Names of files, hosts and estimators may be anything here.
                let Err(message) = parse(name, &format!("--{long}=?/?")) else { continue };
                count += 1;
                assert!(message.contains("invalid value '?/?'"), "{message}");
                assert!(!message.contains("digit") && !message.contains("literal"), "{message}");
                if let Some((_, example)) = message.split_once(", as in ") {
                    let example = example.split([' ', '\n']).next().unwrap().trim_end_matches(',');
                    let parsed = parse(name, &format!("--{long}={example}"));
                    assert!(message.contains("expected ") && parsed.is_ok(), "{example}, {parsed:?}: {message}");
                } else {
                    assert!(message.contains("possible values: ") || message.contains("'uniform' or"), "{message}");
                }
            }
        }
        assert!(count > 100, "{count} options");
    }
}
