#!/usr/bin/python3
"""Atlases of thousands of subjects: time, memory, subjects added to an atlas, and how near the modes are to the exact ones.

    Testing/Validation/atlas_scale.py BUILD_FOLDER [--scratch FOLDER] [--subjects N]

trains an atlas on twelve phantom femora of about 2,500 cells at degree 2, draws subjects from it, each with noise of its own in
every coefficient, trains on them with `bonetk train --from`, and writes Documentation/validation/atlas_scale.md. About 25 minutes on
two cores and 3 GB in the scratch folder, where what is done is not done again."""

import argparse
import json
import math
import os
import pathlib
import subprocess
import tempfile

from report import made_by

HERE = pathlib.Path(__file__).resolve()
REPORT = HERE.parents[2] / "Documentation" / "validation" / "atlas_scale.md"
NOISE = 20  # HU, of every coefficient
COUNTS = (1000, 2000, 5000, 10000)
ADDED = 100


class Scale:
    def __init__(self, build, scratch):
        self.bonetk = build / "Apps" / "bonetk" / "bonetk"
        self.program = build / "Testing" / "Validation" / "boneAtlasValidation"
        self.scratch = scratch

    def run(self, *command):
        done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
        if done.returncode != 0:
            raise SystemExit(f"{command}: {done.stderr.strip()}")
        return done.stdout

    def seed(self):
        """The atlas that subjects are drawn from."""
        atlas, folder = self.scratch / "seed.h5", self.scratch / "seed"
        folder.mkdir(exist_ok=True)
        for i in range(12):
            model, ct, labels = self.scratch / f"model{i}", self.scratch / "ct.nii.gz", self.scratch / "labels.nii.gz"
            if (folder / f"{i:02}.vtu").exists():
                continue
            self.run(self.bonetk, "phantom", "--bone", "femur", "--subject", i, "-o", ct, "--labels", labels, "--quiet")
            self.run(self.bonetk, "build", ct, "--labels", labels, "--tetrahedra", 2500, "--degree", 2, "--no-page", "-o", model,
                     "--quiet")
            self.run(self.bonetk, "register", "subject", self.scratch / "model0" / "model_L1.vtu", model / "model_L1.vtu", "--ct", ct,
                     "-o", folder / f"{i:02}.vtu", "--quiet")
        if not atlas.exists():
            self.run(self.bonetk, "train", "--from", folder, "--variance", 1, "--no-page", "-o", atlas, "--quiet")
        return atlas

    def subjects(self, name, first, count):
        folder = self.scratch / name
        if not folder.exists():
            temporary = self.scratch / f".{name}"
            temporary.mkdir(exist_ok=True)
            self.run(self.program, "samples", self.seed(), temporary, first, count, NOISE)
            temporary.rename(folder)
        return folder

    def part(self, count):
        """The first subjects of all, by links."""
        folder = self.scratch / f"first{count}"
        if not folder.exists():
            folder.mkdir()
            for i in range(1, count + 1):
                os.link(self.scratch / "all" / f"{i:05}.vtu", folder / f"{i:05}.vtu")
        return folder

    def train(self, output, *options):
        """Seconds by the clock, processor seconds and the peak in MB."""
        times = self.scratch / "times"
        self.run("/usr/bin/time", "-o", times, "-f", "%e %U %S %M", self.bonetk, "train", *options, "--no-page", "--quiet", "-o",
                 self.scratch / output)
        wall, user, system, kilobytes = (float(x) for x in times.read_text().split()[-4:])
        return {"wall": wall, "cpu": user + system, "mb": kilobytes / 1024}

    def compare(self, first, second, modes=10):
        return json.loads(self.run(self.program, "compare", self.scratch / first, self.scratch / second, modes))


def row(name, t):
    return f"| {name} | {t['wall']:.0f} | {t['cpu']:.0f} | {t['mb']:.0f} |"


def comparison(name, c):
    cells = [name, f"{c['mean']:.4f}"]
    for part in ("shape", "density"):
        p = c[part]
        cells += [f"{p['modes'][0]}, {p['modes'][1]}", f"{100 * p['variance']:.3f}", f"{p['degrees']:.2f}", f"{100 * p['total']:.4f}"]
    return "| " + " | ".join(cells) + " |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--scratch", type=pathlib.Path)
    parser.add_argument("--subjects", type=int, default=COUNTS[-1])
    options = parser.parse_args()
    scratch = options.scratch or pathlib.Path(tempfile.mkdtemp())
    scratch.mkdir(exist_ok=True)
    scale = Scale(options.build, scratch)
    counts = [n for n in COUNTS if n <= options.subjects]
    most = counts[-1]
    scale.subjects("all", 1, most)
    added = scale.subjects("added", most + 1, ADDED)
    times = {n: scale.train(f"{n}.h5", "--from", scale.part(n)) for n in counts}
    add = scale.train("more.h5", "--from", added, "--add", scratch / f"{most}.h5")
    both = scratch / "both"
    if not both.exists():
        both.mkdir()
        for folder in (scale.part(1000), added):
            for file in folder.iterdir():
                os.link(file, both / file.name)
    scale.train("small.h5", "--from", scale.part(1000), "--variance", 0.99, "--modes", 60)
    scale.train("exact.h5", "--from", scale.part(1000), "--modes", 60)
    scale.train("memory.h5", "--from", scale.part(1000), "--modes", 60, "--memory", 40)
    scale.train("joined.h5", "--from", both, "--modes", 60)
    scale.train("joined2.h5", "--from", added, "--modes", 60, "--add", scratch / "small.h5")
    exponent = math.log(times[most]["cpu"] / times[counts[-2]]["cpu"]) / math.log(most / counts[-2]) if len(counts) > 1 else 1
    lines = scale.run(scale.bonetk, "info", scratch / f"{most}.h5").splitlines()
    cells = next(line.split()[-1] for line in lines if line.startswith("tetrahedra"))
    REPORT.write_text(f"""# Atlases of thousands of subjects

{made_by(__file__)}.

Femora of {cells} cells, degree 2, drawn from an atlas of twelve phantoms, each with {NOISE} HU of noise of its own in every coefficient, as
files. `bonetk train --from FOLDER`, with its defaults: 98 % of the variance, 1024 MB of memory for subjects and modes.

| subjects | s | processor s | peak, MB |
|---|---|---|---|
""" + "\n".join(row(f"{n:,}", t) for n, t in times.items()) + f"""
{row(f"{ADDED} added to {most:,}", add)}

From {counts[-2]:,} to {most:,} subjects processor time grows with their number to the power of {exponent:.2f}. Adding {ADDED} takes
{100 * add['cpu'] / times[most]['cpu']:.1f} % of the processor time of training on all.

Up to 1,023 subjects are held at once, and modes are exact. Beyond, or where `--memory` holds fewer, they are found in the span of half
as many directions as are held. Two atlases of 1,000 subjects, 60 modes at most, exact and with 40 MB; and of {1000 + ADDED:,}, at once and in two
steps (the first with 99 % of the variance). Compared are the ten first modes: the largest difference of a variance, the largest angle
between the two spans, and the difference of the total variance.

| atlases | means, mm | modes of shape | variance, % | angle, degrees | total, % | of density | variance, % | angle, degrees | total, % |
|---|---|---|---|---|---|---|---|---|---|
{comparison("exact, 40 MB", scale.compare("exact.h5", "memory.h5"))}
{comparison("at once, in two steps", scale.compare("joined.h5", "joined2.h5"))}
""")
    print(REPORT.read_text())


if __name__ == "__main__":
    main()
