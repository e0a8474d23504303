#!/bin/bash
# Sets up, builds and runs the tests.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

if [[ "${1:-}" == "--help" ]]; then
  echo "Usage: scripts/test.sh [CTEST_ARGUMENT...]    for example -R Evaluation"
  exit 0
fi

"$root/scripts/build.sh"
exec ctest --test-dir "$root/build" -j2 --output-on-failure "$@"
