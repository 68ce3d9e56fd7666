#!/usr/bin/env python3
"""The whole job on the femur phantom, as Examples/run.sh does it: counts, validity and how well the model fits."""
from bonetk_testing import TestCase, main, read_json


class Phantom(TestCase):
    def test_femur(self):
        self.succeed("phantom", "--bone", "femur", "--spacing", 0.8, "--noise", 20, "-o", "ct.nii.gz", "--labels", "l.nii.gz")
        _, err = self.succeed("build", "ct.nii.gz", "--labels", "l.nii.gz", "-o", "out")
        self.assertIn("warning", err)  # the shaft leaves the image
        first, second, third = read_json("out/report.json")["levels"]
        self.assertTrue(25000 <= first["tetrahedra"] <= 40000, first["tetrahedra"])
        self.assertAlmostEqual(second["tetrahedra"] / first["tetrahedra"], 1 / 5, delta=0.03)
        self.assertAlmostEqual(third["tetrahedra"] / first["tetrahedra"], 1 / 13, delta=0.015)
        for level in (first, second, third):
            self.assertTrue(level["valid"])
        self.assertGreaterEqual(first["labelDice"], 0.97)
        self.assertLessEqual(first["meshToLabelMm"]["mean"], 0.5)
        self.assertLessEqual(first["densityError"]["percentOfRange"], 3.0)


if __name__ == "__main__":
    main()
