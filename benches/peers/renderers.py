"""The contestants behind one interface: `load(scene, ..)`, then `render(spp, seed)` -> (image or None, measurements)."""

import json
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent


class RendererError(RuntimeError):
    """A renderer failed; the message says which, on what, and what it wrote."""


class Mitsuba:
    """A Mitsuba variant in a worker process."""

    def __init__(self, variant, threads, llvm=None, scratch=None):
        self.name = f"mitsuba {variant}"
        self.scratch = Path(scratch or tempfile.mkdtemp(prefix="lichtwerk-peers-"))
        environment = dict(os.environ)
        if llvm:
            environment["DRJIT_LIBLLVM_PATH"] = llvm
        # Dr.Jit keeps compiled kernels in ~/.drjit; a fresh home makes the first render pay for compilation, honestly.
        home = self.scratch / f"home-{variant}"
        home.mkdir(parents=True, exist_ok=True)
        environment["HOME"] = str(home)
        self.process = subprocess.Popen([sys.executable, "-B", str(HERE / "worker.py"), variant, str(threads)],
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=environment, text=True)
        self.versions = self.call("versions")

    def call(self, name, **arguments):
        try:
            self.process.stdin.write(json.dumps({"call": name, **arguments}) + "\n")
            self.process.stdin.flush()
            line = self.process.stdout.readline()
        except BrokenPipeError:
            line = ""
        if not line:
            raise RendererError(f"{self.name} ended with status {self.process.wait()}")
        answer = json.loads(line)
        if "error" in answer:
            raise RendererError(f"{self.name}: {answer['error']}")
        return answer

    def load(self, file, scene, width, height, max_depth, rr_depth=5):
        self.call("load", file=str(file), parameters=dict(scene.parameters), width=width, height=height,
                  max_depth=max_depth, rr_depth=rr_depth)

    def render(self, spp, seed, image=True):
        out = self.scratch / "mitsuba.npy"
        measured = self.call("render", spp=spp, seed=seed, out=str(out) if image else None)
        return (np.load(out).astype(np.float64) if image else None), measured

    def close(self):
        self.process.stdin.close()
        self.process.wait()


class Lichtwerk:
    """The `lichtwerk` program, one process per image."""

    def __init__(self, program, threads, scratch=None):
        self.name = "lichtwerk"
        self.program = str(Path(program).resolve())
        if not os.access(self.program, os.X_OK):
            raise RendererError(f"{self.program} is not an executable; build it with `cargo build --release`")
        self.threads = threads
        self.scratch = Path(scratch or tempfile.mkdtemp(prefix="lichtwerk-peers-"))
        self.versions = {"lichtwerk": self.output([self.program, "--version"]), "threads": threads}

    @staticmethod
    def output(command):
        done = subprocess.run(command, capture_output=True, text=True)
        return done.stdout.strip() if done.returncode == 0 else "unknown"

    def load(self, file, scene, width, height, max_depth, rr_depth=5):
        self.file, self.size, self.max_depth = str(file), f"{width}x{height}", max_depth

    def render(self, spp, seed, image=True):
        out, stats = self.scratch / "lichtwerk.exr", self.scratch / "lichtwerk.json"
        command = [self.program, "render", self.file, "--estimator", "path", "--sampler", "independent", "--spp", str(spp), "--size", self.size,
                   "--seed", str(seed), "--threads", str(self.threads), "--max-depth", str(self.max_depth),
                   "--out", str(out), "--stats", str(stats)]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run(command, capture_output=True, text=True, stdin=subprocess.DEVNULL)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        if done.returncode != 0:
            raise RendererError(f"{' '.join(command)}\nended with status {done.returncode}: {done.stderr.strip()[-2000:]}")
        measured = json.loads(stats.read_text())
        # The whole process, loading included: an upper bound of what rendering took.
        measured["process_cpu_seconds"] = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        return (read_rgb(out) if image else None), measured

    def close(self):
        pass


def read_rgb(path):
    """Channels R, G and B of an EXR file as (height, width, 3)."""
    import mitsuba as mi

    if mi.variant() is None:
        mi.set_variant("scalar_rgb")
    bitmap = mi.Bitmap(str(path))
    names = [field.name for field in bitmap.struct_()]
    missing = [name for name in "RGB" if name not in names]
    if missing:
        raise RendererError(f"{path}: no channel {missing[0]} among {', '.join(names)}")
    pixels = np.array(bitmap, dtype=np.float64)
    return pixels[..., [names.index(name) for name in "RGB"]]
