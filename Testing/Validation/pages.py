#!/usr/bin/env python3
"""How large the pages of `bonetk build` are, how fast they open and cut, and how far their cuts are from the model's density.

Builds phantoms and, where BONETK_DATA is set, a clinical hip at the default size of about 33,000 tetrahedra, opens each page five
times in headless Chromium (BONETK_CHROMIUM, or the one in the path) and writes Documentation/validation/pages.md. Fails where a
first frame's median is above 3 s or the hip's page above 3 MB. Needs node and what `ctest -R Page` has installed.

    BONETK_BUILD=build/test Testing/Validation/pages.py
"""
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile

import numpy

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ["BONETK_BUILD"]).resolve()
os.environ["BONETK"] = str(BUILD / "Apps" / "bonetk" / "bonetk")
os.environ["BONETK_PAGE_MODULES"] = str(BUILD / "Testing" / "Page")
os.environ.setdefault("BONETK_CHROMIUM", shutil.which("chromium-headless-shell") or shutil.which("chromium") or "")
sys.path += [str(ROOT / "Testing" / "Page"), str(ROOT / "Testing" / "Validation")]
from bonetk_test import PLANES, cut_differences, look, must, read_grid  # noqa: E402
from simplification import HIP, bones  # noqa: E402
from report import made_by

REPORT = ROOT / "Documentation" / "validation" / "pages.md"
NAMES = (HIP, "phantom femur 0", "phantom hemipelvis 0")
RUNS = 5
FIRST_FRAME = 3.0  # s, at the most
HIP_SIZE = 3e6     # bytes, at the most


def table(head, rows):
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines) + "\n"


def build(bone, folder):
    """The folder of a bone's model and page."""
    place = folder / bone.name.replace(" ", "_")
    place.mkdir()
    if bone.phantom:
        bone.ct, bone.labels = place / "ct.nii.gz", place / "l.nii.gz"
        must("phantom", *bone.phantom, "--spacing", 1, "--noise", 20, "-o", bone.ct, "--labels", bone.labels, "-q")
    must("build", bone.ct, "--labels", bone.labels, *bone.options(), "-q", "-o", place / "m")
    return place / "m"


def measure(bone, folder):
    """A row of the table, and what is above its limit."""
    model = build(bone, folder)
    page = model / "report.html"
    frames = sorted(look(page)["frameTime"] / 1000 for _ in range(RUNS))
    grid = read_grid(model / "model_L1.vtu")
    bounds = grid.GetBounds()
    middle = [(bounds[2 * axis] + bounds[2 * axis + 1]) / 2 for axis in range(3)]
    cuts = [{"level": level, "orientation": plane, "position": float(middle[axis])}
            for level in (0, 1) for plane, (axis, _) in PLANES.items()]
    seen = look(page, cuts=cuts)["cuts"]
    times = [cut["milliseconds"] for cut in seen[:3]]
    differences = [cut_differences(model / f"model_L{k // 3 + 1}.vtu", cut, list(PLANES.values())[k % 3][0], folder)[0]
                   for k, cut in enumerate(seen)]
    every = numpy.concatenate(differences)
    row = [bone.name, grid.GetNumberOfCells(), f"{page.stat().st_size / 1e6:.2f}", f"{statistics.median(frames):.2f}",
           f"{frames[0]:.2f} to {frames[-1]:.2f}", f"{statistics.median(times):.0f}", f"{every.mean():.2f}",
           f"{numpy.percentile(every, 99):.1f}"]
    failed = []
    if statistics.median(frames) > FIRST_FRAME:
        failed.append(f"{bone.name}: first frame after {statistics.median(frames):.2f} s")
    if bone.name == HIP and page.stat().st_size > HIP_SIZE:
        failed.append(f"{bone.name}: {page.stat().st_size} bytes")
    if every.mean() > 1:
        failed.append(f"{bone.name}: the cut is {every.mean():.2f} HU from the density")
    print(*row, *failed, flush=True)
    return row, failed


def main():
    chosen = [bone for bone in bones(os.environ.get("BONETK_DATA")) if bone.name in NAMES]
    with tempfile.TemporaryDirectory() as folder:
        measured = [measure(bone, pathlib.Path(folder)) for bone in chosen]
    head = ["bone", "tetrahedra of level 1", "page, MB", "first frame, s", "least to most", "cut, ms", "cut to density, HU, mean",
            "99 % below"]
    failed = [text for _, texts in measured for text in texts]
    REPORT.write_text(PAGE.format(made_by=made_by(__file__), table=table(head, [row for row, _ in measured])))
    sys.exit("\n".join(failed) or 0)


PAGE = """# Pages

{made_by}, Chromium drawing without a graphics
card. Pages are those of `bonetk build` with its defaults: three levels, all contours, CT slices, pictures and charts.

{table}
First frame: from the start of loading the page to its first picture, median of five (limit 3 s). Cut: axial, coronal and sagittal
through the middle of level 1: each cell's polygon and the polynomial on it; median. Each pixel of the screen is then coloured by the
polynomial's value there. Cut to density: at every 0.2 mm of the cuts of levels 1 and 2 on three planes, beside
`DensityImageFilter` on the model's files (limit of the mean 1 HU). The difference comes of the page's coefficients, which are
rounded to a 500th of their range, and of its points, which are rounded to a 65,000th of the bone's length: at the border of two
tetrahedra a pixel can lie in the one here and in the other there.
"""


if __name__ == "__main__":
    main()
