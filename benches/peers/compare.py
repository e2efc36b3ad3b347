"""`compare`: do both renderers compute the same image? `selftest`: would `compare` notice?"""

import json
import shutil
import tempfile
from pathlib import Path

import numpy as np

import blocks
import machine
import picture
import scenes
from renderers import Lichtwerk, Mitsuba

OUR_SEEDS, THEIR_SEEDS = 1_000, 500_000


def batches(renderer, count, spp, first_seed):
    """`count` images with independent seeds, (count, height, width, 3)."""
    return np.stack([renderer.render(spp, first_seed + index)[0] for index in range(count)])


def is_known(block, scene, size, known):
    """The reason noted for a difference in this block, if there is one. Boxes are in fractions of the image."""
    width, height = size
    for entry in known:
        x0, y0, x1, y1 = entry["box"]
        if entry["scene"] == scene.name and x0 * width <= block["x"] < x1 * width and y0 * height <= block["y"] < y1 * height:
            return entry["reason"]
    return None


def judge(scene, ours, theirs, options, alpha, known, folder):
    """Compare two stacks, write picture and JSON, print the verdict; the number of unexplained differences."""
    height, width = ours.shape[1:3]
    if options.clamp:
        ours, theirs = blocks.clamped(ours, theirs, options.clamp)
    result, t = blocks.compare(ours, theirs, options.block, alpha)
    result["clamped"] = blocks.clamped_ratios(ours, theirs)
    for block in result["blocks"]:
        block["known"] = is_known(block, scene, (width, height), known)
    differing = [block for block in result["blocks"] if block["differs"] and not block["known"]]
    explained = [block for block in result["blocks"] if block["differs"] and block["known"]]
    # Image means contain the explained blocks; they decide only where nothing is explained.
    channels = [] if any(entry["scene"] == scene.name for entry in known) else [c for c in result["channels"] if c["differs"]]

    folder.mkdir(parents=True, exist_ok=True)
    picture.write(folder / f"{scene.name}.png", ours.mean(axis=0), theirs.mean(axis=0), t, options.block)
    result.update(scene=scene.name, size=[width, height], batches=[len(ours), len(theirs)], differing=len(differing) + len(channels),
                  explained=len(explained))
    (folder / f"{scene.name}.json").write_text(json.dumps(result, indent=1))

    print(f"\n{scene.name} {width}x{height}, {result['tests']} tests: "
          f"{len(differing)} blocks and {len(channels)} channel means differ, {len(explained)} differ as noted")
    for channel, clamped in zip(result["channels"], result["clamped"]):
        print("  {channel}: mean ratio {ratio:.5f} +- {ratio_standard_error:.5f} (t {t:+.2f}), median block ratio {median_block_ratio:.5f}"
              .format(**channel)
              + " (block noise {:.1%}), clamped ratio {:.5f} +- {:.5f}".format(
                  channel["median_block_relative_error"], clamped["ratio"], clamped["ratio_standard_error"]))
    for block in sorted(result["blocks"], key=lambda block: block["p"])[: options.worst]:
        mark = "DIFFERS" if block["differs"] and not block["known"] else block["known"] or "" if block["differs"] else ""
        print("  block x {x:4} y {y:4} {channel}: ours {ours:.5g} theirs {theirs:.5g} t {t:+.2f} p {p:.1e} ".format(**block) + mark)
    return len(differing) + len(channels)


def run(options):
    """Render every scene with both and compare; the exit status."""
    known = json.loads(options.known.read_text())
    folder = options.out / "compare"
    chosen = scenes.select(options.scenes)
    alpha = options.alpha / len(chosen)
    scratch = Path(tempfile.mkdtemp(prefix="lichtwerk-peers-"))
    bad = {}
    try:
        theirs = Mitsuba(options.variant, options.threads, options.llvm, scratch)
        ours = Lichtwerk(options.lichtwerk, options.threads, scratch)
        for scene in chosen:
            file = scenes.with_box_filter(scene, options.assets, scratch / "scenes")
            width, height = scene.size(options.scale)
            depth = options.max_depth or scene.max_depth
            for renderer in (ours, theirs):
                renderer.load(file, scene, width, height, depth)
            stacks = [batches(renderer, options.batches, options.spp, seed)
                      for renderer, seed in ((ours, OUR_SEEDS + options.seed), (theirs, THEIR_SEEDS + options.seed))]
            bad[scene.name] = judge(scene, *stacks, options, alpha, known, folder)
        theirs.close()
    finally:
        shutil.rmtree(scratch, ignore_errors=True)
    summary = {"machine": machine.stamp(options.root), "versions": {**ours.versions, **theirs.versions}, "variant": options.variant,
               "batches": options.batches, "spp_per_batch": options.spp, "block": options.block, "alpha": options.alpha,
               "clamp": options.clamp, "seed": options.seed, "differing": bad}
    (folder / "summary.json").write_text(json.dumps(summary, indent=1))
    print(f"\nwritten to {folder}")
    return 1 if any(bad.values()) else 0


def selftest(options):
    """Mitsuba against itself must pass; against itself with a planted error of a few percent it must not.

    Two errors are planted: everything 1 % brighter (the image means must show it), and one eighth of the image 15 % brighter
    (its blocks must show it).
    """
    options.worst = min(options.worst, 2)
    scratch = Path(tempfile.mkdtemp(prefix="lichtwerk-peers-"))
    failures = []
    try:
        renderer = Mitsuba(options.variant, options.threads, options.llvm, scratch)
        chosen = scenes.select(options.scenes or ["cornell-box"])
        for scene in chosen:
            file = scenes.with_box_filter(scene, options.assets, scratch / "scenes")
            width, height = scene.size(options.scale)
            renderer.load(file, scene, width, height, options.max_depth or scene.max_depth)
            a, b = (batches(renderer, options.batches, options.spp, seed + options.seed) for seed in (OUR_SEEDS, THEIR_SEEDS))
            patch = a.copy()
            patch[:, : height // 2, : width // 4] *= 1.15
            for name, stack, expected in (("equal", a, False), ("brighter by 1 %", a * 1.01, True), ("patch brighter by 15 %", patch, True)):
                print(f"\n--- {name}: must {'be rejected' if expected else 'pass'}", end="")
                found = judge(scene, stack, b, options, options.alpha, [], options.out / "selftest" / name.split()[0])
                if bool(found) != expected:
                    failures.append(f"{scene.name}, {name}")
        renderer.close()
    finally:
        shutil.rmtree(scratch, ignore_errors=True)
    print("\nself-test " + ("failed: " + "; ".join(failures) if failures else "passed"))
    return 1 if failures else 0
