#!/usr/bin/env bash
# Compare lichtwerk with Mitsuba 3, block by block, or race it and other peers:
#
#   benches/peers/run.sh table              # all peers side by side: one table with ratios and intervals
#   benches/peers/run.sh compare            # all scenes; exit status 1 if a block differs
#   benches/peers/run.sh speed              # paths per second, interleaved runs
#   benches/peers/run.sh selftest           # Mitsuba against itself, and against itself with planted errors
#   benches/peers/run.sh all --help         # every option
#
# Mitsuba comes from PyPI into a virtual environment outside the tree (LICHTWERK_PEERS_CACHE, default a folder in the
# user's cache). llvm_ad_rgb needs an LLVM library >= 16: it is installed with apt-get if none is there and we may.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
cache=${LICHTWERK_PEERS_CACHE:-${XDG_CACHE_HOME:-${HOME:-/tmp}/.cache}/lichtwerk-peers}
say() { echo "peers: $*" >&2; }

as_root() {
  if [ "$(id -u)" = 0 ]; then "$@"; elif command -v sudo >/dev/null; then sudo -n "$@"; else return 1; fi
}

apt_install() {
  command -v apt-get >/dev/null || return 1
  as_root apt-get update -qq >/dev/null && DEBIAN_FRONTEND=noninteractive as_root apt-get install -qq -y --no-install-recommends "$@" >/dev/null
}

# The stamp file is written last: an environment that a killed run left half-made is made again.
environment=$cache/mitsuba-$(cksum <"$here/requirements.txt" | cut -d' ' -f1)
if [ ! -e "$environment/ready" ]; then
  say "installing Mitsuba into $environment"
  mkdir -p "$cache"
  rm -rf "$environment"
  if ! python3 -c 'import venv, ensurepip' 2>/dev/null; then
    apt_install python3-venv || { say "python3 with venv is needed"; exit 2; }
  fi
  python3 -m venv "$environment"
  "$environment/bin/pip" install --quiet --disable-pip-version-check -r "$here/requirements.txt"
  touch "$environment/ready"
fi
python=$environment/bin/python

if [ "$(PYTHONPATH=$here "$python" -B -c 'import llvm; print(len(llvm.candidates()))')" = 0 ]; then
  package=$(apt-cache search --names-only '^libllvm(1[6-9]|20)(t64)?$' 2>/dev/null | cut -d' ' -f1 | sort -V | tail -1 || true)
  if [ -n "$package" ] && apt_install "$package"; then
    say "installed $package for llvm_ad_rgb"
  else
    say "no LLVM library >= 16: llvm_ad_rgb is left out"
  fi
fi

needs_program=yes
for argument in "$@"; do
  case $argument in
    selftest | -h | --help | --without-lichtwerk | --lichtwerk | --lichtwerk=*) needs_program=no ;;
  esac
done
if [ $needs_program = yes ]; then
  cargo build --release --manifest-path "$root/Cargo.toml" --package lichtwerk --bin lichtwerk
fi

exec "$python" -B "$here/peers.py" "$@"
