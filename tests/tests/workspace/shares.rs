//! The table of shares is complete: no suite is missing, none has another share.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use estimator_checks::FALSE_POSITIVE_RATE;
use lichtwerk_tests::shares::SHARES;

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() && path.file_name().is_some_and(|name| name != "target") {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// The arguments of all calls of `function` outside of comments.
fn calls(text: &str, function: &str) -> Vec<Vec<String>> {
    let code: String =
        text.lines().filter(|line| !line.trim_start().starts_with("//")).flat_map(|line| [line, "\n"]).collect();
    let mut found = Vec::new();
    for (start, _) in code.match_indices(function) {
        let (mut depth, mut quoted, mut arguments) = (1, false, vec![String::new()]);
        for c in code[start + function.len()..].chars() {
            match c {
                '"' => quoted = !quoted,
                '(' | '[' if !quoted => depth += 1,
                ')' | ']' if !quoted => depth -= 1,
                _ => {}
            }
            match c {
                _ if depth == 0 => break,
                ',' if depth == 1 && !quoted => arguments.push(String::new()),
                _ => arguments.last_mut().unwrap().push(c),
            }
        }
        found.push(arguments.iter().map(|argument| argument.trim().to_owned()).filter(|a| !a.is_empty()).collect());
    }
    found
}

/// A product or quotient of numbers and the whole rate.
fn value(expression: &str) -> Option<f64> {
    let number = |text: &str| match text.trim() {
        text if text.rsplit("::").next() == Some("FALSE_POSITIVE_RATE") => Some(FALSE_POSITIVE_RATE),
        text => text.replace('_', "").parse().ok(),
    };
    if let Some((a, b)) = expression.split_once('*') {
        return Some(number(a)? * number(b)?);
    }
    match expression.split_once('/') {
        Some((a, b)) => Some(number(a)? / number(b)?),
        None => number(expression),
    }
}

#[test]
fn every_suite_is_in_the_table_with_its_share() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let mut files = Vec::new();
    for folder in ["crates", "examples", "tests", "benches"] {
        sources(&root.join(folder), &mut files);
    }
    // The suites in the harness's own sources, and those of example programs, are no part of the workspace's suite; this
    // file only looks like it.
    let others = ["crates/estimator-checks/src", "examples/examples", "tests/tests/workspace/shares.rs"]
        .map(|path| root.join(path));
    files.retain(|file| !others.iter().any(|other| file.starts_with(other)));
    assert!(files.len() > 50, "{} source files below {}", files.len(), root.display());

    let mut found = BTreeMap::new();
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        let whole = calls(&text, "Suite::new(").into_iter().map(|mut arguments| {
            arguments.push("FALSE_POSITIVE_RATE".to_owned());
            arguments
        });
        for arguments in whole.chain(calls(&text, "Suite::with_share(")) {
            let place = format!("{}: {arguments:?}", file.display());
            assert_eq!(arguments.len(), 3, "{place}");
            let share = value(&arguments[2]).unwrap_or_else(|| panic!("{place}: write the share as a number"));
            let name = arguments[0].trim_matches('"').to_owned();
            assert_eq!(found.insert(name, share), None, "{place}: two suites of this name");
        }
    }
    let table: BTreeMap<String, f64> = SHARES.iter().map(|(name, share)| ((*name).to_owned(), *share)).collect();
    assert_eq!(table.len(), SHARES.len(), "a name stands twice in the table");
    assert_eq!(found.keys().collect::<Vec<_>>(), table.keys().collect::<Vec<_>>(), "suites found, and in the table");
    for (name, share) in &found {
        assert!((share / table[name] - 1.0).abs() < 1e-9, "{name}: {share:e} is not {:e}", table[name]);
    }
}

#[test]
fn suites_are_found_in_any_layout() {
    let text = "// Suite::new(\"comment\", 1)\nstatic A: Suite =\n  Suite::with_share(\n  \"a, (b\",\n  f(1, 2),\n  R / 10.0,\n);";
    assert_eq!(calls(text, "Suite::with_share("), [["\"a, (b\"", "f(1, 2)", "R / 10.0"]]);
    assert!(calls(text, "Suite::new(").is_empty());
    assert_eq!(value("FALSE_POSITIVE_RATE / 10.0"), Some(FALSE_POSITIVE_RATE / 10.0));
    assert_eq!(value("0.5 * estimator_checks::FALSE_POSITIVE_RATE"), Some(0.5 * FALSE_POSITIVE_RATE));
    assert_eq!(value("1e-7"), Some(1e-7));
    assert_eq!(value("SHARE"), None);
}
