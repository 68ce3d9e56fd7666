#!/usr/bin/python3
"""Mesh quality of whole bones: is what the quality stage promises so?

    BONETK_DATA=... Testing/Validation/quality.py BUILD_FOLDER [--check PROGRAM] [--only TEXT]

tiles the real bones in BONETK_DATA and two phantoms as `bonetk build` does by default (about 33,000 tetrahedra), runs the
quality stage and writes Documentation/validation/quality.md. --check names an independent checker, called as PROGRAM
MESH.vtu, which must exit 0 for a valid mesh. --only takes the bones whose name has TEXT in it, and writes no report.
About five minutes on two cores, without --check."""

import argparse
import os
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve()
REPORT = HERE.parents[2] / "Documentation" / "validation" / "quality.md"


def cases(data):
    """(name, CT, labels, label or None, distance bound as `bonetk build` chooses it)"""
    found = [("phantom femur", "femur", None, 0, 0.3), ("phantom hemipelvis", "hemipelvis", None, 0, 0.3)]
    if data:
        hip = [f"{data}/hip_ct/hip_ct.nii.gz", f"{data}/hip_ct/hip_labels.nii.gz"]
        tibia = [f"{data}/tibia_ct/tibia_ct.nii.gz", f"{data}/tibia_ct/tibia_labels.nii.gz"]
        pelvis = [f"{data}/pelvis_ct_3mm/pelvis_ct.nii.gz", f"{data}/pelvis_ct_3mm/pelvis_labels.nii.gz"]
        found += [("clinical femur", *hip, 1, 0.288), ("clinical hip", *hip, 2, 0.288), ("tibia", *tibia, 2, 0.3)]
        for label, bone in enumerate(("left femur", "right femur", "left hip", "right hip", "sacrum"), 1):
            found.append((f"pelvis at 3 mm, {bone}", *pelvis, label, 0.3))
    return found


def run(*command):
    return subprocess.run([str(c) for c in command], capture_output=True, text=True, check=True).stdout


class Row:
    """What was measured on one bone."""

    def __init__(self, values):
        self.values = values

    def __getitem__(self, key):
        return self.values[key]

    def region(self, when, number):
        prefix = f"{when}.region{number}."
        return {key[len(prefix):]: value for key, value in self.values.items() if key.startswith(prefix)}

    def change(self, key):
        return 100.0 * (self[f"after.{key}"] / self[f"before.{key}"] - 1.0)

    def regions(self):
        return [number for number in (1, 2, 3) if self.region("after", number)]

    def fall(self, key):
        return 100.0 * (1.0 - self[f"after.{key}"] / self[f"before.{key}"])

    def failures(self):
        failed = []
        if not self["valid"]:
            failed.append("not valid")
        cortical = self.region("after", 1)
        if cortical["least"] < 2:
            failed.append("cortical angle")
        if cortical["mean"] < 0.75 * cortical["allowed"]:
            failed.append("cortical mean")
        for number in self.regions()[1:]:
            region = self.region("after", number)
            if region["least"] < 5 or region["below8"] > 1e-3 * region["cells"] or region["mean"] < 35:
                failed.append(f"angles of region {number}")
        if abs(self.change("volume")) > 0.5 or any(abs(self.change(f"region{n}.volume")) > 1 for n in self.regions()):
            failed.append("volume")
        if self["after.dice"] < self["before.dice"]:
            failed.append("Dice")
        if self.fall("roughness_across") < 50:
            failed.append("roughness")
        if self["surface1.mean"] > 0.3:
            failed.append("displacement")
        return failed


class Validation:
    def __init__(self, build, check):
        self.bonetk = build / "Examples" / "bonetk" / "bonetk"
        self.program = build / "Testing" / "Validation" / "boneQualityValidation"
        self.check = check

    def measure(self, case, folder):
        name, ct, labels, label, bound = case
        if labels is None:
            labels = f"{folder}/labels.nii.gz"
            run(self.bonetk, "phantom", "--bone", ct, "-o", f"{folder}/ct.mha", "--labels", labels, "--quiet")
            ct = f"{folder}/ct.mha"
        tiled, made = f"{folder}/tiled.vtu", f"{folder}/made.vtu"
        run(self.program, "tile", ct, labels, label, "z", tiled)
        lines = run(self.program, "improve", tiled, made, bound, labels, label).splitlines()
        values = {key: float(value) for key, value in (line.split() for line in lines)}
        values["valid"] = values["after.valid"]
        if self.check:
            code = subprocess.run(["/usr/bin/python3", self.check, made], capture_output=True, check=False).returncode
            values["valid"] = values["valid"] and code == 0
        methods = run(self.program, "methods", tiled) if name == "clinical hip" else ""
        return Row(values), methods


def angles(row):
    out = []
    for when in ("before", "after"):
        cells = []
        for number in (1, 2, 3):
            region = row.region(when, number)
            if not region:
                cells.append("")
            elif number == 1:
                cells.append(f"{region['least']:.1f}; {100 * region['below2'] / region['cells']:.2f}; "
                             f"{region['mean']:.1f} of {region['allowed']:.1f}")
            else:
                cells.append(f"{region['least']:.1f}; {100 * region['below8'] / region['cells']:.2f}; {region['mean']:.1f}")
        out.append(f"{row[when + '.cells']:.0f} | " + " | ".join(cells))
    return out


def report(rows, methods):
    out = ["# Mesh quality\n", "Written by `Testing/Validation/quality.py`: bones tiled as `bonetk build` does by default, then the quality",
           "stage with its defaults (distance bound: half a pixel, at most 0.3 mm).\n", "## Angles\n",
           "Smallest dihedral angle, degrees: cortical: least; % of cells below 2; mean, and what thickness over edge allows on",
           "average (mean of the three cells of a prism of that height). Other regions: least; % of cells below 8; mean.\n",
           "| bone | | cells | cortical | spongy | medullary |", "|---|---|---|---|---|---|"]
    for name, row in rows:
        before, after = angles(row)
        out += [f"| {name} | tiled | {before} |", f"| | made | {after} |"]
    out += ["", "## Shape\n",
            "Volume change of the body and of regions 1/2/3; distance of the new boundary from the old, mean over its area and",
            "largest; agreement with the label map (distances both ways, means); turn between neighbouring boundary triangles, mean,",
            "of all edges and of those within a slice, where slices meet. Seconds are processor time of one core, under load.\n",
            "| bone | valid | volume, % | regions, % | moved, mm | Dice | to label, mm | from label, mm | roughness, all | "
            "across slices | s | not met |", "|" + "---|" * 12]
    for name, row in rows:
        regions = "/".join(f"{row.change(f'region{n}.volume'):+.2f}" for n in row.regions())
        out.append(
            f"| {name} | {'yes' if row['valid'] else 'NO'} | {row.change('volume'):+.2f} | {regions} | "
            f"{row['surface1.mean']:.2f}, {row['surface1.largest']:.1f} | {row['before.dice']:.4f} → {row['after.dice']:.4f} | "
            f"{row['before.to_label']:.2f} → {row['after.to_label']:.2f} | {row['before.from_label']:.2f} → "
            f"{row['after.from_label']:.2f} | {row['before.roughness']:.1f} → {row['after.roughness']:.1f} | "
            f"{row['before.roughness_across']:.1f} → {row['after.roughness_across']:.1f} | {row['cpu_seconds']:.1f} | "
            f"{', '.join(row.failures())} |")
    out += ["", "## The paper's Figures 5 to 7: three methods on the clinical hip\n",
            "| method | iterations | volume, % | inverted cells |", "|---|---|---|---|"]
    for line in methods.splitlines():
        method, iterations, volume, inverted = line.split()
        out.append(f"| {method} | {iterations} | {float(volume):+.2f} | {inverted} |")
    return "\n".join(out) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--check")
    parser.add_argument("--only", default="")
    options = parser.parse_args()
    validation = Validation(options.build, options.check)
    rows, methods = [], ""
    for case in cases(os.environ.get("BONETK_DATA")):
        if options.only in case[0]:
            with tempfile.TemporaryDirectory() as folder:
                row, table = validation.measure(case, folder)
            rows.append((case[0], row))
            methods += table
            print(case[0], "fails:" if row.failures() else "meets all", ", ".join(row.failures()), flush=True)
    text = report(rows, methods)
    if options.only:
        print(text)
    else:
        REPORT.write_text(text)
    sys.exit(1 if any(row.failures() for _, row in rows) else 0)


if __name__ == "__main__":
    main()
