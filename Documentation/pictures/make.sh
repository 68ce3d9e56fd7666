#!/bin/sh
# Makes the guide's pictures of pages, of phantoms: Documentation/pictures/make.sh BUILD. Needs node, Chromium and what
# `ctest -R Page` has installed. About five minutes.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
build=$(cd "$1" && pwd)
bonetk=$build/Apps/bonetk/bonetk
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
cd "$folder"
"$bonetk" phantom --bone femur --spacing 0.8 --noise 20 -o ct.nii.gz --labels labels.nii.gz -q
"$bonetk" build ct.nii.gz --labels labels.nii.gz -o model -q
for subject in 1 2 3 4 5 6; do
  "$bonetk" phantom --bone femur --subject $subject --spacing 1.5 -o $subject.nii.gz --labels labels_$subject.nii.gz -q
  "$bonetk" build $subject.nii.gz --labels labels_$subject.nii.gz --tetrahedra 8000 --levels 0.5 --degree 2 --no-page -o $subject -q
  echo "$subject/model_L1.vtu, $subject.nii.gz" >> subjects.txt
done
"$bonetk" train subjects.txt -o atlas.h5 -q
BUILD_PAGE=$folder/model/report.html ATLAS_PAGE=$folder/atlas.html PICTURES=$here \
  node "$here/../../Testing/Page/run.mjs" "$build/Testing/Page" "$build/Modules/Report/page" screenshots.mjs
