#!/usr/bin/env python3
"""`bonetk export`: files that solvers and readers take, solutions that are known, and what is refused."""
import itertools
import math
import os
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree

import numpy

import calculix
from bonetk_testing import EXAMPLES, TestCase, bonetk, main, run, write_json

try:
    import meshio
except ImportError:
    meshio = None

KELLER = ("--law", "keller1994")
EDGES = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]


def modulus(ash):
    """Keller's law, MPa."""
    return 10500 * ash ** 2.29


@unittest.skipUnless(calculix.find_solver(), "CalculiX is not installed")
class Solutions(TestCase):
    """Closed forms. Bodies have an ash density of 0.5 g/cm^3 unless told."""
    MODULUS = modulus(0.5)

    def make_bar(self, length=40.0, side=4.0, cells=(14, 2, 2), ash=lambda x: numpy.full(len(x), 0.5)):
        calculix.write_model("bar.vtu", *calculix.box_mesh(cells, (length, side, side)), ash)
        write_json({"A": [0, 0, 0], "B": [0, side, 0]}, "marks.json")

    def export(self, *options, model="bar.vtu"):
        self.succeed("export", model, "--format", "calculix", *KELLER, "-o", "mesh.inp", "--landmarks", "marks.json", *options)

    def pull(self, stretch):
        """Force that stretches the bar, free to become thinner. No node but those of its ends lies within 3 % of them."""
        tables = calculix.solve("mesh.inp", f"""*BOUNDARY
END_LOW_X, 1, 1
LM_A, 2, 3
LM_B, 3, 3
END_HIGH_X, 1, 1, {stretch}
*NODE PRINT, NSET=END_HIGH_X, TOTALS=ONLY
RF""")
        return tables["total force END_HIGH_X"][0][0]

    def test_bar_in_tension(self):
        self.make_bar()
        for options in ((), ("--order", 1), ("--modulus", "nodes")):
            self.export(*options)
            force = self.MODULUS * 16.0 * 0.1 / 40.0
            self.assertAlmostEqual(self.pull(0.1) / force, 1.0, delta=1e-4, msg=options)

    def test_bar_whose_modulus_changes_along_it(self):
        self.make_bar(ash=lambda x: 0.3 + 0.6 * x[:, 0] / 40.0)
        compliance = numpy.mean(1.0 / modulus(0.3 + 0.6 * (numpy.arange(100000) + 0.5) / 100000))
        force = 16.0 * 0.1 / 40.0 / compliance
        error = {}
        for name, options in (("bins", ("--bins", 200)), ("few", ("--bins", 3)), ("nodes", ("--modulus", "nodes"))):
            self.export("--poisson", 0, *options)
            error[name] = abs(self.pull(0.1) / force - 1.0)
        self.assertLess(error["bins"], 0.005)
        self.assertLess(error["nodes"], 0.005)
        self.assertGreater(error["few"], 2 * error["bins"])

    def bend(self):
        """Deflection of the free end under a force of 1 N across the bar. The other end is held such that it may become
        thinner, as beam theory has it; held altogether it would be 1 % stiffer."""
        held = "".join(f"LM_{name}, 2, 2\n" for name in "PQRST")
        tables = calculix.solve("mesh.inp", f"*BOUNDARY\nEND_LOW_X, 1, 1\n{held}LM_R, 3, 3\nEND_HIGH_X, 2, 2, 1.0\n"
                                "*NODE PRINT, NSET=END_LOW_X, TOTALS=ONLY\nRF")
        return 1.0 / -tables["total force END_LOW_X"][0][1]

    def test_cantilever(self):
        length, side = 60.0, 4.0
        self.make_bar(length, side, (16, 4, 4))
        write_json({name: [0, side / 2, i * side / 4] for i, name in enumerate("PQRST")}, "marks.json")
        shear = self.MODULUS / 2.6
        known = length ** 3 / (3 * self.MODULUS * side ** 4 / 12) + length / (shear * side ** 2 * 5 / 6)
        self.export()
        self.assertAlmostEqual(self.bend() / known, 1.0, delta=0.003)
        self.export("--order", 1)
        self.assertLess(self.bend() / known, 0.8, "four nodes are known to be too stiff")

    def test_ball_under_pressure(self):
        # Pressure on a face that is not the one meant, or from within, would not leave the stress even.
        radius, pressure = 10.0, 3.0
        calculix.write_model("ball.vtu", *calculix.ball_mesh(6, radius), lambda x: numpy.full(len(x), 0.5))
        write_json({"O": [0, 0, 0], "X": [radius, 0, 0], "Y": [0, radius, 0]}, "marks.json")
        for options in ((), ("--order", 1)):
            self.export(*options, model="ball.vtu")
            tables = calculix.solve("mesh.inp", f"""*BOUNDARY
LM_O, 1, 3
LM_X, 2, 3
LM_Y, 3, 3
*DLOAD
EXTERIOR_FACES, P, {pressure}
*NODE PRINT, NSET=NODES
U
*NODE PRINT, NSET=LM_O, TOTALS=ONLY
RF""".replace("*DLOAD\nEXTERIOR_FACES", "*DSLOAD\nEXTERIOR"))
            moved = tables["displacements NODES"][:, 1:]
            mesh = meshio.read("mesh.inp").points
            known = -pressure * (1 - 2 * 0.3) / self.MODULUS * mesh
            self.assertLess(numpy.abs(moved - known).max(), 1e-4 * numpy.abs(known).max())


@unittest.skipUnless(meshio, "meshio is not installed")
class Files(TestCase):
    """One model of a phantom in every format."""

    @classmethod
    def setUpClass(cls):
        cls.made = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.made.cleanup)
        ct, labels = (os.path.join(cls.made.name, name) for name in ("ct.nii.gz", "l.nii.gz"))
        for command in (("phantom", "--bone", "femur", "--spacing", 2, "-o", ct, "--labels", labels),
                        ("build", ct, "--labels", labels, "--degree", 2, "--tetrahedra", 5000, "-o", cls.made.name + "/m")):
            code, _, err = bonetk(*command)
            assert code == 0, err

    def setUp(self):
        super().setUp()
        os.symlink(self.made.name + "/m", "m")
        write_json({"femoral head": [28.0, 0.0, 20.0]}, "marks.json")

    def export(self, format, output, *options):
        return self.succeed("export", "m/model.hierarchy.json", "--level", 2, "--format", format, "--law", "keyak1998",
                            "--line", 0.0, 0.0008, "--landmarks", "marks.json", "--bins", 20, "-o", output, *options)

    def check_middles(self, points, elements):
        for i, (a, b) in enumerate(EDGES):
            middle = 0.5 * (points[elements[:, a]] + points[elements[:, b]])
            self.assertLess(numpy.abs(points[elements[:, 4 + i]] - middle).max(), 1e-6)

    def check_sets(self, mesh, node_sets, element_sets):
        """Against what the model's own arrays say."""
        self.assertTrue({"BOUNDARY", "INTERFACE_2", "INTERFACE_3", "CUT_1", "END_LOW_X", "END_HIGH_Z",
                         "LM_femoral_head"} <= set(node_sets), node_sets)
        self.assertEqual(len(node_sets["LM_femoral_head"]), 1)
        regions = [element_sets[f"REGION_{k}"] for k in (1, 2, 3)]
        self.assertEqual(sum(map(len, regions)), len(mesh))
        materials = [ids for name, ids in element_sets.items() if name.startswith("MAT_")]
        self.assertEqual(sorted(itertools.chain(*materials)), list(range(len(mesh))))
        shared = numpy.intersect1d(mesh[numpy.asarray(regions[0])], mesh[numpy.asarray(regions[1])])
        self.assertEqual(sorted(node_sets["INTERFACE_2"]), sorted(shared))

    def test_calculix_and_abaqus(self):
        self.export("calculix", "a.inp")
        self.export("abaqus", "b.inp")
        with open("a.inp") as a, open("b.inp") as b:
            self.assertEqual(a.read(), b.read())
        mesh = meshio.read("a.inp")
        self.assertEqual([block.type for block in mesh.cells], ["tetra10"])
        self.check_middles(mesh.points, mesh.cells[0].data)
        self.check_sets(mesh.cells[0].data, mesh.point_sets, {name: sets[0] for name, sets in mesh.cell_sets.items()})
        if calculix.find_solver():
            tables = calculix.solve("a.inp", "*BOUNDARY\nEND_LOW_Z, 1, 3\n*CLOAD\nLM_femoral_head, 3, -100\n"
                                    "*NODE PRINT, NSET=END_LOW_Z, TOTALS=ONLY\nRF")
            self.assertAlmostEqual(tables["total force END_LOW_Z"][0][2], 100.0, delta=0.01)

    def test_gmsh(self):
        self.export("gmsh", "a.msh")
        self.export("vtk", "a.vtu")
        mesh, grid = meshio.read("a.msh"), meshio.read("a.vtu")
        blocks = [b for b, block in enumerate(mesh.cells) if block.type == "tetra10"]
        cells = numpy.concatenate([mesh.cells[b].data for b in blocks])
        self.check_middles(mesh.points, cells)
        start = dict(zip(blocks, numpy.cumsum([0] + [len(mesh.cells[b].data) for b in blocks])))
        nodes, elements = {}, {}
        for name, sets in mesh.cell_sets.items():
            for b, ids in enumerate(sets):
                if ids is not None and len(ids):
                    if mesh.cells[b].type == "vertex":
                        nodes.setdefault(name, []).extend(mesh.cells[b].data[ids].ravel())
                    elif b in start:
                        elements.setdefault(name, []).extend(start[b] + numpy.asarray(ids, int))
        self.check_sets(cells, nodes, elements)
        # The same moduli as in the other file, each with its own element.
        corners = {tuple(sorted(c[:4])): m for c, m in zip(grid.cells[0].data, grid.cell_data["YoungsModulus"][0])}
        moduli = numpy.concatenate([mesh.cell_data["YoungsModulus"][b] for b in blocks])
        for cell, value in zip(cells, moduli):
            self.assertAlmostEqual(corners[tuple(sorted(cell[:4]))] / value, 1.0, delta=1e-6)
        done = subprocess.run(["gmsh", "a.msh", "-o", "b.msh", "-format", "msh41", "-save"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertNotIn("Error", done.stdout + done.stderr)
        again = meshio.read("b.msh")
        self.assertEqual(sum(len(block.data) for block in again.cells if block.type == "tetra10"), len(cells))
        self.assertEqual(len(again.points), len(mesh.points))

    def test_febio(self):
        for options, parts in (((), "MAT_"), (("--modulus", "cells"), "BONE")):
            self.export("febio", "a.feb", *options)
            root = xml.etree.ElementTree.parse("a.feb").getroot()
            self.assertEqual((root.tag, root.get("version")), ("febio_spec", "4.0"))
            self.assertEqual([child.tag for child in root],
                             ["Module", "Material", "Mesh", "MeshDomains"] + (["MeshData"] if parts == "BONE" else []))
            mesh = root.find("Mesh")
            points = numpy.array([[float(x) for x in node.text.split(",")] for node in mesh.find("Nodes")])
            elements, names = {}, set()
            for block in mesh.findall("Elements"):
                self.assertEqual(block.get("type"), "tet10")
                self.assertTrue(block.get("name").startswith(parts))
                names.add(block.get("name"))
                for element in block:
                    elements[int(element.get("id"))] = [int(x) - 1 for x in element.text.split(",")]
            cells = numpy.array([elements[i + 1] for i in range(len(elements))])
            self.check_middles(points, cells)
            self.assertEqual({domain.get("mat") for domain in root.find("MeshDomains")}, names)
            self.assertEqual({material.get("name") for material in root.find("Material")}, names)
            for material in root.find("Material"):
                self.assertEqual(material.get("type"), "isotropic elastic")
                self.assertEqual([child.tag for child in material], ["density", "E", "v"])
            sets = {entry.get("name"): [int(x) - 1 for x in entry.text.replace("\n", " ").split(",")]
                    for tag in ("NodeSet", "ElementSet") for entry in mesh.findall(tag)}
            for block in mesh.findall("Elements"):
                sets.setdefault(block.get("name"), [int(element.get("id")) - 1 for element in block])
            self.check_sets(cells, sets, {name: ids for name, ids in sets.items() if name[:4] in ("MAT_", "REGI")})
            faces = [[int(x) - 1 for x in face.text.split(",")] for face in mesh.find("Surface")]
            self.assertEqual(sorted({n for face in faces for n in face}), sorted(sets["BOUNDARY"]))
            for i in range(3):
                a, b, middle = (points[[face[k] for face in faces]] for k in (i, (i + 1) % 3, 3 + i))
                self.assertLess(numpy.abs(0.5 * (a + b) - middle).max(), 1e-6)
            volume = sum(points[a] @ numpy.cross(points[b], points[c]) for a, b, c, *_ in faces) / 6
            self.assertGreater(volume, 0)
        maps = {data.get("name"): {int(e.get("lid")): float(e.text) for e in data} for data in root.find("MeshData")}
        material = root.find("Material/material")
        self.assertEqual({material.find("E").text, material.find("density").text}, set(maps))
        self.export("vtk", "a.vtu")
        grid = meshio.read("a.vtu")
        for name, values in maps.items():
            self.assertEqual(sorted(values), list(range(1, len(cells) + 1)))
            known = grid.cell_data[name][0]
            self.assertTrue(numpy.allclose([values[i + 1] for i in range(len(cells))], known, rtol=1e-8, atol=0), name)

    def test_tables_of_moduli_by_node(self):
        """Young's modulus and mass density go with one temperature, GPa, over the same range."""
        self.export("calculix", "a.inp", "--modulus", "nodes")
        tables, key = {}, None
        with open("a.inp") as file:
            for line in file:
                if line.startswith("*"):
                    key = line.strip()
                elif key in ("*ELASTIC", "*DENSITY", "*INITIAL CONDITIONS, TYPE=TEMPERATURE"):
                    tables.setdefault(key, []).append([float(x) for x in line.split(",")])
        elastic, density, nodes = (numpy.array(tables[key]) for key in tables)
        self.assertTrue(numpy.allclose(elastic[:, 0], 1000 * elastic[:, 2]))
        self.assertLessEqual(elastic[0, 2], nodes[:, 1].min() + 1e-9)
        self.assertGreaterEqual(elastic[-1, 2], nodes[:, 1].max() - 1e-9)
        self.assertTrue((numpy.diff(density, axis=0) > 0)[:, 1].all())
        self.assertTrue(1e-4 < density[0, 1] < density[-1, 1] < 50)

    def test_boundary_on_a_finer_model(self):
        self.export("calculix", "a.inp")
        straight = meshio.read("a.inp").points
        out, _ = self.export("calculix", "a.inp", "--surface", "m/model_L1.vtu")
        self.assertIn("nodes of the boundary lie on m/model_L1.vtu", out)
        mesh = meshio.read("a.inp")
        moved = numpy.flatnonzero(numpy.abs(mesh.points - straight).max(axis=1) > 1e-9)
        self.assertGreater(len(moved), 100)
        self.assertTrue(set(moved) <= set(mesh.point_sets["BOUNDARY"]))
        self.assertFalse(set(moved) & set(mesh.point_sets["CUT_1"]))
        if calculix.find_solver():
            calculix.solve("a.inp", "*BOUNDARY\nEND_LOW_Z, 1, 3\n*CLOAD\nLM_femoral_head, 3, -100")

    @unittest.skipUnless(EXAMPLES and os.path.exists(EXAMPLES + "/boneFiniteElementExample"), "the examples are not built")
    def test_example(self):
        code, out, err = run(EXAMPLES + "/boneFiniteElementExample", "m/model_L2.vtu", 0.0, 0.0008, "a.inp")
        self.assertEqual(code, 0, err)
        self.assertIn("J. H. Keyak", out)
        self.succeed("export", "m/model_L2.vtu", "--format", "calculix", "--law", "keyak1998", "--line", 0.0, 0.0008, "-o", "b.inp")
        with open("a.inp") as a, open("b.inp") as b:
            self.assertEqual(a.read(), b.read())

    def test_what_is_said(self):
        out, err = self.export("calculix", "a.inp", "--order", 1)
        self.assertIn("J. H. Keyak", out)
        self.assertIn("materials; a modulus differs from its bin's by", out)
        self.assertIn("elements of four nodes are too stiff", err)
        out, _ = self.succeed("export", "--law", "list")
        self.assertGreaterEqual(len(out.splitlines()), 8)
        self.assertTrue(all("doi:" in line or "J Bone Joint Surg" in line for line in out.splitlines()), out)

    def test_refused(self):
        model = ("export", "m/model_L1.vtu", "--format", "calculix")
        self.refuse_usage(*model, "-o", "a.inp", says="--law")
        self.refuse_usage(*model, "--law", "keyak1998", "-o", "a.inp", says="holds HU")
        line = ("--line", 0, 0.0008)
        self.refuse_usage(*model, "--law", "keyak", *line, "-o", "a.inp", says="keyak")
        self.refuse_usage(*model, "--law", "keyak1998", *line, "-o", "a.msh", says=".inp")
        self.refuse_usage(*model, "--law", "keyak1998", *line, "--modulus", "cells", "-o", "a.inp", says="nodes")
        self.refuse_usage(*model, "--law", "keyak1998", *line, "--level", 2, "-o", "a.inp", says="--level")
        self.refuse_usage(*model, "--law", "keyak1998", *line, "--order", 1, "--surface", "m/model_L1.vtu", "-o", "a.inp",
                          says="--surface")
        self.refuse_usage("export", "--law", "keyak1998", "-o", "a.inp", says="model")
        self.refuse_usage(*model, "--law", "keyak1998", *line, "--poisson", 0.5, "-o", "a.inp", says="--poisson")
        self.refuse_usage("export", "m/model.hierarchy.json", "--level", 9, "--format", "febio", "--law", "keyak1998", *line,
                          "-o", "a.feb", says="levels")
        write_json({"far": [9000.0, 0, 0]}, "far.json")
        self.refuse(*model, "--law", "keyak1998", *line, "--landmarks", "far.json", "-o", "a.inp", says="landmark far")


if __name__ == "__main__":
    main()
