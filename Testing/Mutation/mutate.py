#!/usr/bin/env python3
"""Plants faults in the kernels, one at a time, and says which of them no test sees.

    Testing/Mutation/mutate.py FOLDER [--named] [--random COUNT --seed SEED] [--again RESULTS [--survivors]] [--own] [-j JOBS]

FOLDER is where a copy of the checkout is made and built; the checkout is not touched. A fault is planted in the copy, the
tests of its module are built and run, and, where they pass, those of modules that stand on it, the contract of all filters
and the whole job in C++. Test programs are built when they are first needed, and have to pass before anything is planted.
A fault is killed by a test that fails, crashes, or takes more than a minute and ten times as long as without the fault; one
that does not compile is none, and another is drawn for it. Results are appended to FOLDER/results.txt, a line a fault:

    killed by TEST, or SURVIVED; FILE:LINE; what; old line; new line       (with tabulators between)

`--again` plants those of such a file once more, wherever their lines stand now. Faults that are named stand in named.txt
beside this script. See README.md for what survived and why.
"""
import argparse
import itertools
import os
import random
import re
import resource
import shutil
import subprocess
import sys
import time

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))

# Modules with kernels, and the test programs that are run, in order, until one fails: first the module's own.
TESTS = {"Core": ["Core", "Tiling", "Quality", "Density", "Simplification", "Filter", "Integration"],
         "Contour": ["Contour", "Filter", "Integration"],
         "Tiling": ["Tiling", "Quality", "Filter", "Integration"],
         "Quality": ["Quality", "Simplification", "Filter", "Integration"],
         "Density": ["Density", "Simplification", "Filter", "Integration"],
         "Simplification": ["Simplification", "Filter", "Integration"],
         "Radiograph": ["Radiograph", "Filter", "Integration"],
         "Atlas": ["Atlas", "Filter"],
         "Phantom": ["Phantom", "Filter", "Integration"],
         "Evaluation": ["Evaluation", "Integration"],
         "Measurement": ["Measurement"],
         "Export": ["Export"]}

# A fault may ask for memory without end.
MEMORY = 8 << 30

# What is changed, and into what. Changes that mean the same in most places, as < into <=, are left out.
OPERATORS = [
    ("plus to minus", re.compile(r"(?<=[\w\])] )\+(?= [\w(])"), "-"),
    ("minus to plus", re.compile(r"(?<=[\w\])] )-(?= [\w(])"), "+"),
    ("times to divide", re.compile(r"(?<=[\w\])] )\*(?= [\w(])"), "/"),
    ("divide to times", re.compile(r"(?<=[\w\])] )/(?= [\w(])"), "*"),
    ("less to greater", re.compile(r"(?<=[\w\])] )<(?= [\w(-])"), ">"),
    ("greater to less", re.compile(r"(?<=[\w\])] )>(?= [\w(-])"), "<"),
    ("equal to unequal", re.compile(r"(?<= )==(?= )"), "!="),
    ("unequal to equal", re.compile(r"(?<= )!=(?= )"), "=="),
    ("and to or", re.compile(r"(?<= )&&(?= )"), "||"),
    ("or to and", re.compile(r"(?<= )\|\|(?= )"), "&&"),
    ("min to max", re.compile(r"std::min\b(?=\()"), "std::max"),
    ("max to min", re.compile(r"std::max\b(?=\()"), "std::min"),
    ("half to one", re.compile(r"\b0\.5\b"), "1.0"),
    ("plus-equal to minus-equal", re.compile(r"(?<= )\+=(?= )"), "-="),
    ("minus-equal to plus-equal", re.compile(r"(?<= )-=(?= )"), "+="),
    ("condition negated", re.compile(r"(?<=\bif \()(?=[^!\n]*\)$)"), "!("),
    ("call left out", re.compile(r"^\s+(this->)?[A-Z]\w*\([^;{}]*\);$"), ";"),
]


def sources():
    found = []
    for module in TESTS:
        for folder, _, files in os.walk(os.path.join(ROOT, "Modules", module)):
            if os.sep + "test" in folder:
                continue
            for name in sorted(files):
                if name.endswith((".cxx", ".hxx")) and "Instantiations" not in name:
                    found.append((module, os.path.relpath(os.path.join(folder, name), ROOT)))
    return sorted(found)


def candidates(lines):
    """(line number, what, start, end, replacement) of all faults that a file could have."""
    found = []
    for number, line in enumerate(lines):
        text = line.split("//")[0]
        stripped = text.strip()
        if not stripped or stripped.startswith(("#", "*", "/*", "///", "template", "using", "static_assert", "case", "typename")) \
                or "operator" in text or "execution" in text.lower() or "Exception" in text or '"' in text:
            continue
        for what, pattern, replacement in OPERATORS:
            for match in pattern.finditer(text.rstrip()):
                found.append((number, what, match.start(), match.end(), replacement))
    return found


def changed(line, start, end, what, replacement):
    end_of_line = "\n" if line.endswith("\n") else ""
    text = line.rstrip("\n")
    new = text[:start] + replacement + text[end:]
    return new + (")" if what == "condition negated" else "") + end_of_line


def draw(count, seed):
    """Faults at random, alike likely in each line of code that could have one."""
    chance = random.Random(seed)
    places = []
    for module, path in sources():
        with open(os.path.join(ROOT, path)) as file:
            lines = file.readlines()
        by_line = {}
        for fault in candidates(lines):
            by_line.setdefault(fault[0], []).append(fault)
        places += [(module, path, faults, lines[number]) for number, faults in by_line.items()]
    chance.shuffle(places)
    for module, path, faults, line in places:
        number, what, start, end, replacement = chance.choice(faults)
        yield module, path, number, what, line, changed(line, start, end, what, replacement)


def named():
    """FILE | what | text of one line, or text #2 for the second line that has it | new text, from named.txt."""
    with open(os.path.join(HERE, "named.txt")) as file:
        for entry in file:
            if not entry.strip() or entry.startswith("#"):
                continue
            path, what, old, new = [part.strip() for part in entry.split(" | ")]
            with open(os.path.join(ROOT, path)) as source:
                lines = source.readlines()
            old, _, which = old.partition(" #")
            numbers = [i for i, line in enumerate(lines) if old in line]
            if not which and len(numbers) != 1:
                sys.exit(f"named.txt: {path} has {len(numbers)} lines with: {old}")
            number = numbers[int(which or 1) - 1]
            yield path.split("/")[1], path, number, what, lines[number], lines[number].replace(old, new)


def again(path, survivors):
    """Those of a file of results, where their lines stand now: the nearest to where they stood."""
    with open(path) as file:
        for entry in file:
            outcome, place, what, old, new = entry.rstrip("\n").split("\t")
            if survivors and outcome != "SURVIVED":
                continue
            source, number = place.rsplit(":", 1)
            with open(os.path.join(ROOT, source)) as code:
                lines = code.readlines()
            numbers = [i for i, line in enumerate(lines) if line.strip() == old]
            if not numbers:
                print(f"gone: {place} {old}", flush=True)
                continue
            at = min(numbers, key=lambda i: abs(i + 1 - int(number)))
            yield source.split("/")[1], source, at, what, lines[at], lines[at].replace(old, new)


def limit_memory():
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))


def run(command, folder, seconds, limited=False):
    try:
        done = subprocess.run(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              errors="replace", timeout=seconds, preexec_fn=limit_memory if limited else None)
        return done.returncode, done.stdout
    except subprocess.TimeoutExpired as late:
        return -1, (late.stdout or b"").decode(errors="replace")


class Copy:
    """A copy of the checkout and its build."""

    def __init__(self, folder, jobs):
        self.root = os.path.join(folder, "source")
        self.build = os.path.join(folder, "build")
        self.jobs = str(jobs)
        self.seconds = {}  # that a program takes without a fault
        os.makedirs(self.root, exist_ok=True)
        listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, capture_output=True, text=True)
        wanted = {path for path in listed.stdout.split("\n") if path and os.path.exists(os.path.join(ROOT, path))}
        for path in wanted:
            target, source = os.path.join(self.root, path), os.path.join(ROOT, path)
            if not os.path.exists(target) or not same(source, target):
                os.makedirs(os.path.dirname(target), exist_ok=True)
                shutil.copyfile(source, target)
        for parent, _, files in os.walk(self.root):
            for path in (os.path.join(parent, name) for name in files):
                if os.path.relpath(path, self.root) not in wanted:
                    os.remove(path)
        code, text = run(["cmake", "-G", "Ninja", "-S", self.root, "-B", self.build, "-DCMAKE_BUILD_TYPE=Release",
                          "-DCMAKE_CXX_FLAGS_RELEASE=-O1", "-DBONETK_UNITY_BUILD=OFF"], folder, 600)
        if code != 0:
            sys.exit(text)

    def make(self, tested):
        return run(["cmake", "--build", self.build, "-j", self.jobs, "--target", f"bone{tested}Tests"], self.root, 7200)

    def test(self, name, seconds):
        """Whether the tests pass, and the first that does not."""
        program = os.path.join(self.build, f"Modules/{name}" if name in TESTS else "Testing", f"bone{name}Tests")
        code, text = run([program, "--gtest_brief=0", "--gtest_fail_fast"], self.root, seconds, limited=True)
        # Where a test crashes or takes too long it is the last that was begun.
        failed = re.findall(r"\[  FAILED  \] (\S+?),? ", text) or re.findall(r"\[ RUN +\] (\S+)", text)[-1:]
        return code == 0, f"{name}.{failed[0]}" if failed else name

    def prepare(self, name):
        """Builds and runs the tests without a fault, once."""
        if name in self.seconds:
            return
        code, text = self.make(name)
        if code != 0:
            sys.exit(text)
        start = time.monotonic()
        passed, test = self.test(name, 3600)
        if not passed:
            sys.exit(f"{test} fails without a fault.")
        self.seconds[name] = time.monotonic() - start

    def write(self, path, lines):
        with open(os.path.join(self.root, path), "w") as file:
            file.writelines(lines)

    def try_fault(self, tests, path, number, new):
        """None where it does not compile, else the name of the test that sees it, or "" where none does."""
        with open(os.path.join(ROOT, path)) as file:
            lines = file.readlines()
        for tested in tests:
            self.prepare(tested)
            self.write(path, lines[:number] + [new] + lines[number + 1:])
            try:
                code, text = self.make(tested)
                if code != 0:
                    # Tests are listed as part of building.
                    return None if "error:" in text else f"{tested}, whose tests cannot be listed"
                passed, killer = self.test(tested, 60 + 10 * self.seconds[tested])
                if not passed:
                    return killer
            finally:
                self.write(path, lines)
        return ""


def same(a, b):
    with open(a, "rb") as first, open(b, "rb") as second:
        return first.read() == second.read()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder")
    parser.add_argument("--named", action="store_true", help="the faults of named.txt")
    parser.add_argument("--random", type=int, default=0, metavar="COUNT", help="so many at random")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="pass over the first faults that would be planted")
    parser.add_argument("--again", metavar="RESULTS", help="those of a file of results")
    parser.add_argument("--survivors", action="store_true", help="of those, the ones that survived")
    parser.add_argument("--own", action="store_true", help="run the tests of the fault's own module alone")
    parser.add_argument("--list", action="store_true", help="say which, and plant none")
    parser.add_argument("-j", "--jobs", type=int, default=os.cpu_count())
    options = parser.parse_args()
    faults = [*(named() if options.named else ()), *(again(options.again, options.survivors) if options.again else ())]
    wanted = len(faults) + options.random
    os.makedirs(options.folder, exist_ok=True)
    copy = None if options.list else Copy(options.folder, options.jobs)
    done = killed = 0
    for module, path, number, what, old, new in itertools.chain(faults, draw(options.random, options.seed)):
        if done == wanted:
            break
        line = f"{path}:{number + 1}\t{what}\t{old.strip()}\t{new.strip()}"
        if done < options.first or options.list:
            done += 1
            print(line if options.list else "passed over: " + line, flush=True)
            continue
        killer = copy.try_fault(TESTS[module][:1] if options.own else TESTS[module], path, number, new)
        if killer is None:
            continue
        done += 1
        killed += 1 if killer else 0
        text = (f"killed by {killer}\t" if killer else "SURVIVED\t") + line
        print(f"{done}/{wanted} {text}", flush=True)
        with open(os.path.join(options.folder, "results.txt"), "a") as file:
            file.write(text + "\n")
    if not options.list:
        print(f"{killed} of {done - options.first} killed")


if __name__ == "__main__":
    main()
