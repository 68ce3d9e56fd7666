#!/usr/bin/env python3
"""The documentation's site is made without warnings, and its links hold, as do those of the sources' pages."""
import os
import pathlib
import sys
import unittest

from bonetk_testing import TestCase, main, run

ROOT = pathlib.Path(__file__).resolve().parents[2]
SITE = ROOT / "Documentation/site"


def check_links(*folders):
    code, out, err = run(sys.executable, SITE / "check_links.py", *folders)
    return code, out.splitlines(), err


class Site(TestCase):
    def test_site(self):
        code, out, err = run("bash", SITE / "make.sh", os.environ["BONETK_BUILD"], "site")
        self.assertEqual((code, out + err), (0, ""))
        self.assertEqual(check_links("site/html")[:2], (0, []))
        for page in ("index.html", "Documentation/guide.html", "reference/classbone_1_1DensityFitFilter.html",
                     "reference/structbone_1_1DensityFitParameters.html"):
            self.assertGreater((pathlib.Path("site/html") / page).stat().st_size, 5000, page)

    def test_links_of_the_sources(self):
        code, faults, err = check_links(ROOT)
        self.assertEqual((code, faults), (0, []))
        self.assertGreater(int(err.split()[0]), 50)

    def test_what_is_wrong_is_seen(self):
        pages = {"index.html": '<h1 id="a">A</h1><a href="b.html#c">b</a><a href="#a">a</a>', "b.html": '<p id="c">',
                 "one.md": "# A `b` c\n[x](two.md#a-b-c) [y](#a-b-c)", "two.md": "## A b, c"}
        for name, text in pages.items():
            pathlib.Path(name).write_text(text)
        self.assertEqual(check_links("."), (0, [], "2 links, 0 faults\n"))
        for name, change, says in (("index.html", ("#c", "#d"), "b.html#d: there is no such place"),
                                   ("index.html", ("b.html", "../b.html"), "there is no such file"),
                                   ("index.html", ("b.html#c", "#a"), "b.html: no link leads here")):
            pathlib.Path(name).write_text(pages[name].replace(*change))
            code, faults, _ = check_links(".")
            self.assertEqual(code, 1)
            self.assertTrue(any(says in fault for fault in faults), (says, faults))
        os.remove("index.html")
        self.assertEqual(check_links("."), (0, [], "2 links, 0 faults\n"))
        pathlib.Path("two.md").write_text("## A b\n[z](three.md)")
        self.assertEqual(check_links(".")[1], ["one.md: two.md#a-b-c: there is no such place in the page",
                                               "two.md: three.md: there is no such file"])


if __name__ == "__main__":
    main()
