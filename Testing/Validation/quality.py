#!/usr/bin/python3
"""Mesh quality of whole bones: is what the quality stage promises so?

    BONETK_DATA=... Testing/Validation/quality.py BUILD_FOLDER [--check PROGRAM] [--only TEXT] [--keep FOLDER]

tiles the real bones in BONETK_DATA and two phantoms as `bonetk build` does by default (about 33,000 tetrahedra), runs the
quality stage and writes Documentation/validation/quality.md. --check names an independent checker, called as PROGRAM
MESH.vtu, which must exit 0 for a valid mesh. --only takes the bones whose name has TEXT in it, and writes no report. --keep
keeps tilings and contours in a folder and takes those that are there. About five minutes on two cores, without --check.
Needs nibabel, numpy, scipy and vtk."""

import argparse
import os
import pathlib
import subprocess
import sys
import tempfile

import nibabel
import numpy
import vtk
from scipy import ndimage
from vtk.util.numpy_support import vtk_to_numpy

from report import made_by

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


class OwnShape:
    """The surface of a label smoothed by a Gaussian of one voxel (the largest spacing), to put a mesh's points on."""

    def __init__(self, labels, label):
        image = nibabel.load(labels)
        mask = numpy.asarray(image.dataobj)
        mask = (mask == label if label else mask > 0).astype(numpy.float32)
        self.matrix = numpy.diag([-1, -1, 1, 1]) @ image.affine
        self.spacing = numpy.linalg.norm(self.matrix[:3, :3], axis=0)
        self.field = ndimage.gaussian_filter(mask, self.spacing.max() / self.spacing) - 0.5
        self.gradient = numpy.gradient(self.field, *self.spacing)

    def project(self, points):
        x = (numpy.linalg.inv(self.matrix) @ numpy.c_[points, numpy.ones(len(points))].T)[:3]

        def sample(field):
            return ndimage.map_coordinates(field, x, order=1, mode="nearest")

        for _ in range(12):
            gradient = numpy.stack([sample(field) for field in self.gradient])
            step = -sample(self.field) * gradient / numpy.maximum((gradient**2).sum(0), 1e-6)
            step *= numpy.minimum(1, 0.5 / numpy.maximum(numpy.linalg.norm(step, axis=0), 1e-9))
            x = x + step / self.spacing[:, None]
        return (self.matrix @ numpy.r_[x, numpy.ones((1, x.shape[1]))])[:3].T

    def roughness(self, mesh):
        """Mean turn (degrees) across slices of the mesh's boundary with its points put on the surface."""
        reader = vtk.vtkXMLUnstructuredGridReader()
        reader.SetFileName(mesh)
        reader.Update()
        grid = reader.GetOutput()
        cells = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 4)
        slices = vtk_to_numpy(grid.GetPointData().GetArray("Slice"))
        faces = numpy.concatenate([cells[:, f] for f in ([1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1])])
        _, first, count = numpy.unique(numpy.sort(faces, 1), axis=0, return_index=True, return_counts=True)
        faces = faces[first[count == 1]]
        points = vtk_to_numpy(grid.GetPoints().GetData()).astype(float)
        used = numpy.unique(faces)
        points[used] = self.project(points[used])
        a, b, c = (points[faces[:, k]] for k in range(3))
        normals = numpy.cross(b - a, c - a)
        normals /= numpy.linalg.norm(normals, axis=1)[:, None] + 1e-30
        edges = numpy.sort(numpy.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), 1)
        order = numpy.lexsort((edges[:, 1], edges[:, 0]))
        edges, owner = edges[order], numpy.tile(numpy.arange(len(faces)), 3)[order]
        pairs = numpy.flatnonzero((edges[:-1] == edges[1:]).all(1) & (slices[edges[:-1, 0]] == slices[edges[:-1, 1]]))
        cosines = (normals[owner[pairs]] * normals[owner[pairs + 1]]).sum(1)
        return numpy.degrees(numpy.arccos(numpy.clip(cosines, -1, 1))).mean()


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

    def excess(self, when):
        return self[f"{when}.roughness_across"] - self[f"{when}.own"]

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
        if any(self[f"after.{way}_label"] > self[f"before.{way}_label"] for way in ("to", "from")):
            failed.append("distances")
        if self.fall("roughness_across") < 50:
            failed.append("roughness")
        if self["surface1.mean"] > 0.3:
            failed.append("displacement")
        return failed


class Validation:
    def __init__(self, build, check, keep):
        self.keep = keep
        self.bonetk = build / "Apps" / "bonetk" / "bonetk"
        self.program = build / "Testing" / "Validation" / "boneQualityValidation"
        self.check = check

    def measure(self, case, folder):
        name, ct, labels, label, bound = case
        if labels is None:
            labels = f"{folder}/labels.nii.gz"
            run(self.bonetk, "phantom", "--bone", ct, "-o", f"{folder}/ct.mha", "--labels", labels, "--quiet")
            ct = f"{folder}/ct.mha"
        kept, made = self.keep or folder, f"{folder}/made.vtu"
        tiled, contours = (f"{kept}/{name.replace(' ', '_')}.{what}" for what in ("vtu", "vtp"))
        if not (os.path.exists(tiled) and os.path.exists(contours)):
            run(self.program, "tile", ct, labels, label, "z", tiled, contours)
        lines = run(self.program, "improve", tiled, made, bound, contours, labels, label).splitlines()
        values = {key: float(value) for key, value in (line.split() for line in lines)}
        own = OwnShape(labels, label)
        values["before.own"], values["after.own"] = own.roughness(tiled), own.roughness(made)
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


SURFACES = {1: "boundary", 2: "cortical, trabecular", 3: "trabecular, medullary"}


def contour_distances(rows):
    """Boundary and interfaces against the contours of all slices, as tiled and as made."""
    out = ["", "## Boundary and interfaces against the contours\n",
           "Distances in mm (mean, 95 percentile, largest) between each surface and the contours of all slices, periosteal for the",
           "boundary and endosteal for the interfaces: from points on the contours to the surface, and from the surface's corners and",
           "centroids to the shape that the contours describe, interpolated between slices, away from caps (where the shape's normal lies",
           "within 45 degrees of the slices). The latter are of first order and say nothing of the largest, where contours end or part.\n",
           "| bone | surface | from contours: tiled | made | to contours: tiled | made |", "|---|---|---|---|---|---|"]
    for name, row in rows:
        for level, surface in SURFACES.items():
            if f"after.level{level}.from_contours.mean" in row.values:
                cells = [f"{row[key + '.mean']:.2f}, {row[key + '.percentile95']:.2f}" + (f", {row[key + '.largest']:.1f}" if way == "from" else "")
                         for way in ("from", "to") for key in (f"{when}.level{level}.{way}_contours" for when in ("before", "after"))]
                out.append(f"| {name} | {surface} | {' | '.join(cells)} |")
    return out


def report(rows, methods):
    out = ["# Mesh quality\n", f"{made_by(__file__)}: bones tiled as `bonetk build` does by default, then the quality",
           "stage with its defaults (distance bound: half a pixel, at most 0.3 mm; fitted to the contours of all slices and the label).\n", "## Angles\n",
           "Smallest dihedral angle, degrees: cortical: least; % of cells below 2; mean, and what thickness over edge allows on",
           "average (mean of the three cells of a prism of that height). Other regions: least; % of cells below 8; mean.\n",
           "| bone | | cells | cortical | trabecular | medullary |", "|---|---|---|---|---|---|"]
    for name, row in rows:
        before, after = angles(row)
        out += [f"| {name} | tiled | {before} |", f"| | made | {after} |"]
    out += ["", "## Shape\n",
            "Volume change of the body and of regions 1/2/3; distance of the new boundary from the old, mean over its area and",
            "largest; agreement with the label map (distances both ways, means); turn between neighbouring boundary triangles, mean,",
            "of all edges and of those within a slice, where slices meet (degrees). Own is that of the same triangles with their",
            "points on the surface of the label map smoothed by one voxel: what the bone's shape has at these edges. Excess is",
            "the roughness across slices less that. Seconds are of the clock, on two cores.\n",
            "| bone | valid | volume, % | regions, % | moved, mm | Dice | to label, mm | from label, mm | roughness, all | "
            "across slices | own | excess | s | not met |", "|" + "---|" * 14]
    for name, row in rows:
        regions = "/".join(f"{row.change(f'region{n}.volume'):+.2f}" for n in row.regions())
        out.append(
            f"| {name} | {'yes' if row['valid'] else 'NO'} | {row.change('volume'):+.2f} | {regions} | "
            f"{row['surface1.mean']:.2f}, {row['surface1.largest']:.1f} | {row['before.dice']:.4f} → {row['after.dice']:.4f} | "
            f"{row['before.to_label']:.2f} → {row['after.to_label']:.2f} | {row['before.from_label']:.2f} → "
            f"{row['after.from_label']:.2f} | {row['before.roughness']:.1f} → {row['after.roughness']:.1f} | "
            f"{row['before.roughness_across']:.1f} → {row['after.roughness_across']:.1f} | {row['before.own']:.1f} → {row['after.own']:.1f} | "
            f"{row.excess('before'):.1f} → {row.excess('after'):.1f} | {row['seconds']:.1f} | "
            f"{', '.join(row.failures())} |")
    out += contour_distances(rows)
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
    parser.add_argument("--keep")
    options = parser.parse_args()
    if options.keep:
        pathlib.Path(options.keep).mkdir(parents=True, exist_ok=True)
    validation = Validation(options.build, options.check, options.keep)
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
