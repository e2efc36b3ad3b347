"""Lichtwerk against Mitsuba 3: the same pictures (`compare`), and how fast (`speed`); all peers in one table (`table`). Started by run.sh."""

import argparse
import sys
from pathlib import Path

import compare
import llvm
import speed
import table
from renderers import RendererError

ROOT = Path(__file__).resolve().parents[2]


def parse():
    parser = argparse.ArgumentParser(prog="benches/peers/run.sh", description=__doc__)
    parser.add_argument("mode", choices=["compare", "speed", "selftest", "table", "all"])
    parser.add_argument("scenes", nargs="*", help="scene names; all of scenes.py for compare, cornell-box and modern-hall for speed")
    parser.add_argument("--assets", type=Path, default=ROOT.parent / "shared" / "assets")
    parser.add_argument("--lichtwerk", type=Path, default=ROOT / "target" / "release" / "lichtwerk", help="the program")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "peers")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--max-depth", type=int, help="instead of the depth of each scene")
    parser.add_argument("--scale", type=float, help="image size as a part of the film size (compare 1/8, speed 1/2)")
    parser.add_argument("--spp", type=int, help="samples per pixel and batch (compare 32, speed 16)")
    parser.add_argument("--variant", help="Mitsuba variant for compare; llvm_ad_rgb if it works, else scalar_rgb")
    test = parser.add_argument_group("compare, selftest")
    test.add_argument("--batches", type=int, default=32, help="independent seeds per renderer, at least 16")
    test.add_argument("--seed", type=int, default=0, help="added to all seeds: another number, an independent repetition")
    test.add_argument("--block", type=int, default=8, help="pixels a side")
    test.add_argument("--alpha", type=float, default=1e-4, help="false-positive rate of the whole run, shared by Holm")
    test.add_argument("--clamp", type=float, help="compare bounded samples: pixels of single samples (--spp 1) end at this many times the median")
    test.add_argument("--worst", type=int, default=5, help="blocks to print per scene")
    test.add_argument("--known", type=Path, default=Path(__file__).with_name("known_differences.json"))
    race = parser.add_argument_group("speed")
    race.add_argument("--repetitions", type=int, default=5)
    race.add_argument("--rr-depth", type=int, default=5, help="Mitsuba's depth from which Russian roulette may end a path")
    race.add_argument("--wanted", type=float, default=2.5, help="ratio over scalar_rgb below which the exit status is 1")
    race.add_argument("--denoiser", action="store_true", help="table: Open Image Denoise as well")
    race.add_argument("--without-lichtwerk", action="store_true", help="measure Mitsuba alone")
    options = parser.parse_args()
    if options.batches < 16 and options.mode not in ("speed", "table"):
        parser.error("--batches below 16 leaves the t statistic no ground under heavy tails")
    if options.clamp is not None and (options.spp != 1 or options.clamp <= 0):
        parser.error("--clamp takes a positive number and needs --spp 1: only single samples are distributed alike in both renderers")
    if not options.assets.is_dir():
        parser.error(f"no folder {options.assets}; give one with --assets")
    options.root = ROOT
    return options


def with_defaults(options, mode):
    """A copy of the options with the defaults of `mode` filled in."""
    filled = argparse.Namespace(**vars(options))
    races = mode in ("speed", "table")
    filled.scale = options.scale or (0.5 if races else 0.125)
    filled.spp = options.spp or (16 if races else 32)
    filled.variant = options.variant or ("llvm_ad_rgb" if options.llvm else "scalar_rgb")
    return filled


def main():
    options = parse()
    options.llvm = llvm.find()
    # The table races Mitsuba, too.
    modes = ["selftest", "compare", "table"] if options.mode == "all" else [options.mode]
    actions = {"compare": compare.run, "selftest": compare.selftest, "speed": speed.run, "table": table.run}
    try:
        return max(actions[mode](with_defaults(options, mode)) for mode in modes)
    except RendererError as error:
        print(error, file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
