//! Values of options: whoever mistypes one is told what was expected, with an example.

use std::fmt::{Display, LowerExp};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::ValueEnum;
use clap::builder::{PathBufValueParser, TypedValueParser};

use crate::output::ImageFormat;

/// What numbers of the command line have in common.
pub(crate) trait Number: FromStr + Display + PartialOrd + Copy + Send + Sync + 'static {}

impl<T: FromStr + Display + PartialOrd + Copy + Send + Sync + 'static> Number for T {}

/// Whole numbers of a range.
pub(crate) fn whole<T: Number>(
    range: RangeInclusive<T>,
    example: T,
) -> impl Fn(&str) -> Result<T, String> + Clone + Send + Sync + 'static {
    let expected = format!("expected a whole number from {} to {}, as in {example}", range.start(), range.end());
    one_of(expected, move |number| range.contains(number))
}

/// Numbers of a range.
pub(crate) fn real<T: Number + LowerExp>(
    range: RangeInclusive<T>,
    example: T,
) -> impl Fn(&str) -> Result<T, String> + Clone + Send + Sync + 'static {
    let [from, to, example] = [*range.start(), *range.end(), example].map(short);
    one_of(format!("expected a number from {from} to {to}, as in {example}"), move |number| range.contains(number))
}

/// Numbers for which this holds.
pub(crate) fn real_where<T: Number>(
    what: &'static str,
    example: T,
    holds: fn(&T) -> bool,
) -> impl Fn(&str) -> Result<T, String> + Clone + Send + Sync + 'static {
    one_of(format!("expected {what}, as in {example}"), holds)
}

/// Without a row of zeros.
fn short(number: impl Display + LowerExp) -> String {
    Some(number.to_string()).filter(|text| text.len() < 8).unwrap_or_else(|| format!("{number:e}"))
}

/// Positive numbers that are finite.
pub(crate) fn positive(example: f64) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync + 'static {
    real_where("a positive number", example, |number| *number > 0.0 && number.is_finite())
}

/// Numbers from zero that are finite.
pub(crate) fn not_negative(example: f32) -> impl Fn(&str) -> Result<f32, String> + Clone + Send + Sync + 'static {
    real_where("a number that is not negative", example, |number| *number >= 0.0 && number.is_finite())
}

/// Exposures, in stops.
pub(crate) fn stops(text: &str) -> Result<f32, String> {
    real(-100.0..=100.0, -1.5)(text)
}

fn one_of<T: Number>(
    expected: String,
    holds: impl Fn(&T) -> bool + Clone + Send + Sync + 'static,
) -> impl Fn(&str) -> Result<T, String> + Clone + Send + Sync + 'static {
    // Neither `invalid digit found in string` nor the name of a type helps anybody.
    move |text: &str| text.trim().parse().ok().filter(&holds).ok_or_else(|| expected.clone())
}

/// Folders, which nothing is written into yet. A name of an image is taken for a mistake, unless there is such a folder.
pub(crate) fn folder() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| match ImageFormat::of(&path) {
        Ok(_) if !path.is_dir() => {
            Err(format!("expected a folder, as in {}; the program names the files in it", stem(&path)))
        }
        _ => Ok(path),
    })
}

/// The folder that was meant, perhaps.
fn stem(path: &Path) -> String {
    let mut path = path.to_owned();
    while ImageFormat::of(&path).is_ok() {
        path.set_extension("");
    }
    path.display().to_string()
}

/// The name of a value on the command line.
pub(crate) fn name_of(value: impl ValueEnum) -> String {
    value.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_none_is_told_what_was_expected() {
        let spp = whole(1..=100u64, 64);
        assert_eq!((spp("1"), spp(" 100 ")), (Ok(1), Ok(100)));
        for wrong in ["", "0", "101", "-1", "1.5", "1e1", "x", "99999999999999999999"] {
            assert_eq!(spp(wrong).unwrap_err(), "expected a whole number from 1 to 100, as in 64", "{wrong}");
        }
        let cosine = real(-1.0..=1.0f32, 0.95);
        assert_eq!(cosine("-0.5"), Ok(-0.5));
        for wrong in ["", "nan", "inf", "1.01", "0,5"] {
            assert_eq!(cosine(wrong).unwrap_err(), "expected a number from -1 to 1, as in 0.95", "{wrong}");
        }
        for wrong in ["0", "-1", "inf", "nan", ""] {
            assert_eq!(positive(0.5)(wrong).unwrap_err(), "expected a positive number, as in 0.5", "{wrong}");
        }
        assert_eq!(real(1e-12..=1e15, 0.5)("0").unwrap_err(), "expected a number from 1e-12 to 1e15, as in 0.5");
        assert!(not_negative(3.0)("0") == Ok(0.0) && not_negative(3.0)("-0.1").is_err());
        assert!(stops("-1.5") == Ok(-1.5) && ["nan", "inf", "bright"].iter().all(|wrong| stops(wrong).is_err()));
    }

    #[test]
    fn images_are_no_folders() {
        let command = clap::Command::new("a").arg(clap::Arg::new("out").value_parser(folder()));
        let parse = |name: &str| {
            let matches = command.clone().try_get_matches_from(["a", name]).map_err(|error| error.to_string());
            matches.map(|matches| matches.get_one::<PathBuf>("out").unwrap().clone())
        };
        assert_eq!(parse("out/x"), Ok("out/x".into()));
        assert_eq!(parse("v1.2"), Ok("v1.2".into()));
        for wrong in ["out/x.png", "x.EXR"] {
            let message = parse(wrong).unwrap_err();
            assert!(message.contains("expected a folder, as in ") && message.contains(wrong), "{message}");
        }
        assert!(parse("out/x.exr.png").unwrap_err().contains("expected a folder, as in out/x;"));
        let parent = tempfile::tempdir().unwrap();
        let odd = parent.path().join("odd.png");
        std::fs::create_dir(&odd).unwrap();
        assert_eq!(parse(odd.to_str().unwrap()), Ok(odd));
    }
}
