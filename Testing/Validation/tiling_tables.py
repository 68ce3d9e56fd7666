#!/usr/bin/python3
"""Tables of the tiling on whole real bones: the paper's Table 1, the metrics, time against size.

    BONETK_DATA=... Testing/Validation/tiling_tables.py BUILD_FOLDER --check PROGRAM

writes Documentation/validation/tiling_tables.md. --check names an independent checker, called as PROGRAM MESH.vtu
--label LABELS --label-value V --json OUT, which exits 0 for a valid mesh. Times need a quiet machine. About half an hour on
two cores."""

import argparse
import json
import math
import os
import pathlib
import subprocess
import tempfile
import time

import nibabel
import numpy

from report import made_by

HERE = pathlib.Path(__file__).resolve()
REPORT = HERE.parents[2] / "Documentation" / "validation" / "tiling_tables.md"
BONES = (("femur", "hip_ct/hip_ct.nii.gz", "hip_ct/hip_labels.nii.gz", 1),
         ("hip bone", "hip_ct/hip_ct.nii.gz", "hip_ct/hip_labels.nii.gz", 2),
         ("tibia", "tibia_ct/tibia_ct.nii.gz", "tibia_ct/tibia_labels.nii.gz", 2))
METRICS = ("volume", "area", "span", "density", "combined")
SIZES = (5_000, 15_000, 33_000, 100_000, 250_000, 500_000)
REFERENCE = (3.1, 33_000)  # mean slice distance (mm) of a hip bone, tetrahedra
INTRODUCTION = """# Tiling: tables

{made_by}. Meshes as tiled, before any smoothing."""


class Tables:
    def __init__(self, build, check, folder):
        self.bonetk = build / "Apps" / "bonetk" / "bonetk"
        self.program = build / "Testing" / "Validation" / "boneTilingValidation"
        self.check = check
        self.folder = pathlib.Path(folder)
        self.data = pathlib.Path(os.environ["BONETK_DATA"])
        self.out = [INTRODUCTION.format(made_by=made_by(__file__))]

    def run(self, *command):
        return subprocess.run([str(c) for c in command], capture_output=True, text=True, check=True).stdout

    def say(self, *lines):
        self.out.extend(lines)
        print("\n".join(lines), flush=True)

    def checked(self, mesh, labels, label):
        report = self.folder / "check.json"
        done = subprocess.run(["/usr/bin/python3", self.check, str(mesh), "--label", str(labels), "--label-value", str(label),
                               "--json", str(report)], capture_output=True, text=True)
        info = json.loads(report.read_text())["info"]
        inner = sum(r["bad_edges"] + r["pinched_vertices"] for r in info.get("regions_inward", {}).values())
        return done.returncode == 0 and inner == 0, info

    def tiled(self, contours, mesh):
        return {key: value for key, value in (line.split() for line in self.run(self.program, contours, mesh).splitlines())}

    def build_contours(self, bone):
        """Contours of the default build."""
        name, ct, labels, label = bone
        folder = self.folder / name.replace(" ", "_")
        self.run(self.bonetk, "build", self.data / ct, "--labels", self.data / labels, "--label", label, "--degree", 0,
                 "-o", folder, "--quiet")
        return folder / "contours.vtp"

    def bones(self):
        self.say("\n## Facts about the models (the paper's Table 1)\n",
                 "Contours of the default `bonetk build`. Voxels inside: of the label. Distances (mm): mean from the mesh's surface to\n"
                 "the label's, and back.\n",
                 "| model | vertices | tetrahedra | slices | voxels inside | voxels a tetrahedron | mm3 a tetrahedron | valid | Dice | "
                 "volume, % | distances |", "|" + "---|" * 11)
        for bone in BONES:
            name, _, labels, label = bone
            contours, mesh = self.build_contours(bone), self.folder / "mesh.vtu"
            row = self.tiled(contours, mesh)
            valid, info = self.checked(mesh, self.data / labels, label)
            voxels = int((numpy.asarray(nibabel.load(self.data / labels).dataobj) == label).sum())
            cells = info["tetrahedra"]
            self.say(f"| {name} | {info['points']:,} | {cells:,} | {row['slices']} | {voxels:,} | {voxels / cells:.1f} | "
                     f"{info['volume_mm3'] / cells:.2f} | {'yes' if valid else 'NO'} | {info['label_dice']:.4f} | "
                     f"{info['volume_error_pct']:+.2f} | {info['mesh_to_label_mm']['mean']:.3f}, "
                     f"{info['label_to_mesh_mm']['mean']:.3f} |")

    def metrics(self):
        name, ct, labels, label = BONES[1]
        contours, mesh = self.folder / "hip_bone" / "contours.vtp", self.folder / "mesh.vtu"
        self.say("\n## Metrics\n", f"The same contours of the {name}. Least angle: the mean over cells of the smallest dihedral "
                 "angle. Seconds: wall time of\n`bonetk mesh` on two threads, reading and writing included.\n",
                 "| metric | valid | tetrahedra | Dice | volume, % | distances | least angle | under 5 degrees, % | radius ratio | s |",
                 "|" + "---|" * 10)
        for metric in METRICS:
            start = time.monotonic()
            self.run(self.bonetk, "mesh", contours, "--ct", self.data / ct, "--metric", metric, "--threads", 2, "-o", mesh,
                     "--quiet")
            seconds = time.monotonic() - start
            valid, info = self.checked(mesh, self.data / labels, label)
            self.say(f"| {metric} | {'yes' if valid else 'NO'} | {info['tetrahedra']:,} | {info['label_dice']:.4f} | "
                     f"{info['volume_error_pct']:+.2f} | {info['mesh_to_label_mm']['mean']:.3f}, "
                     f"{info['label_to_mesh_mm']['mean']:.3f} | {info['dihedral_mean_of_min_deg']:.1f} | "
                     f"{info['dihedral_below_5deg_pct']:.1f} | {info['radius_ratio_mean']:.3f} | {seconds:.1f} |")

    def times(self):
        name, ct, labels, label = BONES[1]
        self.say("\n## Time\n", f"The {name} at growing resolution. Seconds of one processor, without reading and writing; of two "
                 "threads by the\nclock, with both.\n",
                 "| tetrahedra | slices | processor, s | clock, two threads, s |", "|---|---|---|---|")
        contours, mesh = self.folder / "time.vtp", self.folder / "mesh.vtu"
        measured = []
        for size in SIZES:
            distance = REFERENCE[0] * math.sqrt(REFERENCE[1] / size)
            self.run(self.bonetk, "contours", self.data / ct, "--labels", self.data / labels, "--label", label,
                     "--slice-step", f"{distance:.3f}", "--tetrahedra", size, "-o", contours, "--quiet")
            row = self.tiled(contours, mesh)
            start = time.monotonic()
            self.run(self.bonetk, "mesh", contours, "--threads", 2, "-o", mesh, "--quiet")
            clock = time.monotonic() - start
            measured.append((math.log(int(row["tetrahedra"])), math.log(float(row["seconds"]))))
            self.say(f"| {int(row['tetrahedra']):,} | {row['slices']} | {float(row['seconds']):.2f} | {clock:.2f} |")
        exponent = numpy.polyfit(*zip(*measured), 1)[0]
        self.say(f"\nThe cost goes with the power {exponent:.2f} of the number of tetrahedra (least squares of the logarithms).")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--check", required=True)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        tables = Tables(options.build, options.check, folder)
        tables.bones()
        tables.metrics()
        tables.times()
        REPORT.write_text("\n".join(tables.out) + "\n")


if __name__ == "__main__":
    main()
