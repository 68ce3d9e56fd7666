#!/usr/bin/env python3
"""How near the cortical thickness measured in a CT comes to the truth: phantoms of one thickness, of thin ends on a thick shaft, and
the femur and the hemipelvis of `bonetk phantom`.

Writes Documentation/validation/thickness.md. Environment: BONETK (the program), BONETK_VALIDATION (boneThicknessValidation).

    BONETK=build/test/Apps/bonetk/bonetk BONETK_VALIDATION=build/test/Testing/Validation/boneThicknessValidation \
        Testing/Validation/thickness.py
"""
import json
import math
import os
import pathlib
import subprocess
import tempfile

import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk

from report import ROOT, made_by

BONETK, PROGRAM = os.environ["BONETK"], os.environ["BONETK_VALIDATION"]
REPORT = ROOT / "Documentation/validation/thickness.md"
THICKNESS = (0.3, 0.5, 0.7, 1.0, 2.0, 4.0)
GRIDS = ((1.0, 1.0), (0.7, 1.0), (0.5, 0.5))
SEEDS = 3
DENSITY = 1600


def run(*command):
    return subprocess.run([str(c) for c in command], capture_output=True, text=True, check=True).stdout


def write_bone(path, step=0.75):
    """A rod with a waist and round ends, oblique to the image's axes: every direction is that of a normal somewhere."""
    axis = numpy.array([0.35, -0.25, 0.9])
    axis /= numpy.linalg.norm(axis)
    size = (60, 56, 84)
    grid = numpy.stack(numpy.meshgrid(*[(numpy.arange(n) - (n - 1) / 2) * step for n in size], indexing="ij"), axis=-1)
    along = (grid @ axis).clip(-16, 16)
    level = numpy.linalg.norm(grid - along[..., None] * axis, axis=-1) - (12.5 - 2.0 * numpy.exp(-(along / 9) ** 2))
    image = vtk.vtkImageData()
    image.SetDimensions(*size)
    image.SetOrigin(*[-(n - 1) / 2 * step for n in size])
    image.SetSpacing(step, step, step)
    image.GetPointData().SetScalars(numpy_to_vtk(level.ravel(order="F").astype(float), deep=True))
    contour = vtk.vtkFlyingEdges3D()
    contour.SetInputData(image)
    contour.SetValue(0, 0.0)
    contour.ComputeNormalsOff()
    clean = vtk.vtkCleanPolyData()
    clean.SetInputConnection(contour.GetOutputPort())
    writer = vtk.vtkPLYWriter()
    writer.SetInputConnection(clean.GetOutputPort())
    writer.SetFileName(str(path))
    writer.Write()


def build(folder, name, *phantom):
    """A model of a phantom's outer surface, and its mesh's path."""
    ct, labels = folder / f"{name}.mha", folder / f"{name}_l.nii.gz"
    run(BONETK, "phantom", *phantom, "-o", ct, "--labels", labels, "--quiet")
    run(BONETK, "build", ct, "--labels", labels, "--degree", 1, "--no-page", "--quiet", "-o", folder / name)
    return folder / name / "model_L1.vtu"


class Errors:
    """Those of several runs together."""

    def __init__(self, runs):
        self.points, self.found, self.sum, self.squares = (sum(run[key] for run in runs) for key in ("points", "found", "sum", "squares"))
        self.percentile95 = numpy.mean([run["percentile95"] for run in runs])

    @property
    def mean(self):
        return self.sum / self.found if self.found else math.nan

    def row(self):
        if not self.found:
            return "| | | "
        deviation = math.sqrt(max(0.0, self.squares / self.found - self.mean**2))
        return f"| {self.mean:+.2f} | {deviation:.2f} | {self.percentile95:.2f} "


def measure(bone, mesh, **options):
    """Of all seeds."""
    return json.loads(run(PROGRAM, bone, mesh, *[f"{key}={value}" for key, value in options.items()], f"seeds={SEEDS}"))


def row(runs, *ways):
    found = Errors([run["fit"] for run in runs])
    return "".join(Errors([run[way] for run in runs]).row() for way in ways) + f"| {100 * found.found / found.points:.1f} |"


def known(bone, mesh):
    """One thickness; blur and density are known."""
    lines, worst = [], 0.0
    for spacing, slices in GRIDS:
        for thickness in THICKNESS:
            options = {"thickness": thickness, "spacing": spacing, "slices": slices, "true": DENSITY, "density": DENSITY, "spread": 1}
            runs = measure(bone, mesh, **options)
            worst = max(worst, abs(Errors([run["fit"] for run in runs]).mean))
            lines.append(f"| {spacing} × {spacing} × {slices} | {thickness} " + row(runs, "raw", "fit", "half", "freed"))
            print(lines[-1], flush=True)
    return lines, worst


def estimated(bone, mesh):
    """Thin ends on a shaft of 4 mm, from which blur and density are estimated."""
    lines = []
    for spacing, slices in GRIDS[:2]:
        for thickness in THICKNESS[:-1]:
            runs = measure(bone, mesh, thickness=thickness, shaft=4.0, spacing=spacing, slices=slices, true=DENSITY, upper=thickness + 0.05)
            density = numpy.mean([run["report"]["corticalDensity"] for run in runs])
            spread = [numpy.mean([run["report"]["pointSpread"][way] for run in runs]) for way in ("inPlane", "across")]
            lines.append(f"| {spacing} × {spacing} × {slices} | {thickness} | {density:.0f} | {spread[0]:.2f}, {spread[1]:.2f} " +
                         row(runs, "fit", "half", "freed"))
            print(lines[-1], flush=True)
    return lines


def phantoms(folder):
    """The analytic bones, whose cortical density is another in each place."""
    lines = []
    for bone in ("femur", "hemipelvis"):
        mesh = build(folder, bone, "--bone", bone)
        for lower, upper in ((1, 1.5), (1.5, 3), (3, 9)):
            runs = measure(bone, mesh, spacing=0.7, slices=1.0, lower=lower, upper=upper)
            if runs[0]["fit"]["points"] < 20:
                continue
            density = numpy.mean([run["report"]["corticalDensity"] for run in runs])
            lines.append(f"| {bone} | {lower} to {upper} | {runs[0]['fit']['points']:.0f} | {density:.0f} " + row(runs, "fit", "half", "freed"))
            print(lines[-1], flush=True)
    return lines


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        bone = folder / "bone.ply"
        write_bone(bone)
        mesh = build(folder, "rod", "--surface", bone, "--spacing", 0.8)
        first, worst = known(bone, mesh)
        second = estimated(bone, mesh)
        third = phantoms(folder)
        seconds = json.loads(run(PROGRAM, "femur", folder / "femur/model_L1.vtu", "spacing=0.7", "slices=1"))[0]
    head = "mean | sd | p95 |"
    REPORT.write_text(f"""# Cortical thickness

{made_by(__file__)}.

CTs of phantoms: the blur is a Gaussian of 1 mm full width at half maximum (standard deviation 0.42 mm) along each axis, the noise 20 HU,
and {SEEDS} seeds of the noise are taken together. The thickness is measured at the points of the outer surface of a model that `bonetk build`
made, and compared with the phantom's along its normal. Errors are in mm: mean, standard deviation (sd), 95 percentile of the absolute error
(p95). "Found" is the share of the points that have a result by the fit, in percent. The phantoms' blur is the Gaussian that the fit assumes, and their
cortex is homogeneous but for the last table: a scanner's kernel and a porous cortex will do worse.

Three ways: the fit of a blurred cortex (`bonetk thickness`), the half-maximum rule on the line along the normal in the linearly interpolated
CT (`FindCorticalEdges`), and its width freed of the known blur (`ThicknessOfBlurredLayer`).

## One thickness, blur and density known

A rod with round ends and a waist, oblique to the image; cortex of {DENSITY} HU, trabecular bone of 140 to 460 HU, soft tissue of 40 HU. "Fitted" is
the fit without median and smoothing over the surface, "smoothed" with them, as is the default. Largest absolute mean error, smoothed:
{worst:.2f} mm.

| voxel, mm | thickness, mm | fitted: {head} smoothed: {head} half maximum: {head} freed of blur: {head} found, % |
|{'---|' * 15}
""" + "\n".join(first) + f"""

## Thin ends on a thick shaft, blur and density estimated

The same rod, whose shaft has a cortex of 4 mm; only points where the cortex is as thin as said count. Estimated: the cortex's density (HU) and the
blur's full width at half maximum, in the slices' plane and across (mm; true: {DENSITY} and 1).

| voxel, mm | thickness, mm | density | blur | smoothed: {head} half maximum: {head} freed of blur: {head} found, % |
|{'---|' * 14}
""" + "\n".join(second) + f"""

## Bones whose cortical density varies

The analytic bones of `bonetk phantom`, voxels of 0.7 × 0.7 × 1 mm, by true thickness. Thin cortex is less dense here (femur: 1280 HU at the head,
1620 HU at the shaft) than thick cortex, whose density the fit takes for it: where the density is too high by a share, the thickness of
thin cortex is too low by about that share. `--cortical-density` says otherwise. Where two cortices of the hemipelvis meet, the phantom's
thickness is the plate's, which no way measures.

| bone | thickness, mm | points | density | smoothed: {head} half maximum: {head} freed of blur: {head} found, % |
|{'---|' * 14}
""" + "\n".join(third) + f"""

Time of the filter for the femur's {seconds['report']['points']} points: {seconds['seconds']:.1f} s.
""")


if __name__ == "__main__":
    main()
