#!/usr/bin/env bash
# Makes the reports of Documentation/validation again, each by the command that the table in its README.md names:
#
#   BONETK_DATA=DATA Testing/Validation/run.sh [REPORT...]     default: all
#   BONETK_DATA=DATA Testing/Validation/run.sh --stale         those that do not measure the programs as they are; the others
#                                                              are given the present commit
#   Testing/Validation/run.sh --list                           the commands alone
#
# Builds the preset test first (BONETK_BUILD: takes that build tree as it is). Goes on after a report that fails, names those at
# the end, and ends with 1 then. BONETK_CHECK names an independent checker of meshes, called as PROGRAM MESH.vtu.
# Models that several reports measure are made once: in the folder BONETK_WORK, which keeps them by the commit that last changed what
# makes them, or in a temporary one.
set -uo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
# "| [atlas](atlas.md) | `atlas.py $build` | Evaluation | 20 min |" to "atlas<tab>atlas.py $build"
reports=$(sed -n 's/^| \[\(.*\)\](\1\.md) | `\(.*\)` | .* | .* |$/\1\t\2/p' "$root/Documentation/validation/README.md")
if [ "${1:-}" = --list ]; then
  echo "$reports"
  exit
fi
if [ "${1:-}" = --stale ]; then
  "$root/Testing/Validation/report.py" --confirm
  mapfile -t names < <("$root/Testing/Validation/report.py" --stale)
  set -- "${names[@]}"
  echo "== not of the programs as they are: ${*:-none}"
  [ $# -gt 0 ] || exit 0
fi
[ $# -gt 0 ] || mapfile -t all < <(cut -f 1 <<< "$reports")
[ $# -gt 0 ] || set -- "${all[@]}"
for report in "$@"; do
  grep -q "^$report	" <<< "$reports" || { echo "$0: there is no report $report: see $0 --list" >&2; exit 2; }
done
[ -d "${BONETK_DATA:-}" ] || { echo "$0: BONETK_DATA names no folder of data" >&2; exit 2; }

if [ -z "${BONETK_BUILD:-}" ]; then
  (cd "$root" && cmake --preset test && cmake --build --preset test) || exit 1
fi
build=$(realpath "${BONETK_BUILD:-$root/build/test}")
programs=$build/Testing/Validation
check=${BONETK_CHECK:+--check $BONETK_CHECK}
[ -z "$check" ] || export CHECK=$BONETK_CHECK
# Debian's Python, which sees Debian's numpy and VTK.
export BONETK=$build/Apps/bonetk/bonetk build programs check PATH=$root/Testing/Validation:/usr/bin:$PATH
if [ -n "${BONETK_WORK:-}" ]; then
  work=$BONETK_WORK/$("$root/Testing/Validation/report.py" --of Evaluation Phantom | tr ' ' _)
else
  work=$(mktemp -d)
  trap 'rm -rf "$work"' EXIT
fi
export FEMORA=$work/femora MODELS=$work/models
mkdir -p "$FEMORA" "$MODELS"
failed=()
for report in "$@"; do
  command=$(sed -n "s/^$report\t//p" <<< "$reports")
  echo "== $report: $command"
  begin=$SECONDS
  bash -c "$command" || failed+=("$report")
  echo "== $report: $((SECONDS - begin)) s"
done
[ ${#failed[@]} -eq 0 ] || { echo "$0: failed: ${failed[*]}" >&2; exit 1; }
