#!/usr/bin/env bash
# Turns a CT into a density model with radiographs and a report, by the bonetk that is installed, or else, as with
# BONETK_FROM_SOURCE=1, by one that it builds from the sources around it, after it has installed what that needs:
#
#   Examples/run.sh                          the analytic femur phantom
#   Examples/run.sh CT LABELS [LABEL]        a CT with a label map on its grid (LABEL: the bone's value, where it has several)
#   Examples/run.sh CT CONTOURS              a CT with initial contours (.vtp, or .mrk.json of 3D Slicer)
#
# Results go to the folder out/ of the project, or of the current folder where there are no sources. Running it again is
# quick.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)

if [ $# -eq 1 ] || [ $# -gt 3 ]; then
  echo "usage: $0 [CT LABELS [LABEL] | CT CONTOURS]   (a CT alone does not say which bone is meant)" >&2
  exit 2
fi
for file in "${@:1:2}"; do
  if [ ! -e "$file" ]; then
    echo "$0: there is no file $file" >&2
    exit 1
  fi
done

sources=no
[ ! -e "$root/CMakePresets.json" ] || sources=yes
bonetk=$(command -v bonetk || true)
if [ $sources = yes ] && { [ -z "$bonetk" ] || [ -n "${BONETK_FROM_SOURCE:-}" ]; }; then
  "$root/CMake/install-packages.sh"
  (cd "$root" && cmake --preset release > /dev/null && cmake --build --preset release --target bonetk)
  bonetk=$root/build/release/Apps/bonetk/bonetk
elif [ -z "$bonetk" ]; then
  echo "$0: no bonetk is installed, and there are no sources in $root to build it from" >&2
  exit 1
fi
echo "By $bonetk, $("$bonetk" --version | head -n 1):"

[ $sources = yes ] || root=$PWD
mkdir -p "$root/out"
if [ $# -eq 0 ]; then
  out=$root/out/femur_phantom
  ct=$root/out/femur_phantom_ct.nii.gz
  labels=$root/out/femur_phantom_labels.nii.gz
  "$bonetk" phantom --bone femur --spacing 0.8 --noise 20 -o "$ct" --labels "$labels"
  where=(--labels "$labels")
else
  ct=$1
  name=$(basename "$ct")
  out=$root/out/${name%%.*}
  case $2 in
    *.vtp | *.mrk.json) where=(--init "$2") ;;
    *) where=(--labels "$2") ;;
  esac
  [ $# -lt 3 ] || where+=(--label "$3")
fi
"$bonetk" build "$ct" "${where[@]}" -o "$out"

echo
echo "Results in $out:"
echo "  report.html                             a page that shows it all: the model in 3D, slices, pictures, figures"
echo "  report.txt, report.json                 counts, errors and times"
echo "  slices.png                              the CT's slices with the contours"
echo "  cut_plane.png                           CT, model and difference on a plane, level by level"
echo "  radiographs.png                         radiographs of the CT and of each level, and their difference"
echo "  model_L1.vtu, ..., model.hierarchy.json the models (ParaView shows them)"
