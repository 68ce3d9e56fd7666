#!/usr/bin/env python3
"""Checks links within the documentation: files, anchors, and pages that no link leads to.

    check_links.py FOLDER...      each a site of HTML pages with an index.html, or sources with Markdown pages

Prints a line for each fault; ends with 1 where there is one. Links to other sites are not followed."""
import html
import pathlib
import re
import sys
import urllib.parse

from github_slug import github_slug

SKIPPED = {"build", ".git", "node_modules"}


def html_page(path):
    """Anchors and links of a page."""
    text = re.sub(r"<script.*?</script>|<!--.*?-->", "", path.read_text(errors="replace"), flags=re.DOTALL)
    anchors = set(re.findall(r'\s(?:id|name)="([^"]+)"', text))
    return anchors, re.findall(r'<[a-z][^>]*?\s(?:href|src)="([^"]*)"', text)


def markdown_page(path):
    text = re.sub(r"^```.*?^```", "", path.read_text(), flags=re.DOTALL | re.MULTILINE)
    anchors = set()
    for heading in re.findall(r"^#+ (.*)$", text, re.MULTILINE):
        slug = github_slug(re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading).replace("`", ""), "-")
        anchors.add(slug if slug not in anchors else f"{slug}-{sum(one.startswith(slug) for one in anchors)}")
    return anchors, re.findall(r"\]\(<?([^)\s>]+)>?\)", re.sub(r"`[^`]*`", "", text))


def check(folder):
    """The faults of a folder, and the number of its links within it."""
    root = pathlib.Path(folder).resolve()
    site = (root / "index.html").exists()
    read = html_page if site else markdown_page
    paths = [path for path in root.rglob("*.html" if site else "*.md") if not SKIPPED & set(path.relative_to(root).parts)]
    pages = {path: read(path) for path in paths}
    faults, count, linked = [], 0, {root / "index.html"}
    for path, (_, links) in pages.items():
        for link in links:
            parts = urllib.parse.urlsplit(html.unescape(link))
            if parts.scheme or parts.netloc or not (parts.path or parts.fragment):
                continue
            count += 1
            relative, anchor = urllib.parse.unquote(parts.path), urllib.parse.unquote(parts.fragment)
            target = (path.parent / relative).resolve() if relative else path
            where = f"{path.relative_to(root)}: {link}"
            if not target.is_file() or root not in target.parents:
                faults.append(f"{where}: there is no such file")
            elif anchor and target in pages and anchor not in pages[target][0]:
                faults.append(f"{where}: there is no such place in the page")
            if target != path:
                linked.add(target)
    # Doxygen's own pages are found by its scripts.
    faults += [f"{path.relative_to(root)}: no link leads here" for path in pages
               if site and path not in linked and "reference" not in path.relative_to(root).parts]
    return faults, count


if __name__ == "__main__":
    found = [check(folder) for folder in sys.argv[1:]]
    for fault in sorted(fault for faults, _ in found for fault in faults):
        print(fault)
    print(f"{sum(count for _, count in found)} links, {sum(len(faults) for faults, _ in found)} faults", file=sys.stderr)
    sys.exit(any(faults for faults, _ in found))
