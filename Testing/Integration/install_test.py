#!/usr/bin/env python3
"""What is installed from the build tree: the program with what belongs to it, the Python package, and find_package(BoneTK)
for a project of its own. And what --version says."""
import os
import pathlib
import re
import shutil

from bonetk_testing import BONETK, TestCase, bonetk, main, run

BUILD = pathlib.Path(os.environ["BONETK_BUILD"])
ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "CMake/BoneTKBuildInformation.cmake"


class Install(TestCase):
    def install(self, *components):
        for component in components:
            code, _, err = run("cmake", "--install", BUILD, "--prefix", "prefix", "--component", component)
            self.assertEqual(code, 0, err)
        return pathlib.Path("prefix").absolute()

    def test_program(self):
        prefix = self.install("program")
        code, out, err = run("prefix/bin/bonetk", "--version")
        self.assertEqual((code, out, err), bonetk("--version"))
        for file in ("man/man1/bonetk.1*", "man/man1/bonetk-register-rigid.1*", "bash-completion/completions/bonetk",
                     "zsh/*/_bonetk", "fish/vendor_completions.d/bonetk.fish", "doc/bonetk/copyright"):
            self.assertEqual(len(list((prefix / "share").glob(file))), 1, file)
        licence = (prefix / "share/doc/bonetk/copyright").read_text()
        for text in ("Apache License", "CLI11", "vtk.js") if (BUILD / "Modules/Report/page/bundle.js").exists() else ("Apache",):
            self.assertIn(text, licence)
        # No file of the build tree is asked for, but for what its own strings name for messages.
        self.assertNotIn(str(BUILD).encode() + b"/Modules", pathlib.Path("prefix/bin/bonetk").read_bytes())

    def test_project_that_uses_it(self):
        prefix = self.install("development", "documentation")
        shutil.copytree(prefix / "share/doc/bonetk-doc/Examples", "examples")
        code, out, err = run("cmake", "-S", "examples", "-B", "build", "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}",
                             "-DCMAKE_BUILD_TYPE=Debug")
        self.assertEqual(code, 0, out + err)
        code, out, err = run("cmake", "--build", "build", "--target", "bonePhantomExample")
        self.assertEqual(code, 0, out + err)
        code, out, err = run("build/bonePhantomExample", "ct.mha", "labels.mha")
        self.assertEqual(code, 0, out + err)
        self.assertTrue(os.path.getsize("ct.mha") > 0 and os.path.getsize("labels.mha") > 0)

    def test_example_uses_what_is_installed(self):
        prefix = self.install("program", "documentation")
        script = prefix / "share/doc/bonetk-doc/Examples/run.sh"
        # A stand-in, as the femur of this example takes half a minute.
        (prefix / "bin/bonetk").unlink()
        (prefix / "bin/bonetk").write_text('#!/bin/sh\necho "bonetk 9"; echo "$@" >> called\n')
        (prefix / "bin/bonetk").chmod(0o755)
        code, out, err = run(script, env={"PATH": f"{prefix}/bin:/usr/bin:/bin"})
        self.assertEqual((code, err), (0, ""))
        self.assertIn(f"By {prefix}/bin/bonetk, bonetk 9:", out)
        called = pathlib.Path("called").read_text().split("\n")
        self.assertIn(f"-o {os.getcwd()}/out/femur_phantom", called[2])
        code, _, err = run(script, env={"PATH": "/usr/bin:/bin"}) if not shutil.which("bonetk") else (1, "", "no bonetk")
        self.assertEqual(code, 1)
        self.assertIn("no bonetk", err)

    def test_version(self):
        code, out, err = bonetk("--version")
        self.assertEqual((code, err), (0, ""))
        commit = r"([0-9a-f]{12} of \d{4}-\d\d-\d\d(, changed)?|unknown: built without git)"
        self.assertRegex(out, rf"^bonetk \d+\.\d+\.\d+\ncommit     {commit}\ncompiler   \w+ [\d.]+, \w+\n"
                              r"libraries  ITK [\d.]+, VTK [\d.]+, Eigen [\d.]+\n$")

    def values(self, source, commit=""):
        """What CMake writes of a source tree: commit, date, and whether it was changed."""
        code, _, err = run("cmake", f"-DSOURCE={source}", "-DGIT=git", f"-DCOMMIT={commit}", "-DVERSION=1.2.3",
                           "-DCOMPILER=GNU 1", "-DCONFIGURATION=Release", "-DOUTPUT=values.cxx", "-P", SCRIPT)
        self.assertEqual(code, 0, err)
        text = pathlib.Path("values.cxx").read_text()
        return re.search(r'\{ "1.2.3", "(.*)", "(.*)", (\w+), "GNU 1", "Release" \}', text).groups()

    def test_commit(self):
        def git(*arguments):
            self.assertEqual(run("git", "-C", "tree", "-c", "user.name=n", "-c", "user.email=e", *arguments)[0], 0)

        os.makedirs("tree/archive")
        pathlib.Path("tree/file").write_text("1")
        self.assertEqual(self.values("tree"), ("", "", "false"))
        git("init", "-q")
        self.assertEqual(self.values("tree"), ("", "", "false"))  # before the first commit
        git("add", "file")
        git("commit", "-qm", "first", "--date", "2026-03-01T12:00:00")
        commit, date, changed = self.values("tree")
        self.assertRegex(commit, "^[0-9a-f]{12}$")
        self.assertRegex(date, r"^\d{4}-\d\d-\d\d$")
        self.assertEqual(changed, "false")
        written = os.stat("values.cxx").st_mtime_ns
        self.values("tree")
        self.assertEqual(os.stat("values.cxx").st_mtime_ns, written)  # nothing is compiled anew
        pathlib.Path("tree/file").write_text("2")
        self.assertEqual(self.values("tree"), (commit, date, "true"))
        self.assertEqual(self.values("tree/archive"), ("", "", "false"))  # in another project's repository
        self.assertEqual(self.values("tree", "abc"), ("abc", "", "false"))


if __name__ == "__main__":
    main()
