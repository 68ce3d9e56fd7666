#!/usr/bin/env python3
"""Training and sampling a statistical model: every option does what it says, and nothing impossible is written."""
import os
import shutil
import tempfile

import numpy
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader, vtkXMLUnstructuredGridWriter

from bonetk_testing import EXAMPLES, TestCase, bonetk, main, phantom, run


def read(path):
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def points(path):
    return vtk_to_numpy(read(path).GetPoints().GetData()).copy()


def coefficients(path):
    return vtk_to_numpy(read(path).GetCellData().GetArray("DensityCoefficients")).copy()


def write(like, path, place, density=lambda c, mesh: c):
    """A mesh like another one, with its points and its density's coefficients changed."""
    mesh = read(like)
    moved = place(vtk_to_numpy(mesh.GetPoints().GetData()).copy())
    mesh.GetPoints().SetData(numpy_to_vtk(moved, deep=1))
    if mesh.GetCellData().HasArray("DensityCoefficients"):
        changed = numpy_to_vtk(density(vtk_to_numpy(mesh.GetCellData().GetArray("DensityCoefficients")).copy(), mesh), deep=1)
        changed.SetName("DensityCoefficients")
        mesh.GetCellData().AddArray(changed)
    for derived in ("MeanDensity",):
        mesh.GetCellData().RemoveArray(derived)
    mesh.GetPointData().RemoveArray("Density")
    writer = vtkXMLUnstructuredGridWriter()
    writer.SetFileName(path)
    writer.SetInputData(mesh)
    writer.Write()


class Atlas(TestCase):
    made = None  # a folder with the files that every test begins with

    def setUp(self):
        super().setUp()
        if Atlas.made is None:
            phantom("--bone", "femur", "--spacing", 1.05, every=2)
            self.succeed("contours", "ct.nii.gz", "--labels", "l.nii.gz", "--slice-step", 10, "--contour-spacing", 12, "-o", "c.vtp")
            self.succeed("mesh", "c.vtp", "-o", "shape.vtu")
            self.succeed("fit", "ct.nii.gz", "shape.vtu", "--degree", 1, "-o", "bone.vtu")
            Atlas.made = tempfile.TemporaryDirectory()
            shutil.copytree(".", Atlas.made.name, dirs_exist_ok=True)
        shutil.copytree(Atlas.made.name, ".", dirs_exist_ok=True)

    def population(self, sizes, like="bone.vtu"):
        """Subjects in a folder each, longer or shorter, with more or less density in the cortex."""
        for i, size in enumerate(sizes):
            os.makedirs(f"s{i}", exist_ok=True)

            def denser(c, mesh, i=i):
                region = vtk_to_numpy(mesh.GetCellData().GetArray("Region"))
                c[region == 1] += 100.0 * (i % 2)
                return c

            write(like, f"s{i}/model.vtu", lambda p, size=size: p * [1.0, 1.0, size], denser)
        with open("list.txt", "w") as file:
            file.write("".join(f"s{i}/model.vtu\n" for i in range(len(sizes))))

    def train(self, *options, output="atlas.h5"):
        return self.succeed("train", "list.txt", "-o", output, *options)

    def info(self, name="atlas.h5"):
        return self.succeed("info", name)[0]

    def test_subjects_are_named_by_their_folders(self):
        self.population([0.98, 1.0, 1.02, 1.01])
        out, _ = self.train("--registered", "meshes")
        for name in ("s0 ", "s1 ", "s2 ", "s3 "):
            self.assertIn("\n" + name, "\n" + out)
        self.assertEqual(sorted(f for f in os.listdir("meshes") if f.endswith(".vtu")),
                         [f"000{i + 1}_s{i}.vtu" for i in range(4)])

    def test_a_folder_of_registered_subjects_gives_the_atlas_of_the_list(self):
        self.population([0.98, 1.0, 1.02, 1.01])
        self.train("--registered", "meshes", "--no-page")
        for i in range(4):
            self.succeed("register", "subject", "s0/model.vtu", f"s{i}/model.vtu", "-o", f"s{i}.vtu")
            with open(f"s{i}.vtu", "rb") as one, open(f"meshes/000{i + 1}_s{i}.vtu", "rb") as other:
                self.assertEqual(one.read(), other.read())
        self.succeed("train", "--from", "meshes", "-o", "again.h5", "--no-page")
        with open("atlas.h5", "rb") as first, open("again.h5", "rb") as second:
            self.assertEqual(first.read(), second.read())
        self.refuse("train", "--from", "s0", "-o", "x.h5", says="two or more")
        os.mkdir("empty")
        self.refuse("train", "--from", "empty", "-o", "x.h5", says="holds no meshes")
        self.refuse("train", "--from", "nowhere", "-o", "x.h5", says="nowhere")
        self.refuse("train", "list.txt", "--from", "meshes", "-o", "x.h5", code=2, says="--from")
        self.refuse("train", "-o", "x.h5", code=2, says="--from")
        self.refuse("train", "--from", "meshes", "--standard", "s0/model.vtu", "-o", "x.h5", code=2, says="--standard")
        self.refuse("register", "subject", "list.txt", "s0/model.vtu", "-o", "x.vtu", code=2, says="list.txt")

    def test_subjects_are_added_to_an_atlas(self):
        self.population([0.98, 1.0, 1.02, 1.01, 0.97, 1.03])
        self.train("--variance", 1, "--registered", "meshes", "--no-page", output="all.h5")
        with open("list.txt") as file:
            lines = file.readlines()
        for name, part in (("first.txt", lines[:4]), ("more.txt", lines[4:])):
            with open(name, "w") as file:
                file.writelines(part)
        self.succeed("train", "first.txt", "--variance", 1, "-o", "first.h5", "--no-page")
        self.succeed("train", "more.txt", "--variance", 1, "--add", "first.h5", "-o", "both.h5", "--no-page")
        everyone, both = self.info("all.h5"), self.info("both.h5")
        self.assertIn("subjects                    6", both)
        self.assertEqual([line for line in both.splitlines() if line.startswith("subjects")],
                         [line for line in everyone.splitlines() if line.startswith("subjects")])
        self.succeed("sample", "all.h5", "-o", "all.vtu")
        self.succeed("sample", "both.h5", "-o", "both.vtu")
        # In the mean frame of six subjects, and of the first four.
        one, two = (p - p.mean(axis=0) for p in (points("all.vtu"), points("both.vtu")))
        u, _, v = numpy.linalg.svd(one.T @ two)
        self.assertLess(numpy.abs(one @ u @ v - two).max(), 0.001)
        numpy.testing.assert_allclose(coefficients("both.vtu"), coefficients("all.vtu"), atol=1e-6)
        self.refuse("train", "more.txt", "--add", "both.h5", "-o", "x.h5", says="in the atlas already")
        self.refuse("train", "more.txt", "--add", "list.txt", "-o", "x.h5", says="list.txt")

    def test_registrations_that_were_done_are_not_done_again(self):
        self.population([0.98, 1.0, 1.02])
        self.train("--registered", "meshes", "--no-page")
        os.remove("meshes/0003_s2.vtu")
        with open("atlas.h5", "rb") as file:
            atlas = file.read()
        with open("meshes/requests.jsonl", "a") as file:
            file.write('\n{"file": "0002_s1.v')  # what a kill leaves
        clean = "is registered" in self.train("--registered", "meshes", "--no-page", output="again.h5")[0]
        with open("again.h5", "rb") as file:
            self.assertEqual(file.read(), atlas)
        if ", changed" in self.succeed("--version")[0]:
            return  # what such a program did before is not known by its commit
        self.assertTrue(clean)
        out, _ = self.train("--registered", "meshes", "--no-page")
        self.assertEqual(out.count("is registered"), 3)
        out, _ = self.train("--registered", "meshes", "--no-page", "--degree", 1)
        self.assertEqual(out.count("is registered"), 0)

    def test_the_same_file_twice(self):
        """That the files hold no times is looked at in the unit tests of module IO."""
        self.population([0.98, 1.0, 1.02])
        self.train()
        self.train(output="again.h5")
        with open("atlas.h5", "rb") as first, open("again.h5", "rb") as second:
            self.assertEqual(first.read(), second.read())

    def test_every_file_is_read_before_the_first_is_registered(self):
        self.population([0.98, 1.0, 1.02])
        self.succeed("phantom", "--bone", "femur", "--spacing", 4, "-o", "other.nii.gz")
        with open("s2/model.vtu", "rb") as file:
            whole = file.read()
        with open("s2/model.vtu", "wb") as file:
            file.write(whole[:len(whole) // 2])
        error = self.refuse("train", "list.txt", "-o", "x.h5", says="s2/model.vtu")
        self.assertNotIn("standard model's topology", error)
        with open("s2/model.vtu", "wb") as file:
            file.write(whole)
        with open("list.txt", "a") as file:
            file.write("s2/model.vtu, missing.nii.gz\n")
        self.refuse("train", "list.txt", "-o", "x.h5", says="missing.nii.gz")

    def test_combined_modes(self):
        self.population([0.97, 1.0, 1.02, 1.05])
        self.train("--variance", 1)
        self.assertNotIn("combined modes", self.info())
        self.refuse("sample", "atlas.h5", "--combined", "1=1", "-o", "x.vtu", code=2, says="0 such modes")
        self.train("--variance", 1, "--combined")
        self.assertIn("combined modes", self.info())
        self.succeed("sample", "atlas.h5", "-o", "mean.vtu")
        self.succeed("sample", "atlas.h5", "--combined", "1=1", "-o", "one.vtu")
        self.succeed("sample", "atlas.h5", "--combined", "1=2", "-o", "two.vtu")
        mean, one, two = points("mean.vtu"), points("one.vtu"), points("two.vtu")
        self.assertGreater(numpy.abs(one - mean).max(), 0.1)
        numpy.testing.assert_allclose(two - mean, 2.0 * (one - mean), atol=1e-6)
        mean, one, two = coefficients("mean.vtu"), coefficients("one.vtu"), coefficients("two.vtu")
        self.assertGreater(numpy.abs(one - mean).max(), 1.0)
        numpy.testing.assert_allclose(two - mean, 2.0 * (one - mean), atol=1e-6 * numpy.abs(mean).max())
        self.succeed("sample", "atlas.h5", "--random", 3, "-o", "r.vtu")
        self.refuse("sample", "atlas.h5", "--combined", "1=1", "--shape", "1=1", "-o", "x.vtu", code=2, says="--combined")

    def test_similarity_takes_size_out(self):
        for i, size in enumerate((0.8, 1.0, 1.1, 1.3)):
            os.mkdir(f"s{i}")
            write("bone.vtu", f"s{i}/model.vtu", lambda p, size=size: p * size)
        with open("list.txt", "w") as file:
            file.write("".join(f"s{i}/model.vtu\n" for i in range(4)))
        self.train()
        self.assertIn("size                        in the shape modes", self.info())
        self.assertGreater(float(self.info().split("shape 1 ")[1].split()[0]), 5.0)
        self.train("--similarity")
        self.assertIn("size                        taken out", self.info())
        self.assertNotIn("shape 1 ", self.info())

    def test_outliers(self):
        self.population([0.99, 1.0, 1.01, 1.005, 0.995, 1.4])
        _, err = self.train()
        self.assertIn("s5 is an outlier", err)
        self.assertNotIn("left out", err)
        self.assertIn("subjects                    6", self.info())
        _, err = self.train("--reject-outliers")
        self.assertIn("left out", err)
        self.assertIn("subjects                    5", self.info())
        _, err = self.train("--reject-outliers", "--outlier-threshold", 0)
        self.assertIn("subjects                    6", self.info())

    def test_inner_product_of_densities(self):
        """A pattern of the whole cortex, and a larger one of single coefficients in small cells: the volume tells them
        apart, coefficients do not."""
        pattern = numpy.random.default_rng(1)

        def density(c, mesh, i):
            c = c.copy()
            region = vtk_to_numpy(mesh.GetCellData().GetArray("Region"))
            c[region == 1] += 60.0 * (-1) ** i
            noise = pattern.normal(size=c.shape)
            noise -= noise.mean(axis=1, keepdims=True)  # no cell's mean changes
            return c + 120.0 * noise

        for i in range(8):
            os.mkdir(f"s{i}")
            write("bone.vtu", f"s{i}/model.vtu", lambda p: p, lambda c, mesh, i=i: density(c, mesh, i))
        with open("list.txt", "w") as file:
            file.write("".join(f"s{i}/model.vtu\n" for i in range(8)))

        def share(*options):
            self.train(*options)
            return float(self.info().split("density 1 ")[1].split(",")[1].split("%")[0])

        by_volume, by_integral, by_coefficient = (share(), share("--within-cell-weight", 1), share("--coefficient-product"))
        self.assertGreater(by_volume, by_integral + 5.0)
        self.assertGreater(by_integral, by_coefficient + 5.0)

    def test_mirrored_subjects_and_methods(self):
        self.population([1.0, 1.0], "shape.vtu")
        # Another mesh of a mirrored bone: it has to be registered.
        self.succeed("phantom", "--bone", "femur", "--subject", 1, "--spacing", 2.5, "-o", "o.nii.gz", "--labels", "m.nii.gz")
        self.succeed("contours", "o.nii.gz", "--labels", "m.nii.gz", "--slice-step", 12, "--contour-spacing", 13, "-o", "o.vtp")
        self.succeed("mesh", "o.vtp", "-o", "right.vtu")
        mesh = read("right.vtu")
        moved = vtk_to_numpy(mesh.GetPoints().GetData()).copy() * [-1.0, 1.0, 1.0]
        mesh.GetPoints().SetData(numpy_to_vtk(moved, deep=1))
        cells = vtk_to_numpy(mesh.GetCells().GetConnectivityArray())
        cells[:] = cells.reshape(-1, 4)[:, [1, 0, 2, 3]].ravel()
        mesh.GetCellData().RemoveArray("FaceNeighbors")
        writer = vtkXMLUnstructuredGridWriter()
        writer.SetFileName("left.vtu")
        writer.SetInputData(mesh)
        writer.Write()
        results = {}
        for side, options in (("right", []), ("left", ["--mirror", "try"]), ("left", ["--mirror", "always"]),
                              ("left", ["--mirror", "never"]), ("right", ["--method", "icp"]),
                              ("right", ["--interior", "frames"])):
            with open("list.txt", "w") as file:
                file.write(f"s0/model.vtu\n{side}.vtu\n")
            out, _ = self.train("--registered", "meshes", *options)
            line = next(line for line in out.splitlines() if line.startswith(side))
            self.assertEqual("mirrored" in line, options[-1:] in (["try"], ["always"]), line)
            results[" ".join([side] + options)] = points(f"meshes/0002_{side}.vtu"), float(line.split()[1])
        right = results["right"]
        # The mirror image of the mirror image is the subject.
        for mirrored in ("left --mirror try", "left --mirror always"):
            self.assertLess(abs(results[mirrored][1] - right[1]), 0.2 * right[1])
        self.assertGreater(numpy.abs(results["right --method icp"][0] - right[0]).max(), 1e-3)
        interior = numpy.abs(results["right --interior frames"][0] - right[0]).max(axis=1)
        self.assertGreater(interior.max(), 1e-3)
        self.assertGreater((interior < 1e-9).sum(), 0)  # exterior points are where they were

    def test_samples_that_cannot_be(self):
        self.population([0.5, 1.0, 1.5])
        self.train()
        self.refuse("sample", "atlas.h5", "--shape", "1=3.1", "-o", "x.vtu", code=2, says="3 standard deviations")
        self.refuse("sample", "atlas.h5", "--density", "1=-9", "-o", "x.vtu", code=2, says="--limit")
        self.refuse("sample", "atlas.h5", "--shape", "1=-1.5", "--limit", 1, "-o", "x.vtu", code=2, says="--limit")
        # Beyond -2 or so the bone is turned inside out.
        self.refuse("sample", "atlas.h5", "--shape", "1=-8", "1=8", "-o", "x.vtu", "--limit", 10, code=2, says="twice")
        refused = 0
        for i, value in enumerate(("1=-8", "1=-2.5", "1=8")):
            refused += self.sample(value, f"far{i}.vtu")
        self.assertGreater(refused, 0)

    def sample(self, value, name):
        """Whether the sample is refused, as one must be that cannot be repaired: with nothing written."""
        code, _, err = bonetk("sample", "atlas.h5", "--shape", value, "--limit", 10, "-o", name)
        if code == 0:
            self.succeed("validate", name)
            return False
        self.assertEqual(code, 1)
        self.assertIn("cannot be repaired", err)
        self.assertFalse(os.path.exists(name))
        return True

    def test_shape_alone(self):
        """Models without density are trained, sampled and drawn."""
        self.population([0.98, 1.0, 1.02], "shape.vtu")
        self.train()
        self.assertNotIn("density modes", self.info())
        self.succeed("sample", "atlas.h5", "--shape", "1=1", "-o", "s.vtu")
        self.refuse("sample", "atlas.h5", "--density", "1=1", "-o", "x.vtu", code=2, says="0 such modes")
        if EXAMPLES:
            code, _, err = run(os.path.join(EXAMPLES, "boneAtlasExample"), "pictures", "atlas.h5")
            self.assertEqual(code, 0, err)
            self.assertEqual(os.listdir("pictures"), ["shape_modes.png"])


if __name__ == "__main__":
    main()
