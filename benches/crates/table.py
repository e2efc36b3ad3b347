#!/usr/bin/env python3
"""What each library costs and what stands behind it, as a table in Markdown.

    benches/crates/table.py > table.md           # everything; builds each library alone in an empty folder: minutes
    benches/crates/table.py --without-builds     # all but the seconds

Dependencies are all packages that a library needs, without and with all of its features (cargo tree; not itself). Seconds are those of
`cargo build --release` into an empty folder, sources fetched before: CPU seconds, which depend less on what else the machine does, and wall
seconds. Lines are those of `src`, without and with comments, documentation and unit tests. Public items, and those documented, are
counted by rustdoc (`--show-coverage`, which the stable compiler offers to those who insist). Tests are functions and examples of
documentation that are compiled and run. Shares are those of the false-positive rate of 1e-6 of all statistical checks of the workspace.
"""

import argparse
import json
import os
import re
import resource
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "benches" / "peers"))
import machine  # noqa: E402


def cargo(*arguments, **environment):
    """The standard output of cargo; its errors go through."""
    return subprocess.run(
        ["cargo", *arguments], cwd=ROOT, env={**os.environ, **environment}, check=True, stdout=subprocess.PIPE, text=True
    ).stdout


def dependencies(name, *features):
    """Number of packages that a library needs, itself not among them."""
    lines = cargo("tree", "--package", name, "--edges", "normal", "--prefix", "none", "--format", "{p}", "--no-dedupe", *features)
    return len({line.split(" (")[0] for line in lines.splitlines() if line.strip()}) - 1


def build_seconds(name):
    """CPU and wall seconds of a build from nothing."""
    with tempfile.TemporaryDirectory() as folder:
        before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
        cargo("build", "--quiet", "--release", "--package", name, "--lib", CARGO_TARGET_DIR=folder)
        after, wall = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic() - begin
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, wall


def without_unit_tests(text):
    """A source file up to its module of unit tests, which stands last by the house's custom."""
    return re.split(r"^#\[cfg\(test\)\]\n(?:#\[.*\]\n)*mod tests \{", text, flags=re.MULTILINE)[0]


def lines(folder):
    """Lines of code, and all lines."""
    texts = [path.read_text() for path in folder.rglob("*.rs")]
    code = [line.strip() for text in texts for line in without_unit_tests(text).splitlines()]
    return sum(1 for line in code if line and not line.startswith("//")), sum(text.count("\n") for text in texts)


def coverage(name):
    """Public items, documented ones, and the examples in the documentation."""
    text = cargo(
        "rustdoc", "--quiet", "--package", name, "--lib", "--all-features", "--", "-Z", "unstable-options", "--show-coverage",
        "--output-format", "json", RUSTC_BOOTSTRAP="1",
    )
    files = json.loads(text[text.index("{"):]).values()
    return [sum(file[key] for file in files) for key in ("total", "with_docs", "total_examples")]


def test_functions(folder):
    """Functions that are tests, those of proptest included."""
    return sum(len(re.findall(r"^\s*#\[test\]", path.read_text(), flags=re.MULTILINE)) for path in folder.rglob("*.rs"))


def shares():
    """The false-positive rates by the first word of their suites."""
    text = (ROOT / "tests" / "src" / "shares.rs").read_text()
    sums = {}
    for suite, share in re.findall(r'^\s*\("([^"]+)", ([0-9.e+-]+)\),', text, flags=re.MULTILINE):
        crate = suite.split(" ")[0]
        sums[crate] = sums.get(crate, 0.0) + float(share)
    return sums


def main():
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--without-builds", action="store_true")
    arguments = parser.parse_args()
    cargo("fetch", "--locked")
    manifests = sorted((ROOT / "crates").glob("*/Cargo.toml"))
    share = shares()
    toolchain = subprocess.run(["rustc", "--version"], check=True, stdout=subprocess.PIPE, text=True).stdout.split(" (")[0]
    stamp = machine.stamp(ROOT)
    print(f"{stamp['cpu']}, {stamp['cores']} cores, load {stamp['load_average']:.1f}; {toolchain}; commit {stamp['lichtwerk_commit']}.\n")
    print("| crate | dependencies, default (none .. all features) | compile: CPU s (wall s) | lines: code (all) | public items | documented | tests: functions + examples | share of false positives |")
    print("|---|---|---|---|---|---|---|---|")
    for manifest in manifests:
        name = tomllib.loads(manifest.read_text())["package"]["name"]
        needs = [dependencies(name, *features) for features in ([], ["--no-default-features"], ["--all-features"])]
        seconds = "" if arguments.without_builds else "{:.1f} ({:.1f})".format(*build_seconds(name))
        code, everything = lines(manifest.parent / "src")
        items, documented, examples = coverage(name)
        row = [
            f"[`{name}`](../crates/{manifest.parent.name})",
            f"{needs[0]} ({needs[1]} .. {needs[2]})",
            seconds,
            f"{code:,} ({everything:,})",
            f"{items:,}",
            f"{documented:,} ({100 * documented / items:.0f} %)",
            f"{test_functions(manifest.parent)} + {examples}",
            f"{share[name]:.1e}" if name in share else "none: exact tests",
        ]
        print("| " + " | ".join(row) + " |", flush=True)


if __name__ == "__main__":
    main()
