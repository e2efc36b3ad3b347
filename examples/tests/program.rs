//! The `lichtwerk` program from end to end.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod command;
mod signals;

use std::fs;
use std::io::Read;
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

use command::{answer, assert_same_image, fails, image, lichtwerk, names, run, succeeds, text};
use lichtwerk::experiments::{EXPERIMENTS, Experiment};
use lichtwerk::output::{Checkpoint, save_image};
use scene_core::film::LayeredImage;
use tempfile::TempDir;

/// The least rendering: a few pixels of the Cornell box.
fn tiny<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&["render", "cornell-box", "--size", "8x6", "--spp", "1"], more].concat()
}

/// A Mitsuba file with a camera, and `content` from the third line.
fn scene_file(folder: &Path, name: &str, content: &str) {
    let head = "<scene version=\"3.0.0\">\n<sensor type=\"perspective\"/>\n";
    fs::write(folder.join(name), format!("{head}{content}\n</scene>\n")).unwrap();
}

/// Width and height that the header of a PNG file states.
fn png_size(path: &Path) -> [u32; 2] {
    let bytes = fs::read(path).unwrap();
    assert_eq!(&bytes[..8], b"\x89PNG\r\n\x1a\n");
    assert!(bytes.ends_with(b"IEND\xaeB`\x82"));
    [16, 20].map(|at| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap()))
}

#[test]
fn list_names_what_can_be_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(folder.path(), &["list"]);
    assert!(output.status.success() && output.stderr.is_empty());
    for name in [
        "cornell-box",
        "furnace",
        "interior",
        "office",
        "conference",
        "plane-light",
        "plane-point",
        "path",
        "light",
        "direct",
        "ao",
        "robust-igi",
        "instant-radiosity",
        "bdpt",
        "balance",
        "stratification",
        "strata",
        "sobol",
        "gaussian",
        "samplers",
    ] {
        assert!(text(&output.stdout).lines().any(|line| line.trim_start().starts_with(name)), "{name}");
    }
    assert!(names(folder.path()).is_empty());
}

#[test]
fn render_writes_images_and_stats_and_says_nothing_in_a_pipe() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    for estimator in ["path", "light", "direct", "ao", "robust-igi", "instant-radiosity", "bdpt"] {
        let more =
            ["--estimator", estimator, "--out", "a.exr", "--out", "a.png", "--stats", "a.json", "--threads", "2"];
        succeeds(folder.path(), &tiny(&more));
        assert_eq!(names(folder.path()), ["a.exr", "a.json", "a.png"]);
        assert_eq!(png_size(&path("a.png")), [8, 6]);

        let image = LayeredImage::read_exr(&path("a.exr")).unwrap();
        assert_eq!((image.width(), image.height()), (8, 6));
        for channel in ["R", "G", "B", "Albedo.R", "N.X", "Z", "Variance.R"] {
            assert!(image.channel(channel).is_some(), "{channel}");
        }
        assert!(image.rgb().unwrap().iter().flatten().sum::<f32>() > 0.0);

        let stats: serde_json::Value = serde_json::from_slice(&fs::read(path("a.json")).unwrap()).unwrap();
        let mut keys: Vec<_> = stats.as_object().unwrap().keys().map(String::as_str).collect();
        keys.sort_unstable();
        let mut documented = [
            ["scene", "estimator", "width", "height"],
            ["spp", "threads", "load_seconds", "render_seconds"],
            ["paths", "closest_hit_rays", "visibility_rays", "peak_bytes"],
        ]
        .concat();
        documented.extend(["ranks", "gathered_bytes", "received_bytes"]);
        documented.extend([
            "heuristic",
            "lights",
            "sampler",
            "seed",
            "max_depth",
            "path_filter",
            "details",
            "renderer",
        ]);
        documented.sort_unstable();
        assert_eq!(keys, documented);
        assert_eq!((&stats["scene"], &stats["estimator"]), (&"cornell-box".into(), &estimator.into()));
        assert_eq!((&stats["width"], &stats["height"], &stats["spp"]), (&8.into(), &6.into(), &1.into()));
        assert_eq!(stats["threads"], 2);
        for (key, attribute) in [("heuristic", "heuristic"), ("sampler", "sampler"), ("renderer", "renderer")] {
            assert_eq!(stats[key].as_str(), image.attribute(attribute).map(ToString::to_string).as_deref(), "{key}");
        }
        assert_eq!((&stats["seed"], &stats["max_depth"], &stats["lights"]), (&0.into(), &(-1).into(), &"power".into()));
        // Light paths whose splats are on the film count: as many as there are samples.
        let light_paths = match estimator {
            "light" | "bdpt" => 48,
            _ => 0,
        };
        assert_eq!(stats["paths"], 48 + light_paths);
        assert!(stats["closest_hit_rays"].as_u64().unwrap() >= 48);
        assert!(stats["load_seconds"].as_f64().unwrap() > 0.0 && stats["render_seconds"].as_f64().unwrap() > 0.0);
    }
}

/// What was asked for is in the numbers, which may go to standard output.
#[test]
fn stats_tell_the_settings_in_a_pipe_too() {
    let folder = tempfile::tempdir().unwrap();
    let settings = ["--heuristic", "balance", "--sampler", "lattice", "--seed", "18446744073709551615"];
    let more = ["--max-depth", "3", "--lights", "uniform", "--out", "a.exr", "--stats", "-"];
    let stats: serde_json::Value =
        serde_json::from_str(&answer(folder.path(), &tiny(&[&settings[..], &more].concat()))).unwrap();
    assert_eq!((&stats["heuristic"], &stats["sampler"]), (&"balance".into(), &"lattice".into()));
    assert_eq!((&stats["seed"], &stats["max_depth"]), (&u64::MAX.into(), &3.into()));
    assert_eq!((&stats["lights"], &stats["path_filter"]), (&"uniform".into(), &serde_json::Value::Null));
    assert_eq!(stats["details"], serde_json::json!({ "rrDepth": "5" }));
    let filtered = answer(folder.path(), &tiny(&["--filter", "psf", "--out", "b.exr", "--stats", "-"]));
    let filtered: serde_json::Value = serde_json::from_str(&filtered).unwrap();
    assert!(filtered["path_filter"].as_str().unwrap().starts_with("Psf "), "{filtered}");
    let numbers = answer(folder.path(), &["diff", "a.exr", "b.exr", "--json", "-"]);
    assert!(serde_json::from_str::<serde_json::Value>(&numbers).unwrap()["mse"].as_f64().unwrap() > 0.0);
    assert_eq!(names(folder.path()), ["a.exr", "b.exr"]);
}

#[test]
fn without_a_name_images_go_to_out() {
    let folder = tempfile::tempdir().unwrap();
    succeeds(folder.path(), &tiny(&[]));
    assert_eq!(names(&folder.path().join("out")), ["cornell-box.exr", "cornell-box.png"]);
}

#[test]
fn the_command_line_fixes_the_image() {
    let folder = tempfile::tempdir().unwrap();
    let pixels = |name: &str, more: &[&str]| {
        succeeds(folder.path(), &tiny(&[&["--out", name], more].concat()));
        LayeredImage::read_exr(&folder.path().join(name)).unwrap().rgb().unwrap()
    };
    let first = pixels("a.exr", &["--threads", "1"]);
    assert_eq!(first, pixels("b.exr", &["--threads", "3"]));
    assert_ne!(first, pixels("c.exr", &["--seed", "1"]));
    assert_ne!(first, pixels("d.exr", &["--max-depth", "2"]));
    assert_eq!(pixels("e.exr", &["--estimator", "direct"]), pixels("d.exr", &["--max-depth", "2"]));
}

/// No time, no name, no order of chance is in a file: the same command writes the same bytes.
#[test]
fn the_command_line_fixes_the_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = |more: &[&str]| {
        succeeds(folder.path(), &tiny(&[&["--out", "a.exr", "--out", "a.png"], more].concat()));
        ["a.exr", "a.png"].map(|name| fs::read(folder.path().join(name)).unwrap())
    };
    for estimator in ["path", "light", "sppm"] {
        let first = bytes(&["--estimator", estimator, "--threads", "1"]);
        // Six attributes or more in any order would be the same by chance once in 720 times.
        (0..3).for_each(|_| assert!(bytes(&["--estimator", estimator, "--threads", "2"]) == first, "{estimator}"));
    }
}

/// The options of light paths change the image, and what makes no sense is refused.
#[test]
fn light_paths_have_options() {
    let folder = tempfile::tempdir().unwrap();
    let pixels = |more: &[&str]| {
        succeeds(folder.path(), &tiny(&[&["--out", "a.exr", "--estimator", "robust-igi"], more].concat()));
        LayeredImage::read_exr(&folder.path().join("a.exr")).unwrap().rgb().unwrap()
    };
    let first = pixels(&[]);
    assert_eq!(first, pixels(&["--threads", "1"]));
    for more in [
        &["--threshold", "1"][..],
        &["--threshold", "abs:1e-9"],
        &["--partition", "soft", "--threshold", "1"],
        &["--light-paths", "7"],
        &["--interleave", "none"],
        &["--interleave", "2x5"],
        &["--shadow-rays", "sampled:2"],
        &["--shadow-rays", "ordered:0.5"],
        &["--gather", "2"],
        &["--discontinuity-buffer"],
    ] {
        assert_ne!(first, pixels(more), "{more:?}");
    }
    for (more, reason) in [
        (["--threshold", "-1"], "not negative"),
        (["--threshold", "many"], "many"),
        (["--interleave", "3"], "COLUMNSxROWS"),
        (["--interleave", "0x3"], "COLUMNSxROWS"),
        (["--light-paths", "0"], "0"),
        (["--shadow-rays", "few"], "sampled:N"),
        (["--partition", "none"], "none"),
    ] {
        let output = run(folder.path(), &tiny(&more));
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{more:?}: {message}");
        assert!(message.contains(reason), "{more:?}: '{message}' does not say '{reason}'");
    }
    fails(folder.path(), &tiny(&["--heuristic", "stratification"]), &["whole paths"]);
}

/// The classical form unless told otherwise.
#[test]
fn light_paths_are_shared_by_pixels_only_if_bdpt_is_told_to() {
    let folder = tempfile::tempdir().unwrap();
    let paths = |more: &[&str]| {
        let bdpt = ["--estimator", "bdpt", "--out", "a.exr", "--stats", "a.json"];
        succeeds(folder.path(), &tiny(&[&bdpt[..], more].concat()));
        let stats: serde_json::Value =
            serde_json::from_slice(&fs::read(folder.path().join("a.json")).unwrap()).unwrap();
        (stats["paths"].as_u64().unwrap() - 48, image(folder.path(), "a.exr").rgb().unwrap())
    };
    let usual = paths(&[]);
    assert_eq!(usual, paths(&["--light-paths", "1", "--interleave", "none"]));
    let shared = paths(&["--light-paths", "32", "--interleave", "3x3"]);
    assert_eq!((usual.0, shared.0), (48, 9 * 32));
    assert_ne!(usual.1, shared.1);
    let refused = run(folder.path(), &tiny(&["--lights", "ris", "--direct", "nee"]));
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("contradicts --direct nee"), "{}", text(&refused.stderr));
}

#[test]
fn frames_and_eyes_are_rendered_together() {
    let folder = TempDir::new().unwrap();
    let frames = |more: &[&'static str]| {
        let two = ["frames", "cornell-box", "cornell-box", "--size", "8x6", "--spp", "3", "--max-depth", "2"];
        [&two[..], more].concat()
    };
    succeeds(folder.path(), &frames(&["--stereo", "0.02", "--filter-time", "0.5", "--out", "pairs"]));
    let of = |eye: &str| ["exr", "png"].map(|end| format!("cornell-box-{eye}.{end}"));
    let expected: Vec<String> = ["000-left", "000-right", "001-left", "001-right"].iter().flat_map(|e| of(e)).collect();
    assert_eq!(names(&folder.path().join("pairs")), expected);
    let read = |name: &str| image(folder.path(), name);
    let mean = |name: &str| {
        let rgb = read(name).rgb().unwrap();
        rgb.iter().flatten().sum::<f32>() / rgb.len() as f32
    };
    let told = |name: &str, key: &str| read(name).attribute(key).map(ToString::to_string);
    assert_eq!(told("pairs/cornell-box-001-left.exr", "frame").unwrap(), "cornell-box-001-left");
    assert_eq!(told("pairs/cornell-box-001-left.exr", "maxDepth").unwrap(), "2");
    // The lamp and the boxes are elsewhere for the other eye.
    assert_ne!(read("pairs/cornell-box-000-left.exr").rgb(), read("pairs/cornell-box-000-right.exr").rgb());

    succeeds(folder.path(), &frames(&["--blur", "--filter", "psf-hash", "--out", "blur"]));
    assert_eq!(names(&folder.path().join("blur")), of("blur"));
    succeeds(folder.path(), &frames(&["--out", "each", "--filter", "psf-hash"]));
    let [whole, a, b] = ["blur/cornell-box-blur.exr", "each/cornell-box-000.exr", "each/cornell-box-001.exr"].map(mean);
    assert!((whole / (0.5 * (a + b)) - 1.0).abs() < 1e-4, "{whole} is not the mean of {a} and {b}");
    assert_eq!(read("blur/cornell-box-blur.exr").attribute("spp").and_then(|spp| spp.as_u64()), Some(6));

    fails(folder.path(), &["frames", "cornell-box", "interior"], &["interior", "--size"]);
    fails(folder.path(), &frames(&["--estimator", "light"]), &["path, direct and ao"]);
    fails(folder.path(), &frames(&["--filter", "psf-hash", "--filter-time", "1"]), &["--filter-time"]);
    fails(folder.path(), &frames(&["--filter-extra", "1"]), &["--filter-extra"]);
    fails(folder.path(), &["frames", "no-such-scene"], &["no-such-scene"]);
    for folder_option in [
        &["frames", "cornell-box", "--out", "x.png"][..],
        &["compare", "cornell-box", "--estimators", "path", "--out", "x.png"],
        &["experiment", "samplers", "--out", "x.png"],
        &["showcase", "--out", "x.png"],
    ] {
        let output = run(folder.path(), folder_option);
        assert_eq!(output.status.code(), Some(2), "{folder_option:?}");
        assert!(text(&output.stderr).contains("expected a folder, as in x;"), "{}", text(&output.stderr));
        assert!(!folder.path().join("x.png").exists());
    }
}

#[test]
fn diff_compares_two_images() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    succeeds(folder, &tiny(&["--out", "a.exr"]));
    succeeds(folder, &tiny(&["--out", "b.exr", "--seed", "5"]));
    for (other, same) in [("a.exr", true), ("b.exr", false)] {
        let output = run(folder, &["diff", other, "a.exr", "--json", "diff.json"]);
        assert!(output.status.success() && output.stderr.is_empty(), "{}", text(&output.stderr));
        for metric in ["MSE", "relative MSE", "MRSE", "FLIP", "ratio"] {
            assert!(text(&output.stdout).contains(metric), "{metric}");
        }
        let report: serde_json::Value = serde_json::from_slice(&fs::read(folder.join("diff.json")).unwrap()).unwrap();
        for metric in ["mse", "relative_mse", "mrse", "flip_ldr", "flip_hdr"] {
            assert_eq!(report[metric].as_f64().unwrap() == 0.0, same, "{metric} of {other}");
        }
        assert!(!same || report["mean_ratio"][0] == 1.0);
    }

    succeeds(folder, &["render", "furnace", "--size", "4x4", "--spp", "1", "--out", "small.exr"]);
    fails(folder, &["diff", "a.exr", "small.exr"], &["8x6", "4x4"]);
    fails(folder, &["diff", "a.exr", "missing.exr"], &["missing.exr"]);
    let whole = fs::read(folder.join("a.exr")).unwrap();
    fs::write(folder.join("half.exr"), &whole[..whole.len() / 2]).unwrap();
    fails(folder, &["diff", "half.exr", "a.exr"], &["half.exr"]);
}

#[test]
fn the_showcase_fills_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(folder.path(), &["showcase", "--out", "new/show", "--spp", "1", "--size", "16x9"]);
    assert!(output.status.success() && output.stderr.is_empty(), "{}", text(&output.stderr));
    let found = names(&folder.path().join("new/show"));
    assert!(
        found.iter().any(|name| name.ends_with(".exr")) && found.iter().any(|name| name.ends_with(".png")),
        "{found:?}"
    );
    for heading in ["seconds", "rays", "error", "efficiency"] {
        assert!(text(&output.stdout).contains(heading), "{heading}");
    }
    fs::write(folder.path().join("file"), "").unwrap();
    fails(folder.path(), &["showcase", "--out", "file/show", "--spp", "1", "--size", "16x9"], &["file/show"]);
}

#[test]
fn experiments_fail_before_they_start() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fails(folder, &["experiment", "nothing"], &["'nothing'", "lichtwerk list"]);
    fs::write(folder.join("file"), "").unwrap();
    for name in ["samplers", "all"] {
        fails(folder, &["experiment", name, "--quick", "--out", "file/report"], &["file/report"]);
    }
    fs::create_dir_all(folder.join("taken/report.json")).unwrap();
    fails(folder, &["experiment", "samplers", "--quick", "--out", "taken"], &["cannot write taken/report.json"]);
    assert_eq!(names(&folder.join("taken")), ["report.json"]);
}

#[test]
fn every_sampler_renders() {
    let folder = tempfile::tempdir().unwrap();
    let list = run(folder.path(), &["list"]);
    let section = text(&list.stdout).split("samplers (--sampler)\n").nth(1).unwrap().split("\n\n").next().unwrap();
    let samplers: Vec<&str> = section.lines().map(|line| line.split_whitespace().next().unwrap()).collect();
    assert!(samplers.len() >= 6 && samplers.contains(&"global-halton"), "{samplers:?}");
    for sampler in samplers {
        for estimator in ["path", "light"] {
            succeeds(folder.path(), &tiny(&["--sampler", sampler, "--estimator", estimator, "--out", "a.exr"]));
            let image = LayeredImage::read_exr(&folder.path().join("a.exr")).unwrap();
            assert!(image.rgb().unwrap().iter().flatten().sum::<f32>() > 0.0, "{sampler}");
            assert_eq!(image.attribute("sampler"), Some(&sampler.into()));
        }
    }
}

#[test]
fn scenes_that_are_none_have_one_line_reasons() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let render = |scene| ["render", scene, "--size", "8x6", "--spp", "1", "--out", "a.exr"];
    fails(folder, &render("nowhere"), &["'nowhere'", "lichtwerk list"]);
    fails(folder, &render("missing.xml"), &["missing.xml", "No such file"]);
    fails(folder, &render("."), &["."]);
    fs::write(folder.join("scene.txt"), "").unwrap();
    fails(folder, &render("scene.txt"), &["scene.txt", ".xml"]);
    fs::create_dir(folder.join("folder.xml")).unwrap();
    fails(folder, &render("folder.xml"), &["folder.xml"]);

    scene_file(folder, "whole.xml", "<emitter type=\"constant\"/>\n<shape type=\"sphere\"/>");
    succeeds(folder, &render("whole.xml"));
    let whole = fs::read(folder.join("whole.xml")).unwrap();
    fs::write(folder.join("truncated.xml"), &whole[..whole.len() - 20]).unwrap();
    fails(folder, &render("truncated.xml"), &["truncated.xml:"]);
    fs::write(folder.join("bytes.xml"), [0xff, 0xfe, 0x00]).unwrap();
    fails(folder, &render("bytes.xml"), &["bytes.xml"]);

    fs::write(folder.join("nothing.xml"), "<scene version=\"3.0.0\"></scene>").unwrap();
    fails(folder, &render("nothing.xml"), &["no sensor"]);
    scene_file(folder, "empty.xml", "");
    fails(folder, &render("empty.xml"), &["empty.xml", "the scene is empty"]);
    scene_file(folder, "dark.xml", "<shape type=\"sphere\"/>");
    fails(folder, &render("dark.xml"), &["dark.xml", "no light"]);
    scene_file(folder, "plugin.xml", "<shape type=\"sphere\">\n<bsdf type=\"velvet\"/>\n</shape>");
    fails(folder, &render("plugin.xml"), &["plugin.xml:4", "`velvet`"]);
    scene_file(folder, "mesh.xml", "<shape type=\"ply\"><string name=\"filename\" value=\"no.ply\"/></shape>");
    fails(folder, &render("mesh.xml"), &["no.ply"]);
    scene_file(folder, "a.xml", "<include filename=\"b.xml\"/>");
    scene_file(folder, "b.xml", "<include filename=\"a.xml\"/>");
    fails(folder, &render("a.xml"), &["cycle", "b.xml"]);
    let nan = "<emitter type=\"constant\"><rgb name=\"radiance\" value=\"nan 1 1\"/></emitter>";
    scene_file(folder, "nan.xml", nan);
    fails(folder, &render("nan.xml"), &["nan.xml"]);
    fails(folder, &tiny(&["-D", "a=b"]), &["takes no parameters"]);
    assert!(!folder.join("a.exr").exists() || fs::remove_file(folder.join("a.exr")).is_ok());
}

/// A binary PLY mesh of one triangle with these corners and indices.
fn triangle_file(corners: [[f32; 3]; 3], indices: [u32; 3]) -> Vec<u8> {
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
                  property float z\nelement face 1\nproperty list uchar uint vertex_indices\nend_header\n";
    let corners = corners.into_iter().flatten().flat_map(f32::to_le_bytes);
    header.bytes().chain(corners).chain([3]).chain(indices.into_iter().flat_map(u32::to_le_bytes)).collect()
}

#[test]
fn damaged_meshes_and_images_have_one_line_reasons() {
    const CORNERS: [[f32; 3]; 3] = [[-1.0, -1.0, 5.0], [1.0, -1.0, 5.0], [0.0, 1.0, 5.0]];
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let render = |scene| ["render", scene, "--size", "8x6", "--spp", "1", "--out", "a.exr"];
    let lit =
        "<emitter type=\"constant\"/>\n<shape type=\"ply\"><string name=\"filename\" value=\"mesh.ply\"/></shape>";
    scene_file(folder, "mesh.xml", lit);
    let whole = triangle_file(CORNERS, [0, 1, 2]);
    fs::write(folder.join("mesh.ply"), &whole).unwrap();
    succeeds(folder, &render("mesh.xml"));
    for length in [0, 100, whole.len() - 14, whole.len() - 1] {
        fs::write(folder.join("mesh.ply"), &whole[..length]).unwrap();
        fails(folder, &render("mesh.xml"), &["mesh.ply", "mesh.xml:4"]);
    }
    fs::write(folder.join("mesh.ply"), triangle_file(CORNERS, [0, 1, 3])).unwrap();
    fails(folder, &render("mesh.xml"), &["mesh.ply", "vertex 3"]);

    // A triangle with a corner that is no point is left out, and counted.
    fs::write(folder.join("mesh.ply"), triangle_file([[f32::NAN, 0.0, 5.0], CORNERS[1], CORNERS[2]], [0, 1, 2]))
        .unwrap();
    let output = run(folder, &render("mesh.xml"));
    let message = text(&output.stderr);
    assert!(
        output.status.success() && message.starts_with("warning: ") && message.contains("dropped 1 triangles"),
        "{message}"
    );

    succeeds(folder, &tiny(&["--out", "sky.exr"]));
    let sky = fs::read(folder.join("sky.exr")).unwrap();
    let envmap = "<emitter type=\"envmap\"><string name=\"filename\" value=\"sky.exr\"/></emitter>";
    scene_file(folder, "sky.xml", envmap);
    succeeds(folder, &render("sky.xml"));
    for length in [0, 100, sky.len() / 2, sky.len() - 2] {
        fs::write(folder.join("sky.exr"), &sky[..length]).unwrap();
        fails(folder, &render("sky.xml"), &["sky.exr", "sky.xml:3"]);
    }
}

#[test]
fn nonsense_on_the_command_line_is_status_2() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, reason) in [
        (&["--size", "0x8"][..], "at least one pixel"),
        (&["--size", "8"], "WIDTHxHEIGHT"),
        (&["--spp", "99999999999999"], "whole number from 1 to 4294967296, as in 64"),
        (&["--spp", "0"], "whole number from 1 to 4294967296, as in 64"),
        (&["--spp", "-1"], "invalid value '-1' for '--spp <SPP>': expected a whole number"),
        (&["--size", "-8x8"], "unexpected argument '-8'"),
        (&["--time", "-3"], "positive number, as in 60"),
        (&["--max-depth", "0"], "segments"),
        (&["--estimator", "magic"], "possible values: path"),
        (&["--threads", "1000000"], "from 0 to 4096"),
        (&["--exposure", "bright"], "expected a number from -100 to 100, as in -1.5"),
        (&["--filter-radius", "-1"], "expected a number that is not negative, as in 3"),
        (&["--shard", "0/3"], "expected K/N with K from 1 to N, as in 2/8"),
        (&["-D", "spp"], "expected NAME=VALUE, as in spp=16"),
    ] {
        let output = run(folder.path(), &[&["render", "cornell-box"], arguments].concat());
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(reason), "{arguments:?}: {message}");
    }
    let output = run(folder.path(), &["--help"]);
    assert!(output.status.success() && text(&output.stdout).contains("render"));
    for (size, reason) in [("100000x100000", "between 1 and"), ("65536x65536", "too large")] {
        fails(folder.path(), &["render", "cornell-box", "--size", size, "--spp", "1"], &[reason]);
    }
}

#[test]
fn outputs_that_cannot_be_written_are_found_before_rendering() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::create_dir(folder.join("folder.exr")).unwrap();
    // So many samples that rendering first would not end.
    let render = |option, name| ["render", "cornell-box", "--size", "64x64", "--spp", "1000000000", option, name];
    for name in ["no/such/folder.exr", "folder.exr", "/proc/image.exr", "/a.exr/b.png"] {
        fails(folder, &render("--out", name), &["cannot write", name]);
    }
    fails(folder, &render("--stats", "no/stats.json"), &["cannot write", "no/stats.json"]);
    fails(folder, &render("--out", "image.jpeg"), &["image.jpeg", ".exr or .png"]);
    fails(folder, &render("--out", "image"), &["image", ".exr or .png"]);
    assert!(!folder.join("out/cornell-box.exr").exists());
}

/// A file system of 64 KiB, unmounted at the end.
struct SmallDisk(TempDir);

impl SmallDisk {
    fn mount() -> Option<Self> {
        let folder = tempfile::tempdir().unwrap();
        let mount = Command::new("mount").args(["-t", "tmpfs", "-o", "size=64k", "tmpfs"]).arg(folder.path()).output();
        mount.is_ok_and(|output| output.status.success()).then_some(Self(folder))
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(self.0.path()).status();
    }
}

#[test]
fn a_full_disk_leaves_the_old_file() {
    let Some(disk) = SmallDisk::mount() else {
        println!("skipped: this user cannot mount a small file system");
        return;
    };
    let folder = disk.0.path();
    fs::write(folder.join("image.exr"), "old").unwrap();
    fails(
        folder,
        &["render", "furnace", "--size", "160x120", "--spp", "1", "--out", "image.exr"],
        &["cannot write image.exr", "No space left"],
    );
    assert_eq!(fs::read(folder.join("image.exr")).unwrap(), b"old");
    assert_eq!(names(folder), ["image.exr"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_device_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    std::os::unix::fs::symlink("/dev/full", folder.path().join("full.exr")).unwrap();
    fails(folder.path(), &tiny(&["--out", "full.exr"]), &["cannot write full.exr", "No space left"]);
}

/// A rendering without end that shows its image to this test: when data arrives, it is under way.
struct Running {
    child: Child,
    /// Keeps taking what the rendering shows.
    _viewer: std::thread::JoinHandle<()>,
}

fn accept(listener: &TcpListener) -> TcpStream {
    let (mut stream, _) = listener.accept().unwrap();
    stream.read_exact(&mut [0]).unwrap();
    stream
}

impl Running {
    fn start(folder: &Path, more: &[&str]) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let server = listener.local_addr().unwrap().to_string();
        let mut arguments = vec!["render", "cornell-box", "--threads", "2"];
        arguments.extend(more);
        arguments.extend(["--display-server", &server]);
        let child = lichtwerk(folder, &arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut stream = accept(&listener);
        let viewer = std::thread::spawn(move || {
            let mut buffer = vec![0; 1 << 16];
            while stream.read(&mut buffer).is_ok_and(|count| count > 0) {}
        });
        Self { child, _viewer: viewer }
    }

    fn signal(&self, name: &str) {
        assert!(Command::new("kill").args([name, &self.child.id().to_string()]).status().unwrap().success());
    }

    fn wait(self) -> Output {
        self.child.wait_with_output().unwrap()
    }
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_the_image_so_far() {
    if signals::interrupts_are_ignored() {
        return;
    }
    for signal in ["-INT", "-TERM"] {
        let folder = tempfile::tempdir().unwrap();
        let more = ["--size", "64x64", "--spp", "1000000000", "--out", "a.exr", "--out", "a.png", "--stats", "a.json"];
        let running = Running::start(folder.path(), &more);
        running.signal(signal);
        let output = running.wait();
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{signal}: {message}");
        assert!(message.starts_with("interrupted after ") && message.lines().count() == 1, "{message}");
        assert_eq!(names(folder.path()), ["a.exr", "a.json", "a.png"]);
        let image = LayeredImage::read_exr(&folder.path().join("a.exr")).unwrap();
        assert!(image.rgb().unwrap().iter().flatten().all(|value| value.is_finite()));
        let stats: serde_json::Value =
            serde_json::from_slice(&fs::read(folder.path().join("a.json")).unwrap()).unwrap();
        let samples = stats["spp"].as_u64().unwrap();
        assert!((1..1_000_000_000).contains(&samples));
        assert!(message.contains(&format!(" {samples} ")), "{message}");
    }
}

#[cfg(unix)]
#[test]
fn killed_while_rendering_leaves_the_old_file() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.exr"), "old").unwrap();
    let running = Running::start(folder.path(), &["--size", "64x64", "--spp", "1000000000", "--out", "a.exr"]);
    running.signal("-KILL");
    assert_eq!(running.wait().status.code(), None);
    assert_eq!(fs::read(folder.path().join("a.exr")).unwrap(), b"old");
    assert_eq!(names(folder.path()), ["a.exr"], "writing had not begun");
}

#[cfg(unix)]
#[test]
fn killed_at_any_time_leaves_the_old_file_or_the_new_one() {
    let folder = tempfile::tempdir().unwrap();
    let path: PathBuf = folder.path().join("a.exr");
    let (mut old, mut new) = (0, 0);
    for milliseconds in [0, 5, 10, 15, 20, 30, 50, 80] {
        fs::write(&path, "old").unwrap();
        // A large file of a short rendering: there is something to interrupt.
        let running = Running::start(folder.path(), &["--size", "400x400", "--spp", "1", "--out", "a.exr"]);
        std::thread::sleep(Duration::from_millis(milliseconds));
        // It may have ended by itself.
        let _ = Command::new("kill").args(["-KILL", &running.child.id().to_string()]).stderr(Stdio::null()).status();
        running.wait();
        if fs::read(&path).unwrap() == b"old" {
            old += 1;
        } else {
            assert_eq!(LayeredImage::read_exr(&path).unwrap().width(), 400);
            new += 1;
        }
    }
    println!("{old} old, {new} new files");
}

/// Killed without warning, and started again by the same command.
#[cfg(unix)]
#[test]
fn a_killed_rendering_goes_on_from_its_checkpoint() {
    let folder = tempfile::tempdir().unwrap();
    let whole = ["--size", "48x32", "--spp", "3000", "--seed", "5", "--estimator", "light"];
    let running_arguments =
        [&whole[..], &["--checkpoint", "a.part", "--checkpoint-seconds", "0.02", "--out", "a.exr"]].concat();
    let running = Running::start(folder.path(), &running_arguments);
    let part = folder.path().join("a.part");
    while !part.exists() {
        std::thread::sleep(Duration::from_millis(2));
    }
    running.signal("-KILL");
    running.wait();
    let kept = Checkpoint::read(&part).unwrap().described.count();
    assert!((1..3000).contains(&kept), "{kept} samples before it was killed: too few to be of use, or all");

    let again = [&["render", "cornell-box", "--threads", "2"], &running_arguments[..]].concat();
    let output = run(folder.path(), &again);
    assert_eq!(output.status.code(), Some(0));
    assert!(text(&output.stderr).contains(&format!("a.part: {kept} samples per pixel are there")));
    let uninterrupted = [&["render", "cornell-box", "--threads", "1"], &whole[..], &["--out", "b.exr"]].concat();
    succeeds(folder.path(), &uninterrupted);
    assert_same_image(folder.path(), "a.exr", "b.exr");
    // Once more: nothing is left to be done.
    run(folder.path(), &[&again[..], &["--stats", "a.json"]].concat());
    assert_same_image(folder.path(), "a.exr", "b.exr");
    assert_eq!(Checkpoint::read(&part).unwrap().described.samples, [[0, 3000]]);

    fails(folder.path(), &[&again[..], &["--max-depth", "3"]].concat(), &["a.part", "max_depth"]);
    fs::write(&part, "something else").unwrap();
    fails(folder.path(), &again, &["a.part", "not a checkpoint"]);
}

/// Parts of a rendering, in any order, are the rendering: for estimators with and without light paths, shared light paths, progressive
/// photons, a sampler that has to know the number of samples, and batches of a filter.
#[test]
fn shards_are_merged_to_the_whole_bit_for_bit() {
    for (name, more) in [
        ("path", &[][..]),
        ("z-sobol", &["--sampler", "z-sobol"]),
        ("light", &["--estimator", "light"]),
        ("bdpt", &["--estimator", "bdpt"]),
        ("bdpt-shared", &["--estimator", "bdpt", "--light-paths", "3", "--interleave", "3x3"]),
        ("igi", &["--estimator", "robust-igi", "--interleave", "3x3", "--discontinuity-buffer"]),
        ("sppm", &["--estimator", "sppm"]),
        ("photons", &["--estimator", "direct", "--lights", "photons"]),
        ("psf", &["--filter", "psf", "--filter-batch", "4"]),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let scene = ["render", "cornell-box", "--size", "20x14", "--spp", "12", "--seed", "3"];
        let of = |outputs: &[&'static str]| [&scene[..], more, outputs].concat();
        succeeds(folder.path(), &of(&["--out", "whole.exr"]));
        for (shard, part, out) in [("1/3", "1.part", "1.exr"), ("2/3", "2.part", "2.exr"), ("3/3", "3.part", "3.exr")] {
            succeeds(folder.path(), &of(&["--shard", shard, "--checkpoint", part, "--out", out, "--threads", "1"]));
        }
        let merge = ["merge", "3.part", "1.part", "2.part", "--out", "merged.exr", "--checkpoint", "all.part"];
        succeeds(folder.path(), &merge);
        println!("{name}");
        assert_same_image(folder.path(), "whole.exr", "merged.exr");
        assert_eq!(Checkpoint::read(&folder.path().join("all.part")).unwrap().described.samples, [[0, 12]]);

        // From images to rounding.
        if !matches!(name, "igi") {
            succeeds(folder.path(), &["merge", "1.exr", "2.exr", "3.exr", "--out", "rounded.exr"]);
            let [whole, rounded] = ["whole.exr", "rounded.exr"].map(|name| image(folder.path(), name).rgb().unwrap());
            for (a, b) in whole.iter().flatten().zip(rounded.iter().flatten()) {
                assert!((a - b).abs() <= 1e-6 * a.abs().max(1e-3), "{name}: {a} and {b}");
            }
        }
        let twice = run(folder.path(), &["merge", "1.part", "1.part", "--out", "a.exr"]);
        assert!(text(&twice.stderr).contains("samples 0 to 4 are in both"), "{}", text(&twice.stderr));
        let gap = run(folder.path(), &["merge", "1.part", "3.part", "--out", "a.exr"]);
        assert!(text(&gap.stderr).contains("warning: of 12 samples"), "{}", text(&gap.stderr));
    }
}

/// Without the feature `mpi`, processes that a launcher starts would all render the same into the same files.
#[cfg(not(feature = "mpi"))]
#[test]
fn processes_that_cannot_share_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let started = |rank: &str, more: &[&str]| {
        let mut command = lichtwerk(folder.path(), &tiny(more));
        command.envs([("OMPI_COMM_WORLD_SIZE", "2"), ("OMPI_COMM_WORLD_RANK", rank)]).output().unwrap()
    };
    let [first, second] = ["0", "1"].map(|rank| started(rank, &[]));
    assert!(text(&first.stderr).contains("one of 2 processes") && text(&first.stderr).contains("--features mpi"));
    assert_eq!((first.status.code(), second.status.code(), text(&second.stderr)), (Some(1), Some(1), ""));
    assert!(started("1", &["--shard", "1/1", "--checkpoint", "a.part", "--out", "a.exr"]).status.success());
}

#[test]
fn parts_that_make_no_sense_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    fails(folder.path(), &["render", "cornell-box", "--time", "1", "--shard", "1/2"], &["--shard", "--spp"]);
    fails(folder.path(), &["merge", "a.part", "b.exr", "--out", "c.exr"], &["not both"]);
    fails(folder.path(), &["merge", "a.part", "--out", "c.exr"], &["a.part"]);
    fails(folder.path(), &tiny(&["--filter", "psf", "--filter-extra", "1", "--shard", "1/2"]), &["--filter-extra"]);
    fails(folder.path(), &tiny(&["--estimator", "restir-direct", "--checkpoint", "a.part"]), &["restir-direct"]);
    let halves = ["render", "cornell-box", "--size", "8x6", "--spp", "6", "--filter", "psf", "--filter-batch", "4"];
    for shard in ["1/2", "2/2"] {
        let told = ["--spp has to be a multiple of 8", "--filter-batch 4"];
        fails(folder.path(), &[&halves[..], &["--shard", shard]].concat(), &told);
    }
    fails(folder.path(), &["render", "cornell-box", "--spp", "2", "--shard", "1/4"], &["not enough for 4 parts"]);
    for (out, seed) in [("1.part", "1"), ("2.part", "2")] {
        succeeds(folder.path(), &tiny(&["--seed", seed, "--checkpoint", out, "--out", "a.png"]));
    }
    fails(folder.path(), &["merge", "1.part", "2.part", "--out", "a.exr"], &["2.part", "seed: 1", "seed: 2"]);
}

#[test]
fn images_are_merged_once_and_with_their_like() {
    let folder = tempfile::tempdir().unwrap();
    let render = |scene: &str, more: &[&'static str]| {
        let scene = ["render", scene, "--size", "8x6", "--spp", "2"];
        succeeds(folder.path(), &[&scene[..], more].concat());
    };
    render("cornell-box", &["--out", "a.exr"]);
    render("cornell-box", &["--seed", "9", "--out", "b.exr"]);
    render("furnace-box", &["--out", "c.exr"]);
    render("cornell-box", &["--max-depth", "2", "--seed", "9", "--out", "d.exr"]);
    fails(
        folder.path(),
        &["merge", "a.exr", "a.exr", "--out", "e.exr"],
        &["a.exr: its samples 0 to 2", "another image"],
    );
    fails(
        folder.path(),
        &["merge", "a.exr", "c.exr", "--out", "e.exr"],
        &["c.exr: its scene is 'furnace-box'", "a.exr"],
    );
    fails(folder.path(), &["merge", "a.exr", "d.exr", "--out", "e.exr"], &["d.exr: its maxDepth is '2'"]);
    // Forms of one estimator, and what only one of them has.
    render("cornell-box", &["--estimator", "bdpt", "--out", "f.exr"]);
    render("cornell-box", &["--estimator", "bdpt", "--light-paths", "4", "--seed", "9", "--out", "g.exr"]);
    fails(
        folder.path(),
        &["merge", "f.exr", "g.exr", "--out", "e.exr"],
        &["g.exr: its lightPaths is", "light_paths: 4"],
    );
    render("cornell-box", &["--filter", "tent", "--seed", "9", "--out", "h.exr"]);
    fails(folder.path(), &["merge", "h.exr", "a.exr", "--out", "e.exr"], &["a.exr: its reconstruction is 'none'"]);
    render("cornell-box", &["--filter", "psf", "--seed", "9", "--out", "i.exr"]);
    fails(folder.path(), &["merge", "i.exr", "a.exr", "--out", "e.exr"], &["a.exr: its pathFilter is 'none'"]);
    // Images of other programs, or what was made of ours by them.
    let change = |name: &str, change: &dyn Fn(&LayeredImage) -> LayeredImage| {
        save_image(&folder.path().join(name), &change(&image(folder.path(), "b.exr")), 0.0).unwrap();
    };
    let bare = |image: &LayeredImage| {
        let mut bare = LayeredImage::new(image.width(), image.height()).unwrap();
        image.channels().for_each(|(name, values)| bare.set_channel(name, values.to_vec()).unwrap());
        bare
    };
    change("uncounted.exr", &bare);
    change("small.exr", &|_| {
        let mut small = LayeredImage::new(4, 3).unwrap();
        small.set_rgb(&[[0.5; 3]; 12]).unwrap();
        small
    });
    change("more.exr", &|image| {
        let mut more = bare(image);
        more.set_channel("More.Y", vec![0.5; 48]).unwrap();
        more
    });
    for (other, told) in [
        ("uncounted.exr", "uncounted.exr: it does not tell how many samples"),
        ("small.exr", "small.exr: it has 4 x 3 pixels, and a.exr has 8 x 6"),
        ("more.exr", "more.exr: it has a channel 'More.Y', and a.exr has none"),
    ] {
        fails(folder.path(), &["merge", "a.exr", other, "--out", "e.exr"], &[told]);
    }
    fails(folder.path(), &["merge", "a.exr", "b.png", "--out", "e.exr"], &["b.png: of a PNG nothing is left"]);
    fails(folder.path(), &["merge", "more.exr", "a.exr", "--out", "e.exr"], &["a.exr: it has no channel 'More.Y'"]);
    succeeds(folder.path(), &["merge", "a.exr", "b.exr", "--out", "e.exr"]);
    fails(folder.path(), &["merge", "a.exr", "nowhere.exr", "--out", "e.exr"], &["nowhere.exr"]);
}

#[test]
fn a_time_limit_ends_the_rendering() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["render", "cornell-box", "--size", "32x32", "--time", "1", "--out", "a.exr", "--stats", "a.json"];
    succeeds(folder.path(), &arguments);
    let stats: serde_json::Value = serde_json::from_slice(&fs::read(folder.path().join("a.json")).unwrap()).unwrap();
    assert!(stats["spp"].as_u64().unwrap() >= 1);
    assert!(stats["render_seconds"].as_f64().unwrap() > 0.0);
    assert!(LayeredImage::read_exr(&folder.path().join("a.exr")).is_ok());
}

#[test]
fn no_viewer_is_only_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    for server in ["127.0.0.1:1", "nonsense"] {
        let output = run(folder.path(), &tiny(&["--out", "a.exr", "--display-server", server]));
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{message}");
        assert!(message.starts_with("warning: no display at ") && message.lines().count() == 1, "{message}");
        fs::remove_file(folder.path().join("a.exr")).unwrap();
    }
}

#[test]
fn a_closed_pipe_is_no_error() {
    let folder = tempfile::tempdir().unwrap();
    let mut child = lichtwerk(folder.path(), &["list"]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), ""));
}

#[test]
fn experiments_are_found_by_their_names() {
    for experiment in EXPERIMENTS {
        assert_eq!(Experiment::named(experiment.name).map(|found| found.about), Some(experiment.about));
        assert_ne!(experiment.name, "all", "this means all of them");
    }
    assert!(Experiment::named("nothing").is_none());
}

/// A filtered image goes on where it ended: batches of the same sequence, and the samples of both.
#[test]
fn filtered_images_are_continued() {
    let folder = tempfile::tempdir().unwrap();
    let filtered = |more: &[&'static str]| {
        let all = ["render", "cornell-box", "--size", "8x6", "--filter", "psf", "--filter-batch", "2"];
        [&all[..], more].concat()
    };
    succeeds(folder.path(), &filtered(&["--spp", "2", "--out", "a.exr"]));
    succeeds(folder.path(), &filtered(&["--spp", "2", "--continue", "a.exr", "--out", "b.exr"]));
    succeeds(folder.path(), &filtered(&["--spp", "4", "--out", "whole.exr"]));
    let [once, twice, whole] = ["a.exr", "b.exr", "whole.exr"].map(|name| image(folder.path(), name));
    let samples = |image: &LayeredImage| image.attribute("spp").and_then(|spp| spp.as_u64());
    assert_eq!([&once, &twice, &whole].map(samples), [Some(2), Some(4), Some(4)]);
    let [once, twice, whole] = [once, twice, whole].map(|image| image.rgb().unwrap());
    let difference = |a: &[[f32; 3]], b: &[[f32; 3]]| -> f32 {
        a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| (a - b).abs()).sum()
    };
    // To the rounding of the files.
    assert!(difference(&twice, &whole) < 1e-4 * difference(&once, &whole), "{twice:?} {whole:?}");

    let refuses = |more: &[&'static str], told: &[&str]| {
        fails(
            folder.path(),
            &filtered(&[&["--spp", "2", "--continue", "a.exr", "--out", "c.exr"], more].concat()),
            told,
        );
    };
    refuses(&["--seed", "1"], &["a.exr cannot be continued", "its seed is '0', not '1'"]);
    refuses(&["--max-depth", "3"], &["its maxDepth is '-1', not '3'"]);
    refuses(&["--direct", "ris"], &["its resampling is 'none'"]);
    succeeds(folder.path(), &filtered(&["--filter", "tent", "--spp", "2", "--out", "a.exr"]));
    refuses(&[], &["its reconstruction is", "not 'none'"]);
}
