#!/usr/bin/env bash
# Installs what is needed, builds and passes all tests: unit and integration tests of the release build, then the unit
# tests again under the address and undefined-behaviour sanitizers. Tests that need real data look for it in the folder
# that BONETK_DATA names, and are skipped where it is not set. Arguments are ctest's, for the tests of the release build.
# Where BONETK_SECONDS is set, the sanitizers are left out, which is said, if they are not built that long after the start.
set -uo pipefail
cd "$(dirname "$0")/.." || exit 1
CMake/install-packages.sh || exit 1

failed=0
total=0
status=0

# run PRESET CTEST-OPTIONS...: builds the preset and runs its tests.
run() {
  local preset=$1 log bad all
  shift
  log=build/$preset/Testing/ctest.log
  cmake --preset "$preset" > /dev/null || exit 1
  cmake --build --preset "$preset" || exit 1
  mkdir -p "$(dirname "$log")"
  ctest --preset "$preset" "$@" | tee "$log"
  [ "${PIPESTATUS[0]}" -eq 0 ] || status=1
  # "98% tests passed, 2 tests failed out of 100"
  read -r bad all < <(sed -n 's/.*tests passed, \([0-9]*\) tests failed out of \([0-9]*\).*/\1 \2/p' "$log" | tail -n 1)
  failed=$((failed + ${bad:-1}))
  total=$((total + ${all:-1}))
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

echo
echo "$((100 * (total - failed) / total))% tests passed, $failed tests failed out of $total"
exit $status
