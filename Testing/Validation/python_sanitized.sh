#!/usr/bin/env bash
# Runs the tests of the Python package under the address and undefined-behaviour sanitizers, in a build tree of its own:
#
#   Testing/Validation/python_sanitized.sh [TEST...]      default: analysis commands data filters radiograph
#
# Leaks are not looked for: Python and its packages keep thousands of blocks until their process ends. That memory does not
# grow is what the tests' cycles of objects show.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
build=$root/build/python_sanitized
[ $# -gt 0 ] || set -- analysis commands data filters radiograph

cmake -S "$root" --preset sanitize -B "$build" -DBONETK_BUILD_APPS=ON -DBONETK_WRAP_PYTHON=ON > /dev/null
cmake --build "$build" --target bonePython --target bonetk
tests=$(IFS='|'; echo "$*")
ctest --test-dir "$build" --output-on-failure -R "^Python\\.($tests)\$"
