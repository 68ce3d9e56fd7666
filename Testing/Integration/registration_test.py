#!/usr/bin/env python3
"""From radiographs to the pose of a bone: bonetk register."""
import math
import os
import tempfile

import numpy
from vtkmodules.vtkFiltersCore import vtkImageAppend
from vtkmodules.vtkIOImage import vtkMetaImageReader, vtkMetaImageWriter
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader, vtkXMLUnstructuredGridWriter

from bonetk_testing import EXAMPLES, TestCase, bonetk, main, read_json, run, write_json

SIZE = 128


def view(beam, up=(0, 0, 1)):
    """A view of the bone along `beam`, 2 mm pixels at 1000 mm."""
    beam = numpy.array(beam, float)
    u = numpy.cross(up, beam)
    u /= numpy.linalg.norm(u)
    v = numpy.cross(beam, u)
    centre = numpy.array(read_json("centre.json"))
    origin = centre + 300 * beam - (SIZE - 1) * (u + v)
    return {"source": list(centre - 700 * beam), "detectorOrigin": list(origin), "detectorU": list(u), "detectorV": list(v),
            "size": [SIZE, SIZE], "spacing": [2.0, 2.0]}


class Register(TestCase):
    @classmethod
    def setUpClass(cls):
        """Builds the model and its X-rays once, for all tests."""
        cls.common = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.common.cleanup)
        before = os.getcwd()
        os.chdir(cls.common.name)
        try:
            for command in (["phantom", "--bone", "hemipelvis", "--spacing", 2.5, "-o", "ct.mha", "--labels", "l.mha"],
                            ["build", "ct.mha", "--labels", "l.mha", "--tetrahedra", 5000, "--levels", 0.4, "--degree", 1,
                             "-o", "m"]):
                assert bonetk(*command)[0] == 0, command
            reader = vtkXMLUnstructuredGridReader()
            reader.SetFileName("m/model_L1.vtu")
            reader.Update()
            write_json(list(reader.GetOutput().GetCenter()), "centre.json")
            write_json([view((0, 1, 0)), view((math.sin(1.2), math.cos(1.2), 0))], "views.json")
            assert bonetk("drr", "ct.mha", "--geometry", "views.json", "--bilinear", "-o", "x.mha")[0] == 0
        finally:
            os.chdir(before)

    def setUp(self):
        super().setUp()
        for name in os.listdir(self.common.name):
            os.symlink(os.path.join(self.common.name, name), name)
        with open("start.tfm", "w") as file:
            file.write("#Insight Transform File V1.0\n#Transform 0\nTransform: Euler3DTransform_double_3_3\n"
                       "Parameters: 0.12 -0.1 0.15 9 -7 11\nFixedParameters: " +
                       " ".join(map(str, read_json("centre.json"))) + " 0\n")
        self.command = ["register", "rigid", "m/model.hierarchy.json", "--xray", "x_V1.mha", "x_V2.mha", "--geometry",
                        "views.json", "--pixels", 128]

    def error(self, path, above=0):
        """How far the pose found moves the corners of a cube of 100 mm about the centre, mm; the truth moves nothing."""
        matrix = numpy.array(read_json(path)["transform"])
        corners = numpy.array(read_json("centre.json")) + [0, 0, above] + 50 * numpy.array(
            [[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
        return numpy.linalg.norm(corners @ matrix[:3, :3].T + matrix[:3, 3] - corners, axis=1).max()

    def test_the_pose_is_found(self):
        out, err = self.succeed(*self.command, "--initial", "start.tfm", "-o", "r")
        result = read_json("r.json")
        self.assertEqual((result["quality"], result["converged"]), ("ok", True))
        self.assertLess(self.error("r.json"), 1.0)
        self.assertEqual(len(result["views"]), 2)
        self.assertTrue(numpy.all(numpy.linalg.eigvalsh(numpy.array(result["covariance"])) > 0))
        self.assertIn("ok", out)
        self.assertEqual(err, "")
        with open("r.tfm") as file:
            self.assertIn("Euler3DTransform", file.read())
        for name in ("r_V1.png", "r_V2.png"):
            self.assertGreater(os.path.getsize(name), 10000)
        # From where it ended there is nothing left to do, and the same file twice.
        self.succeed(*self.command, "--initial", "r.tfm", "--search", 0, 0, "-o", "again")
        self.assertLess(self.error("again.json"), 1.0)
        self.succeed(*self.command, "--initial", "start.tfm", "--threads", 1, "-o", "single")
        with open("r.tfm") as one, open("single.tfm") as other:
            self.assertEqual(one.read(), other.read())

    def test_a_pose_beyond_what_is_searched_is_not_trusted(self):
        """Within the margin it is found all the same."""
        with open("start.tfm", "w") as file:
            file.write("#Insight Transform File V1.0\n#Transform 0\nTransform: Euler3DTransform_double_3_3\n"
                       "Parameters: 0 0 0 0 0 9\nFixedParameters: 0 0 0 0\n")
        for millimetres, quality in ((10, "ok"), (8, "suspect")):
            self.succeed(*self.command, "--initial", "start.tfm", "--search", millimetres, 5, "--searches", 2, "--no-page", "-o", "b")
            self.assertLess(self.error("b.json"), 1.0)
            self.assertEqual(read_json("b.json")["quality"], quality)

    def test_the_example_program(self):
        code, out, err = run(os.path.join(EXAMPLES, "boneRigidRegistrationExample"), "m/model.hierarchy.json", "views.json",
                             "x_V1.mha", "x_V2.mha", "pose.tfm")
        self.assertEqual((code, err), (0, ""))
        self.assertIn("quality ok", out)
        self.succeed(*self.command, "--initial", "pose.tfm", "--search", 0, 0, "-o", "r")
        self.assertLess(self.error("r.json"), 1.0)

    def test_a_mask_and_one_view(self):
        mask = numpy.ones((SIZE, SIZE), numpy.uint8)
        mask[:, :5] = 0
        with open("mask.mhd", "w") as file:
            file.write(f"ObjectType = Image\nNDims = 2\nDimSize = {SIZE} {SIZE}\nElementType = MET_UCHAR\nElementDataFile = mask.raw\n")
        mask.tofile("mask.raw")
        write_json(view((0, 1, 0)), "one.json")
        one = ["register", "rigid", "m/model_L1.vtu", "--xray", "x_V1.mha", "--geometry", "one.json", "--pixels", 128]
        self.succeed(*one, "--mask", "mask.mhd", "--search", 5, 5, "-o", "r")
        deviations = read_json("r.json")["standardDeviations"]
        self.assertGreater(deviations[1], 5 * deviations[0])  # depth, along y
        numpy.zeros_like(mask).tofile("mask.raw")
        self.refuse(*one, "--mask", "mask.mhd", "-o", "none", says="x_V1.mha")

    def test_landmarks(self):
        geometry = read_json("views.json")
        centre = numpy.array(read_json("centre.json"))
        points = {f"p{i}": list(centre + 40 * numpy.array(d)) for i, d in enumerate(
            [(1, 0, 0), (0, 1, 0.2), (0, 0, 1), (-1, 0.3, 0), (0.2, -1, 0), (0.5, 0.5, -1)])}
        write_json(points, "model.json")
        for number, seen in enumerate(geometry):
            u, v, source, origin = (numpy.array(seen[k]) for k in ("detectorU", "detectorV", "source", "detectorOrigin"))
            normal = numpy.cross(u, v)
            pixels = {}
            for name, x in points.items():
                ray = numpy.array(x) - source
                hit = source + ray * normal.dot(origin - source) / normal.dot(ray) - origin
                pixels[name] = [u.dot(hit) / 2, v.dot(hit) / 2]
            write_json(pixels, f"seen{number}.json")
        self.succeed(*self.command, "--initial", "start.tfm", "--landmarks", "model.json", "--xray-landmarks", "seen0.json",
                     "seen1.json", "--search", 0, 0, "-o", "r")
        self.assertLess(self.error("r.json"), 1.0)

    def test_several_bodies(self):
        """Two bones of one CT, one above the other."""
        reader = vtkMetaImageReader()
        reader.SetFileName("ct.mha")
        stack = vtkImageAppend()
        stack.SetAppendAxis(2)
        stack.AddInputConnection(reader.GetOutputPort())
        stack.AddInputConnection(reader.GetOutputPort())
        writer = vtkMetaImageWriter()
        writer.SetFileName("both.mha")
        writer.SetInputConnection(stack.GetOutputPort())
        writer.Write()
        low, high = reader.GetDataExtent()[4:]
        above = 2.5 * (high - low + 1)
        mesh = vtkXMLUnstructuredGridReader()
        mesh.SetFileName("m/model_L1.vtu")
        mesh.Update()
        points = mesh.GetOutput().GetPoints()
        for i in range(points.GetNumberOfPoints()):
            x, y, z = points.GetPoint(i)
            points.SetPoint(i, x, y, z + above)
        shifted = vtkXMLUnstructuredGridWriter()
        shifted.SetFileName("above.vtu")
        shifted.SetInputData(mesh.GetOutput())
        shifted.Write()
        views = []
        for seen in read_json("views.json"):
            u, v, origin = (numpy.array(seen[k]) for k in ("detectorU", "detectorV", "detectorOrigin"))
            middle = numpy.array([0, 0, above / 2])
            views.append({**seen, "source": list(seen["source"] + middle), "size": [2 * SIZE, 2 * SIZE], "spacing": [2.5, 2.5],
                          "detectorOrigin": list(origin + middle + (SIZE - 1 - 1.25 * (2 * SIZE - 1)) * (u + v))})
        write_json(views, "wide.json")
        self.succeed("drr", "both.mha", "--geometry", "wide.json", "--bilinear", "-o", "w.mha")
        self.succeed("register", "rigid", "m/model.hierarchy.json", "--xray", "w_V1.mha", "w_V2.mha", "--geometry", "wide.json",
                     "--pixels", 256, "--model", "above.vtu", "--search", 10, 5, "-o", "r")
        for number, offset in ((1, 0), (2, above)):
            self.assertLess(self.error(f"r_B{number}.json", offset), 1.0)
            self.assertIn(f"r_B{number}_V2.png", os.listdir())

    def test_a_view_that_is_elsewhere(self):
        geometry = read_json("views.json")
        # The second view, moved along x, its depth being y or x: 2 mm.
        for member in ("source", "detectorOrigin"):
            geometry[1][member][2] += 2.0
        write_json(geometry, "off.json")
        command = [*self.command[:self.command.index("views.json")], "off.json", "--pixels", 128, "--search", 0, 0]
        self.succeed(*command, "-o", "taken")
        self.succeed(*command, "--view-translation-deviation", 2, "-o", "r")
        # Where the second view may be elsewhere, the first one alone tells its depth, to a millimetre or two.
        self.assertLess(self.error("r.json"), 2.5)
        self.assertNotIn("viewCorrections", read_json("taken.json"))
        first, second = read_json("r.json")["viewCorrections"]
        self.assertTrue(numpy.allclose(first["transform"], numpy.eye(4)))
        self.assertGreater(second["standardDeviations"][2], 0.0)
        corrected, stated = read_json("r_geometry.json"), read_json("views.json")
        self.assertLess(abs(corrected[1]["source"][2] - stated[1]["source"][2]), 1.0)
        # What was found serves as a geometry.
        self.succeed(*self.command[:self.command.index("views.json")], "r_geometry.json", "--pixels", 128, "--search", 0, 0,
                     "--initial", "r.tfm", "-o", "again")
        self.assertLess(self.error("again.json"), 2.5)

    def test_a_bone_that_is_not_there_is_no_success(self):
        # Air with noise: nothing of the bone.
        noise = numpy.random.default_rng(1).normal(1.0, 0.1, (SIZE, SIZE)).astype(numpy.float32)
        with open("x_V1.mhd", "w") as file:
            file.write(f"ObjectType = Image\nNDims = 2\nDimSize = {SIZE} {SIZE}\nElementType = MET_FLOAT\nElementDataFile = x.raw\n")
        noise.tofile("x.raw")
        write_json(view((0, 1, 0)), "one.json")
        _, err = self.succeed("register", "rigid", "m/model_L2.vtu", "--xray", "x_V1.mhd", "--geometry", "one.json",
                              "--pixels", 128, "--searches", 1, "--quiet", "-o", "r")
        self.assertIn("likely wrong", err)
        self.assertEqual(read_json("r.json")["quality"], "failed")

    def test_what_is_refused(self):
        write_json(view((0, 1, 0)), "one.json")
        self.refuse_usage(*self.command[:6], "--geometry", "one.json", "-o", "r", says="1 views, but there are 2 X-rays")
        self.refuse_usage(*self.command[:6], "-o", "r", says="does not say how it was taken")
        self.refuse_usage(*self.command[:6], "--carm", 0, 0, "-o", "r", says="--carm needs")
        self.refuse_usage(*self.command, "--mask", "x_V1.mha", "-o", "r", says="as many --mask")
        self.refuse_usage(*self.command, "--patch", 2, "-o", "r", says="--patch")
        self.refuse_usage(*self.command, "-o", "nowhere/r", says="nowhere")
        self.refuse_usage("register", "rigit", says="register")
        self.refuse(*self.command, "--initial", "views.json", "-o", "r", says="views.json")
        self.succeed("mesh", "m/contours.vtp", "-o", "plain.vtu")
        self.refuse("register", "rigid", "plain.vtu", *self.command[3:], "-o", "r", says="density")


if __name__ == "__main__":
    main()
