#!/usr/bin/env bash
# Builds the test preset and runs the benchmarks of all modules; options are those of Google Benchmark.
set -euo pipefail
cd "$(dirname "$0")/.."
cmake --preset test > /dev/null
cmake --build --preset test
for program in build/test/Modules/*/bone*Benchmarks; do
  echo "== $(basename "$program")"
  "$program" "$@"
done
