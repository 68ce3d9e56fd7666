"""Anchors of headings as GitHub makes them, so that links hold in both."""
import re


def github_slug(heading, separator):
    return re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", separator)
