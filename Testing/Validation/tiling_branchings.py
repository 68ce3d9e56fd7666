#!/usr/bin/python3
"""Contour branching by composites, splitting and filling (paper 2.6) on whole bones.

    BONETK_DATA=... Testing/Validation/tiling_branchings.py BUILD_FOLDER --check PROGRAM [--only TEXT] [--sample N]

tiles the bones of tiling.py, points 4 mm apart, in the three ways and writes Documentation/validation/tiling_branchings.md.
--check names an independent checker, called as PROGRAM MESH.vtu --label LABELS --label-value V --json OUT, which exits 0 for
a valid mesh. --only takes the bones whose name has TEXT in it, --sample every Nth one; both print and write no report.
About an hour on two cores."""

import argparse
import collections
import concurrent.futures
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import tiling
from report import made_by

HERE = pathlib.Path(__file__).resolve()
REPORT = HERE.parents[2] / "Documentation" / "validation" / "tiling_branchings.md"
KINDS = ("composite", "splitting", "filling")
INTRODUCTION = """# Tiling: contour branching

{made_by}. Contours from label maps, points {spacing} mm apart, tiled without CT in the three ways of `bonetk mesh
--branching`; no smoothing.

- Branchings: groups of several pieces on one slice against one or more on the next. Knitted: by bridges or with the parts of
  the one piece. Filled: in filled slabs; of these split: with the surfaces drawn down to where the one piece is split.
- Against the label: Dice overlap, volume, largest distance (mm) from the mesh's surface to the label's and back.
- Other slabs: those whose components and handles are not the stack's ([tiling](tiling.md)). Valid: by an independent
  checker, inner layers included. Seconds are of one core. Rows of sets are sums, with the longest time.

| bone, slice step | branching | branchings | knitted | filled | of these split | tetrahedra | Dice | volume, % | largest distances | other slabs | valid | s |
|---|---|---|---|---|---|---|---|---|---|---|---|---|"""


class Branchings(tiling.Validation):
    def rows(self, case):
        name, source, label, step, axis, spacing = case
        with tempfile.TemporaryDirectory() as folder:
            contours = f"{folder}/c.vtp"
            ct, labels = self.inputs(source)
            of_label = [] if label is None else ["--label", label]
            self.run([self.bonetk, "contours", ct, "--labels", labels, *of_label, "--slice-step", step, "--regular-slices",
                      "--axis", axis, "--contour-spacing", spacing, "--quiet", "--threads", 1, "-o", contours])
            checked = {}
            return name, [self.row(contours, kind, labels if label else None, label, folder, checked) for kind in KINDS]

    def row(self, contours, kind, labels, label, folder, checked):
        """`checked`: what was found of the bone's other meshes, most of which are the same."""
        mesh = f"{folder}/{kind}.vtu"
        out = self.run([self.program, contours, mesh, "--branching", kind]).stdout
        row = {key: float(value) for key, value in (line.split() for line in out.splitlines()) if "/" not in value}
        content = pathlib.Path(mesh).read_bytes()
        if content not in checked:
            checked[content] = self.found(mesh, labels, label, folder)
        row.update(checked[content])
        row["differing"] = sum(row[f"differing_slabs_{region}"] for region in (1, 2, 3))
        return row

    def found(self, mesh, labels, label, folder):
        report = f"{folder}/check.json"
        of_label = ["--label", labels, "--label-value", str(label)] if labels else []
        done = subprocess.run(["/usr/bin/python3", self.check, mesh, *of_label, "--json", report], capture_output=True)
        found = json.loads(pathlib.Path(report).read_text())["info"]
        bad = sum(r["bad_edges"] + r["pinched_vertices"] for r in found.get("regions_inward", {}).values())
        row = {"valid": done.returncode == 0 and bad == 0}
        if labels:
            row["label"] = (f"{found['label_dice']:.4f} | {found['volume_error_pct']:+.2f} | "
                            f"{found['mesh_to_label_mm']['max']:.2f}, {found['label_to_mesh_mm']['max']:.2f}")
        return row


def line(name, kind, row):
    knitted = row["branchings"] - row["filled_branchings"]
    return (f"| {name} | {kind} | {row['branchings']:.0f} | {knitted:.0f} | {row['filled_branchings']:.0f} | "
            f"{row['split_fillings']:.0f} | {row['tetrahedra']:,.0f} | {row.get('label', ' | | ')} | {row['differing']:.0f} | "
            f"{'yes' if row['valid'] else 'NO'} | {row['seconds']:.1f} |")


def lines(results):
    """Real bones one by one, the rest by sets."""
    sets, out = collections.defaultdict(list), []
    for name, rows in results:
        kind = re.match(r"(femur shape|phantom \w+)", name)
        if kind:
            sets[kind.group(1) + re.sub(r"^[^,]*", "", name)].append(rows)
        else:
            out += [line(name, k, row) for k, row in zip(KINDS, rows)]
    for name, members in sets.items():
        for k, kind in enumerate(KINDS):
            rows = [rows[k] for rows in members]
            total = {key: sum(row[key] for row in rows)
                     for key in ("branchings", "filled_branchings", "split_fillings", "tetrahedra", "differing")}
            out.append(line(f"{name}: {len(rows)}", kind, {**total, "valid": all(row["valid"] for row in rows),
                                                            "seconds": max(row["seconds"] for row in rows)}))
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--check", required=True)
    parser.add_argument("--only", default="")
    parser.add_argument("--sample", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    spacing = tiling.SPACINGS[0]
    chosen = [c for c in tiling.cases(os.environ.get("BONETK_DATA")) if c[5] == spacing and options.only in c[0]]
    branchings, results = Branchings(options.build, options.check), []
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for name, rows in pool.map(branchings.rows, chosen[::options.sample]):
            results.append((name, rows))
            print("\n".join(line(name, kind, row) for kind, row in zip(KINDS, rows)), flush=True)
    valid = all(row["valid"] for _, rows in results for row in rows)
    differing = sum(row["differing"] for _, rows in results for row in rows)
    out = [INTRODUCTION.format(made_by=made_by(__file__), spacing=spacing), *lines(results)]
    out.append(f"\n{len(results)} bones, {'all' if valid else 'NOT all'} meshes valid; {differing:.0f} slabs of other topology than the stack's.")
    print(out[-1].strip())
    if options.only == "" and options.sample == 1:
        REPORT.write_text("\n".join(out) + "\n")
    sys.exit(0 if valid else 1)


if __name__ == "__main__":
    main()
