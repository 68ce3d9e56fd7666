#!/usr/bin/env python3
"""`bonetk measure` and `bonetk plan`: a phantom's known measures, solids, landmarks carried by topology, and what cannot be measured."""
import math
import os
import tempfile
import unittest

import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

from bonetk_testing import EXAMPLES, TestCase, bonetk, main, read_json, run, write_json

# Of the mean femur phantom: head's centre and radius, and the pose of its landmarks.
LEAN, TURN, NECK, RADIUS = math.radians(180 - 126), math.radians(12), 50.0, 23.5
HEAD = [NECK * math.sin(LEAN) * math.cos(TURN), -NECK * math.sin(LEAN) * math.sin(TURN), NECK * math.cos(LEAN)]
LANDMARKS = {"femoral_head": [HEAD[0] + 3, HEAD[1] - 2, HEAD[2] + 2], "femoral_neck": [0.4 * x for x in HEAD],
             "shaft_proximal": [0, 0, -75], "shaft_distal": [0, 0, -140], "medial_condyle": [25, 30, -390],
             "lateral_condyle": [-25, 30, -390], "fovea": [1.4 * x for x in HEAD]}


class Measure(TestCase):
    @classmethod
    def setUpClass(cls):
        """One model for all tests."""
        cls.made = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.made.cleanup)
        ct, labels = (os.path.join(cls.made.name, name) for name in ("ct.nii.gz", "l.nii.gz"))
        for command in (("phantom", "--bone", "femur", "--spacing", 1.5, "-o", ct, "--labels", labels),
                        ("build", ct, "--labels", labels, "--degree", 2, "--tetrahedra", 8000, "-o", cls.made.name + "/m")):
            code, _, err = bonetk(*command)
            assert code == 0, err

    def setUp(self):
        super().setUp()
        os.symlink(self.made.name + "/m", "m")
        write_json(LANDMARKS, "landmarks.json")

    def measure(self, *arguments):
        self.succeed("measure", *arguments, "-o", "M.json")
        report = read_json("M.json")
        for entry in report["measures"] + report["landmarks"]:
            self.assertTrue(entry["definition"], entry)
            self.assertIn("value", entry)
            self.assertIn("unit", entry)
        return ({entry["name"]: entry for entry in report["measures"]},
                {entry["name"]: entry["reason"] for entry in report["missing"]}, report["landmarks"])

    def test_phantom(self):
        measures, missing, landmarks = self.measure("m/model_L1.vtu", "--landmarks", "landmarks.json")
        self.assertAlmostEqual(measures["headRadius"]["value"], RADIUS, delta=0.2)
        self.assertEqual(measures["headRadius"]["unit"], "mm")
        for found, known in zip(measures["headCentre"]["value"], HEAD):
            self.assertAlmostEqual(found, known, delta=0.2)
        self.assertAlmostEqual(measures["femoralOffset"]["value"], math.hypot(*HEAD[:2]), delta=1.5)
        self.assertEqual(measures["neckShaftAngle"]["unit"], "degree")
        self.assertGreater(measures["neckCorticalThickness"]["value"], 1.0)
        self.assertLess(measures["neckCorticalThickness"]["value"], 2.5)
        # A cut femur has no condyles.
        self.assertIn("medial_condyle lies", missing["anteversion"])
        self.assertNotIn("anteversion", measures)
        # A landmark that no measure needs is there all the same.
        self.assertEqual([entry["name"] for entry in landmarks], sorted(LANDMARKS))
        fovea = [entry for entry in landmarks if entry["name"] == "fovea"]
        self.assertLess(fovea[0]["distance"], 4)
        # A hierarchy is its first level.
        again, _, _ = self.measure("m/model.hierarchy.json", "--landmarks", "landmarks.json")
        self.assertEqual(measures, again)

    def test_solids(self):
        half = ["--half-space", 0, 0, -30, 0.2, 0.1, 1, "--half-space", 0, 0, -30, -0.2, -0.1, -1]
        measures, missing, _ = self.measure("m/model_L1.vtu", *half, "--ball", *HEAD, 15, "--ball", 500, 0, 0, 3, "--cylinder",
                                            0, 0, -150, 0, 0, -130, 40, "--capsule", 0, 0, -150, 0, 0, -130, 5)
        for what in ("volume", "mass", "region1.volume", "region2.mass"):
            whole = measures["model." + what]["value"]
            parts = [measures[f"halfSpace{side}.{what}"]["value"] for side in (1, 2)]
            self.assertAlmostEqual(sum(parts) / whole, 1, delta=1e-9)
            self.assertGreater(min(parts), 0.05 * whole)
        ball = measures["ball1.volume"]
        self.assertLess(abs(ball["value"] - 4 / 3 * math.pi * 15 ** 3), ball["errorBound"])
        self.assertLess(ball["errorBound"], 2e-3 * ball["value"])
        self.assertEqual(measures["ball2.volume"]["value"], 0)
        self.assertIn("nothing", missing["ball2.meanDensity"])
        self.assertAlmostEqual(measures["capsule1.volume"]["value"], math.pi * (25 * 20 + 4 / 3 * 125), delta=2)
        self.assertIn("no landmark", missing["femur"])
        self.assertIn("no landmark", missing["hemipelvis"])
        self.assertEqual(measures["model.mass"]["unit"], "HU mm^3")

    def test_carried(self):
        """Landmarks of a standard on a subject of one topology: here one that smoothing moved."""
        self.succeed("smooth", "m/model_L1.vtu", "--method", "laplacian", "--iterations", 1, "-o", "moved.vtu")
        near = {name: point for name, point in LANDMARKS.items() if "condyle" not in name}
        write_json(near, "near.json")
        measures, missing, landmarks = self.measure("moved.vtu", "--landmarks", "near.json", "--standard", "m/model_L1.vtu",
                                                    "--write-landmarks", "carried.mrk.json")
        self.assertGreater(landmarks[0]["cell"], 0)
        self.assertAlmostEqual(landmarks[0]["distance"], 0, delta=1e-9)
        # Laplacian smoothing shrinks: it is the subject that is measured.
        self.assertAlmostEqual(measures["headRadius"]["value"], RADIUS - 2, delta=1)
        written = read_json("carried.mrk.json")["markups"][0]["controlPoints"]
        self.assertEqual([point["label"] for point in written], sorted(near))
        self.assertIn("the model holds no density", missing["model.mass"])
        self.refuse("measure", "moved.vtu", "--landmarks", "landmarks.json", "--standard", "m/model_L2.vtu", "-o", "x.json",
                    says="topology")
        self.refuse("measure", "moved.vtu", "--landmarks", "landmarks.json", "--standard", "m/model_L1.vtu", "-o", "x.json",
                    says="condyle' lies")

    def test_plan(self):
        """A resection of the head, and a screw up the neck beside one that leaves the bone."""
        axis = [x / NECK for x in HEAD]
        along = lambda t: [t * x for x in axis]
        plane = [*along(NECK - 18), *axis]
        self.succeed("plan", "m/model_L1.vtu", "--resection", *plane, "--path", *along(-60), *along(NECK + 8), "--path",
                     *along(-60), *along(NECK + 40), "--radius", 3, "-o", "P.json")
        report = read_json("P.json")
        plan = {entry["name"]: entry for entry in report["measures"]}
        missing = {entry["name"] for entry in report["missing"]}
        self.succeed("measure", "m/model_L1.vtu", "--half-space", *plane, "-o", "M.json")
        half = {entry["name"]: entry["value"] for entry in read_json("M.json")["measures"]}
        self.assertEqual(plan["resection1.removed.mass"]["value"], half["halfSpace1.mass"])
        self.assertAlmostEqual((plan["resection1.removed.volume"]["value"] + plan["resection1.kept.volume"]["value"]) /
                               half["model.volume"], 1, delta=1e-9)
        # Of the head's sphere, 18 mm from its centre, or of the neck that is a little wider.
        self.assertGreater(plan["resection1.section.area"]["value"], math.pi * (RADIUS ** 2 - 18 ** 2))
        self.assertLess(plan["resection1.section.area"]["value"], math.pi * 18 ** 2)
        self.assertGreater(plan["resection1.section.largestSecondMoment"]["value"],
                           plan["resection1.section.smallestSecondMoment"]["value"])
        self.assertEqual(plan["path1.safe"]["value"], "yes")
        self.assertIn("path1.breakthrough", missing)
        self.assertTrue(8 < plan["path1.leastClearance"]["value"] < 13, "the neck's radius is 15 to 16 mm, the path's 3")
        self.assertEqual(plan["path2.safe"]["value"], "no")
        self.assertAlmostEqual(plan["path2.breakthrough"]["value"], 60 + NECK + RADIUS - 3, delta=1)
        self.assertEqual(len(plan["path1.densityAlongPercentiles"]["value"]), 5)
        for entry in report["measures"]:
            self.assertTrue(entry["definition"], entry)

        self.succeed("plan", "m/model_L1.vtu", "--path", *along(-60), *along(NECK + 8), "--radius", 3, "--search", "-o", "S.json")
        found = {entry["name"]: entry["value"] for entry in read_json("S.json")["measures"]}
        self.assertEqual((found["path1.search"], found["path1.safe"]), ("found", "yes"))
        self.assertGreaterEqual(found["path1.densityAroundMean"], plan["path1.densityAroundMean"]["value"])
        self.assertLess(math.dist(found["path1.from"], along(-60)), 5 * math.sqrt(2) + 1e-6)
        _, err = self.succeed("plan", "m/model_L1.vtu", "--path", 90, 90, 0, 90, 90, 60, "--radius", 3, "--search", "--quiet", "-o",
                              "N.json")
        self.assertIn("no path", err)
        self.assertEqual({entry["name"]: entry["value"] for entry in read_json("N.json")["measures"]}["path1.search"], "none")

        self.refuse_usage("plan", "m/model_L1.vtu", "-o", "x.json", says="nothing to plan")
        self.refuse_usage("plan", "m/model_L1.vtu", "--path", 0, 0, 0, 1, 1, 1, "-o", "x.json", says="--radius")
        self.refuse_usage("plan", "m/model_L1.vtu", "--path", 1, 1, 1, 1, 1, 1, "--radius", 2, "-o", "x.json", says="one point")
        self.refuse_usage("plan", "m/model_L1.vtu", "--resection", 0, 0, 0, 0, 0, 0, "-o", "x.json", says="normal")
        self.refuse("plan", "m/model_L1.vtu", "--resection", 0, 0, 900, 0, 0, 1, "-o", "x.json", says="does not cut")
        self.succeed("smooth", "m/model_L1.vtu", "--method", "laplacian", "--iterations", 1, "-o", "bare.vtu")
        self.refuse("plan", "bare.vtu", "--path", 0, 0, 0, 1, 1, 1, "--radius", 2, "-o", "x.json", says="no density")

    @unittest.skipUnless(EXAMPLES and os.path.exists(EXAMPLES + "/bonePlanExample"), "the examples are not built")
    def test_examples(self):
        code, out, err = run(EXAMPLES + "/bonePlanExample", "m/model_L1.vtu", "landmarks.json")
        self.assertEqual(code, 0, err)
        self.assertIn("least clearance", out)
        near = {name: point for name, point in LANDMARKS.items() if "condyle" not in name}
        write_json(near, "near.json")
        code, out, err = run(EXAMPLES + "/boneMeasurementExample", "m/model_L1.vtu", "near.json", "m/model_L1.vtu")
        self.assertEqual(code, 0, err)
        self.assertIn("anteversion was not measured: landmark medial_condyle is missing", out)
        self.assertIn("in the middle of the head", out)

    def test_thickness(self):
        out, _ = self.succeed("thickness", "m/model.hierarchy.json", self.made.name + "/ct.nii.gz", "--point-spread", 1.5, "--report",
                              "t.json", "-o", "t.vtp")
        report = read_json("t.json")
        self.assertIn(f"mean {report['thickness']['mean']:.2f} mm", out)
        self.assertEqual(report["pointSpread"], {"unit": "mm", "inPlane": 1.5, "across": 1.5})
        self.assertAlmostEqual(sum(report["shareOfArea"].values()), 1)
        self.assertGreater(report["shareOfArea"]["found"], 0.9)
        reader = vtkXMLPolyDataReader()
        reader.SetFileName("t.vtp")
        reader.Update()
        surface = reader.GetOutput()
        data = surface.GetPointData()
        thickness, density, status = (vtk_to_numpy(data.GetArray("Cortical" + name)) for name in ("Thickness", "Density", "Status"))
        self.assertEqual(data.GetScalars().GetName(), "CorticalThickness")
        self.assertEqual(len(thickness), report["points"])
        for values in (thickness, density):
            self.assertTrue((numpy.isfinite(values) == (status == 1)).all())
        # The shaft's cortex is 5.2 mm thick, the head's 1.3 mm.
        points = vtk_to_numpy(surface.GetPoints().GetData())
        shaft = thickness[(points[:, 2] < -120) & (points[:, 2] > -180) & (status == 1)]
        self.assertAlmostEqual(float(numpy.median(shaft)), 5.2, delta=0.3)
        head = thickness[(points[:, 2] > 40) & (status == 1)]
        self.assertLess(float(numpy.median(head)), 1.5)
        self.refuse("thickness", "m/model_L1.vtu", "none.mha", "-o", "x.vtp", says="none.mha")
        self.refuse_usage("thickness", "m/model_L1.vtu", self.made.name + "/ct.nii.gz", "-o", "x.ply", says=".vtp")
        self.refuse_usage("thickness", "m/model_L1.vtu", self.made.name + "/ct.nii.gz", "--depth", 0, "-o", "x.vtp", says="--depth")

    def test_refusals(self):
        self.refuse_usage("measure", "m/model_L1.vtu", "-o", "x.txt", says=".json")
        self.refuse_usage("measure", "m/model_L1.vtu", "--ball", 1, 2, 3, 4, 5, "-o", "x.json", says="--ball needs 4")
        self.refuse_usage("measure", "m/model_L1.vtu", "--ball", 1, 2, 3, -4, "-o", "x.json", says="radius")
        self.refuse_usage("measure", "m/model_L1.vtu", "--half-space", 1, 2, 3, 0, 0, 0, "-o", "x.json", says="normal")
        self.refuse_usage("measure", "m/model_L1.vtu", "--standard", "m/model_L1.vtu", "-o", "x.json", says="--landmarks")
        self.refuse("measure", "m/contours.vtp", "-o", "x.json", says="no surface")
        self.refuse("measure", "m/model_L1.vtu", "--landmarks", "none.mrk.json", "-o", "x.json", says="none.mrk.json")
        condyles = dict(LANDMARKS, medial_condyle=[-12, 0, -185], lateral_condyle=[12, 0, -185])
        write_json(condyles, "interchanged.json")
        self.refuse("measure", "m/model_L1.vtu", "--landmarks", "interchanged.json", "-o", "x.json", says="interchanged")


if __name__ == "__main__":
    main()
