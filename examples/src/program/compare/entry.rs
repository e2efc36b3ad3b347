//! Entries of `--estimators`, and the options that all of them share.
//!
//! Both are options of `render`, and are handed back to its parser as they are: an option that `render` gets is one here, too.

use std::ffi::OsString;

use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches};

use crate::program::{Failure, RenderArguments, idle};

/// Options of `render` that make no sense for renderings that are compared.
const NOT_HERE: [&str; 9] =
    ["scene", "estimator", "out", "stats", "display_server", "continued", "checkpoint", "checkpoint_seconds", "shard"];

/// Options that are the same for all, or there would be nothing to compare.
const FOR_ALL: [&str; 6] = ["spp", "time", "size", "seed", "exposure", "definitions"];

/// The options of `render` that were given to `compare`, as words for the parser of `render`.
#[derive(Clone, Debug, Default)]
pub struct RenderOptions(Vec<OsString>);

fn render_command() -> Command {
    RenderArguments::augment_args(Command::new("render")).no_binary_name(true).args_override_self(true)
}

/// The options of `render` that can be given here.
fn common(command: &Command) -> impl Iterator<Item = &Arg> {
    command.get_arguments().filter(|argument| !NOT_HERE.contains(&argument.get_id().as_str()))
}

impl Args for RenderOptions {
    fn augment_args(command: Command) -> Command {
        common(&render_command()).fold(command, |command, argument| command.arg(argument.clone()))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for RenderOptions {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut words = Vec::new();
        let command = render_command();
        for argument in common(&command) {
            let (id, long) = (argument.get_id().as_str(), argument.get_long().unwrap_or_default());
            if matches.value_source(id) != Some(ValueSource::CommandLine) {
                continue;
            }
            if matches!(argument.get_action(), ArgAction::SetTrue | ArgAction::SetFalse) {
                words.push(format!("--{long}").into());
                continue;
            }
            for value in matches.get_raw(id).into_iter().flatten() {
                let mut word = OsString::from(format!("--{long}="));
                word.push(value);
                words.push(word);
            }
        }
        Ok(Self(words))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// One of the estimators that are compared.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    /// As it was written.
    pub(super) text: String,
    /// The same, such as files can be called.
    pub(super) file: String,
    /// What `render` would be called with.
    pub(super) arguments: RenderArguments,
}

impl RenderOptions {
    /// What `render` would be called with, apart from the estimator.
    pub(super) fn arguments(&self, scene: &str) -> Result<RenderArguments, Failure> {
        self.with(scene, &[]).map_err(|error| one_line(&error).into())
    }

    /// Parses all entries.
    pub(super) fn entries(&self, scene: &str, texts: &[String]) -> Result<Vec<Entry>, Failure> {
        let mut entries: Vec<Entry> = Vec::new();
        for text in texts {
            let entry = self.entry(scene, text).map_err(|reason| format!("entry '{text}': {reason}"))?;
            if entries.iter().any(|other| other.text == entry.text) {
                return Err(format!("entry '{text}': named twice").into());
            }
            let taken = |name: &str| entries.iter().any(|other| other.file.eq_ignore_ascii_case(name));
            let names =
                std::iter::once(entry.file.clone()).chain((2..).map(|number| format!("{}-{number}", entry.file)));
            let file = names.into_iter().find(|name| !taken(name)).unwrap_or_default();
            entries.push(Entry { file, ..entry });
        }
        Ok(entries)
    }

    fn entry(&self, scene: &str, text: &str) -> Result<Entry, String> {
        let (name, options) = split(text)?;
        let mut words = vec![format!("--estimator={name}")];
        words.extend(options.iter().map(|(option, value)| match value {
            Some(value) => format!("--{option}={value}"),
            None => format!("--{option}"),
        }));
        let arguments = self.with(scene, &words).map_err(|error| one_line(&error))?;
        let file = text.chars().map(|c| if c.is_alphanumeric() || ".-".contains(c) { c } else { '-' }).collect();
        Ok(Entry { text: text.to_owned(), file, arguments })
    }

    fn with(&self, scene: &str, words: &[String]) -> Result<RenderArguments, clap::Error> {
        let all = std::iter::once(OsString::from(scene)).chain(self.0.iter().cloned());
        let matches = render_command().try_get_matches_from(all.chain(words.iter().map(OsString::from)))?;
        let arguments = RenderArguments::from_arg_matches(&matches)?;
        idle::check(&matches, &arguments)?;
        Ok(arguments)
    }
}

/// The name of an entry, and its options with their values.
type Split<'a> = (&'a str, Vec<(String, Option<String>)>);

/// Takes `NAME[:OPTION[=VALUE]]*` apart. Values may have colons in them (`shadow-rays=sampled:2`): what follows one is an option only
/// if it is called like one.
fn split(text: &str) -> Result<Split<'_>, String> {
    let command = render_command();
    let mut parts = text.split(':');
    let name = parts.next().unwrap_or_default();
    if name.is_empty() {
        return Err("it has no name of an estimator".to_owned());
    }
    let mut options: Vec<(String, Option<String>)> = Vec::new();
    for part in parts {
        let (option, value) = part.split_once('=').map_or((part, None), |(option, value)| (option, Some(value)));
        let known = command.get_arguments().find(|argument| argument.get_long() == Some(option));
        match (known, options.last_mut()) {
            (Some(argument), _) => {
                let id = argument.get_id().as_str();
                if NOT_HERE.contains(&id) {
                    return Err(format!("--{option} has no place here"));
                }
                if FOR_ALL.contains(&id) {
                    return Err(format!("--{option} is the same for all entries: give it to compare itself"));
                }
                options.push((option.to_owned(), value.map(str::to_owned)));
            }
            (None, Some((_, Some(before)))) if value.is_none() => {
                before.push(':');
                before.push_str(part);
            }
            _ => return Err(format!("render has no option --{option}")),
        }
    }
    Ok((name, options))
}

/// The reason that clap gives, with the values that are possible.
fn one_line(error: &clap::Error) -> String {
    let text = error.to_string();
    let mut lines = text.lines().map(str::trim).take_while(|line| !line.starts_with("Usage"));
    let reason = lines.next().unwrap_or_default();
    let reason = reason.strip_prefix("error: ").unwrap_or(reason);
    match lines.find(|line| line.starts_with("[possible values")) {
        Some(values) => format!("{reason} {values}"),
        None => reason.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;
    use crate::choices::AnyHeuristic;
    use crate::program::{Arguments, EstimatorName};

    fn entries(options: &[&str], entries: &str) -> Result<Vec<Entry>, String> {
        let line =
            ["lichtwerk", "compare", "furnace", "--estimators", entries].into_iter().chain(options.iter().copied());
        let arguments = Arguments::try_parse_from(line).map_err(|error| one_line(&error))?;
        let Some(crate::program::Command::Compare(arguments)) = arguments.command else { panic!("another command") };
        arguments.options.entries(&arguments.scene, &arguments.estimators).map_err(|error| error.to_string())
    }

    #[test]
    fn entries_are_names_with_options_of_render() {
        let found = entries(
            &["--max-depth", "-1", "--size", "4x4", "--heuristic", "maximum", "--filter", "gaussian", "-D", "a=b"],
            "path,bdpt:heuristic=balance:without-lens,robust-igi:threshold=0.3:shadow-rays=sampled:2:gather=1,path:filter=psf",
        )
        .unwrap();
        let [path, bdpt, igi, filtered] = &found[..] else { panic!("{found:?}") };
        assert_eq!((path.arguments.estimator, path.arguments.heuristic), (EstimatorName::Path, AnyHeuristic::Maximum));
        assert_eq!((bdpt.arguments.estimator, bdpt.arguments.heuristic), (EstimatorName::Bdpt, AnyHeuristic::Balance));
        assert!(bdpt.arguments.light_paths.without_lens && !path.arguments.light_paths.without_lens);
        assert_eq!(igi.arguments.light_paths.gather, 1);
        assert!(format!("{:?}", igi.arguments.light_paths.shadow_rays).contains('2'));
        assert_eq!(filtered.arguments.filter.len(), 2, "the one of all, and its own");
        for entry in &found {
            assert_eq!((entry.arguments.size, entry.arguments.max_depth), (Some([4, 4]), Some(u32::MAX)));
            assert_eq!(entry.arguments.definitions, [("a".to_owned(), "b".to_owned())]);
        }
        assert_eq!(bdpt.file, "bdpt-heuristic-balance-without-lens");
    }

    #[test]
    fn errors_name_the_entry_and_what_is_wrong() {
        for (bad, reason) in [
            (
                "path,magic",
                "entry 'magic': invalid value 'magic' for '--estimator <ESTIMATOR>' [possible values: path,",
            ),
            ("bdpt:heuristic=best", "entry 'bdpt:heuristic=best': invalid value 'best' for '--heuristic"),
            ("path:colour=red", "entry 'path:colour=red': render has no option --colour"),
            ("path:heuristic=power:colour=red", "render has no option --colour"),
            ("path:without-lens=yes", "without-lens"),
            ("path:heuristic", "a value is required"),
            ("path:spp=4", "--spp is the same for all entries"),
            ("path:out=a.png", "--out has no place here"),
            ("path:estimator=bdpt", "--estimator has no place here"),
            (":spp=4", "no name"),
            ("path,", "no name"),
            ("path,bdpt,path", "entry 'path': named twice"),
            ("robust-igi:threshold=-1", "expected a number that is not negative, as in 100"),
            ("robust-igi:light-paths=few", "expected a whole number from 1 to 16777216, as in 32"),
            ("path:lights=ris:direct=nee", "--lights ris stands for --direct ris, and contradicts --direct nee"),
        ] {
            let message = entries(&[], bad).unwrap_err();
            assert!(message.contains(reason), "'{bad}': '{message}' does not say '{reason}'");
            assert_eq!(message.lines().count(), 1, "{message}");
        }
    }

    #[test]
    fn options_that_are_not_for_comparisons_are_not_offered() {
        for bad in [
            &["--stats", "a.json"][..],
            &["--estimator", "path"],
            &["--continue", "a.exr"],
            &["--spp", "4", "--time", "1"],
        ] {
            assert!(entries(bad, "path").is_err(), "{bad:?}");
        }
    }

    #[test]
    fn files_of_different_entries_differ() {
        let found =
            entries(&[], "path:heuristic=power,path:heuristic=balance,path:rr-depth=3,path:rr-depth=3:rr-depth=3")
                .unwrap();
        let mut files: Vec<_> = found.iter().map(|entry| entry.file.clone()).collect();
        files.dedup();
        assert_eq!(files.len(), 4);
        let options = RenderOptions::default();
        // Both would be called the same.
        let found = options.entries("furnace", &["path:max-depth=-1".into(), "path:max-depth=1".into()]).unwrap();
        assert_ne!(found[0].file, found[1].file);
    }
}
