#!/usr/bin/env bash
# Path space filtering beside Intel Open Image Denoise, in equal time:
#
#   cargo build --release && benches/peers/oidn/run.sh [scene] [--size WxH] [--spp N,..] [--trials N]
#
# Installs pyoidn (Open Image Denoise 2 for CPUs), OpenEXR and NumPy from PyPI into a throw-away environment.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
environment=$(mktemp -d)
trap 'rm -rf "$environment"' EXIT

python3 -m venv "$environment"
"$environment/bin/pip" install --quiet pyoidn==2.5.1.0 OpenEXR numpy
"$environment/bin/python" "$here/compare.py" "$@"
