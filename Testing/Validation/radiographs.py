#!/usr/bin/env python3
"""The paper's Table 4 and the comparison of speed, on one bone of a CT.

Builds the model (or takes one built before: MODEL=folder), makes the radiograph of each level, of the CT masked by the
label, and of the same CT by plastimatch where that is installed, and writes Documentation/validation/radiographs.md.
Environment: BONETK (the program), BONETK_DATA (folder of data), BONETK_VALIDATION (boneRadiographValidation: the table
of speed), BONETK_BENCHMARKS (boneRadiographBenchmarks: its table); without the last two there are no such tables.
Arguments: bone's name in the table, CT, label map (below BONETK_DATA), label.

    BONETK=build/test/Apps/bonetk/bonetk Testing/Validation/radiographs.py "hip bone" hip_ct/hip_ct.nii.gz \
        hip_ct/hip_labels.nii.gz 2
"""
import json
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

import nibabel
import numpy

from report import made_by

ROOT = pathlib.Path(__file__).resolve().parents[2]
TARGETS = (1.5, 3.0, 5.0)
PAPER = (3.2, 7.6, 14.4)
BENCHMARKS = "Projection(Once)?/(33000|300000)|Derivatives|Backprojection|Search|Walk"


def run(*command):
    return subprocess.run([str(part) for part in command], check=True, capture_output=True, text=True).stdout


def read_mha(path):
    """Values of a MetaImage of floats with its header inside."""
    raw = path.read_bytes()
    end = raw.index(b"ElementDataFile = LOCAL") + len("ElementDataFile = LOCAL\n")
    header = dict(line.split(" = ", 1) for line in raw[:end].decode().splitlines())
    if header["CompressedData"] == "True":
        import zlib
        data = zlib.decompress(raw[end:])
    else:
        data = raw[end:]
    columns, rows, _ = map(int, header["DimSize"].split())
    kind = {"MET_FLOAT": "<f4", "MET_SHORT": "<i2", "MET_DOUBLE": "<f8"}[header["ElementType"]]
    return numpy.frombuffer(data, kind).reshape(rows, columns).astype(float)


def frame(labels_path, label):
    """A view from the front of 512 x 512 pixels that just holds the labelled voxels, as bonetk's JSON and plastimatch's
    arguments. Patients lie along z; source 1000 mm before the bone's centre, detector 1200 mm from the source."""
    image = nibabel.load(labels_path)
    voxels = numpy.argwhere(numpy.asarray(image.dataobj) == label)
    corners = numpy.array([[(voxels.min(0), voxels.max(0))[(k >> a) & 1][a] for a in range(3)] for k in range(8)])
    points = nibabel.affines.apply_affine(image.affine, corners) * (-1, -1, 1)  # RAS to LPS
    low, high = points.min(0), points.max(0)
    centre = (low + high) / 2
    sad, sid = 1000.0, 1200.0
    nearest = sad - (high[1] - low[1]) / 2
    side = max(high[0] - low[0], high[2] - low[2]) * sid / nearest * 1.02
    pixel = side / 512
    source = centre - (0, sad, 0)
    origin = centre + (-255.5 * pixel, sid - sad, 255.5 * pixel)
    geometry = {"source": source.tolist(), "detectorOrigin": origin.tolist(), "detectorU": [1, 0, 0],
                "detectorV": [0, 0, -1], "size": [512, 512], "spacing": [pixel, pixel]}
    plastimatch = ["--nrm", "0 -1 0", "--vup", "0 0 1", "--sad", sad, "--sid", sid, "-r", "512 512",
                   "-z", f"{side} {side}", "-o", " ".join(map(str, centre))]
    return geometry, plastimatch


def table_4(bonetk, model, work, ct, labels, label, geometry):
    json_path = work / "view.json"
    json_path.write_text(json.dumps(geometry))
    mask = work / "mask.nii.gz"
    image = nibabel.load(labels)
    kept = (numpy.asarray(image.dataobj) == label).astype(numpy.uint8)
    nibabel.save(nibabel.Nifti1Image(kept, image.affine, image.header), mask)
    run(bonetk, "drr", ct, "--mask", mask, "--geometry", json_path, "-o", work / "ct.mha")
    truth = read_mha(work / "ct.mha")
    rows = []
    for level in (1, 2, 3):
        path = model / f"model_L{level}.vtu"
        out = work / f"level{level}.mha"
        run(bonetk, "drr", path, "--geometry", json_path, "-o", out)
        drr = read_mha(out)
        either = (truth != 0) | (drr != 0)
        difference = 100 * numpy.abs(drr - truth)[either] / (truth.max() - truth.min())
        cells = int(re.search(r"(?m)^tetrahedra +(\d+)", run(bonetk, "info", path)).group(1))
        rows.append((level, cells, difference.mean(), difference.std()))
    return rows, truth


def time_plastimatch(work, ct, arguments):
    """Seconds (wall, processor) of `plastimatch drr` exact, less those of a picture of one pixel (reading the CT); None
    without it."""
    if shutil.which("plastimatch") is None:
        return None
    run("plastimatch", "convert", "--input", ct, "--output-img", work / "ct_in.mha")

    def total(*extra):
        before = os.times()
        text = run("plastimatch", "drr", "-i", "exact", "-P", "none", "-t", "raw", *arguments, *extra, "-O", work / "p",
                   work / "ct_in.mha")
        after = os.times()
        processor = after.children_user + after.children_system - before.children_user - before.children_system
        return float(re.search(r"Total time: ([\d.]+)", text).group(1)), processor

    whole = [total() for _ in range(4)]
    reading = [total("-w", "0 0 0 0") for _ in range(4)]
    return [min(t[k] for t in whole) - min(t[k] for t in reading) for k in (0, 1)]


def compare(program, bonetk, model, work, ct, json_path):
    """Milliseconds (wall, processor of all threads) by name, and cells and ray-cell intervals by model, of one run."""
    models = {"L1": model / "model_L1.vtu", "degree2": work / "degree2.vtu", "L2": model / "model_L2.vtu",
              "L3": model / "model_L3.vtu"}
    run(bonetk, "fit", ct, models["L1"], "--degree", 2, "-o", models["degree2"])
    times, cells = {}, {}
    for line in run(program, ct, json_path, *models.values()).splitlines():
        for name, path in models.items():
            line = line.replace(str(path), name)
        words = line.split()
        if words[0] == "cells":
            cells[words[1]] = [float(word) for word in words[2:]]
        elif len(words) >= 3:
            times[" ".join(words[:-2])] = [float(word) for word in words[-2:]]
        else:
            times[words[0]] = float(words[1])
    return times, cells


def first_images(program, model, json_path, processes=20):
    """Milliseconds by the wall clock (least and median) of a process's first radiograph and of those after it."""
    first, kept = [], []
    for _ in range(processes):
        lines = run(program, "first", json_path, model / "model_L1.vtu").splitlines()
        values = {line.split()[0]: float(line.split()[1]) for line in lines}
        first.append(values["first"])
        kept.append(values["kept"])
    return [(min(times), statistics.median(times)) for times in (first, kept)]


def verdict(value, aim, least=False):
    return f"{'within' if (value >= aim if least else value <= aim) else 'over' if not least else 'below'} the aim of {aim:,}"


def gradient_lines(times, first):
    """What registration and training wait for, as multiples of the image's time in the same run."""
    image, derivatives, adjoint = (times[name] for name in ("image", "derivatives", "adjoint"))
    rate = 64e3 / times["search"][0]
    (least, median), (least_kept, median_kept) = first
    return ["", "| for registration and training, level 1 | wall (ms) | processor / 2 (ms) | times the image: wall | processor | aim |",
            "|---|---|---|---|---|---|",
            *(f"| {name} | {wall:.1f} | {processor / 2:.1f} | {wall / image[0]:.1f} | {processor / image[1]:.1f} | {aim} |"
              for name, (wall, processor), aim in (("image", image, ""), ("image and 26 derivatives", derivatives, "6 x"),
                                                   ("image and adjoint, all points and coefficients", adjoint, "4 x"))),
            "", "The three in turn, 60 times.", "",
            f"The first image of a process, `DRRImageFilter`, in 20 processes: {least:.1f} ms, median {median:.1f} ms; "
            f"later ones of the same model {least_kept:.1f} ms, median {median_kept:.1f} ms. The first one waits "
            f"{median - median_kept:.1f} ms longer (median): {verdict(median - median_kept, 2.5)} ms.", "",
            f"64 poses at 128 x 128 pixels in one call of `ProjectMesh`, level 3: {times['search'][0]:.1f} ms, {rate:,.0f} views "
            f"a second: {verdict(rate, 1000, least=True)}. One by one they take {times['search_alone'][0]:.1f} ms; processor time "
            f"{times['search'][1]:.1f} and {times['search_alone'][1]:.1f} ms."]


def speed_lines(times, cells, seconds):
    """The table of speed. Where other work shares the processors, processor time is the fairer measure."""
    model = times["model L1"]
    rows = [("model, level 1, degree 2", times["model degree2"], "20 ms"), ("model, level 1, degree 3", model, "26 ms"),
            ("the same, the only one of its mesh", times["once L1"], ""),
            ("model, level 2", times["model L2"], ""), ("model, level 3", times["model L3"], ""),
            ("CT, Joseph's method (`drr CT`)", times["joseph"], ""),
            ("CT, `itk::RayCastInterpolateImageFunction`", times["itk"], "30 x")]
    if seconds:
        rows.append(("CT, `plastimatch drr` exact, without reading", [1000 * seconds[0], 1000 * seconds[1]], "8 x"))
    count, intervals, _ = cells["L1"]
    lines = ["| radiograph | wall (ms) | processor / 2 (ms) | times level 1 at degree 3: wall | processor | aim |",
             "|---|---|---|---|---|---|"]
    for name, (wall, processor), aim in rows:
        lines.append(f"| {name} | {wall:.1f} | {processor / 2:.1f} | {wall / model[0]:.1f} | {processor / model[1]:.1f} | "
                     f"{aim} |")
    near, many = times["model close"], cells["close"][1]
    passed = ", ".join(f"{cells[level][1] / cells[level][2]:.1f}" for level in ("L1", "L2", "L3"))
    lines += ["", f"On a detector a fifth as wide about its middle, {many / 1e6:.2f} million intervals: {near[0]:.1f} ms, "
              f"{1e6 * near[0] / many:.2f} ns an interval by wall time, {0.5e6 * near[1] / many:.2f} ns by half the "
              "processor time; most cells lie beside it. This is no measure against the aim of 1.6 ns, which is for the view above.",
              "", f"A ray that meets the bone passes {passed} tetrahedra of levels 1 to 3.",
              "", f"Level 1 has {count:.0f} tetrahedra and {intervals / 1e6:.2f} million ray-cell intervals: "
              f"{1e6 * model[0] / intervals:.2f} ns an interval by wall time, {0.5e6 * model[1] / intervals:.2f} ns by half the "
              f"processor time, the model kept (`ProjectionModel`, as `DRRImageFilter` does): {'within' if 1e6 * model[0] / intervals <= 1.6 else 'over'} the aim of 1.6 ns. "
              f"The only radiograph of its mesh takes {1e6 * times['once L1'][0] / intervals:.2f} ns an interval. "
              f"ITK's image and Joseph's differ by {100 * times['itk_difference']:.1f} % of the mean."]
    return lines


def speed(program):
    text = run(program, f"--benchmark_filter={BENCHMARKS}", "--benchmark_format=json", "--benchmark_repetitions=5",
               "--benchmark_min_time=0.1")
    best = {}
    for entry in json.loads(text)["benchmarks"]:
        if entry["run_type"] != "iteration":
            continue
        name = "/".join(part for part in entry["name"].split("/") if not part.endswith("_time"))
        wall, cpu, intervals = best.get(name, (1e9, 1e9, 0))
        best[name] = (min(wall, entry["real_time"]), min(cpu, entry["cpu_time"]), entry.get("intervals", intervals))
    return best


def main():
    bonetk, data = os.environ["BONETK"], pathlib.Path(os.environ["BONETK_DATA"])
    name, ct, labels, label = sys.argv[1], data / sys.argv[2], data / sys.argv[3], int(sys.argv[4])
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        model = pathlib.Path(os.environ.get("MODEL", work / "model"))
        if not model.exists():
            run(bonetk, "build", ct, "--labels", labels, "--label", label, "-o", model, "--degree", 3)
        geometry, arguments = frame(labels, label)
        rows, truth = table_4(bonetk, model, work, ct, labels, label, geometry)
        lines = ["# Radiographs", "",
                 made_by(__file__) + ".", "",
                 f"## The paper's Table 4: {name}, label {label} of `{sys.argv[2]}`", "",
                 "512 x 512 pixels from the front, source 1000 mm before the bone's centre, detector at 1200 mm, degree 3, "
                 "against the radiograph of the CT masked by the label (Joseph's method), over the pixels that either "
                 f"hits; {100 * (truth != 0).mean():.0f} % of the image. In % of the CT radiograph's range.", "",
                 "| level | tetrahedra | mean difference (%) | standard deviation (%) | aim | paper |",
                 "|---|---|---|---|---|---|"]
        for (level, cells, mean, deviation), target, paper in zip(rows, TARGETS, PAPER):
            lines.append(f"| {level} | {cells} | {mean:.2f} | {deviation:.2f} | {target} | {paper} |")
        if "BONETK_VALIDATION" in os.environ:
            load = os.getloadavg()[0]
            seconds = time_plastimatch(work, ct, arguments)
            times, cells = compare(os.environ["BONETK_VALIDATION"], bonetk, model, work, ct, work / "view.json")
            lines += ["", "## Speed on the same CT and view", "",
                      f"2 threads on {os.cpu_count()} processors, which other work shared (load {load:.1f} before, "
                      f"{os.getloadavg()[0]:.1f} after): least of the repetitions, and processor time beside wall time"
                      f"{', which such a load makes meaningless' if load > 4 else ''}.", "", *speed_lines(times, cells, seconds),
                      *gradient_lines(times, first_images(os.environ["BONETK_VALIDATION"], model, work / "view.json"))]
        if "BONETK_BENCHMARKS" in os.environ:
            lines += ["", "## Benchmarks", "", f"`boneRadiographBenchmarks`, 2 threads on {os.cpu_count()} processors, load "
                      f"{os.getloadavg()[0]:.1f} at the start; least of 5. Arguments: cells, degree. The block fills the "
                      "image.", "", "| benchmark | wall (ms) | processor (ms) | ns a ray-cell interval: wall | "
                      "half the processor time |", "|---|---|---|---|---|"]
            for key, (wall, cpu, count) in speed(os.environ["BONETK_BENCHMARKS"]).items():
                each = f"{1e6 * wall / count:.2f} | {0.5e6 * cpu / count:.2f}" if count else "| "
                lines.append(f"| {key} | {wall:.1f} | {cpu:.1f} | {each} |")
        (ROOT / "Documentation/validation/radiographs.md").write_text("\n".join(lines) + "\n")


main()
