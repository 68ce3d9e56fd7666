#!/usr/bin/env python3
"""Files that are damaged, and numbers that no bone has: one line, no crash, no hang, nothing half-written."""
import os
import signal
import struct
import subprocess

import numpy

from bonetk_testing import BONETK, TestCase, main, phantom, write_image, write_json


class Damaged(TestCase):
    def setUp(self):
        super().setUp()
        phantom("--spacing", 3, ct="ct.mha")
        self.contours = ["contours", "ct.mha", "--labels", "l.nii.gz", "--slice-step", 6]

    def mesh(self):
        self.succeed(*self.contours, "-o", "c.vtp")
        self.succeed("mesh", "c.vtp", "-o", "m.vtu")

    def patched(self, source, target, offset, data):
        with open(source, "rb") as file:
            content = bytearray(file.read())
        content[offset:offset + len(data)] = data
        with open(target, "wb") as file:
            file.write(content)
        return target

    def test_wild_numbers_in_a_nifti_header(self):
        write_image("x.nii", numpy.zeros((8, 8, 8), numpy.int16))
        for offset in (80, 280, 284, 292, 324):
            for number in (float("nan"), float("inf"), 3e38):
                name = self.patched("x.nii", "wild.nii", offset, struct.pack("<f", number))
                self.refuse("info", name, says="wild.nii")
        for number in (1e6, 1e-4):
            write_image("unit.nii", numpy.ones((8, 8, 8), numpy.int16), (number,) * 3)
            self.refuse("build", "unit.nii", "--labels", "unit.nii", "-o", "out", says="units mm")

    def test_wild_numbers_in_a_metaimage_header(self):
        header = {"ObjectType": "Image", "NDims": "3", "BinaryData": "True", "TransformMatrix": "1 0 0 0 1 0 0 0 1",
                  "Offset": "0 0 0", "ElementSpacing": "1 1 1", "DimSize": "4 4 4", "ElementType": "MET_SHORT",
                  "ElementNumberOfChannels": "1", "ElementDataFile": "x.raw"}
        with open("x.raw", "wb") as file:
            file.write(bytes(128))

        def write(name, **changes):
            with open(name, "w") as file:
                file.writelines(f"{key} = {value}\n" for key, value in {**header, **changes}.items())
        write("x.mhd")
        self.succeed("info", "x.mhd")
        for field, wrong in (("NDims", "1e9"), ("NDims", "1000000000"), ("ElementNumberOfChannels", "3000000000"),
                             ("TransformMatrix", "inf 0 0 0 1 0 0 0 1"), ("TransformMatrix", "nan 0 0 0 1 0 0 0 1"),
                             ("Offset", "0 0 1e300"), ("ElementSpacing", "1e30 1 1"), ("ElementSpacing", "0 0 0"),
                             ("DimSize", "4 4 4000000000"), ("ElementDataFile", "%d.raw"), ("ElementDataFile", "LIST"),
                             ("ElementDataFile", "%d.raw 1 4 0")):
            write("wild.mhd", **{field: wrong})
            self.refuse("info", "wild.mhd", says="wild.mhd")

    def test_files_nested_deep(self):
        with open("deep.json", "w") as file:
            file.write("[" * 2000000)
        self.refuse("drr", "ct.mha", "--geometry", "deep.json", "-o", "o.mha", says="nested")
        write_json({"rtk": "deep.xml", "size": [4, 4], "spacing": [1.0, 1.0]}, "rtk.json")
        for name, command in (("deep.vtu", ["info", "deep.vtu"]), ("deep.vtp", ["mesh", "-o", "o.vtu", "deep.vtp"]),
                              ("deep.xml", ["drr", "ct.mha", "-o", "o.mha", "--geometry", "rtk.json"])):
            with open(name, "w") as file:
                file.write("<VTKFile>" + "<a>" * 3000000)
            self.refuse(*command, says="nested")

    def test_meshes_of_no_size(self):
        self.mesh()
        from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader, vtkXMLUnstructuredGridWriter
        from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy

        def change(action):
            reader = vtkXMLUnstructuredGridReader()
            reader.SetFileName("m.vtu")
            reader.Update()
            grid = reader.GetOutput()
            action(grid)
            writer = vtkXMLUnstructuredGridWriter()
            writer.SetInputData(grid)
            writer.SetFileName("changed.vtu")
            writer.Write()

        for factor in (1e30, 1e160, 1e-200):
            def scale(grid):
                points = vtk_to_numpy(grid.GetPoints().GetData()) * factor
                grid.GetPoints().SetData(numpy_to_vtk(points, deep=True))
            change(scale)
            for command in ("smooth", "simplify"):
                self.refuse(command, "changed.vtu", "-o", "o.vtu", says="changed.vtu")

        def neighbours(grid):
            array = vtk_to_numpy(grid.GetCellData().GetArray("FaceNeighbors"))
            array[:] = numpy.random.default_rng(1).integers(0, len(array), array.shape)
        change(neighbours)
        self.refuse("smooth", "changed.vtu", "-o", "o.vtu", says="FaceNeighbors")

        def themselves(grid):
            array = vtk_to_numpy(grid.GetCellData().GetArray("FaceNeighbors"))
            array[:] = numpy.arange(len(array))[:, None]
        change(themselves)
        self.refuse("smooth", "changed.vtu", "-o", "o.vtu", says="FaceNeighbors")

        def twice(grid):
            cells = vtk_to_numpy(grid.GetCells().GetConnectivityArray())
            cells[4:8] = cells[0:4]
            grid.GetCellData().RemoveArray("FaceNeighbors")
        change(twice)
        for command in ("smooth", "simplify"):
            self.refuse(command, "changed.vtu", "-o", "o.vtu", says="changed.vtu")

    def test_numbers_that_no_bone_has(self):
        self.mesh()
        for command in (["smooth", "m.vtu", "--distance", "1e300", "-o", "o.vtu"],
                        ["voxels", "m.vtu", "--spacing", "1e300", "-o", "o.mha"],
                        ["voxels", "m.vtu", "--spacing", "0.002", "-o", "o.mha"],
                        ["phantom", "--spacing", "1e300", "-o", "o.mha"],
                        ["contours", "ct.mha", "--labels", "l.nii.gz", "--slice-step", "1e-300", "-o", "o.vtp"],
                        ["build", "ct.mha", "--labels", "l.nii.gz", "--slice-step", "1e-300", "-o", "o"]):
            self.refuse_usage(*command, says=command[-4])

    def test_errors_of_the_stages_name_the_files(self):
        self.mesh()
        write_image("far.nii", numpy.ones((8, 8, 8), numpy.int16))
        with open("far.nii", "r+b") as file:
            file.seek(280)
            file.write(struct.pack("<12f", 1, 0, 0, 900, 0, 1, 0, 900, 0, 0, 1, 900))
        self.refuse("fit", "far.nii", "m.vtu", "--degree", 1, "-o", "o.vtu",
                    says="far.nii, m.vtu: The mesh lies wholly outside")
        for command in (["crop", "ct.mha", "--labels", "far.nii", "-o", "o.mha"],
                        ["build", "ct.mha", "--labels", "far.nii", "-o", "o"]):
            self.refuse(*command, says="ct.mha, far.nii: The label map does not cover the CT")
        self.refuse("voxels", "m.vtu", "-o", "o.mha", says="m.vtu: The input 'Mesh' has no density: fit one first.")
        write_image("small.nii", numpy.ones((8, 8, 8), numpy.int16), (1e-3,) * 3)
        self.refuse("build", "small.nii", "--labels", "small.nii", "-o", "o", says="small.nii: The CT holds no bone: no voxel")

    def test_lists_and_tables(self):
        def write(name, text):
            with open(name, "w") as file:
                file.write(text)
        for text, says in (("", "is empty"), ("#\n", "two subjects or more"), ("m.vtu\nn.vtu\n", "line 1: there is no file m.vtu"),
                           ("ct.mha\nct.mha, no.mha\n", "line 2: there is no file no.mha"), ("m.vtu\0\n", "line 1 is no text"),
                           ("ct.mha\nct.mha\n", "put one first in list.txt")):
            write("list.txt", text)
            self.refuse("train", "list.txt", "-o", "o.h5", code=2 if "put" in says else 1, says="list.txt")
            self.refuse("train", "list.txt", "-o", "o.h5", code=2 if "put" in says else 1, says=says)
        write_json({"parameters": {"plan": {"a\n\u007fb": 1}}}, "report.json")
        self.refuse("build", "--parameters", "report.json", "-o", "o", says="report.json: plan.a  b is no parameter")
        self.mesh()
        self.succeed("fit", "ct.mha", "m.vtu", "--degree", 1, "-o", "d.vtu")
        for references in ({}, [], 3, {"references": 3}, {"references": []}):
            write_json(references, "r.json")
            self.refuse("calibrate", "d.vtu", "--references", "r.json", "--to", "ash", "-o", "o.vtu",
                        says="r.json: must hold a list of one reference or more")
        self.refuse_usage("calibrate", "d.vtu", "-o", "o.vtu", says="--line, --references or --law is required")

    def test_pipes_and_devices_are_refused_at_once(self):
        os.mkfifo("pipe")
        for name in ("pipe", "/dev/zero", "/dev/null"):
            self.refuse("info", name, says="no regular file")
            self.refuse("build", "ct.mha", "--labels", name, "-o", "out", says="no regular file")
            self.refuse("drr", "ct.mha", "--geometry", name, "-o", "o.mha", says="no regular file")
            self.refuse("train", name, "-o", "o.h5", says="no regular file")


class Outputs(TestCase):
    def setUp(self):
        super().setUp()
        phantom("--spacing", 3, ct="ct.mha")
        self.contours = ["contours", "ct.mha", "--labels", "l.nii.gz", "--slice-step", 6]

    def test_several_outputs_appear_together_or_not_at_all(self):
        self.refuse(*self.contours, "-o", "a.vtp", "-o", "nowhere/b.vtp", code=2, says="nowhere")
        self.refuse("phantom", "--spacing", 3, "-o", "a.mha", "--labels", "nowhere/b.mha", code=2, says="nowhere")
        self.refuse("phantom", "--spacing", 3, "-o", "a.mha", "--labels", "a.mha", code=2, says="a.mha")
        os.mkdir("folder.vtp")
        self.refuse(*self.contours, "-o", "a.vtp", "-o", "folder.vtp", code=2, says="folder.vtp")

    def test_a_replaced_file_keeps_its_mode(self):
        os.chmod("ct.mha", 0o600)
        self.succeed("phantom", "--spacing", 4, "-o", "ct.mha")
        self.assertEqual(os.stat("ct.mha").st_mode & 0o777, 0o600)

    def test_a_hang_up_leaves_nothing(self):
        for number in (signal.SIGHUP, signal.SIGQUIT):
            before = sorted(os.listdir())
            process = subprocess.Popen([BONETK, "phantom", "--spacing", "0.7", "-o", "big.mha"], stderr=subprocess.DEVNULL)
            while process.poll() is None and sorted(os.listdir()) == before:
                pass
            process.send_signal(number)
            self.assertIn(process.wait(60), (0, 128 + number))
            if os.path.exists("big.mha"):
                os.remove("big.mha")
            self.assertEqual(sorted(os.listdir()), before)

    def test_text_that_is_lost_is_an_error(self):
        with open("/dev/full", "w") as full:
            done = subprocess.run([BONETK, "info", "ct.mha"], stdout=full, stderr=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, 3)
        self.assertIn("standard output", done.stderr)

    def test_levels_of_an_earlier_build_go(self):
        build = ["build", "ct.mha", "--labels", "l.nii.gz", "--tetrahedra", 1500, "--degree", 1, "-o", "out"]
        self.succeed(*build, "--levels", 0.5, 0.25)
        self.assertIn("model_L3.vtu", os.listdir("out"))
        self.succeed(*build, "--levels", 0.5)
        self.assertNotIn("model_L3.vtu", os.listdir("out"))
        self.assertNotIn("drr_L3.mha", os.listdir("out"))
        self.assertIn("model_L2.vtu", os.listdir("out"))
        os.remove("out/report.txt")
        os.mkdir("out/report.txt")
        before = {name: os.stat("out/" + name).st_mtime_ns for name in os.listdir("out")}
        self.refuse(*build, code=2, says="report.txt")
        self.assertEqual(before, {name: os.stat("out/" + name).st_mtime_ns for name in os.listdir("out")})


if __name__ == "__main__":
    main()
