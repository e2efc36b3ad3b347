//! `lichtwerk compare` from end to end.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod command;
mod signals;

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use command::{answer, fails, lichtwerk, names, text};
use lichtwerk::experiments::Report;

/// A comparison of a few pixels.
const TINY: [&str; 8] = ["compare", "cornell-box", "--size", "8x6", "--spp", "4", "--max-depth", "3"];

/// That comparison with more arguments.
fn tiny<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&TINY, more].concat()
}

fn report(path: &Path) -> Report {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

#[test]
fn a_page_a_report_and_pictures_are_written_and_the_reference_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let arguments = ["--estimators", "path,bdpt:heuristic=balance", "--trials", "2", "--reference-spp", "16"];
    let first = answer(folder, &tiny(&arguments));
    assert!(first.contains("16 samples per pixel") && first.contains("rendered now"), "{first}");
    let out = folder.join("out/compare-cornell-box");
    assert_eq!(names(&out), ["bdpt-heuristic-balance.png", "path.png", "report.html", "report.json"]);
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    // The reference, two means, two maps of each kind, three auxiliary ones.
    assert_eq!(page.matches("<script class=\"pixels\"").count(), 10);
    assert!(page.contains("<svg") && page.contains("bdpt<wbr>:heuristic=balance") && page.ends_with("</html>"));
    assert!(page.contains("1 light path of its own for each sample"), "bdpt is the classical form");
    assert!(page.contains("of each of these errors is the reference's own") && page.contains("% of the smallest one"));
    let found = report(&out.join("report.json"));
    assert_eq!(found.experiment, "compare-cornell-box");
    let rows: Vec<(&str, &serde_json::Value)> =
        found.rows.iter().map(|row| (row.estimator.as_str(), &row.params["spp"])).collect();
    let [one, four] = [1.0, 4.0].map(serde_json::Value::from);
    let bdpt = "bdpt:heuristic=balance";
    assert_eq!(rows, [("path", &one), ("path", &four), (bdpt, &one), (bdpt, &four)]);
    assert!(found.rows.iter().all(|row| row.rays > 0 && row.rel_mse > 0.0 && row.variance > 0.0));

    // The same reference and the same seeds: the same numbers, but for the time.
    let cached = folder.join("out/references");
    let [file] = &names(&cached)[..] else { panic!("{:?}", names(&cached)) };
    let bytes = fs::read(cached.join(file)).unwrap();
    let second = answer(folder, &tiny(&[&arguments[..], &["--out", "second"]].concat()));
    assert!(second.contains("reused"), "{second}");
    assert_eq!(fs::read(cached.join(file)).unwrap(), bytes);
    let again = report(&folder.join("second/report.json"));
    for (one, other) in found.rows.iter().zip(&again.rows) {
        assert_eq!((one.rel_mse, one.variance, one.rays), (other.rel_mse, other.variance, other.rays));
    }

    // The user's own reference, and one estimator only.
    let path = format!("out/references/{file}");
    let own = ["--estimators", "path", "--trials", "1", "--reference", &path, "--out", "third"];
    assert!(answer(folder, &tiny(&own)).contains(&path));
    assert_eq!(names(&folder.join("third")), ["path.png", "report.html", "report.json"]);
}

#[test]
fn errors_come_before_rendering_and_name_the_entry() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("file"), "").unwrap();
    for (arguments, reasons) in [
        (&["--estimators", "path,magic:threshold=1"][..], &["entry 'magic:threshold=1'", "invalid value 'magic'"][..]),
        (&["--estimators", "path:colour=red"], &["entry 'path:colour=red'", "no option --colour"]),
        (&["--estimators", "path,path"], &["entry 'path'", "named twice"]),
        (&["--estimators", "ao"], &["entry 'ao'", "--reference"]),
        (&["--estimators", "path:filter=box:filter=tent"], &["entry 'path:filter=box:filter=tent'", "one of box"]),
        (&["--estimators", "path", "--reference", "none.exr"], &["none.exr"]),
        (&["--estimators", "path", "--out", "file/out"], &["file/out"]),
        (&["--estimators", "path", "--cache", "file/cache"], &["file/cache"]),
    ] {
        fails(folder, &tiny(arguments), reasons);
        assert!(!folder.join("out/references").exists(), "{arguments:?}");
    }
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_what_was_measured() {
    if signals::interrupts_are_ignored() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["--estimators", "path", "--trials", "1000", "--reference-spp", "16", "--out", "out"];
    let arguments = [&["compare", "cornell-box", "--size", "8x6", "--time", "4"][..], &arguments].concat();
    let child = lichtwerk(folder.path(), &arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // The first rendering takes a quarter of a second, and all of them an hour. The cache tells that the first one has begun.
    while !folder.path().join("out/references").exists() {
        std::thread::sleep(Duration::from_millis(10));
    }
    std::thread::sleep(Duration::from_secs(2));
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(text(&output.stderr).starts_with("interrupted"), "{}", text(&output.stderr));
    let page = fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    assert!(page.contains(" of 1000 trials were begun"));
    assert!(!report(&folder.path().join("out/report.json")).rows.is_empty());
}
