"""Find an LLVM library that Mitsuba's llvm_ad_rgb really works with.

Dr.Jit loads the first libLLVM it finds. LLVM 14 and 15, which many systems have, load well and then abort the process when
the path tracer is compiled (`Cannot select: fminimum`). So each candidate is tried in a process of its own.
"""

import glob
import os
import re
import subprocess
import sys
from pathlib import Path

OLDEST = 16
PROBE = """
import mitsuba as mi
mi.set_variant("llvm_ad_rgb")
scene = mi.load_dict(mi.cornell_box())
integrator = mi.load_dict({"type": "path", "max_depth": 8})
import numpy as np
assert np.isfinite(np.array(mi.render(scene, integrator=integrator, spp=1))).all()
"""


def candidates():
    """Shared LLVM libraries of a usable age, the newest that is well tried first."""
    found = {}
    for folder in ("/usr/lib/*", "/usr/lib", "/usr/lib/llvm-*/lib", "/usr/lib64", "/usr/local/lib", "/opt/homebrew/opt/llvm/lib"):
        for path in glob.glob(f"{folder}/libLLVM*"):
            version = re.search(r"libLLVM[-.](?:so\.)?(\d+)", os.path.basename(path))
            if version and int(version[1]) >= OLDEST:
                found.setdefault(os.path.realpath(path), int(version[1]))
    preference = {19: 4, 20: 3, 18: 2, 17: 1}
    return sorted(found, key=lambda path: (preference.get(found[path], 0), found[path]), reverse=True)


def find():
    """Path of a library with which a small image renders, or None. An explicit DRJIT_LIBLLVM_PATH is tried alone."""
    chosen = os.environ.get("DRJIT_LIBLLVM_PATH")
    for path in [chosen] if chosen else candidates():
        environment = dict(os.environ, DRJIT_LIBLLVM_PATH=path)
        probe = subprocess.run([sys.executable, "-c", PROBE], env=environment, cwd=Path("/"),
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=600)
        if probe.returncode == 0:
            return path
    return None


if __name__ == "__main__":
    print(find() or "none")
