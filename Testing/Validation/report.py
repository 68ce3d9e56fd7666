#!/usr/bin/env python3
"""The line that every report begins with: by which script, at which commit and on which machine it was made.

    from report import made_by          made_by(__file__)
    Testing/Validation/report.py NAME   prints it, for scripts of the shell
    Testing/Validation/report.py        the commit alone"""
import os
import pathlib
import platform
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
# What the programs are made of: reports that name one commit measure the same programs, whatever tests and pages came after it.
# Of the tests' folders validation programs take references and helpers, all but the tests themselves.
PROGRAMS = ("CMake", "CMakeLists.txt", "Modules", "Apps", "Testing/Validation/*.cxx", "Testing/Validation/*.h",
            "Testing/Validation/CMakeLists.txt", ":(exclude)Modules/*/test/*Test.cxx", ":(exclude)*.md")


def commit():
    """The last that changed the programs measured, and whether they differ from it now."""
    git = ["git", "-C", ROOT]
    last = subprocess.run([*git, "log", "-1", "--format=%h", "--abbrev=7", "HEAD", "--", *PROGRAMS], capture_output=True, text=True,
                          check=True).stdout.strip()
    changed = subprocess.run([*git, "diff", "--quiet", "HEAD", "--", *PROGRAMS]).returncode != 0
    return last + (" with changes" if changed else "")


def machine():
    """Processor, what tells its generation and the width of its vectors, and number of threads."""
    with open("/proc/cpuinfo") as file:
        lines = [line.partition(":")[::2] for line in file.read().split("\n\n")[0].splitlines()]
    about = {name.strip(): value.strip() for name, value in lines}
    if "model name" not in about:
        return f"{platform.machine()}, {os.cpu_count()} processors"
    flags = about.get("flags", "").split()
    vectors = next((name for flag, name in (("avx512f", "AVX-512"), ("avx2", "AVX2")) if flag in flags), "no AVX2")
    return f"{about['model name']} (family {about['cpu family']}, model {about['model']}, {vectors}), {os.cpu_count()} processors"


COMMIT = commit()  # when the script begins: it may run for hours


def made_by(script):
    """Without a full stop, for what there is to add."""
    return f"Made by `Testing/Validation/{os.path.basename(script)}` at commit {COMMIT} on {machine()}"


if __name__ == "__main__":
    print(made_by(sys.argv[1]) if len(sys.argv) > 1 else COMMIT)
