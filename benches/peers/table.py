"""`table`: every peer beside us, in turns, as one Markdown table with ratios and intervals.

- paths per second: Mitsuba 3 (speed.py);
- range searches, filters, samplers: kiddo, openqmc-rs, sobol_burley, rand_pcg (benches/benches/peers.rs) and nanoflann (nanoflann/);
- errors: Intel Open Image Denoise (oidn/), with --denoiser.

A ratio is the peer's seconds over ours, so that more than one is faster, in one turn; turns follow each other, and the interval is
Student's for the mean logarithm of their ratios, 95 %. A peer that cannot be had is left out, and says so."""

import json
import math
import subprocess
import sys
from statistics import mean, stdev

import machine
import speed

# Quantiles of Student's t, 97.5 %, by degrees of freedom.
STUDENT = {1: 12.71, 2: 4.303, 3: 3.182, 4: 2.776, 5: 2.571, 6: 2.447, 7: 2.365, 8: 2.306, 9: 2.262}

# What bounds each number of ours (docs/performance.md, docs/range-search.md).
LIMITS = {
    "range search, build": "memory: a counting sort in two steps",
    "range search, fixed radius, random order": "latency of memory: nine ranges of points a query",
    "range search, 50 nearest, random order": "latency of memory, and the selection of 50",
    "range search, all around all, in order": "distance tests, eight at a time",
    "path space filter, two threads": "distance tests and weights of about 51 neighbours each",
    "Owen-scrambled Sobol points, 4D": "integer operations",
    "independent numbers": "integer operations",
    "paths": "wrong guesses in traversal, and the instructions of shading",
}


def interval(ratios):
    """Mean ratio by logarithms, and the interval of 95 %."""
    logs = [math.log(ratio) for ratio in ratios]
    if len(logs) < 2:
        return math.exp(logs[0]), math.nan, math.nan
    half = STUDENT[min(len(logs) - 1, max(STUDENT))] * stdev(logs) / math.sqrt(len(logs))
    return tuple(math.exp(mean(logs) + sign * half) for sign in (0, -1, 1))


def rust_peers(options):
    """One turn of benches/benches/peers.rs."""
    command = ["cargo", "bench", "--quiet", "--package", "lichtwerk-benches", "--bench", "peers"]
    done = subprocess.run(command, cwd=options.root, check=True, stdout=subprocess.PIPE, text=True)
    return json.loads(done.stdout.strip().splitlines()[-1])


def nanoflann(options):
    """One turn of nanoflann, or nothing where there is none."""
    command = [options.root / "benches/peers/nanoflann/run.sh", "--json"]
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True)
    return json.loads(done.stdout) if done.returncode == 0 else {}


def in_turns(options):
    """Lists of seconds, by comparison and contestant."""
    seconds = {}
    for turn in range(options.repetitions):
        print(f"turn {turn + 1} of {options.repetitions}", file=sys.stderr)
        turn_of_all = rust_peers(options)
        for comparison, value in nanoflann(options).items():
            # What only nanoflann measures, in random order, has nothing beside it.
            turn_of_all.setdefault(comparison, {})["nanoflann"] = value
        for comparison, contestants in turn_of_all.items():
            for contestant, value in contestants.items():
                seconds.setdefault(comparison, {}).setdefault(contestant, []).append(value)
    return seconds


def row(what, peer, ours, theirs, unit, limit):
    """A row of the table."""
    ratio, low, high = interval([b / a for a, b in zip(ours, theirs)])
    spread = "" if math.isnan(low) else f" ({low:.2f} to {high:.2f})"
    return f"| {what} | {peer} | {min(ours):.3g} {unit} | {min(theirs):.3g} {unit} | {ratio:.2f}{spread} | {limit} |"


def rows_of_crates(seconds):
    """Our own contestants against each of the others."""
    rows = []
    for comparison, contestants in seconds.items():
        mine = {name: values for name, values in contestants.items() if name.startswith("ours")}
        for name, values in mine.items():
            what = comparison + name.removeprefix("ours")
            for peer, theirs in contestants.items():
                if peer not in mine:
                    rows.append(row(what, peer, values, theirs, "s", LIMITS[comparison]))
    return rows


def rows_of_mitsuba(options):
    """Paths per second; the measurement is that of `speed`, whose table is in speed.md."""
    status = speed.run(options)
    report = json.loads((options.out / "speed.json").read_text())
    rows = []
    for scene in report["scenes"]:
        ours = scene["renderers"]["lichtwerk"]["seconds"]
        for name, measured in scene["renderers"].items():
            if name != "lichtwerk":
                what = f"paths, {scene['scene']}, {scene['width']} x {scene['height']}, {scene['spp']} samples, depth {scene['max_depth']}"
                rows.append(row(what, name, ours, measured["seconds"], "s", LIMITS["paths"]))
    return rows, status


def run(options):
    """Measure everything and write the table; the exit status is that of `speed`."""
    stamp = machine.stamp(options.root)
    mitsuba, status = rows_of_mitsuba(options)
    crates = rows_of_crates(in_turns(options))
    lines = [
        f"{stamp['cpu']}, {stamp['cores']} cores, load {stamp['load_average']:.1f} at the start; {stamp['system']}; "
        f"lichtwerk {stamp['lichtwerk_commit']}; {stamp['time']}; {options.repetitions} turns.", "",
        "| what | peer | ours, fastest | peer, fastest | peer's time over ours (95 %) | what limits ours |", "|---|---|---|---|---|---|",
        *mitsuba, *crates,
    ]
    if options.denoiser:
        command = [options.root / "benches/peers/oidn/run.sh", "interior", "--size", "160x120", "--spp", "4,16,64", "--reference", "4096", "--trials", "2"]
        done = subprocess.run(command, stdout=subprocess.PIPE, text=True)
        lines += ["", "Open Image Denoise beside the filter:", "", "```text", done.stdout.strip() or "could not be run", "```"]
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / "table.md").write_text("\n".join(lines) + "\n")
    print("\n".join(lines))
    return status
