#!/usr/bin/env python3
"""From radiographs to the shape of a bone: bonetk register deform."""
import os
import tempfile

import numpy
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader, vtkXMLUnstructuredGridWriter

from bonetk_testing import EXAMPLES, TestCase, bonetk, main, read_json, run, write_json

SIZE = 96
SIZES = [(0.93, 1.02), (1.05, 0.97), (0.98, 1.04), (1.03, 1.0), (1.01, 0.96)]  # of the subjects, along x and z


def read(path):
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def points(path):
    return vtk_to_numpy(read(path).GetPoints().GetData()).copy()


def write_subject(like, path, size, density):
    """A mesh like another one, scaled along x and z about its middle, its cortex denser."""
    mesh = read(like)
    where = vtk_to_numpy(mesh.GetPoints().GetData()).copy()
    middle = where.mean(axis=0)
    mesh.GetPoints().SetData(numpy_to_vtk((where - middle) * [size[0], 1.0, size[1]] + middle, deep=1))
    coefficients = vtk_to_numpy(mesh.GetCellData().GetArray("DensityCoefficients")).copy()
    coefficients[vtk_to_numpy(mesh.GetCellData().GetArray("Region")) == 1] += density
    changed = numpy_to_vtk(coefficients, deep=1)
    changed.SetName("DensityCoefficients")
    mesh.GetCellData().AddArray(changed)
    mesh.GetCellData().RemoveArray("MeanDensity")
    mesh.GetPointData().RemoveArray("Density")
    writer = vtkXMLUnstructuredGridWriter()
    writer.SetFileName(path)
    writer.SetInputData(mesh)
    writer.Write()


def view(centre, beam):
    """A view of the bone along `beam`, from 700 mm onto a detector of 400 mm at 1000 mm."""
    beam = numpy.array(beam, float)
    u = numpy.cross((0, 0, 1), beam)
    v = numpy.cross(beam, u)
    spacing = 400.0 / SIZE
    origin = centre + 300 * beam - (SIZE - 1) / 2 * spacing * (u + v)
    return {"source": list(centre - 700 * beam), "detectorOrigin": list(origin), "detectorU": list(u), "detectorV": list(v),
            "size": [SIZE, SIZE], "spacing": [spacing, spacing]}


# Attenuation per mm and HU, the default of register deform.
BONE_SLOPE = (0.06047 - 0.02059) / 1600


def scale_image(path, factor):
    """Multiplies the pixels of an uncompressed MetaImage of floats."""
    with open(path, "rb") as file:
        content = file.read()
    begin = content.index(b"ElementDataFile = LOCAL\n") + len(b"ElementDataFile = LOCAL\n")
    with open(path, "wb") as file:
        file.write(content[:begin] + (numpy.frombuffer(content[begin:], "<f4") * factor).astype("<f4").tobytes())


class Deform(TestCase):
    @classmethod
    def setUpClass(cls):
        """Makes the atlas and the X-rays of a bone that is none of its subjects, once, for all tests."""
        cls.common = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.common.cleanup)
        before = os.getcwd()
        os.chdir(cls.common.name)
        try:
            for command in (["phantom", "--bone", "hemipelvis", "-o", "ct.mha", "--labels", "l.mha"],
                            ["contours", "ct.mha", "--labels", "l.mha", "--slice-step", 10, "--contour-spacing", 12, "-o",
                             "c.vtp"],
                            ["mesh", "c.vtp", "-o", "plain.vtu"],
                            ["fit", "ct.mha", "plain.vtu", "--degree", 1, "-o", "bone.vtu"]):
                code, _, err = bonetk(*command)
                assert code == 0, err
            names = []
            for i, size in enumerate(SIZES):
                names.append(f"s{i}.vtu")
                write_subject("bone.vtu", names[-1], size, 150.0 * (-1) ** i)
            write_subject("bone.vtu", "truth.vtu", (0.97, 1.03), 60.0)
            with open("list.txt", "w") as file:
                file.write("\n".join(names) + "\n")
            centre = points("truth.vtu").mean(axis=0)
            write_json([view(centre, (0, 1, 0)), view(centre, (1, 0, 0))], "views.json")
            write_json(view(centre, (0, 1, 0)), "one.json")
            for command in (["train", "list.txt", "-o", "atlas.h5"],
                            ["drr", "truth.vtu", "--geometry", "views.json", "-o", "x.mha"]):
                code, _, err = bonetk(*command)
                assert code == 0, err
            for name in ("x_V1.mha", "x_V2.mha"):
                scale_image(name, BONE_SLOPE)
        finally:
            os.chdir(before)

    def setUp(self):
        super().setUp()
        for name in os.listdir(self.common.name):
            os.symlink(os.path.join(self.common.name, name), name)
        self.command = ["register", "deform", "atlas.h5", "--xray", "x_V1.mha", "x_V2.mha", "--geometry", "views.json",
                        "--pixels", 96, "--search-pixels", 48, "--population", 30, "--smooth-modes", 6,
                        "--soft-tissue", 0]

    def distance(self, path):
        """How far points lie from where they are, on average, mm."""
        return numpy.linalg.norm(points(path) - points("truth.vtu"), axis=1).mean()

    def test_the_bone_is_found(self):
        out, _ = self.succeed(*self.command, "--search", 5, 5, "-o", "r")
        result = read_json("r.json")
        self.assertIn("shape", out)
        self.assertLess(self.distance("r.vtu"), 1.0)
        self.succeed("validate", "r.vtu")
        self.assertGreaterEqual(len(result["shape"]), 2)
        self.assertEqual(len(result["smooth"]), 6)
        self.assertGreaterEqual(len(result["density"]), 1)
        self.assertLess(max(map(abs, result["shape"])), 3.0)
        self.assertEqual(len(result["views"]), 2)
        self.assertEqual(result["quality"], "ok")
        self.assertTrue(numpy.all(numpy.linalg.eigvalsh(numpy.array(result["covariance"])) > 0))
        self.assertEqual(len(result["standardDeviations"]), 6)
        self.assertLessEqual(result["pointDeviation"]["mean"], result["pointDeviation"]["largest"])
        self.assertLess(result["pointDeviation"]["mean"], 10.0)
        matrix = numpy.array(result["transform"])
        self.assertTrue(numpy.allclose(matrix[:3, :3] @ matrix[:3, :3].T, numpy.eye(3)))
        with open("r.tfm") as file:
            self.assertIn("Euler3DTransform", file.read())
        for name in ("r_V1.png", "r_V2.png"):
            self.assertGreater(os.path.getsize(name), 5000)
        # The bone explains the X-rays: its own radiographs lie where they do.
        self.succeed("drr", "r.vtu", "--geometry", "views.json", "-o", "again.mha")

    def test_what_the_x_rays_leave_open(self):
        self.succeed(*self.command, "--search", 0, 0, "--samples", 2, "-o", "r")
        posterior = read_json("r.json")["posterior"]
        names = ("volumeMm3", "meanDensity", "massHuMm3")
        for part in (posterior, *posterior["regions"]):
            for name in names:
                self.assertGreater(part[name]["standardDeviation"], 0.0)
        self.assertAlmostEqual(posterior["massHuMm3"]["mean"] / sum(r["massHuMm3"]["mean"] for r in posterior["regions"]), 1.0)
        self.assertTrue(all("region" in r for r in posterior["regions"]))
        with open("r_posterior.h5", "rb") as file:
            self.assertEqual(file.read(4), b"\x89HDF")
        first, second = (numpy.linalg.norm(points(f"r_S{i}.vtu") - points("r.vtu"), axis=1).mean() for i in (1, 2))
        for moved in (first, second):
            self.assertGreater(moved, 1e-4)
            self.assertLess(moved, 5.0)
        self.assertNotEqual(first, second)

    def test_one_view_with_a_prior(self):
        one = [*self.command[:3], "--xray", "x_V1.mha", "--geometry", "one.json", *self.command[8:], "--search", 0, 0]
        self.refuse_usage(*one, "-o", "r", says="--translation-deviation")
        self.succeed(*one, "--translation-deviation", 3, "--rotation-deviation", 3, "-o", "r")
        deviations = read_json("r.json")["standardDeviations"]
        self.assertGreater(deviations[1], 2 * deviations[0])  # depth, along y
        self.assertLess(deviations[1], 3.01)
        self.assertNotIn("r_V2.png", os.listdir())

    def test_the_example_program(self):
        code, out, err = run(os.path.join(EXAMPLES, "boneDeformableRegistrationExample"), "atlas.h5", "views.json", "x_V1.mha",
                             "x_V2.mha", "found.vtu")
        self.assertEqual((code, err), (0, ""))
        self.assertIn("shape coefficients", out)
        self.assertLess(self.distance("found.vtu"), 1.0)

    def test_what_is_refused(self):
        self.refuse_usage(*self.command[:6], "--geometry", "one.json", "-o", "r", says="1 views, but there are 2 X-rays")
        self.refuse_usage(*self.command[:6], "--carm", 0, 0, "-o", "r", says="--carm needs")
        # Density times mm is no attenuation; its gradients will do.
        for name in ("x_V1.mha", "x_V2.mha"):
            with open(name, "rb") as file:
                content = file.read()
            os.remove(name)
            with open(name, "wb") as file:
                file.write(content)
            scale_image(name, 1 / BONE_SLOPE)
        self.refuse(*self.command, "--search", 0, 0, "-o", "r", says="no line integrals of attenuation")
        self.succeed(*self.command, "--search", 0, 0, "--no-intensities", "-o", "u")
        self.refuse_usage(*self.command, "--patch", 2, "-o", "r", says="--patch")
        self.refuse_usage(*self.command, "-o", "nowhere/r", says="nowhere")
        self.refuse("register", "deform", "truth.vtu", *self.command[3:], "-o", "r", says="truth.vtu")
        with open("plain.txt", "w") as file:
            for i, size in enumerate((0.98, 1.0, 1.02)):
                mesh = read("plain.vtu")
                mesh.GetPoints().SetData(numpy_to_vtk(size * points("plain.vtu"), deep=1))
                writer = vtkXMLUnstructuredGridWriter()
                writer.SetFileName(f"p{i}.vtu")
                writer.SetInputData(mesh)
                writer.Write()
                file.write(f"p{i}.vtu\n")
        self.succeed("train", "plain.txt", "-o", "plain.h5")
        self.refuse("register", "deform", "plain.h5", *self.command[3:], "-o", "r", says="plain.h5: has no density")
        self.assertFalse([name for name in os.listdir() if name.startswith("r.") or name.startswith("r_V")])


if __name__ == "__main__":
    main()
