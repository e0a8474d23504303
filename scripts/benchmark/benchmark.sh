#!/bin/bash
# Builds, measures whole mapping jobs and writes the figures into docs/performance.md.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)

for argument in "$@"; do
  if [[ "$argument" == "--help" ]]; then
    exec /usr/bin/python3 "$root/scripts/benchmark/benchmark.py" --help
  fi
done

"$root/scripts/build.sh" plumbline_simulate plumbline_map
exec /usr/bin/python3 "$root/scripts/benchmark/benchmark.py" "$@"
