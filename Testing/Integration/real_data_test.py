#!/usr/bin/env python3
"""The whole job on a real femur (BONETK_DATA, hip_ct, label 1), checked by an independent program where BONETK_CHECK
names one."""
import os
import resource
import subprocess
import sys

from bonetk_testing import TestCase, main, read_json

DATA = os.environ.get("BONETK_DATA")


class RealData(TestCase):
    def test_femur(self):
        folder = os.path.join(DATA, "hip_ct")
        self.assertTrue(os.path.isdir(folder), f"BONETK_DATA is set, but there is no folder {folder}")
        ct, labels = os.path.join(folder, "hip_ct.nii.gz"), os.path.join(folder, "hip_labels.nii.gz")
        _, err = self.succeed("build", ct, "--labels", labels, "--label", 1, "-o", "out", "--degree", 3,
                              "--threads", 2)
        self.assertIn("warning", err)  # the bone leaves the image
        # It took 248 MB where this was written, and 5 with each thread more: another copy of the image is seen.
        self.assertLess(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024 / 1e6, 290)
        levels = read_json("out/report.json")["levels"]
        self.assertTrue(25000 <= levels[0]["tetrahedra"] <= 40000, levels[0]["tetrahedra"])
        self.assertAlmostEqual(levels[1]["tetrahedra"] / levels[0]["tetrahedra"], 1 / 5, delta=0.03)
        self.assertAlmostEqual(levels[2]["tetrahedra"] / levels[0]["tetrahedra"], 1 / 13, delta=0.015)
        for level in levels:
            self.assertTrue(level["valid"])
        self.assertGreaterEqual(levels[0]["labelDice"], 0.97)
        self.assertLessEqual(levels[0]["meshToLabelMm"]["mean"], 0.5)
        if "BONETK_CHECK" in os.environ:
            self.check(os.environ["BONETK_CHECK"], ct, labels, levels)

    def check(self, checker, ct, labels, levels):
        """The independent program finds each level valid and measures what the report says."""
        for number, level in enumerate(levels, 1):
            command = [sys.executable, checker, f"out/model_L{number}.vtu", "--json", "check.json"]
            if number == 1:
                command += ["--label", labels, "--label-value", "1", "--ct", ct]
            done = subprocess.run(command, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            if number == 1:
                info = read_json("check.json")["info"]
                self.assertGreaterEqual(info["label_dice"], 0.97)
                self.assertLessEqual(info["mesh_to_label_mm"]["mean"], 0.5)
                self.assertAlmostEqual(info["label_dice"], level["labelDice"], delta=0.005)
                # It measures to the centres of the label's voxel faces, the report to the faces.
                self.assertLessEqual(level["meshToLabelMm"]["mean"], info["mesh_to_label_mm"]["mean"])
                self.assertAlmostEqual(info["density"]["error_pct_of_range"], level["densityError"]["percentOfRange"],
                                       delta=0.1)


if __name__ == "__main__":
    if not DATA:
        print("BONETK_DATA is not set")
        sys.exit(77)
    main()
