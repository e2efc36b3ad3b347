//! Options that change nothing, because what they belong to is not used.

use clap::parser::ValueSource;
use clap::{ArgMatches, Args, Command};

use super::RenderArguments;
use super::render::EstimatorName;
use crate::choices::LightSelection;

/// Warnings about options of `render` that were given and are not looked at. What an option belongs to is the heading of its help.
pub(super) fn warnings(matches: &ArgMatches, arguments: &RenderArguments) -> Vec<String> {
    let command = RenderArguments::augment_args(Command::new("render"));
    let given = |id: &str| matches!(matches.value_source(id), Some(ValueSource::CommandLine));
    let idle = command.get_arguments().filter_map(|argument| {
        let (heading, long) = (argument.get_help_heading()?, argument.get_long()?);
        (given(argument.get_id().as_str()) && !is_used(heading, arguments))
            .then(|| format!("--{long} has no effect: it belongs to '{heading}'"))
    });
    idle.collect()
}

fn is_used(heading: &str, arguments: &RenderArguments) -> bool {
    use EstimatorName as E;
    let estimator = arguments.estimator;
    match heading.split(" (").next().unwrap_or_default() {
        "Light paths" => estimator.connects_light_paths(),
        "Resampling" => matches!(estimator, E::Path | E::Direct | E::RestirDirect),
        "Photon maps" => {
            matches!(estimator, E::PhotonMap | E::Sppm) || estimator == E::RobustIgi && arguments.photons.caustics
        }
        "Light selection by photons" => arguments.lights == LightSelection::Photons,
        "Path space filter" => arguments.filter.iter().any(|filter| filter.path_space().is_some()),
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::FromArgMatches;

    fn told(words: &[&str]) -> Vec<String> {
        let command = RenderArguments::augment_args(Command::new("render")).no_binary_name(true);
        let matches = command.try_get_matches_from([&["office"], words].concat()).unwrap();
        warnings(&matches, &RenderArguments::from_arg_matches(&matches).unwrap())
    }

    /// Each heading is known here: another one would be thought of as used by all.
    #[test]
    fn options_of_what_is_not_used_are_told() {
        for (idle, used) in [
            ("--threshold=10", "--estimator=robust-igi"),
            ("--candidates=4", "--estimator=restir-direct"),
            ("--photons=1000", "--estimator=photon-map"),
            ("--light-photons=1000", "--lights=photons"),
            ("--filter-radius=5", "--filter=psf"),
        ] {
            // bdpt has no candidates, and the others of these are not path's.
            let lines = told(&[idle, "--estimator=ao"]);
            let name = idle.split('=').next().unwrap();
            assert!(lines.len() == 1 && lines[0].starts_with(&format!("{name} has no effect")), "{lines:?}");
            assert_eq!(told(&[idle, used]), [""; 0], "{idle} {used}");
        }
        assert_eq!(told(&["--photons=10", "--estimator=robust-igi", "--caustics"]), [""; 0]);
        assert_eq!(told(&["--seed=3", "--heuristic=balance"]), [""; 0], "what all have");
        let headings = RenderArguments::augment_args(Command::new("render"));
        let mut headings: Vec<_> = headings.get_arguments().filter_map(|a| a.get_help_heading()).collect();
        headings.sort_unstable();
        headings.dedup();
        assert_eq!(headings.len(), 5, "{headings:?}");
    }
}
