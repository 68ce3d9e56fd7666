#!/usr/bin/env python3
"""Shape and density from simulated X-rays, leave-one-out over femora: how near, how fast, and whether intervals hold.

Makes a CT of each surface of BONETK_DATA/femur_shapes, with a cortex and densities that vary, registers the model of one to
all (or takes what a folder FEMORA holds of that), and finds each bone by the atlas of the others. Writes
Documentation/validation/deformable.md.
Environment: BONETK (the program), BONETK_DATA (folder of data), BONETK_VALIDATION (boneDeformableValidation), SUBJECTS (how many
are found; all if it is not set).

    BONETK=build/test/Apps/bonetk/bonetk BONETK_VALIDATION=build/test/Testing/Validation/boneDeformableValidation \\
        Testing/Validation/deformable.py
"""
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

from report import made_by

ROOT = pathlib.Path(__file__).resolve().parents[2]
ONE = ("--angles", 0, "--prior-translation", 5.8, "--prior-rotation", 5.8)
CASES = (("two views", ("--scatter", 0)),
         ("two views, 512 x 512", ("--scatter", 0, "--pixels", 512, "--target-pixels", 512)),
         ("two views, 30° apart", ("--scatter", 0, "--angles", 0, 30)),
         ("two views of the proximal third", ("--scatter", 0, "--share", 0.3333)),
         ("two views, scatter 0.1 left", ("--scatter", 0.1)),
         ("two views, scatter 0.6, gradients alone", ("--scatter", 0.6, "--intensities", 0)),
         ("one view", ("--scatter", 0, *ONE)),
         ("one view, other starts", ("--scatter", 0, *ONE, "--seed", 2)))
REGIONS = {-1: "whole bone", 1: "cortical", 2: "trabecular", 3: "medullary cavity"}


def run(*command):
    return subprocess.run([str(part) for part in command], check=True, capture_output=True, text=True).stdout


def prepare(folder, shapes):
    """CTs with label maps in `folder`, and in its `registered` each subject in one topology."""
    bonetk = os.environ["BONETK"]
    for subject, shape in enumerate(shapes, 1):
        ct = folder / f"{shape.stem}.mha"
        if not ct.exists():
            run(bonetk, "phantom", "--surface", shape, "--subject", subject, "-o", ct, "--labels",
                folder / f"{shape.stem}_l.nii.gz", "--quiet")
    registered = folder / "registered"
    if not registered.exists():
        last = folder / shapes[-1].stem
        run(bonetk, "build", f"{last}.mha", "--labels", f"{last}_l.nii.gz", "--axis", "x", "--tetrahedra", 10000,
            "--degree", 2, "--quiet", "-o", folder / "standard")
        subjects = folder / "subjects.txt"
        subjects.write_text("".join(f"{shape}, {folder / shape.stem}.mha\n" for shape in shapes))
        run(bonetk, "train", subjects, "--standard", folder / "standard/model_L1.vtu", "--degree", 2, "--registered",
            registered, "--quiet", "-o", folder / "atlas.h5")
        for file in sorted(registered.iterdir()):
            if file.suffix == ".vtu":  # 001_NAME.vtu
                file.rename(registered / file.name.split("_", 1)[1])
            else:
                file.unlink()  # what train knows a repetition by
    return registered


def held(rows, region, what, voxels=False):
    """Of one region: mean absolute error, stated deviation, share of the 95 % intervals that hold the model's, or that of the
    CT's voxels."""
    values = [(found, deviation, of_voxels if voxels else of_model) for row in rows for entry in row["regions"]
              if entry["region"] == region for found, deviation, of_voxels, of_model in [entry[what]]]
    unit = (lambda value: 1.0) if what == "density" else (lambda value: abs(value) / 100)
    errors = [abs(found - model) / unit(model) for found, _, model in values]
    stated = [deviation / unit(model) for _, deviation, model in values]
    inside = sum(abs(found - model) < 1.96 * deviation for found, deviation, model in values)
    return f"{statistics.mean(errors):.1f} ± {statistics.mean(stated):.1f} ({inside} of {len(values)})"


def main():
    data = pathlib.Path(os.environ["BONETK_DATA"]) / "femur_shapes"
    shapes = sorted(data.glob("*.ply"))
    folder = pathlib.Path(os.environ.get("FEMORA") or tempfile.mkdtemp())
    registered = prepare(folder, shapes)
    found = shapes[:int(os.environ.get("SUBJECTS", len(shapes)))]
    only = ("--only", *(shape.stem for shape in found))
    nearness, regions = "", ""
    for name, options in CASES:
        lines = run(os.environ["BONETK_VALIDATION"], registered, folder, data, *options, *only).splitlines()
        every = [json.loads(line) for line in lines]
        rows = [row for row in every if "refused" not in row]
        flagged = sum("refused" in row or row["quality"] != 0 for row in every)

        def mean(key):
            return statistics.mean(row[key] for row in rows)

        nearer = sum(row["found"] < row["projection"] for row in rows)
        nearness += (f"| {name} | {mean('found'):.2f} | {max(row['found'] for row in rows):.2f} | {mean('found95'):.2f} | "
                     f"{mean('aligned'):.2f} | {mean('aligned95'):.2f} | {nearer} of {len(every)} | {mean('coverage'):.3f} | "
                     f"{flagged} | {statistics.median(row['seconds'] for row in rows):.1f} |\n")
        if "gradients" not in name and "third" not in name:
            for region, title in REGIONS.items():
                mass = held(rows, region, "mass") if region != 3 else ""
                regions += (f"| {name} | {title} | {held(rows, region, 'volume')} | {held(rows, region, 'density')} | "
                            f"{mass} | {held(rows, region, 'mass', True) if region < 0 else ''} |\n")
        print(nearness.splitlines()[-1], flush=True)
    text = f"""# Shape and density from X-rays

{made_by(__file__)}.

Leave-one-out, {len(found)} of {len(shapes)} femora: surfaces of real bones, in which cortex and densities vary from bone to bone
(`bonetk phantom --surface --subject`). Each is found by the atlas of the others in X-rays simulated from its CT of 1 mm voxels: the
whole femur on 256 x 256 pixels (2.5 mm at the bone), bilinear attenuation in soft tissue of 40 HU, blur of half a pixel, quantum
noise of 50,000 photons a pixel, views 90° apart where nothing else is said, without scatter or with a scatter-to-primary ratio of
which nothing is subtracted. Starts are uniform in ±10 mm along and ±10° about each axis. One view is told so: its prior has
deviations of 5.8 mm and 5.8°. Each bone has noise and a start of its own.

## Surfaces

Distances from both surfaces' vertices to the other surface, mm: mean over the bones, largest mean of a bone, 95 % of the
points; then of the bone found after it is moved onto the true one. The atlas' mean in its best pose is {mean('meanShape'):.2f} mm off, the
bones' best projection on the atlas' modes {mean('projection'):.2f} mm (95 %: {mean('projection95'):.2f}). *Intervals*: the share of 95 % intervals of points, along each axis,
that hold where the bone's own registered model has them. *Flagged*: how many are not called `ok`, or refused. Of the proximal third,
all these are of what shows, which starts are about too. Seconds: median by the clock, two threads.

| views | mean | largest | 95 % | moved: mean | 95 % | nearer than the projection | intervals | flagged | seconds |
|---|---|---|---|---|---|---|---|---|---|
{nearness}
## Regions

Mean absolute error ± stated standard deviation (how many 95 % intervals hold the value of the bone's own registered model): volume
and density times volume (mass) in %, mean density in HU; last, of the mass beside that of the CT's voxels. The medullary
cavity's density is near 0, so that % of its mass say nothing.

| views | region | volume | density | mass | mass, voxels |
|---|---|---|---|---|---|
{regions}"""
    (ROOT / "Documentation/validation/deformable.md").write_text(text)


if __name__ == "__main__":
    sys.exit(main())
