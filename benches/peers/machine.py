"""What the measurements were made on."""

import os
import platform
import subprocess
import time
from pathlib import Path


def cpu_model():
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def revision(folder):
    """Commit of the working tree, with a mark if files differ from it."""
    def git(*arguments):
        done = subprocess.run(["git", "-C", str(folder), *arguments], capture_output=True, text=True)
        return done.stdout.strip() if done.returncode == 0 else ""

    commit = git("rev-parse", "--short=12", "HEAD") or "unknown"
    return commit + ("+changes" if git("status", "--porcelain", "--untracked-files=no") else "")


def stamp(folder):
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return {"cpu": cpu_model(), "cores": cores, "load_average": os.getloadavg()[0], "system": platform.platform(),
            "python": platform.python_version(), "lichtwerk_commit": revision(folder),
            "time": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime())}
