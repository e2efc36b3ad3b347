#!/usr/bin/env bash
# What nanoflann takes for the range searches of benches/benches/range_search.rs:
#
#   benches/peers/nanoflann/run.sh [--json] [points]
#
# Needs a C++17 compiler and nanoflann.hpp (Debian: libnanoflann-dev), which is installed with apt-get if it is missing and we may.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
cxx=${CXX:-c++}
build=$(mktemp -d)
trap 'rm -rf "$build"' EXIT

has_nanoflann() { echo '#include <nanoflann.hpp>' | "$cxx" -std=c++17 -fsyntax-only -x c++ - 2>/dev/null; }
if ! has_nanoflann; then
  if [ "$(id -u)" = 0 ]; then sudo=(); else sudo=(sudo -n); fi
  { "${sudo[@]}" apt-get update -qq && "${sudo[@]}" apt-get install -qq -y --no-install-recommends libnanoflann-dev; } >/dev/null ||
    { echo "nanoflann.hpp is needed (Debian: libnanoflann-dev)" >&2; exit 2; }
fi
# As cargo builds: for every x86-64.
"$cxx" -std=c++17 -O3 -o "$build/range_search" "$here/range_search.cpp"
exec "$build/range_search" "$@"
