#!/usr/bin/env bash
# Installs what is needed, builds and passes all tests: unit and integration tests of the release build, then the unit
# tests again under the address and undefined-behaviour sanitizers. Tests that need real data look for it in the folder
# that BONETK_DATA names, and are skipped where it is not set. Arguments are ctest's, for the tests of the release build.
# Where BONETK_SECONDS is set, the sanitizers are left out, which is said, if they are not built that long after the start.
set -uo pipefail
cd "$(dirname "$0")/.." || exit 1
CMake/install-packages.sh || exit 1

status=0
results=()

# run PRESET CTEST-OPTIONS...: builds the preset and runs its tests.
run() {
  local preset=$1 result=$PWD/build/$1/tests.xml
  shift
  cmake --preset "$preset" > /dev/null || exit 1
  cmake --build --preset "$preset" || exit 1
  rm -f "$result"
  ctest --preset "$preset" --output-junit "$result" "$@" || status=1
  results+=("$result")
}

run test -j2 "$@"
limit=()
left=$((${BONETK_SECONDS:-0} - SECONDS))
[ -z "${BONETK_SECONDS:-}" ] || limit=(timeout $((left > 1 ? left : 1)))
cmake --preset sanitize > /dev/null || exit 1
"${limit[@]}" cmake --build --preset sanitize
if [ $? -eq 124 ]; then
  echo "The unit tests under the sanitizers are LEFT OUT: $SECONDS seconds have passed."
else
  run sanitize -j2
fi

Testing/summary.py "${results[@]}" || status=1
exit $status
