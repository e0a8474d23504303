#!/bin/bash
# Sets up and builds everything, or the targets named, into build/, the programs into build/bin/.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build="$root/build"

if [[ "${1:-}" == "--help" ]]; then
  echo "Usage: scripts/build.sh [TARGET_OR_NINJA_ARGUMENT...]    for example plumbline_map"
  exit 0
fi

"$root/scripts/setup.sh"
# Ninja runs CMake again by itself when a CMakeLists.txt has changed.
if [[ ! -f "$build/build.ninja" ]]; then
  cmake --preset release -S "$root"
fi
# The compiler needs up to 2 GB for the largest files.
memory_gb=$(awk '/^MemAvailable:/ { print int($2 / 1048576) }' /proc/meminfo)
jobs=$(nproc)
if (( jobs > memory_gb / 2 )); then jobs=$(( memory_gb / 2 )); fi
if (( jobs < 1 )); then jobs=1; fi
ninja -C "$build" -j "$jobs" "$@"
