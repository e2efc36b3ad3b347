//! Options that change nothing, because what they belong to is not used, and options that contradict each other.

use clap::error::ErrorKind;
use clap::parser::ValueSource;
use clap::{ArgMatches, Args, Command};

use super::RenderArguments;
use super::render::EstimatorName;
use crate::choices::LightSelection;
use crate::resampling::DirectName;
use crate::values::name_of;

/// Warnings about options of `render` that were given and are not looked at. What an option belongs to is the heading of its help.
pub(super) fn warnings(matches: &ArgMatches, arguments: &RenderArguments) -> Vec<String> {
    let command = RenderArguments::augment_args(Command::new("render"));
    let given = |id: &str| is_given(matches, id);
    let idle = command.get_arguments().filter_map(|argument| {
        let (heading, long) = (argument.get_help_heading()?, argument.get_long()?);
        (given(argument.get_id().as_str()) && !is_used(heading, arguments))
            .then(|| format!("--{long} has no effect: it belongs to '{heading}'"))
    });
    idle.chain(idle_lights(matches, arguments)).chain(idle_buffer(arguments)).collect()
}

fn is_given(matches: &ArgMatches, id: &str) -> bool {
    matches!(matches.value_source(id), Some(ValueSource::CommandLine))
}

/// Where direct light needs no choice of an emitter, or has one of its own.
fn idle_lights(matches: &ArgMatches, arguments: &RenderArguments) -> Option<String> {
    let is_plain_choice = matches!(arguments.lights, LightSelection::Uniform | LightSelection::Power);
    let is_alone = matches!(arguments.estimator, EstimatorName::Path | EstimatorName::Direct);
    if !(is_given(matches, "lights") && is_plain_choice && is_alone) {
        return None;
    }
    match arguments.resampling.direct {
        DirectName::Nee => None,
        DirectName::Ris => Some("--lights has no effect: with --direct ris, --candidate-lights chooses".to_owned()),
        DirectName::Scattering => Some("--lights has no effect: --direct scattering chooses no emitter".to_owned()),
    }
}

/// The discontinuity buffer smooths over the tile that shares light paths.
fn idle_buffer(arguments: &RenderArguments) -> Option<String> {
    let paths = &arguments.light_paths;
    let is_idle =
        arguments.estimator.connects_light_paths() && paths.discontinuity_buffer && paths.interleave.is_none();
    is_idle.then(|| {
        "--discontinuity-buffer has no effect: it smooths over the tile of --interleave, which is none".to_owned()
    })
}

/// Refuses options of which only one could count.
pub(super) fn check(matches: &ArgMatches, arguments: &RenderArguments) -> Result<(), clap::Error> {
    let direct = arguments.resampling.direct;
    if !is_given(matches, "direct") {
        return Ok(());
    }
    let reason = match arguments.lights {
        LightSelection::Ris if direct != DirectName::Ris => "--lights ris stands for --direct ris",
        LightSelection::Photons if direct != DirectName::Nee => "--lights photons goes with --direct nee alone",
        _ => return Ok(()),
    };
    let name = name_of(direct);
    let text = format!("{reason}, and contradicts --direct {name}: give one of both");
    Err(RenderArguments::augment_args(Command::new("lichtwerk render")).error(ErrorKind::ArgumentConflict, text))
}

fn is_used(heading: &str, arguments: &RenderArguments) -> bool {
    use EstimatorName as E;
    let estimator = arguments.estimator;
    match heading.split(" (").next().unwrap_or_default() {
        "Virtual point lights and bidirectional path tracing" => estimator.connects_light_paths(),
        "Resampling" => matches!(estimator, E::Path | E::Direct | E::RestirDirect | E::PhotonMap | E::Sppm),
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
    use crate::program::arguments::headings::OF_ALL;
    use clap::FromArgMatches;

    fn told(words: &[&str]) -> Vec<String> {
        let command = RenderArguments::augment_args(Command::new("render")).no_binary_name(true);
        let matches = command.try_get_matches_from([&["office"], words].concat()).unwrap();
        warnings(&matches, &RenderArguments::from_arg_matches(&matches).unwrap())
    }

    #[test]
    fn contradictions_are_refused() {
        let checked = |words: &[&str]| {
            let command = RenderArguments::augment_args(Command::new("render")).no_binary_name(true);
            let matches = command.try_get_matches_from([&["office"], words].concat()).unwrap();
            check(&matches, &RenderArguments::from_arg_matches(&matches).unwrap()).map_err(|error| error.to_string())
        };
        for direct in ["nee", "scattering"] {
            let message = checked(&["--lights=ris", "--direct", direct]).unwrap_err();
            assert!(message.contains("--lights ris") && message.contains(&format!("--direct {direct}:")), "{message}");
        }
        assert!(checked(&["--direct=ris", "--lights=photons"]).unwrap_err().contains("--lights photons"));
        for fine in [
            &["--lights=ris"][..],
            &["--lights=ris", "--direct=ris"],
            &["--lights=photons", "--direct=nee"],
            &["--lights=photons"],
            &["--lights=uniform", "--direct=ris"],
        ] {
            assert_eq!(checked(fine), Ok(()), "{fine:?}");
        }
    }

    #[test]
    fn choices_that_nothing_asks_for_are_told() {
        for (idle, reason) in [
            (&["--lights=uniform", "--direct=ris"][..], "--candidate-lights"),
            (&["--lights=power", "--direct=scattering"], "chooses no emitter"),
            (&["--estimator=bdpt", "--discontinuity-buffer"], "--interleave"),
            (&["--estimator=robust-igi", "--discontinuity-buffer", "--interleave=none"], "--interleave"),
        ] {
            let lines = told(idle);
            assert!(lines.len() == 1 && lines[0].contains(reason), "{idle:?}: {lines:?}");
        }
        for used in [
            &["--lights=uniform"][..],
            &["--direct=ris"],
            &["--lights=uniform", "--direct=ris", "--estimator=photon-map"],
            &["--estimator=robust-igi", "--discontinuity-buffer"],
            &["--estimator=bdpt", "--discontinuity-buffer", "--interleave=2x2"],
        ] {
            assert_eq!(told(used), [""; 0], "{used:?}");
        }
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
        assert_eq!(headings.len(), 5 + OF_ALL.len(), "{headings:?}");
    }
}
