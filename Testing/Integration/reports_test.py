#!/usr/bin/env python3
"""Reports of validation: each says its script, commit and machine, is in the list of reports, and is made by run.sh."""
import os
import pathlib
import re
import shutil

from bonetk_testing import TestCase, main, run

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPTS = ROOT / "Testing/Validation"
PAGES = ROOT / "Documentation/validation"
MADE_BY = (r"Made by `Testing/Validation/([a-z_]+\.(?:py|sh))` at commit [0-9a-f]{7,12}( with changes| \(made at [0-9a-f]{7,12}, .*\))? "
           r"on \S.*\S")


def faults(pages, scripts):
    """What is amiss, a line each."""
    module = "(?:" + "|".join(sorted(child.name for child in (ROOT / "Modules").iterdir())) + ")"
    measured = re.findall(rf"^\| \[(\w+)\].*` \| (?:all|{module}(?:, {module})*) \| [^|]* \|$", (pages / "README.md").read_text(), re.MULTILINE)
    listed = dict(line.split("\t") for line in run(scripts / "run.sh", "--list")[1].splitlines())
    for name in sorted(listed):
        if not (pages / f"{name}.md").exists():
            yield f"{name} is listed, and there is no page"
    for page in sorted(pages.glob("*.md")):
        if page.name == "README.md":
            continue
        made = re.match(MADE_BY, (page.read_text().split("\n") + ["", ""])[2])
        if not made:
            yield f"{page.name}: its third line does not say script, commit and machine as report.py does"
        elif made[1] not in listed.get(page.stem, "").split():
            yield f"{page.name}: README.md lists no command of {made[1]} for it"
        elif page.stem not in measured:
            yield f"{page.name}: README.md lists no modules that exist for it"
        elif not re.search(r"made_by\(__file__\)|report\.py", (scripts / made[1]).read_text()):
            yield f"{made[1]} writes no line of report.py"


LIST = ("| page | command | measures | about |\n|---|---|---|---|\n| [one](one.md) | `one.sh $build` | Some | 1 min |\n"
        "| [two](two.md) | `NUMBER=2 two.sh \"a b\"` | Other, Third | 2 h |\n")


class Reports(TestCase):
    def copy(self):
        """The pages and scripts, to be changed."""
        shutil.copytree(PAGES, "Documentation/validation")
        os.makedirs("Testing")
        shutil.copytree(SCRIPTS, "Testing/Validation", ignore=shutil.ignore_patterns("*.cxx", "*.h"))
        return pathlib.Path("Documentation/validation"), pathlib.Path("Testing/Validation").absolute()

    def test_reports(self):
        self.assertEqual(list(faults(PAGES, SCRIPTS)), [])

    def test_line_of_a_report(self):
        code, out, err = run(SCRIPTS / "report.py", "some_script.sh")
        if (ROOT / ".git").exists():
            self.assertEqual((code, err), (0, ""))
            self.assertRegex(out, MADE_BY + r"\n$")

    def test_what_is_missing_is_seen(self):
        pages, scripts = self.copy()
        self.assertEqual(list(faults(pages, scripts)), [])
        text = (pages / "quality.md").read_text()
        (pages / "quality.md").write_text(re.sub(" at commit [0-9a-f]*", "", text))
        table = (pages / "README.md").read_text()
        (pages / "README.md").write_text(table.replace("thickness.py` | Measurement, Evaluation", "thickness.py` | Measurement, Evaluations"))
        (pages / "other.md").write_text(text)
        (pages / "atlas.md").unlink()
        (scripts / "tiling.py").write_text("")
        self.assertEqual([fault.split(":")[0] for fault in faults(pages, scripts)],
                         ["atlas is listed, and there is no page", "other.md", "quality.md", "thickness.md", "tiling.py writes no line of report.py"])

    def test_all_by_one_command(self):
        pages, scripts = self.copy()
        (pages / "README.md").write_text(LIST)
        (scripts / "one.sh").write_text('#!/bin/sh\necho "one $1" >> "$OUT"; exit 3\n')
        (scripts / "two.sh").write_text('#!/bin/sh\necho "two $NUMBER $1" >> "$OUT"\n')
        for name in ("one.sh", "two.sh"):
            (scripts / name).chmod(0o755)
        os.mkdir("build")
        environment = dict(os.environ, BONETK_DATA=".", BONETK_BUILD="build", OUT=os.path.abspath("out"))
        code, _, err = run(scripts / "run.sh", env=environment)
        self.assertEqual((code, err.splitlines()), (1, [f"{scripts}/run.sh: failed: one"]))
        self.assertEqual(pathlib.Path("out").read_text(), f"one {os.path.realpath('build')}\ntwo 2 a b\n")
        self.assertEqual(run(scripts / "run.sh", "two", env=environment)[0], 0)
        code, _, err = run(scripts / "run.sh", "three", env=environment)
        self.assertEqual(code, 2)
        self.assertIn("there is no report three", err)

    def made(self, scripts, environment):
        """Makes those that are stale: their names."""
        code, out, err = run(scripts / "run.sh", "--stale", env=environment)
        self.assertEqual((code, err), (0, ""))
        return [line.split()[1].rstrip(":") for line in out.splitlines() if line.endswith(" s")]

    def committed(self, file):
        """Changes the file, commits it, and returns the commit."""
        pathlib.Path(file).parent.mkdir(parents=True, exist_ok=True)
        with open(file, "a") as stream:
            stream.write(f"# {file}\n")
        for arguments in (("init", "--quiet"), ("add", "Modules", "Apps"), ("commit", "--quiet", "--message", file)):
            code, _, err = run("git", "-c", "user.name=a", "-c", "user.email=b@c", *arguments)
            self.assertEqual(code, 0, err)
        return run("git", "rev-parse", "--short=7", "HEAD")[1].strip()

    def test_those_of_other_programs_alone(self):
        """Reports whose modules changed, or those that these need, are made again; others are given the commit."""
        pages, scripts = self.copy()
        (pages / "README.md").write_text(LIST)
        for script in ("one.sh", "two.sh"):
            page = pages.absolute() / script.replace(".sh", ".md")
            (scripts / script).write_text(f'#!/bin/sh\n(echo "# Page"; echo; "{scripts}/report.py" {script}) > {page}\n')
            (scripts / script).chmod(0o755)
        for module, depends in (("Some", "\n  DEPENDS Base PRIVATE Library"), ("Other", ""), ("Third", " DEPENDS Base"), ("Base", ""),
                                ("Evaluation", " DEPENDS Base"), ("Phantom", "")):
            os.makedirs(f"Modules/{module}/test")
            pathlib.Path(f"Modules/{module}/CMakeLists.txt").write_text(f"bonetk_module({module}{depends})\n")
        os.mkdir("build")
        environment = dict(os.environ, BONETK_DATA=".", BONETK_BUILD="build", BONETK_WORK="work")
        first = self.committed("Apps/a.cxx")
        self.assertEqual(self.made(scripts, environment), ["one", "two"])
        self.assertEqual(self.made(scripts, environment), [])
        self.committed("Modules/README.md")
        self.committed("Modules/Some/test/bTest.cxx")
        self.committed("Modules/Base/README.md")
        (pages / "two.md").unlink()
        self.assertEqual(self.made(scripts, environment), ["two"])
        last = self.committed("Modules/Other/c.cxx")
        self.assertEqual(self.made(scripts, environment), ["two"])
        self.assertRegex((pages / "one.md").read_text(), f"at commit {last} \\(made at {first}, .*\\) on ")
        self.assertIn(f"at commit {last} on ", (pages / "two.md").read_text())
        latest = self.committed("Modules/Other/c.cxx")
        self.assertEqual(self.made(scripts, environment), ["two"])
        self.assertRegex((pages / "one.md").read_text(), f"at commit {latest} \\(made at {first}, .*\\) on ")
        with open("Modules/Some/d.cxx", "w"):
            self.assertEqual(self.made(scripts, environment), [])  # git does not know it
        self.committed("Modules/Some/d.cxx")
        self.assertEqual(self.made(scripts, environment), ["one"])
        self.committed("Modules/Some/test/reference.cxx")  # that validation programs take
        self.assertEqual(self.made(scripts, environment), ["one"])
        self.committed("Modules/Base/e.h")
        self.assertEqual(self.made(scripts, environment), ["one", "two"])
        with open("Modules/Other/c.cxx", "a") as stream:
            stream.write("# not committed\n")
        self.assertEqual(self.made(scripts, environment), ["two"])
        self.assertNotIn("with changes", (pages / "one.md").read_text())
        self.committed("Apps/f.cxx")
        self.assertEqual(self.made(scripts, environment), ["one", "two"])
        self.assertGreater(len(os.listdir("work")), 1)

    def fake(self, build, commit, differs="nothing"):
        """A build tree of the commit whose bonetk writes its arguments to what it is to write; something else where a command is named."""
        os.makedirs(f"{build}/Apps/bonetk")
        program = pathlib.Path(f"{build}/Apps/bonetk/bonetk")
        program.write_text(f'#!/bin/sh\n[ "$1" != --version ] || exec echo "commit     {commit} of 2026-01-01"\n'
                           'while [ "$1" != -o ]; do all="$all $1"; shift; done\n'
                           f'case "$all" in *{differs}*) all="$all changed";; esac\necho "\\"$all\\"" > "$2"\n')
        program.chmod(0o755)

    def test_reports_of_programs_that_do_the_same(self):
        pages, scripts = self.copy()
        (pages / "README.md").write_text(LIST)
        for module in ("Some", "Other", "Third"):
            os.makedirs(f"Modules/{module}")
            pathlib.Path(f"Modules/{module}/CMakeLists.txt").write_text(f"bonetk_module({module})\n")
        first, second, now = (self.committed(file) for file in ("Apps/a.cxx", "Modules/Other/b.cxx", "Modules/Some/c.cxx"))
        for name in ("one", "two"):
            (pages / f"{name}.md").write_text(f"# Page\n\nMade by `Testing/Validation/one.sh` at commit {first} on a machine.\n")
        long = {commit: run("git", "rev-parse", "--short=12", commit)[1].strip() for commit in (second, now)}
        for build, commit, differs in (("old", second, "nothing"), ("new", now, "nothing"), ("other", now, "thickness")):
            self.fake(build, long[commit], differs)
        environment = dict(os.environ, BONETK_DATA=".")

        def unchanged(old, new, page):
            code, out, err = run(scripts / "unchanged.py", old, new, "--confirm", page, env=environment)
            return code, out, err.strip()

        code, out, err = unchanged("old", "other", "one")
        self.assertEqual((code, err), (1, "1 files differ"))
        self.assertRegex(out, "\nbonetk thickness .* -> thickness.vtp\n")
        self.assertEqual(out.count("-> the same\n"), out.count("\n") - 1)
        for old, new, page, says in (("old", "old", "one", "not of the sources as they are"), ("old", "new", "two", "two measured other programs"),
                                     ("old", "new", "three", "there is no report three")):
            code, _, err = unchanged(old, new, page)
            self.assertEqual(code, 1)
            self.assertIn(says, err)
        for name in ("one", "two"):
            self.assertIn(f"at commit {first} on ", (pages / f"{name}.md").read_text())
        self.assertEqual(unchanged("old", "new", "one")[::2], (0, ""))
        self.assertIn(f"at commit {now} (made at {first}, what it measures is the same) on ", (pages / "one.md").read_text())
        self.assertIn(f"at commit {first} on ", (pages / "two.md").read_text())


if __name__ == "__main__":
    main()
