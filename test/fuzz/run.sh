#!/bin/bash
# Builds the fuzzers with clang, AddressSanitizer and UndefinedBehaviorSanitizer, and runs each.
set -euo pipefail

if [[ "${1:-}" == "--help" ]]; then
  echo "Usage: test/fuzz/run.sh [SECONDS [FUZZER...]]"
  echo "Runs the fuzzers (bag, recording, yaml) for SECONDS each, 600 if not given, from the corpora beside"
  echo "this script. What they find is left in build-fuzz/findings/, new inputs in"
  echo "build-fuzz/corpus/. Needs clang-14 and libclang-rt-14-dev."
  exit 0
fi

seconds=${1:-600}
fuzzers=("${@:2}")
[[ ${#fuzzers[@]} -gt 0 ]] || fuzzers=(bag recording yaml)

root=$(cd "$(dirname "$0")/../.." && pwd)
cd "$root"
command -v clang++-14 > /dev/null || {
  echo "run.sh: needs the Debian packages clang-14 and libclang-rt-14-dev" >&2
  exit 1
}
cmake --preset fuzz > /dev/null
cmake --build --preset fuzz

export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
mkdir -p build-fuzz/findings
for name in "${fuzzers[@]}"; do
  mkdir -p "build-fuzz/corpus/$name"
  options=(-max_total_time="$seconds" -timeout=10 -rss_limit_mb=2048 -max_len=16384
           -artifact_prefix="build-fuzz/findings/$name-" -print_final_stats=1)
  [[ ! -f "test/fuzz/$name.dict" ]] || options+=(-dict="test/fuzz/$name.dict")
  echo "== $name, $seconds s"
  "build-fuzz/bin/${name}_fuzzer" "${options[@]}" "build-fuzz/corpus/$name" \
    "test/fuzz/corpus/$name"
done
