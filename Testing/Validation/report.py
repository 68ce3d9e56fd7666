#!/usr/bin/env python3
"""The line that every report begins with: by which script, at which commit and on which machine it was made.

    from report import made_by          made_by(__file__)
    Testing/Validation/report.py NAME   prints it, for scripts of the shell"""
import os
import pathlib
import platform
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]


def commit():
    """That of the sources, and whether they differ from it."""
    git = ["git", "-C", ROOT]
    head = subprocess.run([*git, "rev-parse", "--short=7", "HEAD"], capture_output=True, text=True, check=True).stdout.strip()
    changed = subprocess.run([*git, "diff", "--quiet", "HEAD", "--", "Modules", "Apps", "Testing"]).returncode != 0
    return head + (" with changes" if changed else "")


def machine():
    """Processor and number of threads."""
    with open("/proc/cpuinfo") as file:
        models = [line.split(":")[1].strip() for line in file if line.startswith("model name")]
    return f"{models[0] if models else platform.machine()}, {os.cpu_count()} processors"


COMMIT = commit()  # when the script begins: it may run for hours


def made_by(script):
    """Without a full stop, for what there is to add."""
    return f"Made by `Testing/Validation/{os.path.basename(script)}` at commit {COMMIT} on {machine()}"


if __name__ == "__main__":
    print(made_by(sys.argv[1]))
