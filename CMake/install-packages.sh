#!/usr/bin/env bash
# Installs the Debian packages that BoneTK is built and tested with, as root or through sudo; those that are there
# already cost nothing.
set -euo pipefail
list=$(dirname "$0")/debian-packages.txt

if ! command -v apt-get > /dev/null; then
  echo "No apt-get here: install what corresponds to $list by hand." >&2
  exit 0
fi

missing=()
while read -r package; do
  status=$(dpkg-query -W -f '${Status}' "$package" 2> /dev/null || true)
  [ "$status" = "install ok installed" ] || missing+=("$package")
done < "$list"
# Not in the list, as Debian's npm and a nodejs of another archive, which brings its own npm, exclude each other.
command -v npm > /dev/null || missing+=(nodejs npm)
[ ${#missing[@]} -gt 0 ] || exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo > /dev/null; then
    echo "Missing packages: ${missing[*]}. Install them as root, or install sudo." >&2
    exit 1
  fi
  as_root=(sudo)
fi
echo "Installing ${missing[*]}"
"${as_root[@]}" apt-get update -q
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}"
