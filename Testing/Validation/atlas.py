#!/usr/bin/python3
"""The atlas on real shapes and on phantoms whose factors are known.

    BONETK_DATA=... Testing/Validation/atlas.py BUILD_FOLDER [--scratch FOLDER] [--only registration|population]

makes the standard models with bonetk, registers them to the surfaces in BONETK_DATA/femur_shapes (each in a random pose, its
vertices shuffled) and to models of scanned phantom hemipelves, trains, and writes Documentation/validation/atlas.md. With --only the other
parts are taken from the last run in the scratch folder. About ten minutes on two cores."""

import argparse
import json
import os
import pathlib
import subprocess
import tempfile

from report import made_by

HERE = pathlib.Path(__file__).resolve()
REPORT = HERE.parents[2] / "Documentation" / "validation" / "atlas.md"


class Validation:
    def __init__(self, build, scratch):
        self.bonetk = build / "Apps" / "bonetk" / "bonetk"
        self.program = build / "Testing" / "Validation" / "boneAtlasValidation"
        self.scratch = scratch

    @staticmethod
    def run(*command):
        done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
        if done.returncode != 0:
            raise SystemExit(f"{command[0]}: {done.stderr.strip()}")
        return done.stdout

    def rows(self, name, *arguments):
        lines = self.run(self.program, *arguments)
        (self.scratch / f"{name}.jsonl").write_text(lines)
        return lines

    def standard(self, name, source, axis, tetrahedra):
        folder = self.scratch / name
        if not (folder / "model_L1.vtu").exists():
            ct, labels = self.scratch / f"{name}.mha", self.scratch / f"{name}_labels.nii.gz"
            self.run(self.bonetk, "phantom", *source, "--spacing", 1, "-o", ct, "--labels", labels, "--quiet")
            self.run(self.bonetk, "build", ct, "--labels", labels, "-o", folder, "--axis", axis, "--tetrahedra", tetrahedra,
                     "--degree", 2, "--quiet")
        return folder / "model_L1.vtu"

    def registration(self, data):
        shapes = sorted(pathlib.Path(data, "femur_shapes").glob("*.ply"))
        first = next(s for s in shapes if s.stem == "r_femur_01")
        standard = self.standard("femur", ["--surface", first], "x", 35000)
        self.rows("registration", "registration", standard, first, *shapes)
        few = [s for s in shapes if s.stem in ("l_femur_11", "l_femur_23", "r_femur_10", "r_femur_18")]
        self.rows("frames", "frames", standard, first, *few)
        self.rows("icp", "icp", standard, first, *few)

    def population(self):
        self.rows("population", "population", self.standard("hemipelvis", ["--bone", "hemipelvis"], "z", 30000), 30, 1)


def read(scratch, name):
    path = scratch / f"{name}.jsonl"
    return [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []


def figure(row, name):
    """A mean and its standard error, where the run has them."""
    if name not in row:
        return "not run"
    error = row.get(name + "Error")
    return f"{row[name]:.2f}" + (f" ({error:.2f})" if error is not None else "")


def registration_section(scratch):
    rows = read(scratch, "registration")
    subjects = [r for r in rows if "subject" in r]
    out = ["## Registration\n",
           "A standard model made of the phantom of `r_femur_01` by `bonetk build` (slices and cells of its own), registered to",
           "the 18 femora in random poses with shuffled vertices. Correspondence error: distance to where the data's own",
           "correspondence puts the point. Seconds are processor seconds of all threads; tangled: inverted cells before repair.\n",
           "| subject | surface, mm | back, mm | error mean | median | 95 % | tangled | inverted | s |", "|" + "---|" * 9]
    for r in subjects:
        out.append(f"| {r['subject'][:-4]} | {r['surface']:.2f} | {r['back']:.2f} | {r['mean']:.2f} | {r['median']:.2f} | "
                   f"{r['p95']:.2f} | {r['tangled']} | {r['inverted']} | {r['seconds']:.1f} |")
    for r in (r for r in rows if "all" in r):
        others = [s["mean"] for s in subjects if not s["subject"].startswith("r_femur_01")]
        out.append(f"\nAll points: median {r['median']:.2f} mm, mean {r['mean']:.2f} mm (without the standard's own subject, "
                   f"mean of means {sum(others) / len(others):.2f} mm); largest subject mean "
                   f"{max(s['mean'] for s in subjects):.2f} mm; largest surface distance {max(s['surface'] for s in subjects):.2f} mm.\n")
    for name, what in (("frames", "the paper's eigen-frames for interior points"), ("icp", "non-rigid ICP for the surface")):
        few = [r for r in read(scratch, name) if "subject" in r]
        if few:
            out.append(f"With {what}, on {', '.join(r['subject'][:-4] for r in few)}: error mean "
                       f"{' / '.join(format(r['mean'], '.2f') for r in few)} mm, surface "
                       f"{' / '.join(format(r['surface'], '.2f') for r in few)} mm, tangled cells "
                       f"{' / '.join(str(r['tangled']) for r in few)}.\n")
    models = [r for r in rows if "model" in r]
    if models:
        out += ["## Leave-one-out projection error and the model's quality\n",
                "Mean distance of points, mm (standard error over subjects); 200 samples for specificity.\n",
                "| modes | registered | known correspondence | ratio | compactness | specificity |", "|" + "---|" * 6]
        known = {r["modes"]: r for r in models if r["model"] == "known"}
        for r in (r for r in models if r["model"] == "registered"):
            k = known[r["modes"]]
            out.append(f"| {r['modes']} | {figure(r, 'generalisation')} | {figure(k, 'generalisation')} | "
                       f"{r['generalisation'] / k['generalisation']:.2f} | {figure(r, 'compactness')} | "
                       f"{figure(r, 'specificity')} |")
    return out


def population_section(scratch):
    rows = read(scratch, "population")
    out = []
    subjects = [r for r in rows if "phantom" in r]
    trained = {r["product"]: r for r in rows if "correlation" in r}
    if trained:
        factors = [r for r in rows if "factor" in r]
        names = list(dict.fromkeys(r["factor"] for r in factors))
        explained = {(r["factor"], r["product"]): f"{r['explained']:.3f}" for r in factors}
        means = {k: sum(r[k] for r in subjects) / len(subjects) for k in ("cells", "surface", "back", "volume", "mass")}
        layer = sum(r["layers"][0] for r in subjects) / len(subjects)
        inner = sum(r["layerVolume"][0] for r in subjects) / len(subjects)
        out += ["\n## A population of known factors\n",
                f"{len(subjects)} phantom hemipelves, three factors of shape and two of density, orthogonal over the subjects. Each is",
                "scanned (1 mm, with the scanner's blur), goes through the whole chain to a layered mesh of its own slices and",
                "cells, to which the standard model (another phantom's, of other cells) is registered by layers; density from the",
                "scan. Share of each factor's variance that the first three modes of shape, or two of density, explain, with",
                "the inner product of densities by coefficients (`--coefficient-product`, as in the paper), by the integral over the volume",
                "(`--within-cell-weight 1`), or by volume with variation within cells counting a quarter",
                "(the default):\n",
                "| factor | " + " | ".join(trained) + " |", "|---" * (1 + len(trained)) + "|"]
        out += ["| " + " | ".join([name] + [explained[name, k] for k in trained]) + " |" for name in names]
        out.append("| largest correlation of these shape and density scores | "
                   + " | ".join(f"{r['correlation']:.3f}" for r in trained.values()) + " |")
        out.append("| mass of the mean model to the scan of the phantom of mean factors, % | "
                   + " | ".join(f"{100 * (r['mass'] - 1):+.2f}" for r in trained.values()) + " |")
        out.append(f"\nMeans over the subjects: {means['cells']:.0f} cells of its own; surface {means['surface']:.3f} mm, back "
                   f"{means['back']:.3f} mm, surface between layers {layer:.3f} mm; volume {100 * (means['volume'] - 1):+.2f} % and "
                   f"mass {100 * (means['mass'] - 1):+.2f} % of the label's voxels, inner layer's volume {100 * (inner - 1):+.2f} % of "
                   "its own mesh's.")
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--scratch", type=pathlib.Path)
    parser.add_argument("--only", choices=["registration", "population", "none"])
    options = parser.parse_args()
    scratch = options.scratch or pathlib.Path(tempfile.mkdtemp())
    scratch.mkdir(exist_ok=True)
    validation = Validation(options.build, scratch)
    if options.only in (None, "registration"):
        validation.registration(os.environ["BONETK_DATA"])
    if options.only in (None, "population"):
        validation.population()
    out = ["# Atlas\n", made_by(__file__) + ".\n"]
    out += registration_section(scratch) + population_section(scratch)
    REPORT.write_text("\n".join(out) + "\n")
    print("\n".join(out))


if __name__ == "__main__":
    main()
