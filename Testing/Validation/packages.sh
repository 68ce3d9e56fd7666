#!/usr/bin/env bash
# Makes the Debian packages, installs them into a clean root and uses them there: the program, the page, the Python package,
# the documentation's example programs. As root, on Debian, with mmdebstrap and a mirror that apt reaches.
#
#   Testing/Validation/packages.sh [BUILD-TREE]     default: that of the preset package, which is built
#   Testing/Validation/packages.sh --again          builds in another folder too, and compares the packages byte by byte: some
#                                                   half an hour more
#
# Writes Documentation/validation/packages.md, and all else to standard error.
set -euo pipefail
project=$(cd "$(dirname "$0")/../.." && pwd)
rows=""
say() {
  rows+="| $1 | $2 |"$'\n'
  echo "$1: $2" >&2
}
fail() {
  echo "$0: $1" >&2
  exit 1
}
[ "$(id -u)" -eq 0 ] || fail "a root of its own can only be made as root"
command -v mmdebstrap > /dev/null || fail "mmdebstrap is needed: apt-get install mmdebstrap"

made_by=$(/usr/bin/python3 "$project/Testing/Validation/report.py" "$0")
again=no
if [ "${1:-}" = --again ]; then
  again=yes
  shift
  git -C "$project" diff --quiet HEAD || fail "the sources differ from their commit, of which the other folder is made"
  # Each object is compiled, twice.
  export CCACHE_DISABLE=1
fi
if [ $# -eq 0 ]; then
  (cd "$project" && cmake --preset package && cmake --build --preset package) >&2
  build=$project/build/package
else
  build=$(cd "$1" && pwd)
fi

work=$(mktemp -d)
clean() {
  umount "$work/root/proc" 2> /dev/null || true
  rm -rf --one-file-system "$work"
}
trap clean EXIT

# The packages, twice: the same bytes.
for run in first second; do
  (cd "$build" && cpack -B "$work/$run") >&2
done
for package in "$work"/first/*.deb; do
  cmp "$package" "$work/second/$(basename "$package")" || fail "a second run of cpack writes other bytes"
  say "$(basename "$package"); a second run of cpack writes the same bytes" "$(($(stat -c %s "$package") / 1000)) kB"
done
if [ $again = yes ]; then
  other=$work/another/folder
  git clone -q "$project" "$other" >&2
  (cd "$other" && cmake --preset package && cmake --build --preset package && cd build/package && cpack -B "$work/third") >&2
  for package in "$work"/first/*.deb; do
    cmp "$package" "$work/third/$(basename "$package")" || fail "in another folder $(basename "$package") has other bytes"
  done
  rm -rf "$other"
  say "all packages, compiled again in another folder" "the same bytes"
fi

# A root with apt alone, and what the packages ask for.
begin=$SECONDS
mmdebstrap --variant=apt --quiet "$(. /etc/os-release && echo "$VERSION_CODENAME")" "$work/root" >&2
cp "$work"/first/*.deb "$work/root/tmp"
mount -t proc proc "$work/root/proc"
within() { chroot "$work/root" env -i PATH=/usr/bin:/bin:/usr/sbin:/sbin HOME=/root LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@"; }
# Patterns of file names are those of the root.
add() { within sh -c "apt-get install -q -y --no-install-recommends $*" >&2; }
within apt-get update -q >&2
add "/tmp/bonetk_*.deb"
say "a clean root with bonetk" "$((SECONDS - begin)) s, $(du -smx "$work/root" | cut -f 1) MB"

within bonetk --version >&2
cat > "$work/root/tmp/phantom.sh" << 'END'
set -eu
mkdir /tmp/try && cd /tmp/try
bonetk phantom --spacing 1 -o ct.nii.gz --labels labels.nii.gz
bonetk build ct.nii.gz --labels labels.nii.gz -o femur
bonetk info femur/model.hierarchy.json
# The page has its script, and the pictures have letters: a font was found.
[ "$(wc -c < femur/report.html)" -gt 1000000 ]
END
begin=$SECONDS
within sh /tmp/phantom.sh >&2
took=$((SECONDS - begin))
say "phantom, build and info" "$took s"
late=""
[ $took -le 60 ] || late="phantom, build and info"

# The README's first command, from the documentation's package.
add "/tmp/bonetk-doc_*.deb"
begin=$SECONDS
within sh -c "cd /tmp/try && /usr/share/doc/bonetk-doc/Examples/run.sh" >&2
took=$((SECONDS - begin))
say "the README's first command, Examples/run.sh" "$took s"
[ $took -le 60 ] || late="the README's first command"

add "/tmp/python3-bonetk_*.deb"
say "import bonetk" "$(within python3 -c "
import time
begin = time.time()
import bonetk
print(f'{time.time() - begin:.2f} s, version {bonetk.__version__}')")"
within python3 -c "
import bonetk
result = bonetk.commands.info('/tmp/try/femur/model.hierarchy.json')
assert 'hierarchy' in result.text, result.text
mesh = bonetk.read_mesh('/tmp/try/femur/model_L1.vtu')
assert mesh.points.shape[1] == 3, mesh" >&2

add "/tmp/libbonetk-dev_*.deb" g++ cmake ninja-build
begin=$SECONDS
within sh -c "cp -r /usr/share/doc/bonetk-doc/Examples /tmp/examples && cd /tmp/examples &&
  cmake -G Ninja -S . -B build && cmake --build build && cd /tmp/try && /tmp/examples/build/bonePhantomExample e.mha l.mha" >&2
say "all example programs built with libbonetk-dev" "$((SECONDS - begin)) s"
say "the root with all packages" "$(du -smx "$work/root" | cut -f 1) MB"
cat > "$project/Documentation/validation/packages.md" << END
# Packages

$made_by: the Debian packages, and a clean root of Debian $(. /etc/os-release && echo "$VERSION_ID") (\`mmdebstrap --variant=apt\`) into which apt
installs them. The limit for the phantom and for the README's first command is 60 s.

| | |
|---|---|
$rows
END
[ -z "$late" ] || fail "$late took more than 60 s"
