#!/usr/bin/env python3
"""Radiographs by `drr`: views by name and C-arm, pictures, and what a CT's voxels count."""
import os
import re

import nibabel
import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

from bonetk_testing import TestCase, main, read_json, write_image, write_json

SIZE = (60, 50, 80)  # of the CT: voxels of a millimetre along R, A, S


def pixels_of(path):
    """A radiograph by row and column."""
    return numpy.asarray(nibabel.load(path).dataobj)[:, :, 0].T


def picture_of(path):
    """A PNG by row, from the top, and column."""
    reader = vtk.vtkPNGReader()
    reader.SetFileName(path)
    reader.Update()
    image = reader.GetOutput()
    columns, rows, _ = image.GetDimensions()
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(rows, columns)[::-1]


class Views(TestCase):
    def setUp(self):
        """A CT of soft tissue in air, and the same with a bead at the patient's left, front and top."""
        super().setUp()
        voxels = numpy.full(SIZE, -1000, numpy.int16)
        voxels[10:50, 10:40, 10:70] = 40
        write_image("plain.nii.gz", voxels)
        voxels[2:4, 46:48, 75:77] = 3000
        write_image("bead.nii.gz", voxels)
        self.bead = numpy.array([-2.5, -46.5, 75.5])  # LPS, mm
        self.middle = numpy.array([-29.5, -24.5, 39.5])
        self.half = numpy.array([35.0, 30.0, 45.0])  # with the margin of 5 mm

    def expected(self, beam, right, isocentre=700.0, detector=1000.0, size=512):
        """Columns, rows, and column and row of the bead, by similar triangles."""
        beam, right, down = (numpy.array(v, float) for v in (beam, right, (0, 0, -1)))
        near = isocentre - numpy.abs(beam) @ self.half
        extent = 2 * detector / near * numpy.array([numpy.abs(right) @ self.half, self.half[2]])
        spacing = extent.max() / size
        shape = numpy.ceil(extent / spacing - 1e-6)
        offset = self.bead - self.middle
        place = numpy.array([offset @ right, offset @ down]) * detector / (isocentre + offset @ beam) / spacing
        return shape, (shape - 1) / 2 + place

    def seen(self, *options):
        """Columns, rows, and column and row of the bead in the radiograph."""
        for name in ("plain", "bead"):
            self.succeed("drr", name + ".nii.gz", *options, "-o", name + "_drr.nii.gz")
        bead = (pixels_of("bead_drr.nii.gz") - pixels_of("plain_drr.nii.gz")).astype(float)
        self.assertGreater(bead.max(), 3900)
        rows, columns = numpy.mgrid[:bead.shape[0], :bead.shape[1]]
        return numpy.array(bead.shape[::-1]), numpy.array([(columns * bead).sum(), (rows * bead).sum()]) / bead.sum()

    def test_a_bead_at_the_left_front_and_top(self):
        views = {"ap": ((0, 1, 0), (1, 0, 0), "right"), "pa": ((0, -1, 0), (1, 0, 0), "right"),
                 "left-lateral": ((1, 0, 0), (0, 1, 0), "left"), "lateral": ((1, 0, 0), (0, 1, 0), "left"),
                 "right-lateral": ((-1, 0, 0), (0, -1, 0), "right")}
        for name, (beam, right, side) in views.items():
            shape, place = self.seen("--view", name)
            wanted_shape, wanted = self.expected(beam, right)
            self.assertEqual(list(shape), list(wanted_shape), name)
            self.assertLess(numpy.abs(place - wanted).max(), 0.3, name)
            self.assertLess(place[1], 0.2 * shape[1], name)  # at the top
            share = place[0] / shape[0]
            self.assertGreater(share if side == "right" else 1 - share, 0.8, name)
        shape, place = self.seen("--view", "ap", "--size", 200, "--source-isocentre", 400, "--source-detector", 480)
        wanted_shape, wanted = self.expected((0, 1, 0), (1, 0, 0), 400, 480, 200)
        self.assertEqual(list(shape), list(wanted_shape))
        self.assertLess(numpy.abs(place - wanted).max(), 0.3)

    def test_a_c_arm_turns_to_left_and_head(self):
        for view, angles in (("pa", (0, 0)), ("left-lateral", (90, 0)), ("right-lateral", (-90, 0))):
            self.succeed("drr", "bead.nii.gz", "--view", view, "-o", "view.nii.gz")
            self.succeed("drr", "bead.nii.gz", "--carm", *angles, "-o", "arm.nii.gz")
            difference = numpy.abs(pixels_of("view.nii.gz") - pixels_of("arm.nii.gz"))
            self.assertLess(difference.max(), 1e-3 * pixels_of("view.nii.gz").max(), view)
        self.succeed("drr", "bead.nii.gz", "--carm", 30, 20, "--size", 64, "-o", "arm.nii.gz", "--save-geometry", "arm.json")
        view = read_json("arm.json")
        view = view[0] if isinstance(view, list) else view
        to_source = (self.middle - view["source"]) / 700
        p, s = numpy.radians([30, 20])
        direction = [numpy.sin(p) * numpy.cos(s), -numpy.cos(p) * numpy.cos(s), numpy.sin(s)]
        self.assertLess(numpy.abs(to_source - direction).max(), 1e-6)
        self.assertEqual(max(view["size"]), 64)

    def test_several_views(self):
        self.succeed("drr", "bead.nii.gz", "--view", "ap", "lateral", "--view", "pa", "--size", 50, "-o", "v.nii.gz",
                     "--save-geometry", "v.json")
        self.assertEqual([os.path.exists(f"v_V{k}.nii.gz") for k in (1, 2, 3, 4)], [True, True, True, False])
        self.assertEqual(len(read_json("v.json")), 3)
        self.succeed("drr", "bead.nii.gz", "--geometry", "v.json", "-o", "again.nii.gz")
        for k in (1, 2, 3):
            difference = numpy.abs(pixels_of(f"v_V{k}.nii.gz") - pixels_of(f"again_V{k}.nii.gz"))
            self.assertLess(difference.max(), 1e-3)
        self.succeed("drr", "bead.nii.gz", "--carm", 0, 0, 45, 0, "--size", 50, "-o", "c.png")
        self.assertTrue(os.path.exists("c_V1.png") and os.path.exists("c_V2.png"))

    def test_what_voxels_count(self):
        view = {"source": [-30, -1000, 40], "detectorOrigin": [-30, 200, 40], "detectorU": [1, 0, 0],
                "detectorV": [0, 0, -1], "size": [1, 1], "spacing": [1, 1]}
        write_json(view, "g.json")
        mask = numpy.zeros(SIZE, numpy.int16)
        mask[10:50, 10:25, 10:70] = 1
        write_image("mask.nii.gz", mask)

        def value(*options):
            out, _ = self.succeed("drr", "plain.nii.gz", "--geometry", "g.json", *options, "-o", "o.nii.gz")
            self.assertEqual("max(0, HU + 1000)" in out, not options)
            return pixels_of("o.nii.gz")[0, 0]

        # 50 mm, of which 30 mm are soft tissue; the voxels halfway to others count by half at each end.
        self.assertAlmostEqual(value(), 30 * 1040, delta=1)
        self.assertAlmostEqual(value("--raw"), 30 * 40 - 20 * 1000, delta=1)
        self.assertAlmostEqual(value("--mask", "mask.nii.gz"), 15 * 40, delta=1)
        self.assertAlmostEqual(value("--mask", "mask.nii.gz", "--raw"), 15 * 40, delta=1)
        self.assertAlmostEqual(value("--attenuation"), 0.02059 * 1.04 * 30, delta=1e-3)
        write_image("air.nii.gz", numpy.full(SIZE, -1000, numpy.int16))
        self.succeed("drr", "air.nii.gz", "--view", "ap", "-o", "air_drr.nii.gz")
        self.assertEqual(numpy.abs(pixels_of("air_drr.nii.gz")).max(), 0)

    def test_pictures(self):
        view = ["--view", "ap", "--size", 90]
        self.succeed("drr", "bead.nii.gz", *view, "-o", "o.nii.gz")
        values = pixels_of("o.nii.gz").astype(float)
        for bits, white in ((8, 255), (16, 65535)):
            expected = numpy.floor(white * numpy.clip((values - 1000) / 39000, 0, 1) + 0.5)
            out, _ = self.succeed("drr", "bead.nii.gz", *view, "--bits", bits, "--window", 1000, 40000, "-o", "o.png")
            self.assertIn("o.png: black 1000, white 40000 HU mm\n", out)
            picture = picture_of("o.png")
            self.assertEqual(picture.dtype.itemsize, bits // 8)
            self.assertEqual(numpy.abs(picture - expected).max(), 0, bits)
            self.assertGreater(len(numpy.unique(picture)), 10)
            out, _ = self.succeed("drr", "bead.nii.gz", *view, "--bits", bits, "--window", 1000, 40000, "--invert", "-o",
                                  "o.png")
            self.assertIn("o.png: black 40000, white 1000 HU mm\n", out)
            self.assertLessEqual(numpy.abs(picture_of("o.png") + expected - white).max(), 1)

        def scale(*options):
            out, _ = self.succeed("drr", "bead.nii.gz", *view, *options, "-o", "o.png")
            return [float(number) for number in re.search(r"o.png: black (\S+), white (\S+)", out).groups()]

        black, white = scale()
        self.assertEqual(black, 0)
        wanted = numpy.percentile(values[values != 0], 99.5, method="nearest")
        self.assertAlmostEqual(white / wanted, 1, delta=1e-4)
        self.assertLessEqual(numpy.abs(picture_of("o.png") - 255 * numpy.clip(values / white, 0, 1)).max(), 1)
        black, white = scale("--raw")
        self.assertLess(black, white)
        black, white = scale("--attenuation", "--intensity", 500)
        self.assertEqual(black, 500)
        self.assertLess(white, 400)
        soft, air = picture_of("o.png")[45, picture_of("o.png").shape[1] // 2], picture_of("o.png")[0, 0]
        self.assertGreater(int(soft), int(air) + 100)  # what attenuates more is brighter there too

    def test_refusals(self):
        square = {"source": [-30, -1000, 40], "detectorOrigin": [-60, 200, 80], "detectorU": [1, 0, 0],
                  "detectorV": [0, 0, -1], "size": [6, 8], "spacing": [10, 10]}
        write_json(square, "g.json")
        write_json({**square, "spacing": [10, 12]}, "oblong.json")

        def refuse(*options, says, output="o.png"):
            self.refuse_usage("drr", "plain.nii.gz", *options, "-o", output, says=says)

        refuse(says="--geometry, --view or --carm")
        refuse("--geometry", "g.json", "--view", "ap", says="one way")
        refuse("--geometry", "g.json", "--carm", 0, 0, says="one way")
        refuse("--view", "ap", "--carm", 0, 0, says="one way")
        refuse("--view", "oblique", says="--view: oblique is no view")
        refuse("--carm", 10, says="secondary")
        refuse("--carm", 200, 0, says="-180 to 180")
        refuse("--geometry", "g.json", "--size", 100, says="--size")
        refuse("--geometry", "g.json", "--source-detector", 900, says="--source-detector")
        refuse("--view", "ap", "--size", 0, says="--size")
        refuse("--view", "ap", "--source-isocentre", 990, says="--source-detector")
        refuse("--view", "ap", "--source-isocentre", 1200, says="isocentre")
        refuse("--view", "ap", "--window", 5, 5, says="--window")
        refuse("--view", "ap", "--window", 9, 5, says="--window")
        refuse("--view", "ap", "--window", "nan", 5, says="--window")
        refuse("--view", "ap", "--window", 5, says="--window")
        refuse("--view", "ap", "--bits", 12, says="--bits: 12 is not 8 or 16")
        for option in (["--bits", 16], ["--window", 0, 1], ["--invert"]):
            refuse("--view", "ap", *option, says=".png", output="o.mha")
        refuse("--geometry", "oblong.json", says="square")
        refuse("--view", "ap", "--raw", "--attenuation", says="excludes")
        refuse("--view", "ap", "--raw", "--bilinear", says="excludes")
        refuse("--view", "ap", says=".png", output="o.jpg")
        self.succeed("drr", "plain.nii.gz", "--geometry", "oblong.json", "-o", "o.nii.gz")


class ModelAndCT(TestCase):
    def test_they_agree_in_presets(self):
        self.succeed("phantom", "--spacing", 2, "-o", "ct.nii.gz", "--labels", "l.nii.gz")
        self.succeed("build", "ct.nii.gz", "--labels", "l.nii.gz", "--tetrahedra", 4000, "--levels", 0.9, "-o", "out")
        model, ct = ["out/model_L1.vtu"], ["ct.nii.gz", "--mask", "l.nii.gz"]
        for view in (["--view", "ap"], ["--view", "lateral"], ["--carm", -30, 15]):
            sums, centres, sources = [], [], []
            for name, source in (("model_drr", model), ("ct_drr", ct)):
                self.succeed("drr", *source, *view, "--size", 200, "--save-geometry", name + ".json", "-o", name + ".nii.gz")
                image = pixels_of(name + ".nii.gz").astype(float)
                geometry = read_json(name + ".json")
                geometry = geometry[0] if isinstance(geometry, list) else geometry
                spacing = geometry["spacing"][0]
                rows, columns = numpy.mgrid[:image.shape[0], :image.shape[1]]
                sums.append(image.sum() * spacing ** 2)
                centre = [(columns * image).sum() / image.sum(), (rows * image).sum() / image.sum()]
                centres.append(spacing * (numpy.array(centre) - (numpy.array(image.shape[::-1]) - 1) / 2))
                sources.append(numpy.array(geometry["source"]))
            self.assertLess(numpy.abs(sources[0] - sources[1]).max(), 3, view)
            self.assertLess(abs(sums[0] / sums[1] - 1), 0.05, view)
            self.assertLess(numpy.abs(centres[0] - centres[1]).max(), 3, view)
            self.succeed("drr", *ct, "--geometry", "model_drr.json", "-o", "same.nii.gz")
            model_image, same = pixels_of("model_drr.nii.gz"), pixels_of("same.nii.gz")
            self.assertLess(numpy.abs(model_image - same).mean(), 0.02 * same.max(), view)
        self.refuse_usage("drr", *model, "--view", "ap", "--raw", "-o", "o.mha", says="--raw")
        out, _ = self.succeed("drr", *model, "--view", "ap", "--size", 100, "-o", "o.png")
        self.assertRegex(out, r"^o.png: black 0, white \S+ HU mm\n$")


if __name__ == "__main__":
    main()
