#!/usr/bin/env python3
"""A CT without a label map: bonetk register volume, label, and build --atlas."""
import os
import tempfile

import nibabel
import numpy

from bonetk_testing import EXAMPLES, TestCase, bonetk, main, phantom, read_json, run, write_image
from deform_test import SIZES, points, write_subject

FAST = ["--hypotheses", 50000, "--smooth-modes", 60]


def dice(a, b):
    return 2.0 * numpy.count_nonzero(a & b) / (numpy.count_nonzero(a) + numpy.count_nonzero(b))


def voxels(path):
    return numpy.asarray(nibabel.load(path).dataobj)


class Volume(TestCase):
    @classmethod
    def setUpClass(cls):
        """Makes an atlas of five hip bones, the CT of a sixth, one of its mirror image, and one of a femur."""
        cls.common = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.common.cleanup)
        before = os.getcwd()
        os.chdir(cls.common.name)
        try:
            phantom("--bone", "femur", ct="femur.nii.gz", every=2)
            phantom("--bone", "hemipelvis", "--noise", 20, every=2)
            for command in (["contours", "ct.nii.gz", "--labels", "l.nii.gz", "--slice-step", 6, "--contour-spacing", 8, "-o",
                             "c.vtp"],
                            ["mesh", "c.vtp", "-o", "plain.vtu"],
                            ["fit", "ct.nii.gz", "plain.vtu", "--degree", 1, "-o", "bone.vtu"]):
                code, _, err = bonetk(*command)
                assert code == 0, err
            names = []
            for i, size in enumerate(SIZES):
                names.append(f"s{i}.vtu")
                write_subject("bone.vtu", names[-1], size, 150.0 * (-1) ** i)
            with open("list.txt", "w") as file:
                file.write("\n".join(names) + "\n")
            code, _, err = bonetk("train", "list.txt", "-o", "atlas.h5")
            assert code == 0, err
            write_image("mirror.nii.gz", voxels("ct.nii.gz")[::-1].astype("int16"), (2, 2, 2))
            write_image("mirror_l.nii.gz", voxels("l.nii.gz")[::-1].astype("int16"), (2, 2, 2))
        finally:
            os.chdir(before)

    def setUp(self):
        super().setUp()
        for name in os.listdir(self.common.name):
            os.symlink(os.path.join(self.common.name, name), name)

    def test_the_bone_is_found(self):
        out, _ = self.succeed("register", "volume", "atlas.h5", "ct.nii.gz", *FAST, "-o", "r")
        self.assertIn("ok", out)
        self.succeed("validate", "r.vtu")
        labels = voxels("r_labels.nii.gz")
        self.assertGreater(dice(labels > 0, voxels("l.nii.gz") > 0), 0.93)
        self.assertEqual(set(numpy.unique(labels)), {0, 1, 2})
        self.assertTrue(numpy.allclose(nibabel.load("r_labels.nii.gz").affine, nibabel.load("ct.nii.gz").affine))
        result = read_json("r.json")
        self.assertEqual(result["quality"], "ok")
        self.assertFalse(result["mirrored"])
        self.assertGreater(result["support"]["supported"], 0.75)
        self.assertGreater(result["support"]["visible"], 0.95)
        self.assertLess(max(map(abs, result["shape"])), 3.0)
        self.assertTrue(numpy.all(numpy.linalg.eigvalsh(numpy.array(result["covariance"])) > 0))
        volume = result["posterior"]["volumeMm3"]
        self.assertLess(abs(volume["mean"] - 8.0 * numpy.count_nonzero(voxels("l.nii.gz"))), 4 * volume["standardDeviation"])
        self.assertGreater(os.path.getsize("r_posterior.h5"), 1000)
        with open("r.tfm") as file:
            self.assertIn("Euler3DTransform", file.read())

    def test_a_bone_of_the_other_side_is_found_in_the_mirror(self):
        self.succeed("register", "volume", "atlas.h5", "mirror.nii.gz", *FAST, "--mirror", "try", "-o", "r")
        self.assertTrue(read_json("r.json")["mirrored"])
        self.succeed("validate", "r.vtu")
        self.assertGreater(dice(voxels("r_labels.nii.gz") > 0, voxels("mirror_l.nii.gz") > 0), 0.93)
        self.assertEqual(len(points("r.vtu")), len(points("bone.vtu")))

    def test_label_maps_have_a_value_a_bone(self):
        out, _ = self.succeed("label", "mirror.nii.gz", "--mirrored", "atlas.h5", *FAST, "-o", "found.nii.gz")
        self.assertIn("label 1", out)
        self.assertEqual(set(numpy.unique(voxels("found.nii.gz"))), {0, 1})
        self.assertGreater(dice(voxels("found.nii.gz") > 0, voxels("mirror_l.nii.gz") > 0), 0.93)

    def test_build_needs_no_label_map(self):
        self.succeed("build", "ct.nii.gz", "--atlas", "atlas.h5", "--slice-step", 6, "--contour-spacing", 8, "-o", "built")
        report = read_json("built/report.json")
        self.assertEqual(report["registration"]["quality"], "ok")
        self.assertTrue(report["input"]["atlas"].endswith("atlas.h5"))
        for level in (1, 2, 3):
            self.succeed("validate", f"built/model_L{level}.vtu")
        self.succeed("voxels", "built/model_L1.vtu", "--like", "ct.nii.gz", "--outside", -5000, "-o", "v.nii.gz")
        self.assertGreater(dice(voxels("v.nii.gz") > -4000, voxels("l.nii.gz") > 0), 0.93)
        # Its report repeats it.
        self.succeed("build", "--parameters", "built/report.json", "-o", "again")
        self.assertEqual(read_json("again/report.json")["levels"][0]["points"], report["levels"][0]["points"])

    def test_what_is_not_there_is_not_found(self):
        for command in (["register", "volume", "atlas.h5", "femur.nii.gz", *FAST, "-o", "r"],
                        ["label", "femur.nii.gz", "--atlas", "atlas.h5", *FAST, "-o", "l2.nii.gz"],
                        ["build", "femur.nii.gz", "--atlas", "atlas.h5", "-o", "built"]):
            self.refuse(*command, says="not found")

    def test_the_example_does_the_same(self):
        code, out, err = run(os.path.join(EXAMPLES, "boneAtlasVolumeExample"), "atlas.h5", "mirror.nii.gz", "e.vtu", "e.nii.gz")
        self.assertEqual(code, 0, err)
        self.assertIn("of the other side", out)
        self.succeed("validate", "e.vtu")
        self.assertGreater(dice(voxels("e.nii.gz") > 0, voxels("mirror_l.nii.gz") > 0), 0.93)

    def test_a_subject_against_the_atlas(self):
        write_subject("bone.vtu", "wide.vtu", (1.2, 1.0), 0.0)
        far = {}
        for name in ("bone", "wide"):
            out, _ = self.succeed("evaluate", f"{name}.vtu", "atlas.h5", "-o", f"{name}.json")
            self.assertIn("standard deviations", out)
            result = read_json(f"{name}.json")
            self.assertFalse(result["registered"])
            self.assertEqual(set(result["density"]), set(result["shape"]) - {"residualMm", "typicalResidualMm"} |
                             {"residualMeanAbsolute", "residualBias"})
            far[name] = result["shape"]
        self.assertLess(far["bone"]["mahalanobisDistance"], 3.0)
        self.assertGreater(far["bone"]["probability"], 0.01)
        self.assertGreater(far["wide"]["mahalanobisDistance"], 4.0)
        self.assertLess(far["wide"]["probability"], 1e-3)
        self.refuse("evaluate", "bone.vtu", "ct.nii.gz", "-o", "e.json", says="ct.nii.gz")

    def test_usage(self):
        self.refuse_usage("label", "ct.nii.gz", "-o", "x.nii.gz", says="--atlas")
        self.refuse_usage("build", "ct.nii.gz", "--atlas", "atlas.h5", "--labels", "l.nii.gz", "-o", "x", says="--atlas")
        self.refuse_usage("register", "volume", "atlas.h5", "-o", "x", says="ct")
        self.refuse("register", "volume", "ct.nii.gz", "ct.nii.gz", "-o", "x", says="ct.nii.gz")


if __name__ == "__main__":
    main()
