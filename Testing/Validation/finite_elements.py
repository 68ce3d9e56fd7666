#!/usr/bin/env python3
"""How stiff bones are by level and kind of element, by bins and nodal moduli; and whether exported files are read by other programs.

Builds ten bones (or takes them from the folder MODELS, one folder a bone), exports them with `bonetk export`, solves with
CalculiX (ccx), reads with meshio and gmsh, and writes Documentation/validation/finite_elements.md and finite_elements_strain.png.
Needs matplotlib. Environment: BONETK (the program), BONETK_DATA (folder of data), MODELS.

    BONETK=build/test/Apps/bonetk/bonetk Testing/Validation/finite_elements.py
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import meshio
import numpy

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "Testing" / "Integration"))
os.environ.setdefault("BONETK", "")
import calculix  # noqa: E402
from simplification import bones  # noqa: E402
from report import made_by

BONETK = os.environ["BONETK"]
PAGES = ROOT / "Documentation" / "validation"
LAW = ("--law", "keyak1998", "--line", "0.02", "0.0008")
# Faces of a ten-node element by the corner opposite, corners and then nodes on the edges; of Abaqus' numbers S1 to S4.
FACES = [(0, 1, 2, 4, 5, 6), (0, 3, 1, 7, 8, 4), (1, 3, 2, 8, 9, 5), (2, 3, 0, 9, 7, 6)]
REACH = 20.0  # mm


def run(*command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{command}: {done.stdout}{done.stderr}")
    return done.stdout


def table(head, rows):
    lines = ["| " + " | ".join(map(str, row)) + " |" for row in [head, ["---"] * len(head), *rows]]
    return "\n".join(lines) + "\n"


def build(bone, folder):
    """The folder of a bone's model."""
    model = folder / bone.name.replace(" ", "_")
    if not (model / "model.hierarchy.json").exists():
        if bone.phantom:
            bone.ct, bone.labels = folder / "ct.nii.gz", folder / "labels.nii.gz"
            run(BONETK, "phantom", *bone.phantom, "--spacing", 1, "-o", bone.ct, "--labels", bone.labels, "-q")
        run(BONETK, "build", bone.ct, "--labels", bone.labels, *bone.options(), "--axis", bone.axis, "-o", model, "-q")
    return model / "model.hierarchy.json"


def export(model, level, output, *options, file_format="calculix"):
    start = time.monotonic()
    run(BONETK, "export", model, "--level", level, "--format", file_format, *LAW, *options, "-o", output, "-q")
    return time.monotonic() - start


class Load:
    """1 N downward, spread over the surface around the highest point of the first level: the closer to it the more. The force
    in each node is the integral of the traction with its shape function, so that it is the same load on every mesh."""

    def __init__(self, points):
        self.top = points[points[:, 2].argmax()]

    @classmethod
    def on_first_level(cls, model, folder):
        export(model, 1, folder / "m.inp")
        return cls(meshio.read(folder / "m.inp").points)

    def forces(self, points, elements, exterior):
        """Force of each node along -z."""
        # Seven points of degree 5 (Radon) with the six shape functions of a triangle.
        a, b = (6 - 15 ** 0.5) / 21, (6 + 15 ** 0.5) / 21
        places = [(1 / 3, 1 / 3, 1 / 3, 9 / 40)] + [(*numpy.roll((1 - 2 * c, c, c), i), w) for c, w in
                                                    ((a, (155 - 15 ** 0.5) / 1200), (b, (155 + 15 ** 0.5) / 1200))
                                                    for i in range(3)]
        quadratic = elements.shape[1] == 10
        force = numpy.zeros(len(points))
        for number, nodes in enumerate(FACES):
            faces = elements[exterior[exterior[:, 1] == number, 0]][:, list(nodes if quadratic else nodes[:3])]
            x = points[faces[:, :3]]
            area = 0.5 * numpy.linalg.norm(numpy.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]), axis=1)
            for u, v, w, weight in places:
                at = u * x[:, 0] + v * x[:, 1] + w * x[:, 2]
                near = numpy.clip(1 - ((at - self.top) ** 2).sum(axis=1) / REACH ** 2, 0, None) ** 2
                shape = ((u * (2 * u - 1), v * (2 * v - 1), w * (2 * w - 1), 4 * u * v, 4 * v * w, 4 * w * u)
                         if quadratic else (u, v, w))
                for i, share in enumerate(shape):
                    numpy.add.at(force, faces[:, i], weight * share * area * near)
        return force / force.sum()


def read_exterior(path):
    """Pairs of element and face, from 0."""
    pairs, inside = [], False
    with open(path) as file:
        for line in file:
            if line.startswith("*"):
                inside = line.startswith("*SURFACE")
            elif inside:
                element, face = line.split(",")
                pairs.append((int(element) - 1, int(face.strip()[1]) - 1))
    return numpy.array(pairs)


class Solution:
    """The mean displacement under the load (its work, mm/N), and the displacements."""

    def __init__(self, mesh, load):
        solid = meshio.read(mesh)
        self.points, self.elements = solid.points, solid.cells[0].data
        self.force = load.forces(self.points, self.elements, read_exterior(mesh))
        loads = "\n".join(f"{n + 1}, 3, {-self.force[n]:.9g}" for n in numpy.flatnonzero(self.force))
        start = time.monotonic()
        tables = calculix.solve(mesh.name, f"*BOUNDARY\nEND_LOW_Z, 1, 3\n*CLOAD\n{loads}\n*NODE PRINT, NSET=NODES\nU\n"
                                "*NODE PRINT, NSET=END_LOW_Z, TOTALS=ONLY\nRF", mesh.parent)
        self.seconds = time.monotonic() - start
        self.moved = tables["displacements NODES"][:, 1:]
        self.compliance = float(-(self.moved[:, 2] * self.force).sum())
        reaction = tables["total force END_LOW_Z"][0][2]
        assert abs(reaction - 1.0) < 1e-4, reaction


def improved(model, folder):
    """The same bone, its coarse levels with improved angles."""
    run(BONETK, "simplify", model.parent / "model_L1.vtu", "--improve-angles", "-o", folder / "improved", "-q")
    return folder / "improved.hierarchy.json"


def levels_part(models, folder):
    rows = []
    for name, model in models.items():
        load, reference, better = Load.on_first_level(model, folder), None, improved(model, folder)
        for level, hierarchy, order in [(1, model, 2), (1, model, 1), (2, better, 2), (2, better, 1), (2, model, 2), (3, better, 2),
                                        (3, better, 1), (3, model, 2)]:
            export(hierarchy, level, folder / "m.inp", "--order", order)
            found = Solution(folder / "m.inp", load)
            reference = reference or found
            excess = 100 * (reference.compliance / found.compliance - 1)
            kind = ("C3D10" if order == 2 else "C3D4") + (", angles as they are" if level > 1 and hierarchy is model else "")
            rows.append([name, level, kind, len(found.elements), 3 * len(found.points), f"{1 / found.compliance:.1f}",
                         f"{excess:+.1f}", f"{found.seconds:.1f}"])
            print(*rows[-1], flush=True)
    return table(["bone", "level", "elements", "number", "unknowns", "stiffness, N/mm", "to level 1's C3D10, %", "s"], rows)


def bins_part(model, folder):
    load, rows = Load.on_first_level(model, folder), []
    runs = [(n, ("--bins", n)) for n in (2000, 200, 100, 50, 25, 10)] + [("by node", ("--modulus", "nodes"))]
    reference = None
    for name, options in runs:
        export(model, 2, folder / "m.inp", *options)
        found = Solution(folder / "m.inp", load)
        reference = reference or found
        largest = numpy.linalg.norm(found.moved - reference.moved, axis=1).max() / numpy.linalg.norm(reference.moved, axis=1).max()
        rows.append([name, f"{1 / found.compliance:.2f}", f"{100 * (reference.compliance / found.compliance - 1):+.3f}",
                     f"{100 * largest:.3f}"])
        print(*rows[-1], flush=True)
    return table(["bins", "stiffness, N/mm", "to 2,000 bins, %", "largest difference of a displacement, % of the largest"], rows)


def files_part(models, folder):
    rows = []
    for name, model in models.items():
        row = [name]
        for file_format, path in (("calculix", "f.inp"), ("febio", "f.feb"), ("gmsh", "f.msh")):
            row.append(f"{export(model, 1, folder / path, file_format=file_format):.2f}")
        inp, msh = meshio.read(folder / "f.inp"), meshio.read(folder / "f.msh")
        count = len(inp.cells[0].data)
        assert sum(len(b.data) for b in msh.cells if b.type == "tetra10") == count
        assert {"BOUNDARY", "END_LOW_Z"} <= set(inp.point_sets) and {"REGION_1", "MAT_1"} <= set(inp.cell_sets)
        assert {"BOUNDARY", "END_LOW_Z", "REGION_1", "MAT_1"} <= set(msh.cell_sets)
        assert "Error" not in run("gmsh", folder / "f.msh", "-o", folder / "g.msh", "-format", "msh41", "-save")
        assert (folder / "f.feb").read_text().count("<elem ") == count
        export(model, 3, folder / "m.inp")
        Solution(folder / "m.inp", Load(meshio.read(folder / "m.inp").points))
        rows.append([row[0], count, *row[1:]])
        print(*rows[-1], flush=True)
    return table(["bone", "elements", "`.inp`, s", "`.feb`, s", "`.msh`, s"], rows)


def strain_picture(model, folder):
    """The most compressive principal strain in the elements that the middle plane meets, by level."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    load = Load.on_first_level(model, folder)
    figure, axes = plt.subplots(1, 3, figsize=(10, 7), sharey=True)
    for level, axis in zip((1, 2, 3), axes):
        export(model, level, folder / "m.inp")
        found = Solution(folder / "m.inp", load)
        corners = found.points[found.elements[:, :4]]
        edges = (corners[:, 1:] - corners[:, :1]).transpose(0, 2, 1)
        # Mean strain of an element: its gradient at the centroid, from the ten nodes there.
        shape = numpy.zeros((10, 4))
        for i in range(4):
            shape[i, i] = 4 * 0.25 - 1
        for n, (a, b) in enumerate([(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]):
            shape[4 + n, a] = shape[4 + n, b] = 4 * 0.25
        by_barycentric = numpy.einsum("eni,nk->eik", found.moved[found.elements], shape)
        slope = (by_barycentric[:, :, 1:] - by_barycentric[:, :, :1]) @ numpy.linalg.inv(edges)
        strain = 0.5 * (slope + slope.transpose(0, 2, 1))
        least = numpy.linalg.eigvalsh(strain)[:, 0]
        centre = corners.mean(axis=1)
        middle = numpy.median(centre[:, 1])
        cut = (corners[:, :, 1].min(axis=1) < middle) & (corners[:, :, 1].max(axis=1) > middle)
        dots = axis.scatter(centre[cut, 0], centre[cut, 2], c=-1e6 * 1000 * least[cut], s=14, cmap="viridis", vmin=0, vmax=3000)
        axis.set_title(f"level {level}\n{len(found.elements):,} elements")
        axis.set_aspect("equal")
        axis.set_xlabel("x, mm (left to the right)")
    axes[0].set_ylabel("z, mm (upward)")
    figure.colorbar(dots, ax=axes, label="largest compression at 1000 N, microstrain", shrink=0.7)
    figure.savefig(PAGES / "finite_elements_strain.png", dpi=110)


def main():
    data = os.environ.get("BONETK_DATA")
    chosen = {bone.name: bone for bone in bones(data)[:10]}
    with tempfile.TemporaryDirectory() as made:
        folder = pathlib.Path(made)
        kept = pathlib.Path(os.environ.get("MODELS", made))
        models = {name: build(bone, kept) for name, bone in chosen.items()}
        femur = models["phantom femur 0"]
        some = {name: models[name] for name in ("phantom femur 0", "clinical femur", "tibia") if name in models}
        parts = {"levels": levels_part(some, folder), "bins": bins_part(femur, folder), "files": files_part(models, folder)}
        strain_picture(femur, folder)
    (PAGES / "finite_elements.md").write_text(PAGE.format(made_by=made_by(__file__), **parts))


PAGE = """# Finite elements

{made_by}. Models are those of `bonetk build`, exported by
`bonetk export --law keyak1998 --line 0.02 0.0008` (an example of a calibration, not that of these scanners) and solved by
CalculiX (SPOOLES). Closed forms (bar, bar of changing modulus, cantilever, ball under pressure) are in
`Testing/Integration/export_test.py`.

## Levels and kinds of element

Levels 2 and 3 are those of `simplify --improve-angles`, and beside them those without it. Held at the nodes of `END_LOW_Z`; 1 N
downward, spread over 20 mm around the highest point of the surface, as one integral of the traction for all meshes. Stiffness:
force by mean displacement under it. C3D10 have ten nodes, C3D4 four. Seconds: clock.

{levels}
## Bins and nodes

Level 2 of phantom femur 0, C3D10: what binning costs, beside moduli interpolated between nodes.

{bins}
## Strain

The most compressive principal strain in the elements that the plane through the middle meets, a dot at each one's centroid, of
phantom femur 0 by level.

![Compression by level](finite_elements_strain.png)

## Files

Seconds to read the model and write level 1, whole command. Every `.inp` and `.msh` was read by meshio with its sets, every `.msh`
by gmsh, and level 3 of every bone was solved by CalculiX. That `.feb` files have the documented form is tested in
`export_test.py`; FEBio itself was not run.

{files}"""


if __name__ == "__main__":
    main()
