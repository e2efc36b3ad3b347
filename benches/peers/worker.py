"""Mitsuba in a process of its own: one JSON request per line on stdin, one JSON answer per line on stdout.

A variant per process keeps the variants' memory and threads apart, and an LLVM that is too old for Dr.Jit (it aborts)
takes only the worker down. CPU seconds are those of this process.

    python worker.py VARIANT THREADS
"""

import json
import os
import resource
import sys
import time


def cpu_seconds():
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


class Worker:
    def __init__(self, variant, threads):
        import drjit as dr
        import mitsuba as mi
        import numpy as np

        mi.set_variant(variant)
        mi.set_log_level(mi.LogLevel.Error)
        dr.set_thread_count(threads)
        self.mi, self.dr, self.np = mi, dr, np
        self.scene = self.sensor = self.integrator = None

    def versions(self):
        return {"mitsuba": self.mi.__version__, "drjit": self.dr.__version__, "threads": self.dr.thread_count()}

    def load(self, file, parameters, width, height, max_depth, rr_depth):
        """Load a scene; replace film size and filter, sampler and integrator, and keep the camera as it is."""
        mi, np = self.mi, self.np
        start = time.perf_counter()
        self.scene = mi.load_file(file, **parameters)
        seconds = time.perf_counter() - start
        camera = mi.traverse(self.scene.sensors()[0])
        film = {
            "type": "hdrfilm", "width": width, "height": height, "pixel_format": "rgb",
            "component_format": "float32", "rfilter": {"type": "box"},
        }
        matrix = np.array(camera["to_world"].matrix, dtype=np.float64).reshape(4, 4)
        self.sensor = mi.load_dict({
            "type": "perspective", "fov": float(np.array(camera["x_fov"]).ravel()[0]), "fov_axis": "x",
            "to_world": mi.ScalarTransform4f(matrix), "film": film, "sampler": {"type": "independent"},
        })
        self.integrator = mi.load_dict({"type": "path", "max_depth": max_depth, "rr_depth": rr_depth})
        return {"load_seconds": seconds}

    def render(self, spp, seed, out=None):
        """Render, wait until the image is there, and write it as .npy (height, width, 3) if asked to."""
        wall, cpu = time.perf_counter(), cpu_seconds()
        image = self.mi.render(self.scene, sensor=self.sensor, integrator=self.integrator, spp=spp, seed=seed)
        image = self.np.array(image, dtype=self.np.float32)
        answer = {"render_seconds": time.perf_counter() - wall, "cpu_seconds": cpu_seconds() - cpu}
        if out:
            self.np.save(out, image)
        return answer


def main():
    # Libraries may print: keep the real stdout for the answers, and send file descriptor 1 to stderr.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    worker = Worker(sys.argv[1], int(sys.argv[2]))
    for line in sys.stdin:
        request = json.loads(line)
        try:
            answer = getattr(worker, request.pop("call"))(**request)
        except Exception as error:  # the caller decides what a failure means
            answer = {"error": f"{type(error).__name__}: {error}"}
        print(json.dumps(answer), file=answers, flush=True)


if __name__ == "__main__":
    main()
