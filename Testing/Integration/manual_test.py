#!/usr/bin/env python3
"""Manual pages and completions name every command and option that the help has, and are what man and the shells read."""
import glob
import gzip
import os
import pathlib
import re
import shutil
import subprocess
import unittest

from bonetk_testing import TestCase, bonetk, main, run

FOLDER = pathlib.Path(os.environ["BONETK_BUILD"]) / "Apps/manual"


def page(name):
    for path in (FOLDER / "man1" / f"{name}.1.gz", FOLDER / "man1" / f"{name}.1"):
        if path.exists():
            return (gzip.open if path.suffix == ".gz" else open)(path, "rt").read()
    raise AssertionError(f"there is no page {name}")


def completion(name):
    return (FOLDER / "completions" / name).read_text()


def subcommands(*group):
    """By the help of the program, or of a group."""
    text = bonetk(*group, "--help")[1]
    return re.findall(r"^  ([a-z]+) ", text.split("Subcommands:")[1], re.M) if "Subcommands:" in text else []


def options(*command):
    text = bonetk(*command, "--help")[1].split("Options:")[1]
    named = re.findall(r"^  (-\S+)", text, re.M)
    return [re.sub(r"\{.*", "", name) for names in named for name in names.split(",")]


def commands():
    for name in subcommands():
        inner = subcommands(name)
        yield from ((name, other) for other in inner) if inner else ((name,),)


def need(program):
    if not shutil.which(program):
        raise unittest.SkipTest(f"there is no {program} here")


class Manual(TestCase):
    def test_every_command_and_option_is_named(self):
        bash, zsh, fish = (completion(name) for name in ("bonetk.bash", "_bonetk", "bonetk.fish"))
        listed = page("bonetk")
        seen = 0
        for command in commands():
            name = " ".join(command)
            self.assertIn(f"\\fB{name}\\fR", listed)
            text = page("bonetk-" + "-".join(command)).replace("\\-", "-")
            words = re.search(rf'^    " {name}"\) words=" (.*)" ;;$', bash, re.M)[1].split()
            function = re.search(rf"^_bonetk_{'_'.join(command)}\(\)\n{{(.*?)^}}", zsh, re.M | re.S)[1]
            lines = [line for line in fish.splitlines() if f"__bonetk_at \\'{name}\\'" in line]
            self.assertEqual(sorted(words), sorted(options(*command)), name)
            for option in words:
                seen += 1
                self.assertIn(f"\\fB{option}\\fR", text, name)
                self.assertRegex(function, rf"'\*?{option}\[", name)
                plain = f" -l {option[2:]} " if option.startswith("--") else f" -s {option[1:]} "
                self.assertTrue(any(plain in line + " " for line in lines), f"{name} {option}")
        self.assertGreater(seen, 300)

    def test_pages_have_no_fault(self):
        need("groff")
        pages = sorted(glob.glob(str(FOLDER / "man1/*")))
        self.assertEqual(len(pages), 1 + len(list(commands())))
        for path in pages:
            text = page(os.path.basename(path).split(".")[0])
            done = subprocess.run(["groff", "-ww", "-man", "-Tutf8"], input=text, capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (0, ""), path)
            if shutil.which("mandoc"):
                said = subprocess.run(["mandoc", "-T", "lint", "-W", "warning"], input=text, capture_output=True, text=True)
                # The date is that of the commit, which an archive has not.
                faults = [line for line in said.stdout.splitlines() if "missing date" not in line]
                self.assertEqual(faults, [], path)

    def complete_in_bash(self, *words):
        script = ('source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _bonetk; '
                  'printf "%s\\n" "${COMPREPLY[@]}"')
        code, out, err = run("bash", "--norc", "-uc", script, "bash", FOLDER / "completions/bonetk.bash", "bonetk", *words)
        self.assertEqual((code, err), (0, ""))
        return out.split()

    def test_bash_completes(self):
        for words, expected in ((["bui"], ["build"]), (["build", "--deg"], ["--degree"]),
                                (["register", ""], ["rigid", "deform", "volume", "subject", "--help"]),
                                (["register", "rigid", "m.vtu", "--display-cu"], ["--display-curve"]),
                                (["register", "rigid", "--display-curve", ""], ["linear", "log"]),
                                (["drr", "m.vtu", "--view", "left"], ["left-lateral"]),
                                (["build", "--degree", ""], []), (["build", "--labels", ""], []),
                                (["build", "ct.nii", "--no"], ["--no-page"]), (["--ver"], ["--version"])):
            self.assertEqual(self.complete_in_bash(*words), expected, words)

    def test_fish_completes(self):
        need("fish")
        for line, expected in (("bonetk bui", ["build"]), ("bonetk build --deg", ["--degree"]),
                               ("bonetk register ", ["deform", "rigid", "subject", "volume"]),
                               ("bonetk register rigid --display-curve ", ["linear", "log"]),
                               ("bonetk build --degree ", [])):
            code, out, err = run("fish", "--no-config", "-c", "source $argv[1]; complete -C $argv[2]",
                                 FOLDER / "completions/bonetk.fish", line)
            self.assertEqual((code, err), (0, ""))
            self.assertEqual([match.split("\t")[0] for match in out.splitlines()], expected, line)

    def test_zsh_reads_it(self):
        need("zsh")
        self.assertEqual(run("zsh", "-fn", FOLDER / "completions/_bonetk"), (0, "", ""))


if __name__ == "__main__":
    main()
