//! The program as a user runs it.
#![allow(dead_code, clippy::unwrap_used)]

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use scene_core::film::LayeredImage;

/// The program in a folder.
pub(crate) fn lichtwerk(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lichtwerk"));
    command.args(arguments).current_dir(folder).stdin(Stdio::null());
    command
}

/// Runs it to its end.
pub(crate) fn run(folder: &Path, arguments: &[&str]) -> Output {
    lichtwerk(folder, arguments).output().unwrap()
}

/// What it wrote.
pub(crate) fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

/// Runs what must succeed without a word of complaint; returns what it says.
pub(crate) fn answer(folder: &Path, arguments: &[&str]) -> String {
    let output = run(folder, arguments);
    assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), ""), "{arguments:?}");
    text(&output.stdout).to_owned()
}

/// Runs what must succeed in silence.
pub(crate) fn succeeds(folder: &Path, arguments: &[&str]) {
    assert_eq!(answer(folder, arguments), "", "{arguments:?}");
}

/// Runs what must fail with one line that holds all `reasons`.
pub(crate) fn fails(folder: &Path, arguments: &[&str], reasons: &[&str]) {
    let output = run(folder, arguments);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {message}");
    assert!(message.starts_with("error: ") && message.lines().count() == 1, "{arguments:?}: {message}");
    for reason in reasons {
        assert!(message.contains(reason), "{arguments:?}: '{message}' does not say '{reason}'");
    }
    assert_eq!(text(&output.stdout), "", "{arguments:?}");
}

/// The names in a folder, in order.
pub(crate) fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// An image file.
pub(crate) fn image(folder: &Path, name: &str) -> LayeredImage {
    LayeredImage::read_exr(&folder.join(name)).unwrap()
}

/// Same channels, bit for bit, and the same settings.
pub(crate) fn assert_same_image(folder: &Path, one: &str, other: &str) {
    let (a, b) = (image(folder, one), image(folder, other));
    assert_eq!(a.channels().count(), b.channels().count(), "{one}, {other}");
    for (name, values) in a.channels() {
        let bits = |values: &[f32]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert!(bits(values) == bits(b.channel(name).unwrap()), "{one} and {other} differ in {name}");
    }
    assert_eq!(a.attributes().collect::<Vec<_>>(), b.attributes().collect::<Vec<_>>(), "{one}, {other}");
}
