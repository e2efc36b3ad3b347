"""`speed`: paths per second, interleaved runs of the same scene at the same size, depth and thread count."""

import json
import shutil
import tempfile
from pathlib import Path
from statistics import median

import machine
import scenes
from renderers import Lichtwerk, Mitsuba, RendererError


def contestants(options, scratch):
    """Lichtwerk first, then the Mitsuba variants that run here."""
    found = [] if options.without_lichtwerk else [Lichtwerk(options.lichtwerk, options.threads, scratch)]
    found.append(Mitsuba("scalar_rgb", options.threads, None, scratch))
    if options.llvm:
        found.append(Mitsuba("llvm_ad_rgb", options.threads, options.llvm, scratch))
    else:
        print("llvm_ad_rgb left out: no LLVM library (>= 16) with which it renders")
    return found


def measure(scene, renderers, options):
    """Interleave A B C A B C .. after one unmeasured round, whose times are kept as `first_seconds`."""
    width, height = scene.size(options.scale)
    depth = options.max_depth or scene.max_depth
    paths = width * height * options.spp
    file = Path(options.assets) / scene.file
    rows = {}
    for renderer in renderers:
        renderer.load(file, scene, width, height, depth, rr_depth=options.rr_depth)
        _, first = renderer.render(options.spp, 1, image=False)
        rows[renderer.name] = {"first_seconds": first["render_seconds"], "seconds": [], "cpu_seconds": []}
    for repetition in range(options.repetitions):
        for renderer in renderers:
            _, measured = renderer.render(options.spp, 2 + repetition, image=False)
            row = rows[renderer.name]
            row["seconds"].append(measured["render_seconds"])
            row["cpu_seconds"].append(measured.get("cpu_seconds", measured.get("process_cpu_seconds")))
            if "closest_hit_rays" in measured:
                row["rays_per_path"] = (measured["closest_hit_rays"] + measured["visibility_rays"]) / measured["paths"]
                row["load_seconds"] = measured["load_seconds"]
    for row in rows.values():
        row["paths_per_second"] = [paths / seconds for seconds in row["seconds"]]
        row["paths_per_cpu_second"] = [paths / seconds for seconds in row["cpu_seconds"]]
        row["first_paths_per_second"] = paths / row["first_seconds"]
    return {"scene": scene.name, "width": width, "height": height, "spp": options.spp, "max_depth": depth, "rr_depth": options.rr_depth,
            "threads": options.threads, "paths": paths, "renderers": rows}


def ratios(row, other, key):
    """Ratio of speeds of neighbouring runs: slow phases of a shared machine hit both."""
    pairs = [a / b for a, b in zip(row[key], other[key])]
    return {"min": min(pairs), "median": median(pairs), "max": max(pairs)}


def table(report):
    """The report as a markdown table."""
    stamp = report["machine"]
    lines = [f"{stamp['cpu']}, {stamp['cores']} cores, {report['threads']} threads; lichtwerk {stamp['lichtwerk_commit']}, "
             f"Mitsuba {report['versions'].get('mitsuba')}; {stamp['time']}", "",
             "| scene | renderer | Mpaths/s, median (min .. max) | first run | lichtwerk is faster by (min .. max) "
             "| Mpaths per CPU second | lichtwerk is faster by |", "|---|---|---|---|---|---|---|"]
    for result in report["scenes"]:
        what = f"{result['scene']} {result['width']}x{result['height']}, {result['spp']} spp, depth {result['max_depth']}"
        for name, row in result["renderers"].items():
            speeds = [value / 1e6 for value in row["paths_per_second"]]
            wall, cpu = row.get("lichtwerk_ratio"), row.get("lichtwerk_cpu_ratio")
            by_wall = "{median:.2f} ({min:.2f} .. {max:.2f})".format(**wall) if wall else ""
            by_cpu = "{median:.2f} ({min:.2f} .. {max:.2f})".format(**cpu) if cpu else ""
            lines.append(f"| {what} | {name} | {median(speeds):.3f} ({min(speeds):.3f} .. {max(speeds):.3f}) "
                         f"| {row['first_paths_per_second'] / 1e6:.3f} | {by_wall} "
                         f"| {median(row['paths_per_cpu_second']) / 1e6:.3f} | {by_cpu} |")
    lines += ["", "First run: the unmeasured one, which for llvm_ad_rgb contains the compilation. CPU seconds of lichtwerk are those of the "
              "whole process, with loading and writing; those of Mitsuba are of rendering alone."]
    return "\n".join(lines)


def run(options):
    """Measure the chosen scenes; the exit status says whether the wanted ratio over scalar_rgb was reached."""
    chosen = scenes.select(options.scenes or ["cornell-box", "modern-hall"])
    scratch = Path(tempfile.mkdtemp(prefix="lichtwerk-peers-"))
    report = {"machine": machine.stamp(options.root), "threads": options.threads, "versions": {}, "llvm": options.llvm, "scenes": []}
    slow = []
    try:
        renderers = contestants(options, scratch)
        for renderer in renderers:
            report["versions"].update(renderer.versions)
        for scene in chosen:
            result = measure(scene, renderers, options)
            rows = result["renderers"]
            if "lichtwerk" in rows:
                for name in rows:
                    if name != "lichtwerk":
                        rows[name]["lichtwerk_ratio"] = ratios(rows["lichtwerk"], rows[name], "paths_per_second")
                        rows[name]["lichtwerk_cpu_ratio"] = ratios(rows["lichtwerk"], rows[name], "paths_per_cpu_second")
                if rows["mitsuba scalar_rgb"]["lichtwerk_ratio"]["median"] < options.wanted:
                    slow.append(scene.name)
            report["scenes"].append(result)
        for renderer in renderers:
            renderer.close()
    except RendererError as error:
        raise SystemExit(str(error)) from error
    finally:
        shutil.rmtree(scratch, ignore_errors=True)
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / "speed.json").write_text(json.dumps(report, indent=1))
    (options.out / "speed.md").write_text(table(report) + "\n")
    print(table(report))
    if slow:
        print(f"below {options.wanted} times scalar_rgb: {', '.join(slow)}")
    return 1 if slow else 0
