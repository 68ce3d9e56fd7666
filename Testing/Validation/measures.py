#!/usr/bin/env python3
"""How near landmarks and measures come: on 18 femora with known correspondence, on phantoms of known measures, and integrals over
solids beside sums over points.

Takes the femora's models of one topology as deformable.py makes them (or from a folder FEMORA that holds them), and writes
Documentation/validation/measures.md.
Environment: BONETK (the program), BONETK_DATA (folder of data), FEMORA.

    BONETK=build/test/Apps/bonetk/bonetk Testing/Validation/measures.py
"""
import itertools
import json
import math
import os
import pathlib
import sys
import tempfile

import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

from deformable import ROOT, prepare, run
from report import made_by

BONETK = os.environ["BONETK"]
# Seeds on the last femur, whose space is that of the data: x up, y medial, z backward, mm.
SEEDS = {"femoral_head": (200, 32, -5), "femoral_neck": (186, 8, 0), "shaft_proximal": (110, -10, 3), "shaft_distal": (0, -7, -10),
         "medial_condyle": (-198, 28, 38), "lateral_condyle": (-198, -20, 35)}
MEASURES = {"headRadius": "mm", "femoralOffset": "mm", "neckHeight": "mm", "neckDepth": "mm", "neckShaftAngle": "°",
            "anteversion": "°"}


def read_surface(path):
    reader = vtk.vtkPLYReader()
    reader.SetFileName(str(path))
    reader.Update()
    return vtk_to_numpy(reader.GetOutput().GetPoints().GetData()).astype(float)


def write_json(content, path):
    path.write_text(json.dumps({name: [float(x) for x in point] for name, point in content.items()}))
    return path


def measure(folder, *arguments):
    """Values of `bonetk measure`, and the points of its landmarks."""
    run(BONETK, "measure", *arguments, "--quiet", "-o", folder / "M.json")
    report = json.loads((folder / "M.json").read_text())
    return ({entry["name"]: entry for entry in report["measures"]},
            {entry["name"]: numpy.array(entry["value"]) for entry in report["landmarks"]})


def anatomical(points):
    """Vertices that anatomy knows, by rule, in the space of the data."""
    x, y, z = points.T
    head = numpy.linalg.norm(points - SEEDS["femoral_head"], axis=1) < 30
    distal, proximal = x < -180, x > 150

    def farthest(direction, among):
        return int(numpy.argmax(numpy.where(among, points @ numpy.array(direction, float), -numpy.inf)))

    return {"head, crown": farthest((1, 0.3, 0), head), "head, medial": farthest((0, 1, 0), head),
            "head, front": farthest((0, 0, -1), head), "head, near the fovea": farthest((-0.2, 1, 0.3), head),
            "greater trochanter, tip": farthest((1, -0.5, 0.3), proximal & (y < -20)),
            "greater trochanter, lateral": farthest((0, -1, 0), proximal),
            "lesser trochanter, tip": farthest((0, 0.7, 0.7), (x > 120) & (x < 165) & (z > 15)),
            "medial epicondyle": farthest((0, 1, 0), distal), "lateral epicondyle": farthest((0, -1, 0), distal),
            "medial condyle, back": farthest((0, 0, 1), distal & (y > 10)),
            "lateral condyle, back": farthest((0, 0, 1), distal & (y < -5)),
            "medial condyle, distal": farthest((-1, 0, 0), distal & (y > 10)),
            "lateral condyle, distal": farthest((-1, 0, 0), distal & (y < -5)),
            "intercondylar notch": farthest((1, 0, 0), (x < -190) & (numpy.abs(y - 4) < 4) & (z > 5) & (z < 20)),
            "patellar groove, top": farthest((0, 0, -1), distal)}


def landmarks(folder, shapes, registered):
    """Errors of carried vertices, mm: by landmark, and of 1,000 vertices drawn at random."""
    points = {shape.stem: read_surface(shape) for shape in shapes}
    standard = shapes[-1].stem
    known = anatomical(points[standard])
    drawn = numpy.random.default_rng(1).choice(len(points[standard]), 1000, replace=False)
    chosen = {**known, **{f"v{vertex}": int(vertex) for vertex in drawn}}
    file = write_json({name: points[standard][vertex] for name, vertex in chosen.items()}, folder / "L.json")
    errors = {name: [] for name in chosen}
    for shape in shapes[:-1]:
        _, found = measure(folder, registered / f"{shape.stem}.vtu", "--landmarks", file, "--standard",
                           registered / f"{standard}.vtu")
        for name, vertex in chosen.items():
            errors[name].append(numpy.linalg.norm(found[name] - points[shape.stem][vertex]))
    table = "".join(f"| {name} | {numpy.median(errors[name]):.2f} | {numpy.mean(errors[name]):.2f} | {max(errors[name]):.2f} |\n"
                    for name in known)
    for title, names in ((f"all {len(known)}", known), ("1,000 vertices at random", [f"v{vertex}" for vertex in drawn])):
        every = numpy.concatenate([errors[name] for name in names])
        table += f"| **{title}** | {numpy.median(every):.2f} | {numpy.mean(every):.2f} | {every.max():.2f} |\n"
    return table


def own_seeds(standard, points):
    """The seeds on another shape by the data's own correspondence: affine in the 1,500 vertices around each."""
    result = {}
    for name, seed in SEEDS.items():
        near = numpy.argsort(numpy.linalg.norm(standard - seed, axis=1))[:1500]
        plane = numpy.column_stack([standard[near], numpy.ones(len(near))])
        result[name] = numpy.append(seed, 1) @ numpy.linalg.lstsq(plane, points[near], rcond=None)[0]
    return result


def femora(folder, shapes, registered):
    """Measures on the registered models beside those on the given surfaces, whose landmarks are their own; and how far measures
    move with landmarks."""
    standard = read_surface(shapes[-1])
    write_json(SEEDS, folder / "standard.json")
    random = numpy.random.default_rng(3)
    differences, moved, centres = {name: [] for name in MEASURES}, {name: [] for name in MEASURES}, []
    for shape in shapes:
        seeds = own_seeds(standard, read_surface(shape))
        given, _ = measure(folder, shape, "--landmarks", write_json(seeds, folder / "own.json"))
        model, _ = measure(folder, registered / f"{shape.stem}.vtu", "--landmarks", folder / "standard.json", "--standard",
                           registered / f"{shapes[-1].stem}.vtu")
        shaken = {name: point + random.uniform(-5, 5, 3) for name, point in seeds.items()}
        again, _ = measure(folder, shape, "--landmarks", write_json(shaken, folder / "shaken.json"))
        centres.append(numpy.linalg.norm(numpy.subtract(given["headCentre"]["value"], model["headCentre"]["value"])))
        for name in MEASURES:
            differences[name].append(model[name]["value"] - given[name]["value"])
            moved[name].append(abs(again[name]["value"] - given[name]["value"]))
    table = f"| headCentre | mm | {numpy.mean(centres):.2f} | | {max(centres):.2f} | |\n"
    for name, unit in MEASURES.items():
        d = numpy.array(differences[name])
        table += (f"| {name} | {unit} | {numpy.abs(d).mean():.2f} | {d.mean():+.2f} | {numpy.abs(d).max():.2f} | "
                  f"{numpy.mean(moved[name]):.2f} |\n")
    return table


class Phantom:
    """A right femur in LPS of two condyles, a straight shaft, a waisted neck and a head, whose measures are known."""

    def __init__(self, radius, neck_shaft_angle, anteversion, length=52.0, waist=13.5):
        self.radius, self.angle, self.anteversion, self.waist = radius, neck_shaft_angle, anteversion, waist
        lean, turn = math.radians(180 - neck_shaft_angle), math.radians(anteversion)
        self.axis = numpy.array([math.sin(lean) * math.cos(turn), -math.sin(lean) * math.sin(turn), math.cos(lean)])
        self.centre, self.length = length * self.axis, length
        self.known = {"headRadius": radius, "neckShaftAngle": neck_shaft_angle, "anteversion": anteversion,
                      "femoralOffset": math.hypot(*self.centre[:2]), "neckHeight": 2 * waist, "neckDepth": 2 * waist}
        self.seeds = {"femoral_head": self.centre + (3, -2, 3), "femoral_neck": 0.5 * self.centre + (-2, 2, 1),
                      "shaft_proximal": (8, 3, -60), "shaft_distal": (-4, 9, -200), "medial_condyle": (25, 18, -345),
                      "lateral_condyle": (-16, 17, -356)}

    def level(self, x):
        def ball(centre, radius):
            return numpy.linalg.norm(x - centre, axis=-1) - radius

        along = x @ self.axis
        across = numpy.linalg.norm(x - along[..., None] * self.axis, axis=-1)
        neck = numpy.maximum(across - self.waist - 0.008 * (along - self.length + 30) ** 2,
                             numpy.maximum(along - self.length, -along))
        shaft = ball(numpy.stack([0 * x[..., 0], 0 * x[..., 0], x[..., 2].clip(-350, 0)], axis=-1), 14.3)
        return numpy.minimum.reduce([ball(self.centre, self.radius), neck, shaft, ball((21, 0, -350), 20.2),
                                     ball((-21, 0, -350), 20.2)])

    def write(self, path, step=1.0):
        lower, size = numpy.array([-44.0, -48.0, -374.0]), (122, 92, 454)
        grid = lower + step * numpy.stack(numpy.meshgrid(*[numpy.arange(n) for n in size], indexing="ij"), axis=-1)
        image = vtk.vtkImageData()
        image.SetDimensions(*size)
        image.SetOrigin(*lower)
        image.SetSpacing(step, step, step)
        image.GetPointData().SetScalars(numpy_to_vtk(self.level(grid).ravel(order="F").astype(float), deep=True))
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


def phantoms(folder):
    """Errors against known measures, of the surface itself and of a model built of its CT of 1 mm."""
    rows = ""
    for number, phantom in enumerate((Phantom(23, 127, 15), Phantom(25, 119, 28, 56, 15), Phantom(21, 138, -6, 50, 12.5)), 1):
        surface, ct, labels = folder / f"p{number}.ply", folder / f"p{number}.mha", folder / f"p{number}_l.nii.gz"
        phantom.write(surface)
        run(BONETK, "phantom", "--surface", surface, "-o", ct, "--labels", labels, "--quiet")
        run(BONETK, "build", ct, "--labels", labels, "--tetrahedra", 20000, "--degree", 2, "--quiet", "-o", folder / f"p{number}")
        seeds = write_json(phantom.seeds, folder / "p.json")
        for title, model in (("surface", surface), ("model", folder / f"p{number}/model_L1.vtu")):
            found, _ = measure(folder, model, "--landmarks", seeds)
            errors = [f"{found[name]['value'] - known:+.2f}" for name, known in phantom.known.items()]
            centre = numpy.linalg.norm(numpy.array(found["headCentre"]["value"]) - phantom.centre)
            rows += f"| {number}, {title} | {' | '.join(errors)} | {centre:.2f} |\n"
    return rows, list(phantom.known)


def own_phantoms(folder):
    """Errors on models of the phantoms that `bonetk phantom` makes: of the head's sphere, and of the acetabulum."""
    lean, turn = math.radians(180 - 126), math.radians(12)
    head = 50 * numpy.array([math.sin(lean) * math.cos(turn), -math.sin(lean) * math.sin(turn), math.cos(lean)])
    cases = {"femur": ({"femoral_head": head + (3, -2, 2), "femoral_neck": 0.4 * head}, head, "headCentre", {"headRadius": 23.5}),
             # The landmarks lie at one y, so that the anterior pelvic plane is that of the phantom's angles.
             "hemipelvis": ({"acetabulum": (3, -2, 2), "asis": (-24, -40, 66), "pubic_tubercle": (74, -40, -33)}, numpy.zeros(3),
                            "acetabularCentre", {"acetabularRadius": 26, "radiographicInclination": 45, "radiographicAnteversion": 18})}
    rows = ""
    for bone, (seeds, centre, name, known) in cases.items():
        ct, labels = folder / f"{bone}.mha", folder / f"{bone}_l.nii.gz"
        run(BONETK, "phantom", "--bone", bone, "-o", ct, "--labels", labels, "--quiet")
        run(BONETK, "build", ct, "--labels", labels, "--degree", 2, "--quiet", "-o", folder / bone)
        found, _ = measure(folder, folder / bone / "model_L1.vtu", "--landmarks", write_json(seeds, folder / "b.json"))
        rows += f"| {bone} | {name} | {numpy.linalg.norm(numpy.array(found[name]['value']) - centre):.2f} |\n"
        rows += "".join(f"| {bone} | {what} | {found[what]['value'] - value:+.2f} |\n" for what, value in known.items())
    return rows


def read_model(path):
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()
    cells = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 4)
    points = vtk_to_numpy(grid.GetPoints().GetData())
    return points, cells, vtk_to_numpy(grid.GetCellData().GetArray("DensityCoefficients"))


def equal_parts(levels):
    """Barycentric coordinates of the middles of 8^levels tetrahedra of one volume that a tetrahedron is cut into."""
    parts = numpy.eye(4)[None]
    for _ in range(levels):
        a, b, c, d = (parts[:, i] for i in range(4))
        ab, ac, ad, bc, bd, cd = ((x + y) / 2 for x, y in ((a, b), (a, c), (a, d), (b, c), (b, d), (c, d)))
        parts = numpy.concatenate([numpy.stack(corners, axis=1) for corners in (
            (a, ab, ac, ad), (b, ab, bc, bd), (c, ac, bc, cd), (d, ad, bd, cd),
            (ab, cd, ac, ad), (ab, cd, ad, bd), (ab, cd, bd, bc), (ab, cd, bc, ac))])
    return parts.mean(axis=1)


def count(model, distance, radius):
    """Volume and mass where distance(x), which grows no faster than x moves, is at most `radius`, by 262,144 points in each
    tetrahedron that comes so near; degree 2."""
    points, cells, coefficients = model
    exponents = sorted((e for e in itertools.product(range(3), repeat=4) if sum(e) == 2), reverse=True)
    mu = equal_parts(6)
    basis = numpy.stack([2 / math.prod(math.factorial(k) for k in e) * numpy.prod(mu ** numpy.array(e), axis=1) for e in exponents],
                        axis=1)
    volume = mass = 0.0
    for cell, c in zip(cells, coefficients):
        corners = points[cell]
        centre = corners.mean(axis=0)
        if distance(centre[None])[0] - numpy.linalg.norm(corners - centre, axis=1).max() <= radius:
            size = numpy.linalg.det(corners[1:] - corners[0]) / 6 / len(mu)
            held = distance(mu @ corners) <= radius
            volume += size * held.sum()
            mass += size * (basis[held] @ c).sum()
    return volume, mass


def distance_to(a, b, x):
    a, b = numpy.array(a, float), numpy.array(b, float)
    length = max((b - a) @ (b - a), 1e-30)
    t = (((x - a) @ (b - a)) / length).clip(0, 1)
    return numpy.linalg.norm(x - a - t[..., None] * (b - a), axis=-1)


def integrals(folder, registered, subject):
    """The two sides of planes, and round solids beside sums over points."""
    path = registered / f"{subject}.vtu"
    model = read_model(path)
    random = numpy.random.default_rng(5)
    worst = 0.0
    for _ in range(20):
        point, normal = random.uniform((-200, -20, -20), (200, 20, 20)), random.normal(size=3)
        found, _ = measure(folder, path, "--half-space", *point, *normal, "--half-space", *point, *-normal)
        for what in ("volume", "mass", "region1.volume", "region1.mass", "region2.mass"):
            sides = [found[f"halfSpace{side}.{what}"]["value"] for side in (1, 2)]
            worst = max(worst, abs(sum(sides) / found[f"model.{what}"]["value"] - 1))
    rows = ""
    solids = (("ball in the head", "ball", (201, 31, -3), (201, 31, -3), 12), ("ball across the surface", "ball", (201, 50, -3), (201, 50, -3), 12),
              ("capsule along the neck", "capsule", (150, -35, 5), (201, 31, -3), 4), ("capsule across the shaft", "capsule", (0, -40, -10), (0, 30, -10), 6))
    for title, kind, a, b, radius in solids:
        numbers = (*a, radius) if kind == "ball" else (*a, *b, radius)
        found, _ = measure(folder, path, f"--{kind}", *numbers)
        volume, mass = count(model, lambda x: distance_to(a, b, x), radius)
        entries = [found[f"{kind}1.{what}"] for what in ("volume", "mass")]
        cells = [f"{abs(entry['value'] / other - 1):.1e} | {entry['errorBound'] / entry['value']:.1e}"
                 for entry, other in zip(entries, (volume, mass))]
        rows += f"| {title} | {' | '.join(cells)} |\n"
    return worst, rows


def main():
    data = pathlib.Path(os.environ["BONETK_DATA"]) / "femur_shapes"
    shapes = sorted(data.glob("*.ply"))
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        registered = prepare(pathlib.Path(os.environ.get("FEMORA") or tempfile.mkdtemp()), shapes)
        carried = landmarks(folder, shapes, registered)
        print(carried, flush=True)
        beside = femora(folder, shapes, registered)
        print(beside, flush=True)
        worst, round_solids = integrals(folder, registered, shapes[-1].stem)
        print(worst, round_solids, flush=True)
        known, columns = phantoms(folder)
        print(known, flush=True)
        built = own_phantoms(folder)
        print(built, flush=True)
    text = f"""# Landmarks and measures

{made_by(__file__)}.

{len(shapes)} femora, surfaces of real bones with one triangulation (vertex k of one is vertex k of all), and models of them on one topology of
some 9,000 tetrahedra, registered to CTs that were simulated from the surfaces (`bonetk train --registered`).

## Landmarks carried by topology

A vertex of the last femur's surface is a landmark. `bonetk measure --standard` places it on that femur's model and carries it to the
others, where it is compared with the same vertex of their own surfaces: mm, over {len(shapes) - 1} femora.

| landmark | median | mean | largest |
|---|---|---|---|
{carried}
The registration decides this, and so does what a vertex of the data is: its correspondence is itself that of a registration.

## Measures of the models beside those of the surfaces

Landmarks of the models are carried from the last femur, those of the surfaces are their own by the data's correspondence. Mean and
largest absolute difference, mean difference (model less surface); last, how far a surface's measure moves, in the mean, where each landmark
is moved by up to 5 mm along each axis.

| measure | unit | mean | bias | largest | landmarks moved |
|---|---|---|---|---|---|
{beside}
## Phantoms of known measures

A head, a waisted neck, a straight shaft and two condyles, of which every measure is known; of the surface itself (triangles of 1 mm), and of
a model of 20,000 tetrahedra that `bonetk build` makes of its CT of 1 mm. Errors, mm and degrees.

| phantom | {' | '.join(columns)} | headCentre |
|---|{'---|' * (len(columns) + 1)}
{known}
Models of the mean femur and hemipelvis that `bonetk phantom` makes, by `bonetk build` as it is: errors, mm and degrees. What these know of
their measures is the head's sphere, and the acetabulum's sphere and angles.

| phantom | measure | error |
|---|---|---|
{built}
## Integrals over solids

Of one femur's model, degree 2. The two sides of 20 planes add up to the whole, volumes and masses of regions and of all, to {worst:.0e} of
it. Round solids beside the sum over 262,144 points in each tetrahedron around (which itself is good to about 1e-4), and the bound of the
error that `measure` states, both relative:

| solid | volume | its bound | mass | its bound |
|---|---|---|---|---|
{round_solids}"""
    (ROOT / "Documentation/validation/measures.md").write_text(text)


if __name__ == "__main__":
    sys.exit(main())
