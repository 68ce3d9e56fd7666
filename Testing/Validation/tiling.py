#!/usr/bin/python3
"""Tiling of whole bones: are all meshes valid, and how do they look?

    BONETK_DATA=... Testing/Validation/tiling.py BUILD_FOLDER [--check PROGRAM] [--only TEXT] [--sample N] [--resume LOG]

makes contours and meshes of the real bones in BONETK_DATA and of phantoms at several slice steps and contour spacings
and writes Documentation/validation/tiling.md. --check names an independent checker, called as PROGRAM MESH.vtu
--label LABELS --label-value V --json OUT, which must exit 0 for a valid mesh; without it `bonetk validate` is asked.
--only takes the cases whose name has TEXT in it, --sample every Nth one; both print and write no report. --resume takes the valid
cases from the output of a run that was cut off. About 50 minutes on two cores."""

import argparse
import collections
import concurrent.futures
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import threading

from report import made_by

HERE = pathlib.Path(__file__).resolve()
REPORT = HERE.parents[2] / "Documentation" / "validation" / "tiling.md"
SPACINGS = (4, 2, 8)
INTRODUCTION = """# Tiling

{made_by}. Contours from label maps, tiled without CT; no smoothing.

- Components, handles and voids: of all regions from the first, second, third inward. In brackets those of the stack where
  they differ, each slice thickened to the middle of its neighbours, so that slices are joined in every place where they
  overlap on fine pixels. Where a thin wall leans it overlaps the next slice's in many places, specks among them; the mesh
  joins a pair of pieces once, and may also join pieces by distance. So slabs are compared one by one: *other slabs* are
  those where the mesh has neither the components and handles of pairs of pieces that overlap and correspond, nor those of
  every place where they do.
- Filled: slabs and ends filled by overlaying the triangulations of their slices. Left out: holes that are bone above and
  below. Parted: groups of pieces that belong together by distance but were not joined.
- Against the label: Dice overlap, mean distance (mm) from the mesh's surface to the label's and back, at one spacing of
  each real bone. Dice counts voxel centres inside against the mesh's own volume: large voxels have corners outside, and a
  bone that leaves the image ends at its last slice, so it can come out above 1. Seconds are of one core.
- Valid: by {checker}.
- Rows of sets: the smallest and the largest; *filled*, *left out* and *parted* in all of them; the longest time.
"""


def cases(data):
    """(name, how to make CT and labels, label or None, slice step, axis)"""
    real = []
    if data:
        hip = [f"{data}/hip_ct/hip_ct.nii.gz", f"{data}/hip_ct/hip_labels.nii.gz"]
        for label, bone in ((1, "femur"), (2, "hip")):
            for step in (1, 2, 3):
                real.append((f"clinical {bone}, {step} mm", hip, label, step, "z"))
        pelvis = [f"{data}/pelvis_ct_3mm/pelvis_ct.nii.gz", f"{data}/pelvis_ct_3mm/pelvis_labels.nii.gz"]
        for label, bone in enumerate(("left femur", "right femur", "left hip", "right hip", "sacrum"), 1):
            real.append((f"pelvis at 3 mm, {bone}", pelvis, label, 3, "z"))
        tibia = [f"{data}/tibia_ct/tibia_ct.nii.gz", f"{data}/tibia_ct/tibia_labels.nii.gz"]
        real.append(("tibia, 2 mm", tibia, 2, 2, "z"))
        for shape in sorted(pathlib.Path(data, "femur_shapes").glob("*.ply")):
            real.append((f"femur shape {shape.stem}, 3 mm", ["--surface", str(shape)], None, 3, "x"))
    for bone in ("femur", "hemipelvis"):
        for subject in range(1, 21):
            real.append((f"phantom {bone} {subject}, 2 mm", ["--bone", bone, "--subject", str(subject)], None, 2, "z"))
    bodies = [(f"random body {seed}", ["--random", str(seed)], None, None, None, "") for seed in range(200)]
    return [(*case, spacing) for spacing in SPACINGS for case in real] + bodies


class Validation:
    def __init__(self, build, check):
        self.bonetk = build / "Apps" / "bonetk" / "bonetk"
        self.program = build / "Testing" / "Validation" / "boneTilingValidation"
        self.check = check
        self.phantoms = tempfile.TemporaryDirectory()
        self.made = collections.defaultdict(threading.Lock)

    def inputs(self, source):
        """CT and labels; a phantom is made once."""
        if not source[0].startswith("--"):
            return source
        stem = f"{self.phantoms.name}/{'_'.join(source).replace('/', '_')}"
        ct, labels = f"{stem}.mha", f"{stem}.nii.gz"
        with self.made[stem]:
            if not os.path.exists(labels):
                self.run([self.bonetk, "phantom", *source, "--spacing", "1", "-o", ct, "--labels", labels, "--quiet"])
        return [ct, labels]

    @staticmethod
    def run(command):
        return subprocess.run([str(c) for c in command], capture_output=True, text=True, check=True)

    def mesh(self, case):
        name, source, label, step, axis, spacing = case
        with tempfile.TemporaryDirectory() as folder:
            try:
                contours, mesh, labels = [f"{folder}/c.vtp"], f"{folder}/m.vtu", None
                if source[0] == "--random":
                    contours = source
                else:
                    ct, labels = self.inputs(source)
                    of_label = [] if label is None else ["--label", label]
                    self.run([self.bonetk, "contours", ct, "--labels", labels, *of_label, "--slice-step", step,
                              "--regular-slices", "--axis", axis,
                              "--contour-spacing", spacing, "--quiet", "--threads", 1, "-o", *contours])
                values = dict(line.split() for line in self.run([self.program, *contours, mesh]).stdout.splitlines())
                row = {key: value if "/" in value else float(value) for key, value in values.items()}
                row["topology"] = topology_text(row)
                compared = label is not None and spacing == SPACINGS[0]
                row.update(self.checked(mesh, labels if compared else None, label, folder))
            except subprocess.CalledProcessError as error:
                row = {"valid": False, "error": (error.stderr or error.stdout).strip().splitlines()[-1][:300]}
        return case, row

    def checked(self, mesh, labels, label, folder):
        if not self.check:
            self.run([self.bonetk, "validate", mesh])
            return {"valid": True}
        of_label = ["--label", labels, "--label-value", label] if labels else []
        done = subprocess.run([str(c) for c in ["/usr/bin/python3", self.check, mesh, *of_label, "--json",
                                                 f"{folder}/check.json"]], capture_output=True, text=True)
        report = json.loads(pathlib.Path(folder, "check.json").read_text())
        found = report["info"]
        inward = found.get("regions_inward", {})
        bad = sum(r["bad_edges"] + r["pinched_vertices"] for r in inward.values())
        return {"valid": done.returncode == 0 and bad == 0, "components": found["components"],
                "dice": found.get("label_dice"), "away": found.get("mesh_to_label_mm", {}).get("mean"),
                "back": found.get("label_to_mesh_mm", {}).get("mean"), "error": "" if done.returncode == 0 else done.stdout.strip().splitlines()[-1][:300]}


def topology_text(row):
    """Components/handles/voids of each layer of the mesh; in brackets the stack's, where they differ."""
    texts = []
    for region in (1, 2, 3):
        mesh, stack = row[f"mesh_topology_{region}"], row[f"stack_topology_{region}"]
        if mesh != "0/0/0" or stack != mesh:
            texts.append(mesh if mesh == stack else f"{mesh} ({stack})")
    return ", ".join(texts)


def table_row(case, row):
    name, _, _, _, _, spacing = case
    if "tetrahedra" not in row:
        return f"| {name} | {spacing} | failed: {row['error']} |"
    dice = f"{row['dice']:.3f}, {row['away']:.2f}, {row['back']:.2f}" if row.get("dice") else ""
    return (f"| {name} | {spacing} | {'yes' if row['valid'] else 'NO ' + row.get('error', '')} | {row['topology']} | "
            f"{sum(row[f'differing_slabs_{region}'] for region in (1, 2, 3)):.0f} | {row['tetrahedra']:.0f} | {row['slabs']:.0f} | {row['filled']:.0f} | "
            f"{row['left_out']:.0f} | {row['parted']:.0f} | {dice} | {row['mean_angle']:.0f} | {row['seconds']:.1f} |")


def summary(lines):
    """Rows for the report: real bones and what is not as it should be one by one, the rest by sets."""
    single, sets = [], collections.defaultdict(list)
    for line in lines:
        columns = [column.strip() for column in line.split("|")[1:-1]]
        fine = columns[2] == "yes" and columns[4] == "0"
        kind = re.match(r"(femur shape|phantom \w+|random body)", columns[0])
        if kind and fine:
            sets[kind.group(1) + re.sub(r"^[^,]*", "", columns[0]), columns[1]].append(columns)
        else:
            single.append(line)
    rows = []
    for (kind, spacing), cases in sets.items():
        cells, groups, filled, left_out, parted = ([int(c[k]) for c in cases] for k in (5, 6, 7, 8, 9))
        angle, seconds = ([float(c[k]) for c in cases] for k in (11, 12))
        rows.append(f"| {kind}: {len(cases)} | {spacing} | all | | 0 | {min(cells)} to {max(cells)} | {min(groups)} to {max(groups)} | "
                    f"{sum(filled)} | {sum(left_out)} | {sum(parted)} | | {min(angle):.0f} to {max(angle):.0f} | {max(seconds):.1f} |")
    return single + rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--check")
    parser.add_argument("--only", default="")
    parser.add_argument("--sample", type=int, default=1)
    parser.add_argument("--resume", type=pathlib.Path)
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    validation = Validation(options.build, options.check)
    chosen = [c for c in cases(os.environ.get("BONETK_DATA")) if options.only in c[0]][::options.sample]
    checker = "an independent checker, inner layers included" if options.check else "`bonetk validate`"
    out = [INTRODUCTION.format(made_by=made_by(__file__), checker=checker), "| bone, slice step | spacing, mm | valid | components/handles/voids | other slabs | tetrahedra | groups | filled | "
           "left out | parted | against the label | mean least angle | s |", "|" + "---|" * 13]
    invalid, differing, lines = 0, 0, []
    done = {"|".join(line.split("|")[:3]): line for line in options.resume.read_text().splitlines()
            if "| yes |" in line} if options.resume else {}

    def line_of(case):
        return done.get(f"| {case[0]} | {case[5]} ") or table_row(*validation.mesh(case))

    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for line in pool.map(line_of, chosen):
            columns = [column.strip() for column in line.split("|")]
            invalid += columns[3] != "yes"
            differing += columns[5] != "0"
            lines.append(line)
            print(line, flush=True)
    out += summary(lines)
    out.append(f"\n{len(chosen) - invalid} of {len(chosen)} valid; {differing} with slabs of other topology than the stack's.")
    print(out[-1].strip())
    if options.only == "" and options.sample == 1:
        REPORT.parent.mkdir(exist_ok=True)
        REPORT.write_text("\n".join(out) + "\n")
    sys.exit(1 if invalid else 0)


if __name__ == "__main__":
    main()
