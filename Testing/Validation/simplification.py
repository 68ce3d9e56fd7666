#!/usr/bin/python3
"""Hierarchies of whole bones: are all levels valid and within their limits?

    BONETK_DATA=... Testing/Validation/simplification.py BUILD_FOLDER [--check PROGRAM] [--models FOLDER] [--only TEXT]

makes first levels with `bonetk build` (kept in the folder of --models), simplifies them to the 6,138 and 2,438 cells of the
paper's Table 3 with boneSimplificationValidation, compares with VTK's decimation, simplifies 1,000 random meshes under random
bounds, measures time against size, and writes Documentation/validation/simplification.md. --check names an independent
checker, called as PROGRAM MESH.vtu --json OUT, which must exit 0 for a valid mesh. --only takes the bones whose name has TEXT in it, prints and writes no report;
--part takes one part of the report: levels, angles, storage, vtk, property or time; --jobs is how many bones are worked on at a
time. An hour and a half on two cores."""

import argparse
import concurrent.futures
import gzip
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy

from report import made_by

HERE = pathlib.Path(__file__).resolve()
REPORT = HERE.parents[2] / "Documentation" / "validation" / "simplification.md"
COUNTS = (6138, 2438)
HIP = "clinical hip"
# Of level 2 and level 3: regions' volumes (%), mean distance of the boundary (mm), density error (% of the range).
LIMITS = ((1.0, 0.25, 4.5), (3.0, 0.6, 6.0))
ANGLES = {"levels": (1.5, 3), "angles": (5, 8)}  # least, cortical and other
STORED = (("--degree", 3), ("--degree", 2), ("--degree", 2, "--compact"), ("--degree", 3, "--compact"),
          ("--degree", 3, "--compact", "--compact-error", 4), ("--max-error", 36), ("--max-error", 36, "--compact"),
          ("--max-error", 36, "--compact", "--compact-error", 4), ("--max-error", 36, "--compact", "--compact-error", 12))
SIZES = (8000, 16000, 33000, 66000, 130000, 260000, 500000)
MESHES = 1000


def run(*command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: {(done.stderr or done.stdout).strip()[-500:]}")
    return done.stdout


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]) + "\n"


class Bone:
    """Where a bone comes from: CT and labels of a patient, or what a phantom is made of."""

    def __init__(self, name, ct=None, labels=None, label=None, phantom=None, axis="z"):
        self.name, self.ct, self.labels, self.label = name, ct, labels, label
        self.phantom, self.axis = phantom, axis

    def images(self):
        return self.ct, self.labels, self.label or 0

    def options(self):
        return ["--label", self.label] if self.label else []


def bones(data):
    found = []
    if data:
        hip = (f"{data}/hip_ct/hip_ct.nii.gz", f"{data}/hip_ct/hip_labels.nii.gz")
        tibia = (f"{data}/tibia_ct/tibia_ct.nii.gz", f"{data}/tibia_ct/tibia_labels.nii.gz")
        found = [Bone(HIP, *hip, 2), Bone("clinical femur", *hip, 1), Bone("tibia", *tibia, 2)]
    for kind in ("femur", "hemipelvis"):
        for subject in range(3):
            found.append(Bone(f"phantom {kind} {subject}", phantom=["--bone", kind, "--subject", subject]))
    if data:
        for shape in sorted(pathlib.Path(data, "femur_shapes").glob("*.ply")):
            found.append(Bone(f"femur shape {shape.stem}", phantom=["--surface", shape], axis="x"))
    return found


class Validation:
    def __init__(self, options, folder):
        self.bonetk = options.build / "Apps" / "bonetk" / "bonetk"
        self.program = options.build / "Testing" / "Validation" / "boneSimplificationValidation"
        self.check, self.folder, self.jobs = options.check, folder, options.jobs
        self.models = options.models or folder
        self.failed = []

    def images(self, bone):
        if bone.phantom:
            stem = self.models / bone.name.replace(" ", "_")
            bone.ct, bone.labels = f"{stem}_ct.nii.gz", f"{stem}_labels.nii.gz"
            if not (os.path.exists(bone.ct) and os.path.exists(bone.labels)):
                run(self.bonetk, "phantom", *bone.phantom, "--spacing", 1, "-o", bone.ct, "--labels", bone.labels, "-q")

    def first_level(self, bone, *options):
        """The first level of `bonetk build`."""
        self.images(bone)
        model = self.models / "_".join([bone.name.replace(" ", "_"), *map(str, options[1:2])])
        if not (model / "model_L1.vtu").exists():
            run(self.bonetk, "build", bone.ct, "--labels", bone.labels, *bone.options(), "--axis", bone.axis, *options,
                "-o", model, "-q")
        return model / "model_L1.vtu"

    def checked(self, mesh, folder):
        """What the independent checker finds; without one, what bonetk does."""
        if not self.check:
            return {"valid": subprocess.run([self.bonetk, "validate", mesh], capture_output=True, check=False).returncode == 0}
        out = folder / "check.json"
        done = subprocess.run([str(part) for part in ("/usr/bin/python3", self.check, mesh, "--json", out)],
                              capture_output=True, check=False)
        info = json.loads(out.read_text())["info"]
        bad = sum(r["bad_edges"] + r["pinched_vertices"] for r in info.get("regions_inward", {}).values())
        return {**info, "valid": done.returncode == 0 and bad == 0}

    def hierarchy(self, bone, job="levels"):
        """With its levels as they are, or with improved angles; and what they miss."""
        first = self.first_level(bone)
        with tempfile.TemporaryDirectory(dir=self.folder) as name:
            folder = pathlib.Path(name)
            found = json.loads(run(self.program, job, first, folder / "h", *bone.images(), *COUNTS))
            for number, level in enumerate(found["levels"], 1):
                level["check"] = self.checked(folder / f"h_L{number}.vtu", folder)
                level["cortex"] = cortex(folder / f"h_L{number}.vtu")
        which = bone.name + (", angles improved" if job == "angles" else "")
        found["failed"] = [f"{which}, level {number}: {what}" for number, level in enumerate(found["levels"][1:], 2)
                           for what in misses(level, LIMITS[number - 2], ANGLES[job])]
        if not found["same"]:
            found["failed"].append(f"{bone.name}: not the same from run to run")
        return found

    def hierarchies(self, chosen, *jobs):
        """Of each bone in turn, one of each job; several bones at a time."""
        with concurrent.futures.ThreadPoolExecutor(self.jobs) as pool:
            for bone, found in zip(chosen, pool.map(lambda bone: [self.hierarchy(bone, job) for job in jobs], chosen)):
                self.failed += [what for of_job in found for what in of_job["failed"]]
                yield bone, *found


def least_angles(points, cells):
    """Of each cell the smallest dihedral angle, degrees."""
    normals = numpy.stack([numpy.cross(points[cells[:, b]] - points[cells[:, a]], points[cells[:, c]] - points[cells[:, a]])
                           for a, b, c in ((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1))], 1)
    normals /= numpy.maximum(numpy.linalg.norm(normals, axis=2, keepdims=True), 1e-300)
    cosine = numpy.max([-(normals[:, i] * normals[:, j]).sum(1) for i in range(4) for j in range(i)], 0)
    return numpy.degrees(numpy.arccos(numpy.minimum(1, cosine)))


def cortex(file):
    """Of a level the share of cortical cells, the layer's mean thickness (mm), its triangles' edge (mm, of equilateral ones of the
    mean area), and the mean of its cells' smallest angles."""
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy

    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(file))
    reader.Update()
    mesh = reader.GetOutput()
    points = vtk_to_numpy(mesh.GetPoints().GetData()).astype(float)
    cells = vtk_to_numpy(mesh.GetCells().GetConnectivityArray()).reshape(-1, 4)
    cortical = vtk_to_numpy(mesh.GetCellData().GetArray("Region")) == 1
    edges = points[cells[:, 1:]] - points[cells[:, :1]]
    faces = numpy.concatenate([cells[:, f] for f in ([1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1])])
    _, first, count = numpy.unique(numpy.sort(faces, 1), axis=0, return_index=True, return_counts=True)
    outer = first[count == 1]
    outer = faces[outer[cortical[outer % len(cells)]]]
    a, b, c = (points[outer[:, k]] for k in range(3))
    areas = numpy.linalg.norm(numpy.cross(b - a, c - a), axis=1) / 2
    thickness = numpy.abs(numpy.linalg.det(edges[cortical])).sum() / 6 / areas.sum()
    edge = numpy.sqrt(4 * areas.mean() / numpy.sqrt(3))
    return {"share": cortical.mean(), "thickness": thickness, "edge": edge, "mean": least_angles(points, cells[cortical]).mean()}


def distance(level, region):
    """Mean distance between the surface of the union of regions from one inward and that of level 1, the larger way."""
    found = level["regions"][region]
    return max(found["to"]["mean"], found["from"]["mean"])


def misses(level, limits, angles):
    volume, surface, error = limits
    least = min(level["regions"], key=lambda r: r["faces"])
    if not (level["valid"] and level["check"]["valid"]):
        yield "not valid"
    if any(r["crossing"] + r["pinched"] for r in level["regions"]):
        yield "a surface passes through itself or is pinched"
    if least["faces"] == 0:
        yield "an interface is gone"
    if level["asked"] < level["tetrahedra"] or level["tetrahedra"] < level["asked"] - 12:
        yield f"{level['tetrahedra']} cells ({level['stopReason']})"
    if level["angleOther"] < angles[1] - 1e-6 or level["angleCortical"] < angles[0] - 1e-6:
        yield f"angles {level['angleCortical']:.2f}, {level['angleOther']:.2f}"
    if any(abs(100 * r["volumeChange"]) > volume for r in level["regions"]):
        yield "volume"
    if distance(level, 0) > surface:
        yield f"distance {distance(level, 0):.3f}"
    if level["density"]["percent"] > error:
        yield f"density {level['density']['percent']:.2f} %"


def level_rows(bone, found):
    for number, level in enumerate(found["levels"], 1):
        volumes = "/".join(f"{100 * r['volumeChange']:+.2f}" for r in level["regions"])
        mean = "/".join(f"{distance(level, k):.2f}" for k in range(len(level["regions"])))
        first = number == 1
        yield (bone.name if first else "", level["tetrahedra"], level["points"], "yes" if level["check"]["valid"] else "NO",
               sum(r["crossing"] for r in level["regions"]), f"{level['angleCortical']:.1f}, {level['angleOther']:.1f}",
               "" if first else volumes, "" if first else mean, "" if first else f"{level['surfaceError']:.1f}",
               "" if first else f"{level['densityError']:.1f}", f"{level['density']['percent']:.2f}", "" if first else level["stopReason"],
               f"{found['processorSeconds']:.1f}" if number == 2 else "")


LEVEL_HEAD = ("bone", "cells", "points", "valid", "crossing", "least angles", "volumes, %", "mean distance, mm", "largest, mm",
              "rms, HU", "error, %", "ended by", "s")


def storage(level, coefficients):
    """Bytes: points of 3 floats, 4 vertex ids, degree and region a cell, a float a coefficient."""
    return 12 * level["points"] + 18 * level["tetrahedra"] + 4 * coefficients * level["tetrahedra"]


def paper_table(found):
    paper = {1: ("8,219", "32,741", 3.1, 2.2, 10.6, 59.3, "1,932,124"), 2: ("1,272", "6,138", 6.4, 3.8, 55.2, 316.4, "358,992"),
             3: ("512", "2,438", 8.8, 6.5, 137.9, 796.6, "142,672")}
    rows = []
    for number, level in enumerate(found["levels"], 1):
        error, n = level["density"], level["tetrahedra"]
        voxels = error["voxels"]
        volume = sum(r["volume"] * (1 + r["volumeChange"]) for r in level["regions"])
        rows.append((number, f"{level['points']:,}", f"{n:,}", f"{error['percent']:.2f}", f"{error['deviation']:.2f}",
                     f"{volume / n:.1f}", f"{voxels / n:.1f}", f"{2 * voxels:,}", f"{storage(level, 10):,}"))
        p = paper[number]
        rows.append(("paper", p[0], p[1], p[2], p[3], p[4], p[5], "3,883,996", p[6]))
    return table(("level", "points", "cells", "mean density difference, %", "its deviation, %", "mm³ a cell", "voxels a cell",
                  "CT, bytes", "model, bytes"), rows)


def levels_part(validation, chosen):
    rows, out = [], []
    for bone, found in validation.hierarchies(chosen, "levels"):
        rows += level_rows(bone, found)
        print(*("| " + " | ".join(map(str, row)) + " |" for row in level_rows(bone, found)), sep="\n", flush=True)
        if bone.name == HIP:
            refused = [(number, *level["refused"].values()) for number, level in enumerate(found["levels"][1:], 2)]
            quadratic = validation.folder / "quadratic.vtu"
            run(validation.bonetk, "fit", bone.ct, validation.first_level(bone), "--degree", 2, "-o", quadratic, "-q")
            of_degree_2 = json.loads(run(validation.program, "levels", quadratic, validation.folder / "q", *bone.images(), *COUNTS))
            out += ["## The paper's Table 3, on the clinical hip\n", "With degree 2, which the paper's bytes are those of.\n",
                    paper_table(of_degree_2),
                    "CT: two bytes for each voxel inside. Model: points of three floats, four ids, degree and region a cell, a float a",
                    "coefficient. What files take is [below](#storage).\n", "## Refused candidates on the clinical hip\n",
                    table(("level", *found["levels"][1]["refused"]), refused)]
    head = ["## Levels\n", "First levels are those of `bonetk build`; levels 2 and 3 were asked for as 6,138 and 2,438 cells. Valid: by the",
            "independent checker, inner unions too. Crossing: pairs of triangles of boundary or interfaces that meet (exact). Angles:",
            "smallest dihedral, in the cortical layer and elsewhere, degrees. Volumes: change by region. Distances to level 1: mean over",
            "the surface (the larger way) of the boundary and of the interfaces, and largest of all. rms: integrated difference to level 1.",
            "Error: mean absolute error at the label's voxels, % of the 1..99 % range. Seconds: processor time, both levels, under load.",
            "Every hierarchy was made twice with two threads and once with one: byte for byte the same.\n"]
    limits = [f"Limits of level 2 and 3: volumes {LIMITS[0][0]:.0f} and {LIMITS[1][0]:.0f} %, boundary {LIMITS[0][1]} and {LIMITS[1][1]} mm,",
            f"error {LIMITS[0][2]} and {LIMITS[1][2]} %, angles 1.5 in the cortical layer and 3 elsewhere, counts to within a collapse.",
            "Not met: " + ("; ".join(validation.failed) or "none") + ".\n"]
    return "\n".join([*head, table(LEVEL_HEAD, rows), *limits, *out])


def cortex_text(found):
    return f"{100 * found['share']:.0f} %, {found['thickness']:.1f} mm under {found['edge']:.0f} mm: {found['mean']:.1f}"


def angles_part(validation, chosen):
    """Levels for finite elements, beside those as they are."""
    rows = []
    for bone, *both in validation.hierarchies(chosen, *ANGLES):
        both = dict(zip(ANGLES, both))
        for number in (2, 3):
            plain, better = (both[job]["levels"][number - 1] for job in ANGLES)
            pair = lambda of: f"{of(plain)} → {of(better)}"  # noqa: E731
            rows.append((bone.name if number == 2 else "", number, better["tetrahedra"], "yes" if better["check"]["valid"] else "NO",
                         sum(r["crossing"] for r in better["regions"]),
                         pair(lambda found: f"{found['angleCortical']:.1f}, {found['angleOther']:.1f}"),
                         pair(lambda found: found["angles"]["below"]), pair(lambda found: f"{found['angles']['mean']:.1f}"), cortex_text(better["cortex"]),
                         "/".join(f"{100 * r['volumeChange']:+.2f}" for r in better["regions"]),
                         pair(lambda found: "/".join(f"{distance(found, k):.3f}" for k in range(len(found["regions"])))),
                         pair(lambda found: f"{found['surfaceError']:.1f}"), pair(lambda found: f"{found['density']['percent']:.2f}"),
                         f"{both['levels']['processorSeconds']:.1f} → {both['angles']['processorSeconds']:.1f}" if number == 2 else ""))
            print("| " + " | ".join(map(str, rows[-1])) + " |", flush=True)
    head = ("bone", "level", "cells", "valid", "crossing", "least angles", "cells below", "mean of least angles", "cortical cells",
            "volumes, %", "mean distance, mm", "largest, mm", "error, %", "s")
    return "\n".join(["## Levels for finite elements: `--improve-angles`\n",
                      "The levels above → those with `--improve-angles`, which wants 5 degrees in the cortical layer and 8 elsewhere, and holds back",
                      "edges of more than four times that of a regular tetrahedron of the mean volume. Points move (surfaces' along level 1's), so",
                      "that they are no subset of those before. Below: cells with a smaller angle. Mean of all cells' smallest dihedral angles.",
                      "Cortical cells: their share, the layer's mean thickness, the edge of equilateral triangles of its outer surface's mean area;",
                      "the mean of these cells' smallest angles. The wider the triangles over a thin layer, the flatter its cells.\n",
                      table(head, rows)])


def storage_part(validation, bone):
    import nibabel

    first = validation.first_level(bone)
    ct, labels, label = bone.images()
    inside = numpy.asanyarray(nibabel.load(ct).dataobj)[numpy.asanyarray(nibabel.load(labels).dataobj) == label]
    voxels = numpy.round(inside).astype(numpy.int16).tobytes()
    packed = len(gzip.compress(voxels, 9))
    rows = [("CT: voxels inside, 16 bits", "", "", f"{len(voxels):,}", f"{packed:,}", "", "")]
    for options in STORED:
        file = validation.folder / "stored.vtu"
        run(validation.bonetk, "fit", ct, first, *options, "-o", file, "-q")
        error = json.loads(run(validation.program, "compare", file, *bone.images()))["percent"]
        report = validation.folder / "stored.json"
        run(validation.bonetk, "fit", ct, first, *[o for o in options if "compact" not in str(o)][:2], "--report", report, "-o",
            validation.folder / "x.vtu", "-q")
        plain = file.read_bytes()
        zipped = len(gzip.compress(plain, 9))
        rows.append((f"`{' '.join(map(str, options))}`", f"{json.loads(report.read_text())['coefficients']:,}", f"{error:.2f}",
                     f"{len(plain):,}", f"{zipped:,}", f"{100 * len(plain) / len(voxels):.1f}", f"{100 * zipped / packed:.1f}"))
        print(rows[-1], flush=True)
    head = ("file", "coefficients", "error, %", "bytes", "bytes, gzip", "of the CT, %", "both gzip, %")
    return "\n".join([f"## Storage\n", f"Level 1 of the {bone.name}, fitted by `bonetk fit` with these options. Error as above, of what is in the",
                      "file. Bytes of the file, base64 and all, and of it by `gzip -9`; beside those of the CT's voxels in the label, raw and by",
                      "`gzip -9`. `--compact-error` bounds the change of the density anywhere (HU).\n", table(head, rows)])


def decimated(first, count, scale, out):
    """VTK's quadric decimation by the vertex densities; its result with the region of level 1 at each cell's centroid."""
    import vtk
    from vtk.util import numpy_support as convert

    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(first))
    reader.Update()
    mesh = reader.GetOutput()
    given = convert.vtk_to_numpy(mesh.GetPointData().GetArray("Density")).astype(float)
    bare = vtk.vtkUnstructuredGrid()
    bare.CopyStructure(mesh)
    values = convert.numpy_to_vtk(given * scale, deep=True)
    values.SetName("Density")
    bare.GetPointData().SetScalars(values)
    decimate = vtk.vtkUnstructuredGridQuadricDecimation()
    decimate.SetInputData(bare)
    decimate.SetScalarsName("Density")
    decimate.SetNumberOfTetsOutput(count)
    start = time.process_time()
    decimate.Update()
    seconds = time.process_time() - start
    result = decimate.GetOutput()
    cells = convert.vtk_to_numpy(result.GetCells().GetConnectivityArray()).reshape(-1, 4)
    points = convert.vtk_to_numpy(result.GetPoints().GetData()).astype(float)
    locator = vtk.vtkStaticCellLocator()
    locator.SetDataSet(mesh)
    locator.BuildLocator()
    region = convert.vtk_to_numpy(mesh.GetCellData().GetArray("Region"))
    at = [locator.FindCell(x) for x in points[cells].mean(1)]
    found = numpy.array([region[t] if t >= 0 else 0 for t in at], numpy.int32)
    edges = points[cells[:, 1:]] - points[cells[:, :1]]
    volume = numpy.linalg.det(edges) / 6
    new = convert.vtk_to_numpy(result.GetPointData().GetScalars() or result.GetPointData().GetArray(0)).astype(float) / scale
    for name, data in (("DensityCoefficients", new[cells]), ("Degree", numpy.ones(len(cells), numpy.int32)), ("Region", found)):
        array = convert.numpy_to_vtk(numpy.ascontiguousarray(data), deep=True)
        array.SetName(name)
        result.GetCellData().AddArray(array)
    writer = vtk.vtkXMLUnstructuredGridWriter()
    writer.SetFileName(str(out))
    writer.SetInputData(result)
    writer.Write()
    return {"seconds": seconds, "cells": len(cells), "inverted": int((volume <= 0).sum()),
            "angle": least_angles(points, cells).min(),
            "volumes": {k: volume[found == k].sum() for k in numpy.unique(region)}}


def vtk_part(validation, bone):
    first = validation.first_level(bone)
    linear = validation.folder / "linear.vtu"
    run(validation.bonetk, "fit", bone.ct, first, "--degree", 1, "-o", linear, "-q")
    rows = []
    for degree, mesh in ((3, first), (1, linear)):
        found = json.loads(run(validation.program, "levels", mesh, validation.folder / "v", *bone.images(), *COUNTS))
        volumes = [region["volume"] for region in found["levels"][0]["regions"]]
        for level in found["levels"][1:]:
            rows.append((f"BoneTK, degree {degree}", level["tetrahedra"], 0 if level["valid"] else "NOT VALID",
                         "/".join(f"{100 * r['volumeChange']:+.2f}" for r in level["regions"]), f"{level['density']['percent']:.2f}",
                         f"{level['density']['uncovered']:.1f}", f"{min(level['angleCortical'], level['angleOther']):.2f}",
                         f"{found['processorSeconds']:.1f} (both levels)"))
    for scale, unit in ((1, "HU"), (0.01, "HU/100")):
        for count in COUNTS:
            out = validation.folder / "decimated.vtu"
            found = decimated(first, count, scale, out)
            error = json.loads(run(validation.program, "compare", out, *bone.images()))
            change = "/".join(f"{100 * (v / volumes[k - 1] - 1):+.2f}" for k, v in found["volumes"].items())
            rows.append((f"VTK, density in {unit}", found["cells"], found["inverted"], change, f"{error['percent']:.2f}",
                         f"{error['uncovered']:.1f}", f"{found['angle']:.2f}", f"{found['seconds']:.1f}"))
    head = ("method", "cells", "inverted or flat", "regions' volumes, %", "density error, %", "label uncovered, %",
            "least angle", "s")
    return "\n".join([f"## Against VTK's tetrahedral decimation, {bone.name}\n", table(head, rows),
                      "`vtkUnstructuredGridQuadricDecimation` has no regions: each of its cells has that of level 1 at its centroid. It keeps",
                      "densities at points, so that its degree is 1.\n"])


def property_part(validation):
    done = subprocess.run([validation.program, "property", "1", str(MESHES)], capture_output=True, text=True, check=False)
    lines = done.stdout.strip().splitlines()
    found = json.loads(lines[-1])
    if found["failed"]:
        validation.failed += lines[:-1]
    return "\n".join(["## Random meshes and bounds\n",
                      f"{found['meshes']} random meshes (rods, rings and balls in layers, and tilings of random contours), each under random",
                      "bounds on count, density error, surface distance, volumes, angles and degree. Valid, without crossings, a subset of",
                      "points, and within all bounds, all measured by other means (random points on surfaces and in cells):",
                      f"{found['meshes'] - found['failed']} of {found['meshes']}.\n", *(f"- {line}" for line in lines[:-1]), ""])


def time_part(validation, bone):
    rows, sizes, seconds = [], [], []
    for size in SIZES:
        mesh = validation.first_level(bone, "--tetrahedra", size, "--levels", 0.2)
        count = json.loads(run(validation.program, "time", mesh, 0, 1))["tetrahedra"]
        counts = COUNTS if size == 33000 else (count // 5, count // 13)
        found = json.loads(run(validation.program, "time", mesh, 3 if size <= 33000 else 2, *counts))
        sizes.append(count)
        seconds.append(found["processorSeconds"])
        rows.append((f"{count:,}", f"{found['processorSeconds']:.2f}", f"{found['seconds']:.2f}",
                     f"{1e6 * found['processorSeconds'] / count:.0f}"))
        print(rows[-1], flush=True)
    slope = numpy.polyfit(numpy.log(sizes), numpy.log(seconds), 1)[0]
    against = numpy.polyfit(numpy.log(numpy.array(sizes) * numpy.log(sizes)), numpy.log(seconds), 1)[0]
    return "\n".join([f"## Time, {bone.name}\n", table(("cells", "processor time, s", "clock, s", "µs a cell"), rows),
                      "To a fifth and a thirteenth of the cells (33,000: to 6,138 and 2,438), with two threads; the least of two or three runs.",
                      f"Processor time grows as n^{slope:.2f}, or (n log n)^{against:.2f}.\n"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--check")
    parser.add_argument("--models", type=pathlib.Path)
    parser.add_argument("--only", default="")
    parser.add_argument("--part", default="")
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    chosen = [bone for bone in bones(os.environ.get("BONETK_DATA")) if options.only in bone.name]
    first = next((bone for bone in chosen if bone.name == HIP), chosen[0])
    with tempfile.TemporaryDirectory() as folder:
        validation = Validation(options, pathlib.Path(folder))
        parts = {"levels": lambda: levels_part(validation, chosen), "angles": lambda: angles_part(validation, chosen[:10]),
                 "storage": lambda: storage_part(validation, first), "vtk": lambda: vtk_part(validation, first),
                 "property": lambda: property_part(validation), "time": lambda: time_part(validation, first)}
        out = [make() for name, make in parts.items() if options.part in ("", name)]
    text = "\n".join(["# Simplification\n", made_by(__file__) + ".\n", *out])
    if options.only or options.part:
        print(text)
    else:
        REPORT.write_text(text)
    print("not met:", "; ".join(validation.failed) or "none")
    sys.exit(1 if validation.failed else 0)


if __name__ == "__main__":
    main()
