#!/usr/bin/env python3
"""Rigid registration to X-rays simulated from whole CTs: how often, how exactly and how fast the pose is found.

Builds the models (or takes those built before: MODELS=folder) and registers each from many starts. Writes
Documentation/validation/registration.md.
Environment: BONETK (the program), BONETK_DATA (folder of data), BONETK_VALIDATION (boneRegistrationValidation).
Argument: number of starts, 40 without.

    BONETK=build/test/Apps/bonetk/bonetk BONETK_VALIDATION=build/test/Testing/Validation/boneRegistrationValidation \\
        Testing/Validation/registration.py 200
"""
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
BONES = (("hip bone, clinical CT", "hip_ct/hip", 2), ("femur cut below, clinical CT", "hip_ct/hip", 1),
         ("hip bone cut above, 3 mm CT", "pelvis_ct_3mm/pelvis", 3), ("tibia, 1 mm CT", "tibia_ct/tibia", 2))
VIEWS = (("two views, 90° apart", (0, 90)), ("two views, 30° apart", (0, 30)), ("one view", (0,)))


def run(*command):
    return subprocess.run([str(part) for part in command], check=True, capture_output=True, text=True).stdout


def row(name, lines, single):
    """A line of the table; a pose is found below 2 mm, or, of one view, below 1 mm in its plane."""
    trials = [[float(number) for number in line.split()] for line in lines]
    error = 3 if single else 2
    found = [t for t in trials if t[error] < (1 if single else 2)]
    lost = [t for t in trials if t not in found]
    flagged = sum(t[6] != 0 for t in lost)
    alarms = sum(t[6] != 0 for t in found)
    cells = [name, f"{len(found)} of {len(trials)}", f"{flagged} of {len(lost)}", str(alarms)]
    if found:
        cells += [f"{statistics.median(t[2] for t in found):.2f}", f"{statistics.median(t[3] for t in found):.2f}",
                  " ".join(f"{statistics.mean(t[10 + k] for t in found):.2f}" for k in range(3)),
                  " ".join(f"{statistics.median(t[13 + k] for t in found):.2f}" for k in range(3))]
    else:
        cells += ["", "", "", ""]
    cells += [f"{statistics.median(t[7] for t in trials):.2f}", f"{statistics.mean(t[8] for t in trials):.2f}"]
    return "| " + " | ".join(cells) + " |"


def main():
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 40
    data = pathlib.Path(os.environ["BONETK_DATA"])
    models = pathlib.Path(os.environ.get("MODELS") or tempfile.mkdtemp())
    commit = run("git", "-C", ROOT, "rev-parse", "--short", "HEAD").strip()
    text = f"""# Rigid registration to X-rays

Made by `Testing/Validation/registration.py {count}` at {commit}.

Each model, built by `bonetk build` with its defaults, is registered to X-rays of 256 x 256 pixels simulated from the whole CT:
attenuation of soft tissue and bone, all that the CT holds beside the bone, scatter (scatter-to-primary 0.6, blurred by 30 mm),
blur of half a pixel, quantum noise of 50,000 photons a pixel. Source to bone 700 mm, to detector 1,000 mm; the detector
just holds the bone with a tenth of room. {count} starts, uniform in ±20 mm along and ±20° about each axis.

A pose is found where the mean displacement of the model's points (mTRE) is below 2 mm; of one view, where it is below 1 mm in
the detector's plane. *Flagged*: how many of the poses that were not found are not called `ok`; *alarms*: how many that were
found are not. Errors are medians of the poses found, in mm; the errors of the centre along x, y (the first view's depth) and z
are means, beside them the stated standard deviations. Seconds: median by the clock, mean of the processors, with two threads.
"""
    for title, angles in VIEWS:
        text += f"\n## {title[0].upper() + title[1:]}\n\n| bone | found | flagged | alarms | mTRE | in the plane | centre x, y, z | stated | seconds | processor |\n|---|---|---|---|---|---|---|---|---|---|\n"
        for name, path, label in BONES:
            folder = models / f"{pathlib.Path(path).name}_{label}"
            if not folder.exists():
                run(os.environ["BONETK"], "build", data / f"{path}_ct.nii.gz", "--labels", data / f"{path}_labels.nii.gz",
                    "--label", label, "--quiet", "-o", folder)
            lines = run(os.environ["BONETK_VALIDATION"], data / f"{path}_ct.nii.gz", folder / "model.hierarchy.json",
                        "--angles", *angles, "--count", count, "--seed", 7).splitlines()
            text += row(name, lines, len(angles) == 1) + "\n"
            print(text.splitlines()[-1], flush=True)
    text += """
The tibia's CT ends a voxel above the plateau. This false edge lies beside the true one and pulls the model by half a
millimetre along the bone. Seen from one side, a long bone that is tilted towards the source looks like one tilted away.
"""
    (ROOT / "Documentation/validation/registration.md").write_text(text)


if __name__ == "__main__":
    main()
