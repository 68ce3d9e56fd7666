#!/usr/bin/env python3
"""The line that every report begins with: by which script, at which commit and on which machine it was made.

    from report import made_by                   made_by(__file__)
    Testing/Validation/report.py NAME            prints it, for scripts of the shell
    Testing/Validation/report.py                 the commit alone
    Testing/Validation/report.py --of MODULE...  the last commit that changed these modules' programs
    Testing/Validation/report.py --stale         names of the reports that do not measure the programs as they are, a line each
    Testing/Validation/report.py --confirm       the others are given the present commit: nothing that they measure has changed
"""
import os
import pathlib
import platform
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = ROOT / "Documentation/validation"
# What the programs are made of, beside modules: reports that name one commit measure the same programs, whatever tests and pages
# came after it. Options of the compiler that change what it makes are those of presets and modules.
COMMON = ("CMakeLists.txt", "CMakePresets.json", "Apps", "Testing/Validation/*.cxx", "Testing/Validation/*.h",
          "Testing/Validation/CMakeLists.txt")
# Of the tests' folders validation programs take references and helpers, all but the tests themselves.
EXCLUDED = (":(exclude)Modules/*/test/*Test.cxx", ":(exclude)*.md")
AT = re.compile(r"^(Made by `[^`]*`) at commit ([0-9a-f]{7,12})(?: \(made at ([0-9a-f]{7,12}), [^)]*\))? on ", re.MULTILINE)


def git(*arguments):
    return subprocess.run(["git", "-C", ROOT, *arguments], capture_output=True, text=True)


def needed(modules):
    """The modules and all that they depend on."""
    found, left = set(), list(modules)
    while left:
        module = left.pop()
        if module not in found:
            found.add(module)
            listed = (ROOT / "Modules" / module / "CMakeLists.txt").read_text()
            depends = re.search(r"bonetk_module\(\w+\s+DEPENDS([\s\w]*?)(?:\s(?:PUBLIC|PRIVATE)\b|\))", listed)
            left += depends[1].split() if depends else []
    return sorted(found)


def sources(modules):
    """What git is asked about; of all modules for `all`."""
    of = ["Modules", "CMake"] if "all" in modules else [f"Modules/{module}" for module in needed(modules)]
    return (*COMMON, *of, *EXCLUDED)


def commit(modules=("all",)):
    """The last that changed what these modules' programs are made of, and whether it differs from it now."""
    of = sources(modules)
    last = git("log", "-1", "--format=%h", "--abbrev=7", "HEAD", "--", *of).stdout.strip()
    changed = git("diff", "--quiet", "HEAD", "--", *of).returncode != 0
    return last + (" with changes" if changed else "")


def measured():
    """Of each report of README.md's table, the modules that it measures."""
    rows = re.findall(r"^\| \[(\w+)\]\(\1\.md\) \| `.*` \| ([\w, ]+) \| .* \|$", (PAGES / "README.md").read_text(), re.MULTILINE)
    return {name: modules.split(", ") for name, modules in rows}


def is_same(modules, *commits):
    """Whether these modules' programs are the same at two commits, or at one and in the folder."""
    return git("diff", "--quiet", *commits, "--", *sources(modules)).returncode == 0


def is_fresh(name, modules, *since):
    """Whether nothing that the report measures has changed from the commit that it names to another, or to what is in the folder."""
    page = PAGES / f"{name}.md"
    made = AT.search(page.read_text()) if page.exists() else None
    return made is not None and is_same(modules, made[2], *since)


def stale():
    return [name for name, modules in measured().items() if not is_fresh(name, modules)]


def confirm(names):
    """Gives reports the present commit; names that at which they were made."""
    now = commit()
    for name in names if re.fullmatch("[0-9a-f]+", now) else []:
        page = PAGES / f"{name}.md"
        made = AT.search(page.read_text())
        if made and made[2] != now:
            line = f"{made[1]} at commit {now} (made at {made[3] or made[2]}, what it measures is the same) on "
            page.write_text(page.read_text().replace(made[0], line, 1))


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


def main(arguments):
    if arguments[:1] == ["--of"]:
        print(commit(arguments[1:]))
    elif arguments == ["--stale"]:
        print("".join(f"{name}\n" for name in stale()), end="")
    elif arguments == ["--confirm"]:
        left = stale()
        confirm(name for name in measured() if name not in left)
    else:
        print(made_by(arguments[0]) if arguments else COMMIT)


if __name__ == "__main__":
    main(sys.argv[1:])
