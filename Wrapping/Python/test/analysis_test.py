"""Measures, plans, evaluations and finite elements in memory: the same figures as the commands write; filters' reports."""
import json
import os
import tempfile
import unittest

import numpy as np

import bonetk
from bodies import box, linear, ramp_image

BALLS = [(15, 12, 18, 6), (10, 10, 10, 4.5)]
HALF_SPACE = [(0, 0, 20, 0, 0, 1)]
LANDMARKS = {"here": (3.0, 4.0, 5.0), "there": (25.0, 20.0, 30.0)}


class InFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)
        self.mesh = linear(box())
        bonetk.write_mesh(self.mesh, "m.vtu")
        bonetk.write_landmarks(LANDMARKS, "l.mrk.json")

    def same(self, report, path):
        """As the program's file, but for the files' names; the file has them beside."""
        with open(path) as file:
            content = json.load(file)
        names = {name for name in content if name not in report}
        self.assertTrue(names <= {"model", "atlas"}, names)
        self.assertEqual(report, {name: value for name, value in content.items() if name not in names})


class SameFigures(InFolder):
    def test_measure(self):
        bonetk.commands.measure("m.vtu", landmarks="l.mrk.json", ball=BALLS, capsule=[(5, 5, 5, 20, 15, 25, 4)],
                                cylinder=[(5, 5, 5, 20, 15, 25, 3)], half_space=HALF_SPACE, solid_error=1, no_page=True,
                                output="m.json")  # 1 %
        report = bonetk.measure(self.mesh, LANDMARKS, balls=BALLS, capsules=[(5, 5, 5, 20, 15, 25, 4)],
                                cylinders=[(5, 5, 5, 20, 15, 25, 3)], half_spaces=HALF_SPACE, solid_error=0.01)
        self.same(report, "m.json")
        values = {measure["name"]: measure["value"] for measure in report["measures"]}
        self.assertAlmostEqual(values["model.volume"], 30 * 24 * 36, places=6)
        self.assertAlmostEqual(values["halfSpace1.volume"], 30 * 24 * 16, places=6)
        with self.assertRaisesRegex(bonetk.UsageError, "balls must be rows of 4 numbers"):
            bonetk.measure(self.mesh, balls=[(1, 2, 3)])
        with self.assertRaisesRegex(bonetk.UsageError, "radius"):
            bonetk.measure(self.mesh, balls=[(1, 2, 3, -1)])
        with self.assertRaisesRegex(bonetk.UsageError, 'no parameter "solid_eror"'):
            bonetk.measure(self.mesh, solid_eror=1)

    def test_landmarks_are_carried(self):
        moved = self.mesh.replace(points=self.mesh.points + [1, 2, 3])
        report = bonetk.measure(moved, LANDMARKS, standard=self.mesh)
        np.testing.assert_allclose(report["landmarks"][0]["value"], (4, 6, 8))
        self.assertEqual(bonetk.read_landmarks("l.mrk.json"), LANDMARKS)

    def test_plan(self):
        path = [(2, 12, 18, 20, 12, 18)]
        bonetk.commands.plan("m.vtu", resection=HALF_SPACE, path=path, radius=3, margin=1, search=True, output="p.json")
        self.same(bonetk.plan(self.mesh, resections=HALF_SPACE, paths=path, radius=3, margin=1, search=True), "p.json")
        with self.assertRaisesRegex(bonetk.UsageError, "nothing to plan"):
            bonetk.plan(self.mesh)
        with self.assertRaisesRegex(bonetk.UsageError, "radius"):
            bonetk.plan(self.mesh, paths=path)

    def test_evaluate(self):
        rng = np.random.default_rng(3)
        modes = rng.normal(size=(2, 64, 3))
        subjects = [self.mesh.replace(points=self.mesh.points + 0.2 * (a * modes[0] + b * modes[1]))
                    for a, b in rng.normal(size=(6, 2))]
        model = bonetk.train(subjects[1:])
        bonetk.write_model(model, "a.h5")
        bonetk.write_mesh(subjects[0], "s.vtu")
        bonetk.commands.evaluate("s.vtu", "a.h5", no_page=True, output="e.json")
        report = bonetk.evaluate(subjects[0], model)
        self.same(report, "e.json")
        self.assertFalse(report["registered"])
        other = linear(box((4, 4, 4)))
        bonetk.write_mesh(other, "o.vtu")
        bonetk.commands.evaluate("o.vtu", "a.h5", mirror="never", no_page=True, output="e.json")
        seen = []
        report = bonetk.evaluate(other, model, mirror="never", progress=seen.append)
        self.same(report, "e.json")
        self.assertTrue(report["registered"])
        self.assertGreater(len(seen), 0)
        with self.assertRaises(ZeroDivisionError):
            bonetk.evaluate(other, model, progress=lambda share: 1 / 0)

    def test_export(self):
        line = (0, 0.002)
        bonetk.commands.export("m.vtu", format="gmsh", law="keyak1998", line=line, landmarks="l.mrk.json", bins=5,
                               no_page=True, output="c.msh")
        model = bonetk.export(self.mesh, "keyak1998", "p.msh", format="gmsh", line=line, landmarks=LANDMARKS, bins=5)
        with open("c.msh") as one, open("p.msh") as other:
            self.assertEqual(one.read(), other.read())
        self.assertEqual(model["elements"].shape, (162, 10))
        np.testing.assert_array_equal(model["elements"][:, :4], self.mesh.tetrahedra)
        np.testing.assert_array_equal(model["nodes"][:64], self.mesh.points)
        np.testing.assert_allclose(model["nodes"][model["elements"][:, 4]],
                                   model["nodes"][model["elements"][:, :2]].mean(axis=1))
        self.assertEqual(model["exterior"].shape, (6 * 9 * 2, 6))
        self.assertLess(model["materials"]["modulus"].max(), model["modulus"].max() + 1e-9)
        self.assertEqual(len(model["node_sets"]["LM_here"]), 1)
        self.assertEqual(len(model["element_sets"]["REGION_1"]) + len(model["element_sets"]["REGION_2"]), 162)
        first = bonetk.export(self.mesh, "keyak1998", line=line, order=1)
        self.assertEqual((first["elements"].shape, first["exterior"].shape), ((162, 4), (108, 3)))
        np.testing.assert_allclose(first["modulus"], model["modulus"])
        self.assertIn("keyak1998", {law["name"] for law in bonetk.elasticity_laws()})
        for keywords, pattern in ((dict(law="hooke"), "none of|hooke"), (dict(law="keyak1998"), "density"),
                                  (dict(law="keyak1998", line=line, order=3), "Order is 3")):
            with self.assertRaisesRegex(bonetk.UsageError, pattern):
                bonetk.export(self.mesh, **keywords)
        with self.assertRaises(bonetk.DataError):
            bonetk.export(self.mesh, "keyak1998", "p.xyz", line=line)

    def test_nodes_are_moved_onto_a_surface(self):
        angle = np.linspace(0, 2 * np.pi, 13)[:-1]
        ring = np.stack([10 * np.cos(angle), 10 * np.sin(angle)], axis=1)
        points = np.array([[0, 0, z] for z in (0, 8)] + [[x, y, z] for z in (0, 8) for x, y in ring])
        tetrahedra = []
        for i in range(12):
            a, b = 2 + i, 2 + (i + 1) % 12
            tetrahedra += [(0, a, b, 1), (a, b, 1, b + 12), (a, b + 12, 1, a + 12)]
        mesh = bonetk.DensityMesh(points, tetrahedra, coefficients=np.ones((36, 1)), quantity="ash")
        self.assertTrue(mesh.validate()["valid"])
        model = bonetk.export(mesh, "keyak1998", surface=mesh)
        self.assertIsNotNone(model["curved"])
        self.assertLess(model["curved"]["largest_move"], 1e-9)
        self.assertIsNone(bonetk.export(mesh, "keyak1998")["curved"])


class Reports(unittest.TestCase):
    def test_of_a_fit(self):
        f = bonetk.DensityFitFilter()
        f.image, f.mesh, f.degree = ramp_image(), box(), 1
        f.update()
        self.assertEqual(f.report["outside"], 0)
        self.assertEqual(f.report["samples"] % 162, 0)
        self.assertTrue(f.report["finite"])

    def test_of_a_collapse(self):
        f = bonetk.TetraCollapseFilter()
        f.mesh, f.levels = linear(box((5, 5, 5))), [400, 200]
        f.update()
        self.assertEqual(len(f.report), len(f.output) - 1)
        removed = len(f.output[0].points) - len(f.output[1].points)
        self.assertEqual(f.report[0]["collapses"], removed)
        self.assertIn("topology", f.report[0]["refused"])

    def test_every_filter_with_a_report_has_its_keys(self):
        for name, keys in {
            "SnakeContourFilter": {"slices", "warnings", "doubts", "brighter_share"},
            "ContourResampleFilter": {"samples", "largest_error"},
            "ContourTilingMeshSource": {"slabs", "notes"}, "MeshQualityFilter": {"flips", "smoothing"},
            "TetraSmoothingFilter": {"moves", "refused"}, "TetraSwapFilter": {"done", "refused"},
            "AtlasRegistrationFilter": {"surface_distance", "untangling"}, "RadiographPreprocessFilter": {"open_beam"},
        }.items():
            self.assertTrue(keys <= set(getattr(bonetk, name)().report), name)


class NotANumber(unittest.TestCase):
    def test_outside_of_a_model(self):
        image = bonetk.sample(linear(box()), ramp_image(), outside_value=float("nan"))
        x = np.array([(1, 1, 1), (20, 12, 30)]) + 0.0
        index = np.rint((x - image.origin) / image.spacing).astype(int)
        self.assertTrue(np.isfinite(image.array[tuple(index.T[::-1])]).all())
        self.assertTrue(np.isnan(image.array[0, 0, 0]))
        f = bonetk.DensityImageFilter()
        f.outside_value = np.float32("nan")
        self.assertTrue(np.isnan(f.outside_value))
        with self.assertRaisesRegex(bonetk.UsageError, "OutsideValue must be a number"):
            f.outside_value = "none"


if __name__ == "__main__":
    unittest.main()
