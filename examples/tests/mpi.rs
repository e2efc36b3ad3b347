//! `mpirun -n N lichtwerk render ..`, with all processes on this machine.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod command;
mod signals;

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

use command::{assert_same_image, succeeds, text};
use lichtwerk::output::{Checkpoint, RenderStats};

/// Whether there is an Open MPI to try this with. Says so if not.
fn is_missing() -> bool {
    let version = Command::new("mpirun").arg("--version").output();
    let found = version.is_ok_and(|output| text(&output.stdout).contains("Open MPI"));
    if !found {
        println!("skipped: no mpirun of Open MPI here");
    }
    !found
}

/// So many ranks of the program. Ranks that wait for each other in vain are ended after a while.
fn mpirun(folder: &Path, ranks: usize, arguments: &[&str]) -> Command {
    let mut command = Command::new("mpirun");
    command.args(["--allow-run-as-root", "--oversubscribe", "--timeout", "900", "-n", &ranks.to_string()]);
    command.arg(env!("CARGO_BIN_EXE_lichtwerk")).args(arguments);
    command.current_dir(folder).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// Runs what must succeed; returns what it says.
fn together(folder: &Path, ranks: usize, arguments: &[&str]) -> String {
    let output = mpirun(folder, ranks, arguments).output().unwrap();
    let message = text(&output.stderr);
    assert_eq!((output.status.code(), text(&output.stdout)), (Some(0), ""), "{ranks} ranks, {arguments:?}: {message}");
    message.to_owned()
}

/// Runs what must fail, with one line of the program's that holds all `reasons`.
fn fail_together(folder: &Path, ranks: usize, arguments: &[&str], reasons: &[&str]) {
    let output = mpirun(folder, ranks, arguments).output().unwrap();
    let message = text(&output.stderr);
    assert!(!output.status.success(), "{arguments:?}");
    let errors: Vec<&str> = message.lines().filter(|line| line.starts_with("error: ")).collect();
    assert_eq!(errors.len(), 1, "{arguments:?}: {message}");
    for reason in reasons {
        assert!(errors[0].contains(reason), "{arguments:?}: '{message}' does not say '{reason}'");
    }
}

fn stats(folder: &Path, name: &str) -> RenderStats {
    serde_json::from_slice(&fs::read(folder.join(name)).unwrap()).unwrap()
}

const SCENE: [&str; 6] = ["render", "cornell-box", "--size", "20x14", "--seed", "3"];

/// Estimators with and without light paths, some that all samples share, progressive photons, batches of a filter; a sampler
/// that has to know the number of samples; and more ranks than samples.
#[test]
fn ranks_make_the_image_of_one_process_bit_for_bit() {
    if is_missing() {
        return;
    }
    let photon_map = ["--estimator", "photon-map", "--photons", "3001"];
    for (name, ranks, shares, more) in [
        ("path", 2, false, &["--spp", "12"][..]),
        ("path, z-sobol", 3, false, &["--spp", "12", "--sampler", "z-sobol", "--threads", "1"]),
        ("light", 3, false, &["--spp", "7", "--estimator", "light"]),
        ("igi", 3, false, &["--spp", "7", "--estimator", "robust-igi", "--discontinuity-buffer"]),
        ("igi and caustics", 2, false, &["--spp", "4", "--estimator", "robust-igi", "--caustics", "--photons", "2000"]),
        ("sppm", 2, false, &["--spp", "5", "--estimator", "sppm", "--photons", "2000"]),
        ("psf", 3, false, &["--spp", "12", "--filter", "psf", "--filter-batch", "4"]),
        ("light photons", 2, true, &["--spp", "5", "--estimator", "direct", "--lights", "photons"]),
        ("photons, gathered", 3, true, &[&photon_map[..], &["--spp", "4"]].concat()),
        ("photons, no samples", 3, true, &[&photon_map[..], &["--spp", "2", "--gather-rays", "0"]].concat()),
        (
            "photons, guided",
            3,
            true,
            &[&photon_map[..], &["--spp", "3", "--deposition", "importance", "--guide", "both", "--importons", "2000"]]
                .concat(),
        ),
        (
            "photons, filtered",
            2,
            true,
            &[&photon_map[..], &["--spp", "4", "--filter", "psf", "--filter-batch", "2"]].concat(),
        ),
    ] {
        println!("{name}");
        let folder = tempfile::tempdir().unwrap();
        let of = |outputs: &[&'static str]| [&SCENE[..], more, outputs].concat();
        succeeds(folder.path(), &of(&["--out", "one.exr", "--stats", "one.json"]));
        let said = together(folder.path(), ranks, &of(&["--out", "all.exr", "--stats", "all.json"]));
        assert_eq!(said, "", "{name}");
        assert_same_image(folder.path(), "one.exr", "all.exr");

        // Each ray once; films of 232 or 328 bytes per pixel arrive along a tree.
        let [one, all] = ["one.json", "all.json"].map(|file| stats(folder.path(), file));
        let counts = |stats: &RenderStats| (stats.spp, stats.paths, stats.closest_hit_rays, stats.visibility_rays);
        assert_eq!(counts(&all), counts(&one), "{name}");
        assert_eq!((one.ranks, one.gathered_bytes, one.received_bytes), (1, 0, 0));
        assert_eq!((all.ranks, all.gathered_bytes > 0), (ranks, shares), "{name}");
        let films = u64::from(ranks.next_power_of_two().ilog2());
        assert!((films * 280 * 232..films * 280 * 400).contains(&all.received_bytes), "{name}: {}", all.received_bytes);
        println!("  {} bytes gathered, {} received", all.gathered_bytes, all.received_bytes);
    }
}

/// The processes that a process has started.
fn children(parent: &Child) -> Vec<u32> {
    let parent_of = |pid: u32| {
        let stat = fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
        // After the name, which is in brackets: state, parent.
        stat.rsplit_once(") ")?.1.split(' ').nth(1)?.parse().ok()
    };
    let pids = fs::read_dir("/proc").unwrap().filter_map(|entry| entry.ok()?.file_name().to_str()?.parse().ok());
    let mut pids: Vec<u32> = pids.filter(|&pid| parent_of(pid) == Some(parent.id())).collect();
    pids.sort_unstable();
    pids
}

fn signal(name: &str, pid: u32) {
    assert!(Command::new("kill").args([name, &pid.to_string()]).status().unwrap().success());
}

/// Starts two ranks, and waits until each has kept something in `a.part`.
fn start(folder: &Path, arguments: &[&str]) -> Child {
    let mut running = mpirun(folder, 2, arguments).spawn().unwrap();
    let is_there = |part: &str| folder.join(part).exists();
    while !["a.part.1-of-2", "a.part.2-of-2"].into_iter().all(is_there) {
        assert!(running.try_wait().unwrap().is_none(), "it ended before it kept anything");
        std::thread::sleep(Duration::from_millis(2));
    }
    running
}

fn end(running: Child) -> Output {
    running.wait_with_output().unwrap()
}

#[test]
fn a_rank_that_is_killed_ends_all_and_they_go_on_from_what_they_kept() {
    if is_missing() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let whole = ["--spp", "8000", "--estimator", "photon-map", "--photons", "1000", "--gather-rays", "0"];
    let whole = [&SCENE[..], &whole, &["--threads", "1"]].concat();
    let kept = [&whole[..], &["--checkpoint", "a.part", "--checkpoint-seconds", "0.02", "--out", "a.exr"]].concat();
    let running = start(path, &kept);
    let ranks = children(&running);
    assert_eq!(ranks.len(), 2, "{ranks:?}");
    signal("-KILL", ranks[1]);
    assert!(!end(running).status.success());
    assert!(!path.join("a.exr").exists());

    // Each goes on from its own.
    let counts = || [1, 2].map(|k| Checkpoint::read(&path.join(format!("a.part.{k}-of-2"))).unwrap().described.count());
    let before = counts();
    assert!(before.iter().all(|count| (1..4000).contains(count)), "{before:?}: not in time, or too early");
    let said = together(path, 2, &kept);
    for (k, count) in (1..).zip(before) {
        assert!(said.contains(&format!("a.part.{k}-of-2: {count} samples per pixel are there")), "{said}");
    }
    succeeds(path, &[&whole[..], &["--out", "one.exr"]].concat());
    assert_same_image(path, "one.exr", "a.exr");
    assert_eq!(counts(), [4000; 2]);

    // Nothing is left to be done; and what they kept can be merged.
    fs::remove_file(path.join("a.exr")).unwrap();
    together(path, 2, &kept);
    assert_same_image(path, "one.exr", "a.exr");
    succeeds(path, &["merge", "a.part.2-of-2", "a.part.1-of-2", "--out", "merged.exr"]);
    assert_same_image(path, "one.exr", "merged.exr");

    // What one finds wrong, the first tells.
    fs::write(path.join("a.part.2-of-2"), "something else").unwrap();
    fail_together(path, 2, &kept, &["rank 1: a.part.2-of-2", "not a checkpoint"]);
}

#[test]
fn a_polite_request_to_end_keeps_the_image_so_far() {
    if is_missing() || signals::interrupts_are_ignored() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let endless = ["--spp", "1000000000", "--threads", "1", "--checkpoint", "a.part", "--checkpoint-seconds", "0.02"];
    let arguments = [&SCENE[..], &endless, &["--out", "a.exr", "--stats", "a.json"]].concat();
    let running = start(folder.path(), &arguments);
    // As mpirun does after Ctrl-C; but it kills ranks that need more than a second then, and the machine may be busy.
    children(&running).into_iter().for_each(|rank| signal("-TERM", rank));
    let output = end(running);
    let said = text(&output.stderr);
    assert_eq!(said.matches("interrupted after").count(), 1, "{said}");
    let parts = ["a.part.1-of-2", "a.part.2-of-2"];
    let samples = parts.map(|part| Checkpoint::read(&folder.path().join(part)).unwrap().described.samples[0]);
    assert_eq!(samples.map(|[first, _]| first), [0, 500_000_000]);
    assert_eq!(stats(folder.path(), "a.json").spp, samples.iter().map(|[first, last]| last - first).sum::<u64>());
    assert!(command::image(folder.path(), "a.exr").rgb().is_ok());
}

#[test]
fn each_rank_has_the_time() {
    if is_missing() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let arguments =
        [&SCENE[..], &["--time", "0.05", "--checkpoint", "a.part", "--out", "a.exr", "--stats", "a.json"]].concat();
    for run in 1..=2 {
        together(folder.path(), 3, &arguments);
        let samples = [1, 2, 3].map(|k| {
            let part = Checkpoint::read(&folder.path().join(format!("a.part.{k}-of-3"))).unwrap();
            assert_eq!(part.described.samples.len(), 1, "{k}");
            part.described.samples[0]
        });
        assert_eq!(samples.map(|[first, _]| first), [0, 1 << 20, 2 << 20], "{run}");
        assert_eq!(stats(folder.path(), "a.json").spp, samples.iter().map(|[first, last]| last - first).sum::<u64>());
    }
}

#[test]
fn what_makes_no_sense_is_told_once() {
    if is_missing() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let scene = |more: &[&'static str]| [&SCENE[..], more].concat();
    fail_together(path, 3, &["render", "nowhere"], &["error: 'nowhere' is neither"]);
    fail_together(path, 2, &scene(&["--out", "nowhere/a.exr"]), &["nowhere"]);
    fail_together(path, 2, &scene(&["--spp", "2", "--shard", "1/2"]), &["--shard", "mpirun"]);
    fail_together(path, 2, &scene(&["--estimator", "restir-direct"]), &["restir-direct"]);
    fail_together(path, 2, &scene(&["--estimator", "sppm", "--time", "1"]), &["radius", "--spp"]);
    fail_together(path, 2, &scene(&["--estimator", "photon-map", "--global-ratio", "0.000001"]), &["error: "]);
    let halves = scene(&["--spp", "6", "--filter", "psf", "--filter-batch", "4"]);
    fail_together(path, 2, &halves, &["multiple of 8", "--filter-batch 4"]);
    // Of one rank alone.
    std::fs::write(path.join("c.part.2-of-2"), "nonsense").unwrap();
    fail_together(path, 2, &scene(&["--checkpoint", "c.part"]), &["rank 1: ", "c.part.2-of-2", "not a checkpoint"]);

    let output = mpirun(path, 3, &["render", "cornell-box", "--nonsense"]).output().unwrap();
    assert!(!output.status.success());
    assert_eq!(text(&output.stderr).matches("unexpected argument").count(), 1, "{}", text(&output.stderr));
    // Not several, and so nothing to share out.
    together(path, 1, &scene(&["--spp", "2", "--shard", "1/2", "--out", "a.exr"]));
}
