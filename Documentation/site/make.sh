#!/usr/bin/env bash
# Makes the documentation's site, static HTML: the C++ reference by Doxygen, whose warnings are errors, and around it the
# guide, tutorials, reports and pages of the modules by mkdocs.
#
#   Documentation/site/make.sh BUILD-TREE FOLDER      FOLDER/html/index.html is its first page
set -euo pipefail
build=$1
mkdir -p "$2"
site=$(cd "$2" && pwd)
here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../.."

rm -rf "$site"/{install,pages,html}
# The pages as they are installed: in the sources' layout, so that their links hold.
cmake --install "$build" --component documentation --prefix "$site/install" > /dev/null
mv "$site"/install/share/doc/bonetk-doc "$site/pages"
rm -r "$site/install"
BONETK_SITE=$site/pages doxygen Documentation/site/Doxyfile
# Doxygen 1.9.4 links to the list of a class' private classes, which it leaves out.
grep -LZ 'name="nested-classes"' "$site"/pages/reference/*.html | xargs -0 sed -i '/<a href="#nested-classes">/d'
(cat "$here/site.css" && pygmentize -S friendly -f html -a .codehilite) > "$site/pages/site.css"
cp "$here/mkdocs.yml" "$site"
PYTHONPATH=$here PYTHONDONTWRITEBYTECODE=1 mkdocs build --quiet --strict --config-file "$site/mkdocs.yml"
rm "$site/html/404.html" # of use to a server alone
