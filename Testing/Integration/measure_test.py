#!/usr/bin/env python3
"""`bonetk measure`: a phantom's known measures, solids, landmarks carried by topology, and what cannot be measured."""
import math
import os
import tempfile

from bonetk_testing import TestCase, bonetk, main, read_json, write_json

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
        measures, missing, landmarks = self.measure("moved.vtu", "--landmarks", "landmarks.json", "--standard", "m/model_L1.vtu",
                                                    "--landmark-reach", 400, "--write-landmarks", "carried.mrk.json")
        self.assertGreater(landmarks[0]["cell"], 0)
        self.assertAlmostEqual(landmarks[0]["distance"], 0, delta=1e-9)
        # Laplacian smoothing shrinks: it is the subject that is measured.
        self.assertAlmostEqual(measures["headRadius"]["value"], RADIUS - 2, delta=1)
        written = read_json("carried.mrk.json")["markups"][0]["controlPoints"]
        self.assertEqual([point["label"] for point in written], sorted(LANDMARKS))
        self.assertIn("the model holds no density", missing["model.mass"])
        self.refuse("measure", "moved.vtu", "--landmarks", "landmarks.json", "--standard", "m/model_L2.vtu", "-o", "x.json",
                    says="topology")
        self.refuse("measure", "moved.vtu", "--landmarks", "landmarks.json", "--standard", "m/model_L1.vtu", "-o", "x.json",
                    says="condyle' lies")

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
