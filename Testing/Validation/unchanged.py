#!/usr/bin/env python3
"""Whether the programs of two build trees do the same: the commands below by both, and all files that they write compared.

    BONETK_DATA=DATA Testing/Validation/unchanged.py OLD NEW [--confirm REPORT...]

For a change of the programs that is not to move any figure: where all is the same, the reports named with --confirm are given the present
commit as report.py --confirm gives it, without being made again: NEW must be of the sources as they are, OLD of what the reports measured.
Reports whose figures do move are made again; times are not compared. Ends with 1 where something differs. Some 25 minutes on two cores.
"""
import argparse
import filecmp
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import report

# Of reports of the commands: what is another from run to run, or names the folder.
PASSING = {"seconds", "program", "outputs"}
# Pages hold times; atlases are compared by what they make.
LEFT_OUT = (".html", ".h5", ".txt")
FEMORA = ("femur_0", "femur_1", "femur_2", "femur_3")  # as many as an atlas needs
PHANTOMS = (*FEMORA, "hemipelvis_0")
XRAY = ("--xray", "xray_V1.mha", "xray_V2.mha", "--geometry", "views.json")
FITS = (("--continuous",), ("--continuous-gradient",), ("--degree", "2", "--compact"))
SIMPLIFIED = (("--max-density-error", "40", "80"), ("--max-cell-error", "60"), ("--max-surface-distance", "0.5", "1"))


def bones(data):
    """Name and options of `build`, of each bone that is built."""
    hip, tibia = (f"{data}/{name}_ct/{name}" for name in ("hip", "tibia"))
    yield "hip", (f"{hip}_ct.nii.gz", "--labels", f"{hip}_labels.nii.gz", "--label", "2")
    yield "femur", (f"{hip}_ct.nii.gz", "--labels", f"{hip}_labels.nii.gz", "--label", "1")
    yield "tibia", (f"{tibia}_ct.nii.gz", "--labels", f"{tibia}_labels.nii.gz", "--label", "2")
    for name in PHANTOMS:
        yield name, (f"{name}.nii.gz", "--labels", f"{name}_labels.nii.gz")


def commands(data):
    """Each as its arguments, in a folder where those before have written."""
    for name in PHANTOMS:
        kind, subject = name.split("_")
        yield "phantom", "--bone", kind, "--subject", subject, "--spacing", "1", "-o", f"{name}.nii.gz", "--labels", f"{name}_labels.nii.gz"
    for name, options in bones(data):
        yield "build", *options, "--tetrahedra", "33000", "--levels", "6138", "2438", "-o", name
    model = "femur_0/model_L1.vtu"
    yield "contours", "femur_0.nii.gz", "--labels", "femur_0_labels.nii.gz", "--tetrahedra", "8000", "-o", "contours.vtp"
    yield "mesh", "contours.vtp", "-o", "mesh.vtu"
    yield "smooth", "mesh.vtu", "-o", "smooth.vtu"
    for i, options in enumerate(FITS):
        yield "fit", "femur_0.nii.gz", "smooth.vtu", *options, "-o", f"fit_{i}.vtu"
    for i, options in enumerate(SIMPLIFIED):
        yield "simplify", "fit_2.vtu", *options, "-o", f"simplified_{i}"
    yield "drr", model, "--view", "ap", "left-lateral", "--size", "256", "--save-geometry", "views.json", "-o", "drr.mha"
    yield "drr", "femur_0.nii.gz", "--attenuation", "--geometry", "views.json", "-o", "xray.mha"
    yield "register", "rigid", "femur_0/model.hierarchy.json", *XRAY, "-o", "rigid"
    yield "thickness", model, "femur_0.nii.gz", "-o", "thickness.vtp"
    yield "measure", model, "--ball", "0", "0", "0", "30", "-o", "measured.json"
    yield "export", model, "--law", "morgan2003-pooled", "--line", "0", "0.001", "--format", "calculix", "-o", "model.inp"
    yield "train", "subjects.txt", "--degree", "3", "--evaluation", "training.json", "-o", "atlas.h5"
    yield "sample", "atlas.h5", "--shape", "1=1", "-o", "sample.vtu"
    yield "evaluate", "femur_1/model_L2.vtu", "atlas.h5", "-o", "evaluated.json"
    yield "register", "volume", "atlas.h5", "femur_1.nii.gz", "-o", "volume"
    yield "register", "deform", "atlas.h5", *XRAY, "-o", "deform"


def commit_of(bonetk):
    version = subprocess.run([bonetk, "--version"], capture_output=True, text=True, check=True).stdout
    found = re.search(r"^commit +([0-9a-f]{12}) of \S+$", version, re.MULTILINE)
    return found[1] if found else sys.exit(f"{bonetk} does not say of which commit it is, or is of one with changes")


def check(programs, reports):
    """That what is compared is what the reports measured, and what there is now."""
    old, new = map(commit_of, programs)
    if not report.is_same(["all"], new):
        sys.exit(f"{programs[1]} is of commit {new}, and not of the sources as they are: build it again")
    measured = report.measured()
    for name in reports:
        if name not in measured:
            sys.exit(f"there is no report {name}")
        if not report.is_fresh(name, measured[name], old):
            sys.exit(f"{name} measured other programs than {programs[0]}, which is of commit {old}")


def lasting(found):
    """A report's content without what is another from run to run."""
    if isinstance(found, dict):
        return {key: lasting(value) for key, value in found.items() if key not in PASSING}
    return [lasting(value) for value in found] if isinstance(found, list) else found


def is_same(first, second):
    if first.suffix == ".json":
        return lasting(json.loads(first.read_text())) == lasting(json.loads(second.read_text()))
    return filecmp.cmp(first, second, shallow=False)


def differences(folders, seen):
    """Files that differ, or that one folder lacks, but for those seen before."""
    names = [{path.relative_to(folder) for path in folder.rglob("*") if path.is_file() and path.suffix not in LEFT_OUT} for folder in folders]
    for name in sorted((names[0] | names[1]) - seen):
        seen.add(name)
        if not (name in names[0] and name in names[1] and is_same(*(folder / name for folder in folders))):
            yield name


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("builds", nargs=2, type=pathlib.Path, metavar="BUILD")
    parser.add_argument("--confirm", nargs="+", default=[], metavar="REPORT")
    options = parser.parse_args()
    data = os.environ.get("BONETK_DATA") or parser.error("BONETK_DATA names no folder of data")
    programs = [build.resolve() / "Apps" / "bonetk" / "bonetk" for build in options.builds]
    check(programs, options.confirm)
    with tempfile.TemporaryDirectory() as name:
        folders = [pathlib.Path(name, which) for which in ("old", "new")]
        for folder in folders:
            folder.mkdir()
            (folder / "subjects.txt").write_text("".join(f"{name}/model_L2.vtu, {name}.nii.gz\n" for name in FEMORA))
        seen, differ = set(), 0
        for command in commands(data):
            for bonetk, folder in zip(programs, folders):
                done = subprocess.run([bonetk, *command, "-q"], cwd=folder, capture_output=True, text=True, check=False)
                if done.returncode != 0:
                    sys.exit(f"{bonetk} {' '.join(command)}: {done.stderr.strip()[-500:]}")
            found = list(differences(folders, seen))
            differ += len(found)
            print("bonetk", *command, "->", ", ".join(map(str, found)) or "the same", flush=True)
    if differ:
        sys.exit(f"{differ} files differ")
    report.confirm(options.confirm)


if __name__ == "__main__":
    main()
