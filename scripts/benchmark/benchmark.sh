#!/bin/bash
# Builds, measures whole mapping jobs and writes the figures into docs/performance.md, or compares
# them with those of another build: --against COMMIT.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
exec /usr/bin/python3 "$root/scripts/benchmark/benchmark.py" --build "$@"
