#!/usr/bin/env python3
"""The acceptance figures of the density fit: the paper's Table 2, Figure 9 and Table 3, on a hip bone and a phantom.

Builds the models (or takes those built before: MODEL=folder of the hip bone's, PHANTOM=folder of the phantom's), fits every
degree with boneDensityValidation, checks degrees 0 to 6 with an independent checker where CHECK names one, and writes
Documentation/validation/density.md with density_phantom.png (needs matplotlib). Models lie in the folder WORK, where that is
named, and stay there. Environment: BONETK, BONETK_DATA,
BONETK_VALIDATION (boneDensityValidation), BONETK_BENCHMARKS (boneDensityBenchmarks; without it there is no table of speed).

    BONETK=build/test/Apps/bonetk/bonetk BONETK_VALIDATION=build/test/Testing/Validation/boneDensityValidation \
        BONETK_BENCHMARKS=build/test/Modules/Density/boneDensityBenchmarks Testing/Validation/density.py
"""
import hashlib
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import matplotlib
import nibabel
import numpy

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib import ticker  # noqa: E402

import smooth_spaces  # noqa: E402
from report import made_by  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
OUT = ROOT / "Documentation" / "validation"
DEGREES = range(9)
BOUNDS = (7.5, 5.2, 3.4, 2.0, 1.35, 1.05, 0.88)
UNLAYERED = (8.94, 6.13, 4.02, 2.38, 1.56, 1.19, 0.98)
NOISE = 20.0
MASS = 0.005


def run(*command):
    return subprocess.run([str(part) for part in command], check=True, capture_output=True, text=True).stdout


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]) + "\n"


def remembered(command, measure):
    """What measure() gives, as JSON; kept in the folder CACHE, where that is named, so that a run can go on later."""
    kept = None
    if "CACHE" in os.environ:
        key = hashlib.sha1(" ".join(map(str, command)).encode()).hexdigest()
        kept = pathlib.Path(os.environ["CACHE"]) / f"{key}.json"
        if kept.exists():
            return json.loads(kept.read_text())
    answer = measure()
    if kept:
        kept.write_text(answer)
    return json.loads(answer)


def fits(mesh, ct, labels, label, *options):
    """What boneDensityValidation found."""
    command = (os.environ["BONETK_VALIDATION"], mesh, ct, labels, label, *options)
    return remembered(command, lambda: run(*command))


def best(entries, value):
    return min(entries, key=value)["degree"]


def storage(entry):
    """Bytes of a model: points of 3 floats, 4 vertex ids, degree and region a tetrahedron, a float a coefficient."""
    return 12 * entry["points"] + (16 + 2) * entry["tetrahedra"] + 4 * entry["coefficients"]


def percent(entry, part):
    """Mean absolute error of a part in % of the whole bone's range."""
    return 100 * entry[part]["mean"] / entry["all"]["range"]


def independent_check(bonetk, mesh, ct, labels, label, work):
    def check(degree):
        out, answer = work / f"d{degree}.vtu", work / "check.json"
        run(bonetk, "fit", ct, mesh, "--degree", degree, "-o", out, "-q")
        subprocess.run(["/usr/bin/python3", os.environ["CHECK"], out, "--ct", ct, "--label", labels, "--label-value", str(label),
                        "--json", answer], capture_output=True)
        return answer.read_text()

    found = [remembered((os.environ["CHECK"], mesh, degree), lambda: check(degree))["info"] for degree in range(len(BOUNDS))]
    return [(info["density"]["error_pct_of_range"], info["label_uncovered_pct"]) for info in found]


def hip(bonetk, data, work):
    ct, labels, label = data / "hip_ct/hip_ct.nii.gz", data / "hip_ct/hip_labels.nii.gz", 2
    model = pathlib.Path(os.environ.get("MODEL", work / "hip"))
    if not model.exists():
        run(bonetk, "build", ct, "--labels", labels, "--label", label, "-o", model, "-q")
    mesh = model / "model_L1.vtu"
    linear = fits(mesh, ct, labels, label)
    spline = fits(mesh, ct, labels, label, "interpolator=bspline")
    continuous = fits(mesh, ct, labels, label, "continuous=1", "degrees=1,2,3,4")
    samples = fits(mesh, ct, labels, label, "voxelweight=0", "limit=inf")
    first = linear[0]
    checked = independent_check(bonetk, mesh, ct, labels, label, work) if "CHECK" in os.environ else []
    text = f"""## Hip bone (real CT, 0.58 x 0.58 x 1 mm)

{first['tetrahedra']:,} tetrahedra, {first['points']:,} points, {first['meshVoxels'] / first['tetrahedra']:.1f} voxels in each;
{100 * first['all']['uncovered'] / first['labelVoxels']:.2f} % of the label's voxels lie outside the mesh. Mean absolute error
at the label's voxels in % of their 1..99 % range ({first['all']['range']:.0f} HU); on an oblique plane through the middle,
against the trilinearly interpolated CT, which is blurred itself; at held-out voxels (one in five left out of the fit).
"Linear" is the fit's own linear interpolation, without the error by curvature.

"""
    rows = []
    for n, entry in enumerate(linear):
        bound = f"{BOUNDS[n]} {'yes' if entry['all']['percent'] <= BOUNDS[n] else '**no**'}" if n < len(BOUNDS) else ""
        rows.append((n, f"{entry['all']['percent']:.2f}", f"{checked[n][0]:.2f}" if n < len(checked) else "", bound,
                     UNLAYERED[n] if n < len(UNLAYERED) else "", f"{percent(entry, 'region1'):.2f}",
                     f"{percent(entry, 'region2'):.2f}", f"{100 * entry['cut'] / entry['all']['range']:.2f}",
                     f"{entry['heldOut']['percent']:.2f}", f"{spline[n]['all']['percent']:.2f}",
                     f"{spline[n]['heldOut']['percent']:.2f}"))
    text += table(("degree", "all voxels", "independent check", "bound, met", "unlayered mesh", "cortical", "trabecular", "plane",
                   "held out", "B-spline", "B-spline, held out"), rows)
    missed = [n for n, row in enumerate(checked) if row[0] > BOUNDS[n] or row[1] > 1.5]
    if checked:
        text += f"""
By the independent check the label's uncovered voxels are {checked[0][1]:.2f} % (bound 1.5), and the bounds are \
{'met at every degree' if not missed else "missed at degree " + ", ".join(map(str, missed))}.
"""
    text += f"""
Least error at held-out voxels: degree {best(linear, lambda e: e['heldOut']['percent'])} (linear), \
{best(spline, lambda e: e['heldOut']['percent'])} (B-spline).

### What the parts of the fit do

"""
    text += table(("degree", "samples alone", "held out", "with voxels", "held out", "continuous", "held out",
                   "overshoot: median", "90 %", "limited tetrahedra"),
                  [(n, f"{samples[n]['all']['percent']:.2f}", f"{samples[n]['heldOut']['percent']:.2f}",
                    f"{linear[n]['all']['percent']:.2f}", f"{linear[n]['heldOut']['percent']:.2f}",
                    *((f"{continuous[n - 1]['all']['percent']:.2f}", f"{continuous[n - 1]['heldOut']['percent']:.2f}")
                      if 1 <= n <= 4 else ("", "")),
                    f"{linear[n]['overshoot']['median']:.2f}", f"{linear[n]['overshoot']['p90']:.2f}",
                    f"{100 * linear[n]['overshoot']['limited'] / first['tetrahedra']:.1f} %") for n in DEGREES])
    text += f"""
Overshoot: how far control values lie beyond the tetrahedron's data before the limit (8), in ranges of those data.

### Mass

Fitted mass in closed form against the voxel sum (value times volume); bound {100 * MASS:.1f} %.

"""
    mass = [[f"{100 * (entry[n]['mass'] / entry[n][of] - 1):+.2f} %" for entry in (linear, spline)
             for of in ("meshVoxelMass", "labelMass")] for n in DEGREES]
    text += table(("degree", "linear: of the voxels in the mesh", "of the label's", "B-spline: of the voxels in the mesh",
                   "of the label's"), [(n, *row) for n, row in enumerate(mass)])
    beyond = [n for n in DEGREES if abs(linear[n]["mass"] / linear[n]["labelMass"] - 1) > MASS]
    text += f"""
Against the label's voxels, with the default interpolation, the bound is \
{'met at every degree' if not beyond else "missed at degree " + ", ".join(map(str, beyond))}.
"""
    inside = 2 * first["meshVoxels"]
    text += f"""
### Storage (the paper's Table 3)

The CT's {first['meshVoxels']:,} voxels inside the model take {inside:,} bytes (2 each). A model takes 12 bytes a point (three
floats), 18 a tetrahedron (four ids of 4, degree and region of 1) and 4 a coefficient.

"""
    rows = []
    for n, entry in enumerate(linear):
        row = [n, entry["coefficients"], f"{storage(entry):,}", f"{100 * storage(entry) / inside:.0f} %"]
        if 1 <= n <= 4:
            shared = continuous[n - 1]
            row += [shared["coefficients"], f"{storage(shared):,}", f"{100 * storage(shared) / inside:.0f} %"]
        rows.append(row + [""] * (7 - len(row)))
    text += table(("degree", "coefficients", "bytes", "of the CT's", "continuous: coefficients", "bytes", "of the CT's"), rows)
    adaptive = [fits(mesh, ct, labels, label, "degrees=6", f"maxerror={bound}")[0] for bound in (60, 40, 25)]
    text += "\nDegree chosen in each tetrahedron, at most 6, by a bound on its root mean square error:\n\n"
    text += table(("bound (HU)", "tetrahedra of degree 0..6", "coefficients", "bytes", "of the CT's", "error", "held out"),
                  [(bound, ", ".join(str(e["degrees"].get(str(d), 0)) for d in range(7)), e["coefficients"],
                    f"{storage(e):,}", f"{100 * storage(e) / inside:.0f} %", f"{e['all']['percent']:.2f}",
                    f"{e['heldOut']['percent']:.2f}") for bound, e in zip((60, 40, 25), adaptive)])
    levels = []
    for level in sorted(model.glob("model_L?.vtu")):
        e = fits(level, ct, labels, label, "degrees=3")[0]
        levels.append((level.stem, e["points"], e["tetrahedra"], f"{e['meshVoxels'] / e['tetrahedra']:.0f}",
                       f"{e['all']['percent']:.2f}", f"{100 * e['all']['deviation'] / e['all']['range']:.2f}",
                       f"{storage(e):,}", f"{100 * storage(e) / inside:.0f} %"))
    text += "\nThe levels of the hierarchy, each fitted to the CT with degree 3:\n\n"
    text += table(("level", "points", "tetrahedra", "voxels each", "error %", "deviation %", "bytes", "of the CT's"), levels)
    return text


METHODS = {"each tetrahedron on its own": ((), "1,2,3"), "continuous": (("continuous=1",), "1,2,3"),
           "continuous gradient": (("gradient=1",), "3")}


def sweep(meshes, ct, labels, label, *options):
    """For each method and degree what the meshes give: {(method, degree): [entry, ...]}."""
    found = {}
    for mesh in meshes:
        for method, (parameters, degrees) in METHODS.items():
            for entry in fits(mesh, ct, labels, label, "joins=1", *parameters, f"degrees={degrees}", *options):
                found.setdefault((method, entry["degree"]), []).append(entry)
    return found


def at(entries, count, value):
    """A value at a number of coefficients: between two meshes in logarithms; None beyond them."""
    x = numpy.log([entry["coefficients"] for entry in entries])
    if not x[0] <= numpy.log(count) <= x[-1]:
        return None
    return float(numpy.exp(numpy.interp(numpy.log(count), x, numpy.log([value(entry) for entry in entries]))))


def sweep_tables(found, measures):
    """All fits, then each at the numbers of coefficients that a continuous gradient has."""
    def number(x):
        return "" if x is None else f"{x:.2f}"

    rows = [(f"{e['tetrahedra'] // (12 if method == 'continuous gradient' else 1):,}", method, degree, f"{e['coefficients']:,}",
             f"{e['bytes']:,}", *(number(value(e)) for value in measures.values()), f"{e['jumps']['value']:.1e}",
             f"{e['jumps']['gradient']:.1e}", f"{e['jumps']['relative']:.1e}", f"{e['seconds']:.1f}")
            for (method, degree), entries in found.items() for e in entries]
    text = table(("tetrahedra", "density", "degree", "coefficients", "bytes", *measures, "jump (HU)", "of the gradient (HU/mm)",
                  "of its length", "seconds"), sorted(rows, key=lambda row: int(row[0].replace(",", ""))))
    smooth = found[("continuous gradient", 3)]
    for name, value in measures.items():
        text += f"\n{name}, at equal numbers of coefficients (between two meshes in logarithms):\n\n"
        text += table(("coefficients", *(f"{method}, {degree}" for method, degree in found)),
                      [(f"{e['coefficients']:,}", *(number(at(entries, e["coefficients"], value)) for entries in found.values()))
                       for e in smooth])
    return text


def with_bytes(found, points):
    """Storage: the split need not be kept, as it follows from the tetrahedra."""
    for entries in found.values():
        for entry, (tetrahedra, count) in zip(entries, points):
            entry["bytes"] = storage({"tetrahedra": tetrahedra, "points": count, "coefficients": entry["coefficients"]})
    return found


def sizes(found):
    return [(entry["tetrahedra"], entry["points"]) for entry in found[("continuous", 1)]]


def smooth(bonetk, data, work):
    """Densities that are continuous, and those whose gradient is, at equal numbers of coefficients."""
    ct, labels, label = data / "hip_ct/hip_ct.nii.gz", data / "hip_ct/hip_labels.nii.gz", 2

    def meshes(name, *inputs):
        for count in (4000, 9000, 20000, 40000, 80000):
            folder = work / f"{name}_{count}"
            if not folder.exists():
                run(bonetk, "build", *inputs, "--tetrahedra", count, "--levels", 0.5, "--no-page", "-o", folder, "-q")
            yield folder / "model_L1.vtu"

    hips = sweep(meshes("hip", ct, "--labels", labels, "--label", label), ct, labels, label)
    _, noisy, regions, clean = make_phantom(bonetk, pathlib.Path(os.environ.get("PHANTOM", work / "phantom")))
    femora = sweep(meshes("femur", noisy, "--labels", regions), noisy, regions, 0, f"truth={clean}")
    of_hip = sweep_tables(with_bytes(hips, sizes(hips)),
                          {"error (%)": lambda e: e["all"]["percent"], "held out (%)": lambda e: e["heldOut"]["percent"],
                           "gradient (HU/mm)": lambda e: e["gradientError"]})
    of_femur = sweep_tables(with_bytes(femora, sizes(femora)),
                            {"error (HU)": lambda e: e["all"]["mean"], "gradient (HU/mm)": lambda e: e["gradientError"]})
    return f"""## Continuous gradients

`--continuous-gradient` gives cubics on tetrahedra split into twelve (Worsey and Farin), with 4 coefficients a vertex and 2 an edge of
each region. Why not another spline: the table below has all splines with a continuous gradient on a block of 48 tetrahedra, found as
null spaces of the smoothness conditions, fitted to a smooth field of 400 to 1600 HU. Without a split, splines of degree 2 are the
polynomials, and those of degree 3 hardly more; of degree 4 there are enough, but none is known to be local, and how many there are
changes with the mesh (a local basis for every mesh takes degree 9). A penalty on jumps of the gradient makes them small only where
the spline becomes one of those few: the error rises before the jumps are gone. Quadratics on the split into 24 (Worsey and Piper)
need split points of edges in line with incentres, which meshes of bones do not have.

{remembered(("smooth_spaces",), lambda: json.dumps(smooth_spaces.text()))}
### Hip bone

Meshes of the hip bone, and what each density costs and gives. Jumps are the largest across faces within regions; "of its length" is
the jump of the gradient over 1 HU/mm plus its length there. Points are stored to 1e-14 of their place, so that the gradient jumps by
more where a tetrahedron is a micrometre thin. "Gradient" is the mean length of its error against central differences of the CT.
Bytes are those of the storage table, without the split, which follows from the tetrahedra.

{of_hip}
### Femur phantom, noise {NOISE:.0f} HU

The same against the known noise-free CT.

{of_femur}"""


def make_phantom(bonetk, folder, bone="femur", subject=0, spacing=1, *build):
    """Model (level 1), noisy CT, labels and noise-free CT of a phantom, in a folder that may have them already."""
    ct, labels, clean = folder / "ct.nii.gz", folder / "labels.nii.gz", folder / "clean.nii.gz"
    if not clean.exists():
        folder.mkdir(exist_ok=True)
        subject = ("--bone", bone, "--subject", subject, "--spacing", spacing)
        run(bonetk, "phantom", *subject, "--noise", NOISE, "-o", ct, "--labels", labels, "-q")
        run(bonetk, "build", ct, "--labels", labels, *build, "-o", folder / "model", "-q")
        run(bonetk, "phantom", *subject, "-o", clean, "-q")
    return folder / "model" / "model_L1.vtu", ct, labels, clean


def phantom(bonetk, work):
    mesh, ct, labels, clean = make_phantom(bonetk, pathlib.Path(os.environ.get("PHANTOM", work / "phantom")))
    default = fits(mesh, ct, labels, 0, f"truth={clean}")
    variants = {"samples alone": fits(mesh, ct, labels, 0, f"truth={clean}", "voxelweight=0", "limit=inf"),
                "B-spline": fits(mesh, ct, labels, 0, f"truth={clean}", "interpolator=bspline"),
                "margin 0.5 mm": fits(mesh, ct, labels, 0, f"truth={clean}", "margin=0.5")}
    text = f"""## Femur phantom (1 mm, noise {NOISE:.0f} HU)

{default[0]['tetrahedra']:,} tetrahedra of {default[0]['meshVoxels'] / default[0]['tetrahedra']:.1f} voxels. Mean absolute
error against the known noise-free CT in HU; below the noise means below {NOISE:.0f} HU.

"""
    rows = []
    for n, e in enumerate(default):
        rows.append((n, f"{e['all']['mean']:.1f}", "yes" if e["all"]["mean"] < NOISE else "no", f"{e['region1']['mean']:.1f}",
                     f"{e['region2']['mean']:.1f}", f"{e['region3']['mean']:.1f}",
                     *(f"{v[n]['all']['mean']:.1f}" for v in variants.values())))
    text += table(("degree", "all", "below the noise", "cortical", "trabecular", "medullary", *variants), rows)
    text += f"\nLeast error: degree {best(default, lambda e: e['all']['mean'])}.\n"
    text += other_phantoms(bonetk, work)
    draw_phantom(default)
    return text + "\n![degree and storage against error](density_phantom.png)\n"


def draw_phantom(fitted):
    """Error by degree, and by what the model takes of the voxels' bytes."""
    errors = [e["all"]["mean"] for e in fitted]
    shares = [storage(e) / (2 * e["meshVoxels"]) for e in fitted]
    figure, (by_degree, by_storage) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    by_degree.plot(range(len(errors)), errors, "o-")
    by_degree.axhline(NOISE, linestyle="--", color="grey")
    by_degree.set(xticks=range(len(errors)), xlabel="degree", ylabel="mean absolute error (HU)", ylim=(0, None))
    by_storage.plot(shares, errors, "o-")
    for degree, place in enumerate(zip(shares, errors)):
        by_storage.annotate(str(degree), place, xytext=(4, 4), textcoords="offset points")
    by_storage.set(xlabel="bytes of the model / bytes of the voxels inside", xscale="log", ylim=(0, None))
    by_storage.xaxis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5)))
    by_storage.xaxis.set_major_formatter("{x:g}")
    by_storage.xaxis.set_minor_formatter(ticker.NullFormatter())
    for axes in (by_degree, by_storage):
        axes.grid(True)
    figure.savefig(OUT / "density_phantom.png", dpi=100)


def other_phantoms(bonetk, work):
    """Subjects of the same phantom, one in finer voxels, and the one of thin cortices as built by default and finer."""
    rows = []
    for bone, subject, spacing, *build in (("femur", 1, 1), ("femur", 2, 1), ("femur", 3, 1), ("femur", 0, 0.7),
                                           ("femur", 0, 0.7, "--tetrahedra", 50000), ("hemipelvis", 0, 1),
                                           ("hemipelvis", 1, 1), ("hemipelvis", 0, 1, "--tetrahedra", 100000),
                                           ("hemipelvis", 1, 1, "--tetrahedra", 100000)):
        folder = work / "_".join(map(str, [bone, subject, spacing, *build]))
        mesh, ct, labels, clean = make_phantom(bonetk, folder, bone, subject, spacing, *build)
        found = fits(mesh, ct, labels, 0, f"truth={clean}", "degrees=1,2,3,4,5,6,7,8")
        errors = {e["degree"]: e["all"]["mean"] for e in found}
        below = [n for n in errors if all(errors[m] < NOISE for m in errors if m >= n)]
        rows.append((f"{bone}, subject {subject}, {spacing} mm", f"{found[0]['tetrahedra']:,}",
                     f"{found[0]['meshVoxels'] / found[0]['tetrahedra']:.1f}", *(f"{errors[n]:.1f}" for n in (2, 3, 4, 6)),
                     f"from degree {min(below)}" if below else "no", min(errors, key=errors.get)))
    return "\nOther phantoms, mean absolute error (HU) by degree:\n\n" + table(
        ("phantom", "tetrahedra", "voxels each", "2", "3", "4", "6", "below the noise", "least at degree"), rows)


def speed():
    if "BONETK_BENCHMARKS" not in os.environ:
        return ""
    out = run(os.environ["BONETK_BENCHMARKS"], "--benchmark_filter=Fit|Sample", "--benchmark_format=json",
              "--benchmark_repetitions=3", "--benchmark_min_time=0.01")
    rows = {}
    for item in json.loads(out)["benchmarks"]:
        if item.get("run_type") == "aggregate":
            continue
        name = re.sub(r"/process_time/real_time.*", "", item["run_name"])
        wall, cpu = rows.get(name, (1e9, 1e9))
        rows[name] = min(wall, item["real_time"]), min(cpu, item["cpu_time"])
    text = f"""## Speed

Best of three, {os.cpu_count()} cores that other work shares (load {os.getloadavg()[0]:.1f}); 33,000 tetrahedra of 20 voxels.

"""
    return text + table(("what", "wall (ms)", "processor (ms)"),
                        [(name, f"{wall:.0f}", f"{cpu:.0f}") for name, (wall, cpu) in rows.items()])


def main():
    bonetk, data = os.environ["BONETK"], pathlib.Path(os.environ["BONETK_DATA"])
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(os.environ.get("WORK", folder))
        parts = [hip(bonetk, data, work), phantom(bonetk, work), smooth(bonetk, data, work), speed()]
    (OUT / "density.md").write_text(f"# Density fit\n\n{made_by(__file__)}.\n\n" + "\n".join(parts))


if __name__ == "__main__":
    sys.exit(main())
