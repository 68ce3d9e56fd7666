#!/usr/bin/env python3
"""Rigid registration to X-rays simulated from whole CTs: how often, how exactly and how fast the pose is found.

Builds the models (or takes those built before: MODELS=folder) and registers each from many starts. Writes
Documentation/validation/registration.md and registration_capture.png. Needs matplotlib.
Environment: BONETK (the program), BONETK_DATA (folder of data), BONETK_VALIDATION (boneRegistrationValidation).
Argument: by how much to multiply the numbers of starts, 1 without.
Trials are kept beside the models, so that a page that was broken off goes on at the same commit and on the same machine.

    BONETK=build/test/Apps/bonetk/bonetk BONETK_VALIDATION=build/test/Testing/Validation/boneRegistrationValidation \\
        Testing/Validation/registration.py
"""
import concurrent.futures
import hashlib
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

from report import made_by

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = ROOT / "Documentation/validation"
HIP = ("hip bone, clinical CT", "hip_ct/hip", 2)
FEMUR = ("femur cut below, clinical CT", "hip_ct/hip", 1)
PELVIS = ("hip bone cut above, 3 mm CT", "pelvis_ct_3mm/pelvis", 3)
TIBIA = ("tibia, 1 mm CT", "tibia_ct/tibia", 2)
WHOLE = ("whole femur, phantom", "whole_femur", None)  # Runs makes its CT
VIEWS = (("two views, 90° apart", (0, 90), 200), ("two views, 30° apart", (0, 30), 200), ("one view", (0,), 100))
FOUND_AGAIN = ("--view-translation-deviation", 0.6, "--view-rotation-deviation", 0.3)
FARTHEST = 60  # mm, of the starts of the capture range
BIN = 4  # mm
# Trials whose seconds are not told: bones, count and options.
CAPTURE = {"search and refinement": ([HIP], 400, "--mtre", FARTHEST),
           "refinement alone": ([HIP], 400, "--mtre", FARTHEST, "--searches", 0)}
MISPLACED = {(bone, name): ([bone], 40, "--view-error", 1, 0.5, *options)
             for bone in (HIP, FEMUR, PELVIS)
             for name, options in (("taken as they are said", ()), ("found along with the pose", FOUND_AGAIN))}
TOGETHER = {"each by itself": ([HIP, FEMUR], 40, "--mtre", 15, "--alone"), "together": ([HIP, FEMUR], 40, "--mtre", 15)}


class Runs:
    """Models, and trials with them."""

    def __init__(self, folder, factor):
        self.folder = folder
        self.data = pathlib.Path(os.environ["BONETK_DATA"])
        self.factor = factor

    def model(self, bone):
        _, path, label = bone
        if label is None:
            folder, labels, options = self.folder / path, self.folder / f"{path}_labels.nii.gz", ("--axis", "x")
        else:
            folder, labels = self.folder / f"{pathlib.Path(path).name}_{label}", self.data / f"{path}_labels.nii.gz"
            options = ("--label", label)
        if not folder.exists():
            run(os.environ["BONETK"], "build", self.ct(bone), "--labels", labels, *options, "--quiet", "-o", folder)
        return folder / "model.hierarchy.json"

    def ct(self, bone):
        _, path, label = bone
        if label is not None:
            return self.data / f"{path}_ct.nii.gz"
        ct = self.folder / f"{path}_ct.nii.gz"
        if not ct.exists():  # soft tissue about it, as the air that follows casts edges
            run(os.environ["BONETK"], "phantom", "--surface", self.data / "femur_shapes/l_femur_13.ply", "--margin", 45, "--quiet",
                "-o", ct, "--labels", self.folder / f"{path}_labels.nii.gz")
        return ct

    def trials(self, bones, count, *options):
        count = max(2, round(self.factor * count))
        command = [os.environ["BONETK_VALIDATION"], self.ct(bones[0]),
                   *map(self.model, bones), "--count", count, "--seed", 7, *options]
        made = made_by(__file__)
        key = hashlib.sha1(" ".join(map(str, (made, *command))).encode()).hexdigest()
        kept = self.folder / "trials" / f"{key}.jsonl"
        if kept.exists():
            return read(kept.read_text())
        lines = run(*command)
        if "with changes" not in made:
            kept.parent.mkdir(exist_ok=True)
            written = kept.with_suffix(".part")
            written.write_text(lines)
            written.rename(kept)
        return read(lines)

    def prepare(self, *listed):
        """Makes these trials, two lists at a time as their seconds do not count."""
        for bones, *_ in listed:
            for bone in bones:
                self.model(bone)
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            return list(pool.map(lambda made: self.trials(*made), listed))


def read(lines):
    return [json.loads(line) for line in lines.splitlines()]


def run(*command):
    return subprocess.run([str(part) for part in command], check=True, capture_output=True, text=True).stdout


def is_found(trial, single=False):
    return trial["plane"] < 1 if single else trial["after"] < 2


def median(trials, key):
    return f"{statistics.median(t[key] for t in trials):.2f}" if trials else ""


def errors(found):
    """Root mean squares of the centre's errors along x, y, z, and medians of the stated deviations."""
    def rms(k):
        return statistics.mean(t["translation"][k] ** 2 for t in found) ** 0.5

    return (" ".join(f"{rms(k):.2f}" for k in range(3)),
            " ".join(f"{statistics.median(t['deviation'][k] for t in found):.2f}" for k in range(3)))


def row(name, trials, single=False):
    found = [t for t in trials if is_found(t, single)]
    lost = [t for t in trials if not is_found(t, single)]
    cells = [name, f"{len(found)} of {len(trials)}", f"{sum(t['quality'] != 0 for t in lost)} of {len(lost)}",
             str(sum(t["quality"] != 0 for t in found)), median(found, "after"), median(found, "plane"),
             *(errors(found) if found else ("", "")), median(trials, "seconds"),
             f"{statistics.mean(t['processor'] for t in trials):.2f}"]
    return "| " + " | ".join(cells) + " |\n"


def capture_range(trials):
    """The largest multiple of BIN below which, in each bin, 95 % are found; and the shares of the bins."""
    shares = []
    for lower in range(0, FARTHEST, BIN):
        inside = [t for t in trials if lower <= t["before"] < lower + BIN]
        shares.append(sum(map(is_found, inside)) / len(inside) if inside else None)
    captured = 0
    for index, share in enumerate(shares):
        if share is not None and share < 0.95:
            break
        captured = BIN * (index + 1)
    return captured, shares


def capture(runs):
    """The section, and its picture."""
    text, figure = "", plt.figure(figsize=(6, 3.2))
    for name, trials in zip(CAPTURE, runs.prepare(*CAPTURE.values())):
        captured, shares = capture_range(trials)
        text += f"| {name} | {captured} |\n"
        plt.plot([BIN * (i + 0.5) for i in range(len(shares))], [100 * s if s is not None else None for s in shares],
                 marker="o", label=name)
    plt.axhline(95, color="grey", linewidth=0.8)
    plt.xlabel("mTRE of the start (mm)")
    plt.ylabel("found (%)")
    plt.legend()
    figure.tight_layout()
    figure.savefig(PAGES / "registration_capture.png", dpi=110)
    return f"| | capture range (mm) |\n|---|---|\n{text}"


def misplaced(runs):
    text = "| bone | | found | median mTRE | largest |\n|---|---|---|---|---|\n"
    for (bone, name), trials in zip(MISPLACED, runs.prepare(*MISPLACED.values())):
        found = [t for t in trials if is_found(t)]
        text += (f"| {bone[0]} | {name} | {len(found)} of {len(trials)} | {median(found, 'after')} | "
                 f"{max(t['after'] for t in found):.2f} |\n")
    return text


def together(runs):
    text = "| bone | | found | median mTRE |\n|---|---|---|---|\n"
    for name, trials in zip(TOGETHER, runs.prepare(*TOGETHER.values())):
        for bone, own in ((HIP, trials), (FEMUR, [t["others"][0] for t in trials])):
            found = [t for t in own if is_found(t)]
            text += f"| {bone[0]} | {name} | {len(found)} of {len(own)} | {median(found, 'after')} |\n"
    return text


def ray_casting(runs):
    text = "| bone | starts within | | found | median mTRE, all | seconds |\n|---|---|---|---|---|---|\n"
    for bone in (HIP, FEMUR):
        for reach in (10, 30):
            for name, options in (("ray casting, 64 pixels", ("--ray-casting", 64)), ("BoneTK, 256 pixels", ())):
                trials = runs.trials([bone], 20, "--mtre", reach, *options)
                text += (f"| {bone[0]} | {reach} mm | {name} | {sum(map(is_found, trials))} of {len(trials)} | "
                         f"{median(trials, 'after')} | {median(trials, 'seconds')} |\n")
            print(text.splitlines()[-1], flush=True)
    return text


def parts(runs):
    """Rows of a long bone of which X-rays show all, or its proximal third."""
    text = ""
    for name, angles in (("two views", (0, 90)), ("one view", (0,))):
        for shown, share in (("all", 1), ("a third", 0.3333)):
            text += row(f"{name}, {shown}", runs.trials([WHOLE], 100, "--angles", *angles, "--axis", 0, "--share", share), len(angles) == 1)
            print(text.splitlines()[-1], flush=True)
    return text


HEADER = ("| {} | found | flagged | alarms | mTRE | in the plane | centre x, y, z | stated | seconds | processor |\n"
          "|---|---|---|---|---|---|---|---|---|---|\n")


def main():
    PAGES.mkdir(exist_ok=True)
    runs = Runs(pathlib.Path(os.environ.get("MODELS") or tempfile.mkdtemp()),
                float(sys.argv[1]) if len(sys.argv) > 1 else 1.0)
    text = f"""# Rigid registration to X-rays

{made_by(__file__)}.

Each model, built by `bonetk build` with its defaults, is registered to X-rays of 256 x 256 pixels simulated from the whole CT:
attenuation of soft tissue and bone, all that the CT holds beside the bone, scatter (scatter-to-primary 0.6, blurred by 30 mm),
blur of half a pixel, quantum noise of 50,000 photons a pixel. Source to bone 700 mm, to detector 1,000 mm; the detector
just holds the bone with a tenth of room. Where nothing else is said, two views are 90° apart and starts are uniform in ±20 mm
along and ±20° about each axis.

A pose is found where the mean displacement of the model's points (mTRE) is below 2 mm; of one view, where it is below 1 mm in
the detector's plane. *Flagged*: how many of the poses that were not found are not called `ok`; *alarms*: how many that were
found are not. mTRE (mm) is the median of the poses found; errors of the centre along x, y (the first view's depth) and z are root
mean squares, beside them the medians of the stated standard deviations. Seconds: median by the clock, mean of the processors,
with two threads.
"""
    for title, angles, count in VIEWS:
        text += f"\n## {title[0].upper() + title[1:]}\n\n{HEADER.format('bone')}"
        for bone in (HIP, FEMUR, PELVIS, TIBIA):
            text += row(bone[0], runs.trials([bone], count if bone != TIBIA else 40, "--angles", *angles),
                        len(angles) == 1)
            print(text.splitlines()[-1], flush=True)
    text += f"""
The tibia's CT ends a voxel above the plateau. This false edge lies beside the true one and pulls the model by half a
millimetre along the bone. Seen from one side, a long bone that is tilted towards the source looks like one tilted away.

## A part of a long bone

A whole femur, and X-rays of all of it or of its proximal third. Starts are about what shows, and so are mTRE and errors. A pose
beyond the translations or at the end of the turns that are searched is `suspect` even where it is right: the search turns the model about what the
first views show of it at the start.

{HEADER.format('views')}{parts(runs)}
## Capture range

Of the first hip, after E. B. van de Kraats et al. (IEEE Trans Med Imaging 2005): starts whose mTRE is uniform from 0 to {FARTHEST} mm,
in bins of {BIN} mm; the capture range ends with the first bin of which less than 95 % are found.

{capture(runs)}
![How many poses are found, by the mTRE of the start](registration_capture.png)

## Views that are not where they are said to be

The second view is 1 mm along some direction and 0.5° about some axis from where its geometry says. `ViewTranslationDeviation` 0.6
and `ViewRotationDeviation` 0.3 say so, and its motion is found along with the pose.

{misplaced(runs)}
## Two bodies

Hip bone and femur in views that hold both, so of larger pixels than above, from starts whose mTRE is uniform from 0 to 15 mm.

{together(runs)}
## Beside ray casting and normalized correlation

The way of ITK's example IntensityBased2D3DRegistration, written anew for two views: radiographs of the CT above 0 HU by
`itk::RayCastInterpolateImageFunction`, normalized correlation, `itk::PowellOptimizer` with the example's steps and tolerances. It
sees 64 x 64 pixels, as an image of 256 x 256 takes sixteen times as long. Same X-rays, same starts, whose mTRE is uniform from 0.

{ray_casting(runs)}"""
    (PAGES / "registration.md").write_text(text)


if __name__ == "__main__":
    main()
