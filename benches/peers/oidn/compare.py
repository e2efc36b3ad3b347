"""Errors of path tracing as it is, denoised, and filtered, at the same number of samples and in the same time.

In the same time: what the filter takes beyond path tracing, path tracing beside it may spend on samples, and so may path tracing before Open Image Denoise with what that takes less.
Both threads, interleaved, medians of times, means of errors; relative MSE as `lichtwerk diff` has it."""

import argparse
import json
import pathlib
import statistics
import subprocess
import tempfile
import time

import numpy
import OpenEXR
import pyoidn

PROGRAM = pathlib.Path(__file__).resolve().parents[3] / "target/release/lichtwerk"


def channels(path):
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return {name: channel.pixels.astype(numpy.float32) for name, channel in file.channels().items()}


def layer(image, names):
    return numpy.ascontiguousarray(numpy.stack([image[name] for name in names], axis=-1))


def render(folder, scene, size, seed, *arguments):
    """The image's channels, and the seconds it took."""
    image, stats = folder / "image.exr", folder / "stats.json"
    command = [PROGRAM, "render", scene, "--size", size, "--seed", str(seed), "--out", image, "--stats", stats]
    subprocess.run([*map(str, command), *map(str, arguments)], check=True, capture_output=True)
    return channels(image), json.loads(stats.read_text())["render_seconds"]


def denoise(image):
    """Colours from Open Image Denoise with albedo and normals, and the seconds it took."""
    color, albedo = layer(image, "RGB"), layer(image, ["Albedo.R", "Albedo.G", "Albedo.B"])
    normal = layer(image, ["N.X", "N.Y", "N.Z"])
    start = time.perf_counter()
    result = pyoidn.denoise(color, albedo=albedo, normal=normal, hdr=True)
    return result, time.perf_counter() - start


def relative_mse(image, reference):
    return float(numpy.mean((image - reference) ** 2 / (reference**2 + 0.01)))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scene", nargs="?", default="interior")
    parser.add_argument("--size", default="320x240")
    parser.add_argument("--spp", default="4,16,64,256")
    parser.add_argument("--reference", type=int, default=4096)
    parser.add_argument("--trials", type=int, default=4)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        truth = layer(render(folder, options.scene, options.size, 999, "--spp", options.reference)[0], "RGB")
        print(f"{options.scene}, {options.size}, reference of {options.reference} samples, {options.trials} trials")
        print(f"{'samples':>8} {'':<34} {'seconds':>8} {'rel. MSE':>10}")
        for samples in map(int, options.spp.split(",")):
            rows = {}
            for seed in range(1, options.trials + 1):
                # The filter sets the time.
                filtered, seconds = render(folder, options.scene, options.size, seed, "--spp", samples, "--filter", "psf")
                rows.setdefault("psf", []).append((seconds, relative_mse(layer(filtered, "RGB"), truth)))
                hashed, of_hash = render(folder, options.scene, options.size, seed, "--spp", samples, "--filter", "psf-hash")
                rows.setdefault("psf-hash", []).append((of_hash, relative_mse(layer(hashed, "RGB"), truth)))
                plain, of_plain = render(folder, options.scene, options.size, seed, "--spp", samples)
                rows.setdefault("input, same samples", []).append((of_plain, relative_mse(layer(plain, "RGB"), truth)))
                clean, extra = denoise(plain)
                rows.setdefault("denoised, same samples", []).append((of_plain + extra, relative_mse(clean, truth)))
                longer, time_taken = render(folder, options.scene, options.size, seed, "--time", f"{max(seconds - extra, 0.02):.4f}")
                clean, extra = denoise(longer)
                rows.setdefault("denoised, same time", []).append((time_taken + extra, relative_mse(clean, truth)))
            for kind, values in rows.items():
                seconds = statistics.median(value[0] for value in values)
                errors = [value[1] for value in values]
                spread = statistics.stdev(errors) / len(errors) ** 0.5 if len(errors) > 1 else float("nan")
                print(f"{samples:>8} {kind:<34} {seconds:>8.3f} {statistics.mean(errors):>10.2e} +- {spread:.0e}")


if __name__ == "__main__":
    main()
