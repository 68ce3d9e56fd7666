#!/usr/bin/env python3
"""Bad input gives one clear line, exit code 1 and no output; bad usage exit code 2."""
import itertools
import re

import numpy

from bonetk_testing import TestCase, bonetk, main, write_image

HEXAHEDRON = """<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian"><UnstructuredGrid>
<Piece NumberOfPoints="8" NumberOfCells="1">
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">
0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1</DataArray></Points>
<Cells><DataArray type="Int64" Name="connectivity" format="ascii">0 1 2 3 4 5 6 7</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">8</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">12</DataArray></Cells>
</Piece></UnstructuredGrid></VTKFile>
"""

CROSSING = """<?xml version="1.0"?>
<VTKFile type="PolyData" version="0.1" byte_order="LittleEndian"><PolyData>
<Piece NumberOfPoints="8" NumberOfVerts="0" NumberOfLines="2" NumberOfStrips="0" NumberOfPolys="0">
<CellData>
<DataArray type="Int32" Name="Slice" format="ascii">0 1</DataArray>
<DataArray type="Int32" Name="Layer" format="ascii">0 0</DataArray>
<DataArray type="Int32" Name="Contour" format="ascii">0 0</DataArray>
<DataArray type="Int32" Name="Region" format="ascii">1 1</DataArray>
<DataArray type="Int32" Name="Axis" format="ascii">0 0</DataArray>
</CellData>
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">
0 0 0 10 0 0 0 10 0 10 10 0  0 0 5 10 0 5 10 10 5 0 10 5</DataArray></Points>
<Lines><DataArray type="Int64" Name="connectivity" format="ascii">0 1 2 3 4 5 6 7</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">4 8</DataArray></Lines>
</Piece></PolyData></VTKFile>
"""


def ball(size=32, radius=10.0):
    x = numpy.arange(size) - (size - 1) / 2.0
    r = numpy.sqrt(x[:, None, None] ** 2 + x[None, :, None] ** 2 + x[None, None, :] ** 2)
    return (r < radius).astype(numpy.int16)


class BadInput(TestCase):
    def setUp(self):
        super().setUp()
        self.labels = ball()
        write_image("labels.nii.gz", self.labels)
        write_image("ct.nii.gz", (self.labels * 1000 + 40).astype(numpy.int16))

    def refuse_ct(self, ct, says):
        """Every command that reads a CT refuses it alike."""
        for command in (["build", ct, "--labels", "labels.nii.gz", "-o", "out"],
                        ["contours", ct, "--labels", "labels.nii.gz", "-o", "out.vtp"]):
            self.refuse(*command, says=says)

    def test_missing_file(self):
        self.refuse_ct("nowhere.nii.gz", "nowhere.nii.gz")
        self.refuse("build", "ct.nii.gz", "--labels", "nowhere.nii.gz", "-o", "out", says="nowhere.nii.gz")
        self.refuse("mesh", "nowhere.vtp", "-o", "out.vtu", says="nowhere.vtp")
        self.refuse("smooth", "nowhere.vtu", "-o", "out.vtu", says="nowhere.vtu")
        self.refuse("fit", "ct.nii.gz", "nowhere.vtu", "--degree", 1, "-o", "out.vtu", says="nowhere.vtu")
        self.refuse("simplify", "nowhere.vtu", "--tetrahedra", 10, "-o", "out", says="nowhere.vtu")
        self.refuse("drr", "nowhere.vtu", "--geometry", "nowhere.json", "-o", "out.mha", says="nowhere")
        self.refuse("validate", "nowhere.vtu", says="nowhere.vtu")
        self.refuse("info", "nowhere.vtu", says="nowhere.vtu")

    def test_text_file_named_nifti(self):
        with open("text.nii.gz", "w") as file:
            file.write("this is no image\n")
        self.refuse_ct("text.nii.gz", "text.nii.gz")

    def test_all_air(self):
        write_image("air.nii.gz", numpy.full(self.labels.shape, -1000, numpy.int16))
        self.refuse_ct("air.nii.gz", "no bone")

    def test_label_that_is_not_there(self):
        self.refuse("build", "ct.nii.gz", "--labels", "labels.nii.gz", "--label", 7, "-o", "out", says="label 7")
        self.refuse("contours", "ct.nii.gz", "--labels", "labels.nii.gz", "--label", 7, "-o", "out.vtp", says="7")

    def test_several_bones_and_none_chosen(self):
        self.labels[:4, :4, :4] = 5
        write_image("two.nii.gz", self.labels)
        for command in (["build", "ct.nii.gz", "--labels", "two.nii.gz", "-o", "out", "--quiet"],
                        ["contours", "ct.nii.gz", "--labels", "two.nii.gz", "-o", "out.vtp"],
                        ["crop", "ct.nii.gz", "--labels", "two.nii.gz", "-o", "out.mha"]):
            self.refuse_usage(*command, says="5 (64 voxels, 0.1 cm^3)")
        self.succeed("contours", "ct.nii.gz", "--labels", "two.nii.gz", "--label", 1, "-o", "out.vtp")
        out, _ = self.succeed("info", "two.nii.gz")
        self.assertIn("64 voxels, 0.1 cm^3", out)

    def test_image_of_one_slice(self):
        write_image("slice.nii.gz", numpy.full((32, 32, 1), 100, numpy.int16))
        self.refuse_ct("slice.nii.gz", "slice")

    def test_nan_voxels(self):
        voxels = (self.labels * 1000.0 + 40.0).astype(numpy.float32)
        voxels[5, 6, 7] = numpy.nan
        write_image("nan.nii.gz", voxels)
        self.refuse_ct("nan.nii.gz", "nan.nii.gz")

    def test_4d_image(self):
        write_image("4d.nii.gz", numpy.zeros((8, 8, 8, 3), numpy.int16))
        self.refuse_ct("4d.nii.gz", "4d.nii.gz")

    def test_labels_on_another_grid(self):
        write_image("small.nii.gz", ball(24, 8.0))
        self.refuse("build", "ct.nii.gz", "--labels", "small.nii.gz", "-o", "out", says="does not cover the CT")

    def test_contour_that_crosses_itself(self):
        with open("crossing.vtp", "w") as file:
            file.write(CROSSING)
        self.refuse("mesh", "crossing.vtp", "-o", "out.vtu", says="crosses")
        self.refuse("build", "ct.nii.gz", "--init", "crossing.vtp", "-o", "out", says="crosses")
        self.refuse("info", "crossing.vtp", says="crosses")

    def test_hexahedra(self):
        with open("hexahedra.vtu", "w") as file:
            file.write(HEXAHEDRON)
        self.refuse("smooth", "hexahedra.vtu", "-o", "out.vtu", says="hexahedr")
        self.refuse("fit", "ct.nii.gz", "hexahedra.vtu", "--degree", 1, "-o", "out.vtu", says="hexahedr")
        self.refuse("simplify", "hexahedra.vtu", "--tetrahedra", 10, "-o", "out", says="hexahedr")
        self.refuse("validate", "hexahedra.vtu", says="hexahedr")

    def test_output_folder_that_is_not_there(self):
        self.refuse_usage("phantom", "--spacing", 4, "-o", "nowhere/ct.nii.gz", says="nowhere")


class BadUsage(TestCase):
    def test_every_number_is_decimal(self):
        """Of every numeric option of every command: an empty text is refused, and in turn hexadecimal, trailing characters, words."""
        wrongs = itertools.cycle(("0x8", "8x", "1e", "eight"))
        numeric = 0
        _, help_text, _ = bonetk("--help")
        commands = re.findall(r"^  (\w+) ", help_text[help_text.index("Subcommands"):], re.MULTILINE)
        self.assertGreater(len(commands), 14)
        commands[commands.index("register")] = "register rigid"
        for command in commands:
            _, text, _ = bonetk(*command.split(), "--help")
            for option in re.findall(r"^ +(?:-\w,)?(--[\w-]+) (?:INT|UINT|FLOAT|NUMBER)", text, re.MULTILINE):
                numeric += 1
                for wrong in ("", next(wrongs)):
                    code, _, err = bonetk(*command.split(), f"{option}={wrong}")
                    self.assertEqual(code, 2, (command, option, wrong, err))
                    self.assertIn(option, err)
                    if wrong:
                        self.assertRegex(err, "no (whole )?number|not a number|is not|not in range|required|Could not convert", (command, option, wrong))
        self.assertGreater(numeric, 50)

    def test_zeros_before_a_number_are_nothing(self):
        for subject in ("010", "10"):
            self.succeed("phantom", "--noise", 10, "--subject", subject, "-o", f"p{subject}.mha")
        with open("p010.mha", "rb") as a, open("p10.mha", "rb") as b:
            self.assertEqual(a.read(), b.read())
        self.succeed("phantom", "--spacing", "08", "--subject", "008", "-o", "p008.mha")

    def test_usage_errors(self):
        self.refuse_usage()
        self.refuse_usage("nonsense")
        self.refuse_usage("build")
        self.refuse_usage("build", "ct.nii.gz", "-o", "out", says="--labels")
        self.refuse_usage("build", "ct.nii.gz", "--labels", "l.nii.gz", "-o", "out", "--degree", 9)
        self.refuse_usage("build", "ct.nii.gz", "--labels", "l.nii.gz", "-o", "out", "--tetrahedra", -5)
        self.refuse_usage("build", "ct.nii.gz", "--labels", "l.nii.gz", "-o", "out", "--nonsense")
        self.refuse_usage("build", "ct.nii.gz", "--label", 1, "-o", "out")
        self.refuse_usage("contours", "ct.nii.gz", "--labels", "l.nii.gz", "-o", "out.txt", says=".vtp")
        self.refuse_usage("contours", "ct.nii.gz", "--labels", "l.nii.gz", "-o", "out.vtp", "--axis", "w")
        self.refuse_usage("mesh", "c.vtp", "--metric", "density", "-o", "out.vtu", says="--ct")
        self.refuse_usage("mesh", "c.vtp", "--metric", "beauty", "-o", "out.vtu")
        self.refuse_usage("mesh", "c.vtp", "--branching", "bridges", "-o", "out.vtu", says="--branching")
        self.refuse_usage("simplify", "m.vtu", "--tetrahedra", 100, "--levels", 0.5, "-o", "out", says="--levels")
        self.refuse_usage("simplify", "m.vtu", "--tetrahedra", 100, 200, "-o", "out")
        self.refuse_usage("phantom", "--bone", "skull", "-o", "ct.nii.gz")
        for number in ("0", "-1", "nan", "inf", "one"):
            self.refuse_usage("phantom", "--spacing", number, "-o", "ct.nii.gz")
        self.refuse_usage("phantom", "--threads", 0, "-o", "ct.nii.gz")

    def test_help_and_version_are_no_errors(self):
        self.assertEqual((bonetk("--version")[0], bonetk("--version")[2]), (0, ""))
        _, out, _ = bonetk("--help")
        for command in "phantom contours mesh smooth fit simplify build drr validate info".split():
            self.assertIn(command, out)
            code, text, err = bonetk(command, "--help")
            self.assertEqual((code, err), (0, ""))
            self.assertIn("--quiet", text)
            self.assertIn("--threads", text)


if __name__ == "__main__":
    main()
