"""Images, meshes, hierarchies, contours and models as objects of Python."""
import copy
import gc
import os
import pickle
import resource
import sys
import tempfile
import types
import unittest

import numpy as np

import bonetk
from bodies import SANITIZED, box, linear


class Images(unittest.TestCase):
    def setUp(self):
        self.voxels = np.arange(60, dtype=np.float32).reshape(3, 4, 5)

    def test_array_is_shared_both_ways(self):
        for voxels in (self.voxels, self.voxels.astype(np.int16)):
            image = bonetk.Image(voxels, (1, 2, 3), (0.5, 0.6, 0.7))
            self.assertEqual(image.array.ctypes.data, voxels.ctypes.data)
            image.array[1, 2, 3] = 7
            self.assertEqual(voxels[1, 2, 3], 7)
            self.assertEqual(image.shape, (3, 4, 5))
            self.assertEqual(image.origin, (1, 2, 3))
            self.assertEqual(image.spacing, (0.5, 0.6, 0.7))

    def test_other_voxels_are_converted(self):
        self.assertEqual(bonetk.Image(self.voxels.astype(float)).array.dtype, np.float32)
        self.assertEqual(bonetk.Image(self.voxels.astype(np.uint8)).array.dtype, np.int16)
        self.assertEqual(bonetk.Image(self.voxels > 3).array.max(), 1)
        np.testing.assert_array_equal(bonetk.Image(self.voxels.T).array, self.voxels.T)
        with self.assertRaisesRegex(bonetk.UsageError, "32767"):
            bonetk.Image(np.full((1, 1, 1), 40000))

    def test_what_is_no_image_is_refused(self):
        for bad, pattern in (
            (dict(array=self.voxels[0]), "three axes"),
            (dict(array=self.voxels, spacing=(0, 1, 1)), "spacing"),
            (dict(array=self.voxels, direction=np.ones((3, 3))), "orthonormal"),
            (dict(array=self.voxels, origin=(0, 1)), "origin must be three numbers"),
            (dict(array=np.zeros((1, 1, 1), dtype=complex)), "holds numbers"),
        ):
            with self.assertRaisesRegex(bonetk.UsageError, pattern):
                bonetk.Image(**bad)

    def test_memory_outlives_image_and_array(self):
        image = bonetk.Image(np.full((20, 20, 20), 3, dtype=np.float32))
        view = image.array
        del image
        gc.collect()
        self.assertEqual(view.sum(), 24000)
        weak = view.base
        self.assertIsNotNone(weak)

    def test_an_image_lets_its_array_go(self):
        voxels = np.zeros((4, 4, 4), dtype=np.float32)
        count = sys.getrefcount(voxels)
        image = bonetk.Image(voxels)
        view = image.array
        del image
        gc.collect()
        self.assertGreater(sys.getrefcount(voxels), count)
        del view
        gc.collect()
        self.assertEqual(sys.getrefcount(voxels), count)

    def test_read_only_arrays_stay_so(self):
        self.voxels.flags.writeable = False
        self.assertFalse(bonetk.Image(self.voxels).array.flags.writeable)

    def test_copies_and_pickles(self):
        turn = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]], dtype=float)
        image = bonetk.Image(self.voxels, (1, 2, 3), (0.5, 0.6, 0.7), turn)
        for other in (copy.copy(image), copy.deepcopy(image), pickle.loads(pickle.dumps(image))):
            np.testing.assert_array_equal(other.array, image.array)
            np.testing.assert_array_equal(other.direction, turn)
            self.assertEqual((other.origin, other.spacing), (image.origin, image.spacing))
            self.assertNotEqual(other.array.ctypes.data, image.array.ctypes.data)

    def test_files(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.mha")
            image = bonetk.Image(self.voxels, (1, 2, 3), (0.5, 0.75, 0.25))
            bonetk.write_image(image, path)
            again = bonetk.read_image(path)
            np.testing.assert_array_equal(again.array, self.voxels)
            self.assertEqual((again.origin, again.spacing), (image.origin, image.spacing))
            bonetk.write_image(self.voxels.astype(np.int16), path)
            self.assertEqual(bonetk.read_image(path, labels=True).array.dtype, np.int16)
            with self.assertRaisesRegex(bonetk.DataError, "none.mha"):
                bonetk.read_image(os.path.join(folder, "none.mha"))

    def test_nibabel_is_shared_and_turned_to_lps(self):
        try:
            import nibabel
        except ImportError:
            self.skipTest("no nibabel")
        voxels = np.asfortranarray(np.arange(60, dtype=np.float32).reshape(5, 4, 3))
        affine = np.array([[0, -0.6, 0, 10], [0.5, 0, 0, 20], [0, 0, 0.7, 30], [0, 0, 0, 1.0]])
        image = bonetk.as_image(nibabel.Nifti1Image(voxels, affine))
        self.assertEqual(image.array.ctypes.data, voxels.ctypes.data)
        np.testing.assert_allclose(image.spacing, (0.5, 0.6, 0.7))
        # Voxel (4, 2, 1): in RAS by the affine, in LPS with x and y negated.
        ras = (affine @ [4, 2, 1, 1])[:3]
        lps = np.array(image.origin) + image.direction @ (np.array(image.spacing) * [4, 2, 1])
        np.testing.assert_allclose(lps, ras * [-1, -1, 1])
        self.assertEqual(image.array[1, 2, 4], voxels[4, 2, 1])

    def test_images_of_simpleitk_are_shared(self):
        voxels = self.voxels

        class Fake:
            __module__ = "SimpleITK.SimpleITK"
            GetOrigin = staticmethod(lambda: (1.0, 2.0, 3.0))
            GetSpacing = staticmethod(lambda: (0.5, 0.6, 0.7))
            GetDirection = staticmethod(lambda: (0, -1, 0, 1, 0, 0, 0, 0, 1))

        module = types.ModuleType("SimpleITK")
        module.GetArrayViewFromImage = lambda image: voxels
        had = sys.modules.get("SimpleITK")
        sys.modules["SimpleITK"] = module
        try:
            image = bonetk.as_image(Fake())
        finally:
            del sys.modules["SimpleITK"]
            if had is not None:
                sys.modules["SimpleITK"] = had
        self.assertEqual(image.array.ctypes.data, voxels.ctypes.data)
        np.testing.assert_array_equal(image.direction, [[0, -1, 0], [1, 0, 0], [0, 0, 1]])
        with self.assertRaisesRegex(bonetk.UsageError, "int is no image"):
            bonetk.as_image(3)


class Meshes(unittest.TestCase):
    def setUp(self):
        self.mesh = linear(box())

    def test_arrays_are_read_only_views(self):
        for name in ("points", "tetrahedra", "neighbors", "region", "degree", "coefficients"):
            array = getattr(self.mesh, name)
            self.assertFalse(array.flags.writeable, name)
            self.assertEqual(array.ctypes.data, getattr(self.mesh, name).ctypes.data, name)
            with self.assertRaises(ValueError):
                array.setflags(write=True)
        self.assertEqual(self.mesh.points.shape, (64, 3))
        self.assertEqual(self.mesh.tetrahedra.shape, (162, 4))
        self.assertEqual(self.mesh.coefficients.shape, (162, 4))
        self.assertIsNone(self.mesh.layer)

    def test_views_outlive_the_mesh(self):
        points = self.mesh.points
        wanted = points.copy()
        del self.mesh
        gc.collect()
        np.testing.assert_array_equal(points, wanted)

    def test_neighbours_share_a_face(self):
        for t, row in enumerate(self.mesh.neighbors):
            for i, n in enumerate(row):
                if n >= 0:
                    face = set(np.delete(self.mesh.tetrahedra[t], i))
                    self.assertTrue(face <= set(self.mesh.tetrahedra[n]))

    def test_density_and_gradient(self):
        inside = np.random.default_rng(1).uniform((0.1, 0.1, 0.1), (29.9, 23.9, 35.9), (500, 3))
        np.testing.assert_allclose(self.mesh.evaluate(inside), 100 + inside @ [3, -2, 5], rtol=1e-12)
        np.testing.assert_allclose(self.mesh.gradient(inside), np.tile([3, -2, 5], (500, 1)), atol=1e-10)
        self.assertTrue(np.isnan(self.mesh.evaluate([[-1, 2, 3], [np.nan, 0, 0]])).all())
        self.assertTrue(np.isnan(self.mesh.gradient([[-1, 2, 3]])).all())
        self.assertAlmostEqual(self.mesh.evaluate((1, 2, 3)), 114)
        with self.assertRaisesRegex(bonetk.UsageError, "n x 3"):
            self.mesh.evaluate(np.zeros((4, 2)))
        with self.assertRaisesRegex(bonetk.DataError, "no density"):
            box().evaluate([[1, 1, 1]])

    def test_places(self):
        inside = np.random.default_rng(2).uniform((0.1, 0.1, 0.1), (29.9, 23.9, 35.9), (50, 3))
        cells, barycentric = self.mesh.locate(np.vstack([inside, [[99, 0, 0]]]))
        self.assertEqual(cells[-1], -1)
        self.assertTrue(np.isnan(barycentric[-1]).all())
        corners = self.mesh.points[self.mesh.tetrahedra[cells[:-1]]]
        np.testing.assert_allclose(np.einsum("nk,nkd->nd", barycentric[:-1], corners), inside, atol=1e-10)

    def test_volume_and_mass_are_those_of_the_box(self):
        self.assertAlmostEqual(self.mesh.volume, 30 * 24 * 36, places=6)
        self.assertAlmostEqual(self.mesh.mass, 30 * 24 * 36 * (100 + 3 * 15 - 2 * 12 + 5 * 18), places=3)
        self.assertEqual(sum(region["tetrahedra"] for region in self.mesh.measure_regions()), 162)

    def test_validation(self):
        self.assertTrue(self.mesh.validate()["valid"])
        turned = self.mesh.tetrahedra.copy()
        turned[5, [0, 1]] = turned[5, [1, 0]]
        report = bonetk.DensityMesh(self.mesh.points, turned).validate()
        self.assertFalse(report["valid"])
        self.assertEqual(report["checks"]["positive orientation"]["failures"], 1)

    def test_wrong_arrays_are_refused(self):
        points, tetrahedra = self.mesh.points, self.mesh.tetrahedra
        with self.assertRaisesRegex(bonetk.DataError, "names point 64"):
            bonetk.DensityMesh(points[:-1], np.full((1, 4), 64))
        with self.assertRaisesRegex(bonetk.UsageError, "m x 4"):
            bonetk.DensityMesh(points, tetrahedra[:, :3])
        with self.assertRaisesRegex(bonetk.UsageError, "k = 1, 4, 10"):
            bonetk.DensityMesh(points, tetrahedra, coefficients=np.zeros((162, 5)))
        with self.assertRaisesRegex(bonetk.UsageError, "region"):
            bonetk.DensityMesh(points, tetrahedra, region=[1, 2])
        with self.assertRaisesRegex(bonetk.UsageError, "none of unknown, hu"):
            bonetk.DensityMesh(points, tetrahedra, quantity="kg")

    def test_replace_leaves_the_mesh(self):
        moved = self.mesh.replace(points=self.mesh.points + [1, 0, 0])
        np.testing.assert_array_equal(moved.points[:, 0], self.mesh.points[:, 0] + 1)
        np.testing.assert_array_equal(moved.coefficients, self.mesh.coefficients)
        self.assertAlmostEqual(moved.evaluate((2, 2, 3)), self.mesh.evaluate((1, 2, 3)))

    def test_copies_and_pickles(self):
        for other in (copy.copy(self.mesh), copy.deepcopy(self.mesh), pickle.loads(pickle.dumps(self.mesh))):
            for name in ("points", "tetrahedra", "neighbors", "region", "degree", "coefficients"):
                np.testing.assert_array_equal(getattr(other, name), getattr(self.mesh, name))
            self.assertEqual(other.quantity, "hu")
        self.assertEqual(len(pickle.loads(pickle.dumps(box())).points), 64)

    def test_files(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.vtu")
            bonetk.write_mesh(self.mesh, path)
            again = bonetk.read_mesh(path)
            np.testing.assert_array_equal(again.coefficients, self.mesh.coefficients)
            np.testing.assert_array_equal(again.points, self.mesh.points)

    def test_vtk(self):
        try:
            import vtkmodules.vtkCommonDataModel  # noqa: F401
        except ImportError:
            self.skipTest("no VTK")
        grid = self.mesh.to_vtk()
        self.assertEqual(grid.GetNumberOfCells(), 162)
        again = bonetk.DensityMesh.from_vtk(grid)
        for name in ("points", "tetrahedra", "region", "degree", "coefficients", "quantity"):
            np.testing.assert_array_equal(getattr(again, name), getattr(self.mesh, name))

    def test_meshio(self):
        try:
            import meshio  # noqa: F401
        except ImportError:
            self.skipTest("no meshio")
        mesh = self.mesh.to_meshio()
        np.testing.assert_array_equal(mesh.points, self.mesh.points)
        np.testing.assert_array_equal(mesh.cells_dict["tetra"], self.mesh.tetrahedra)
        np.testing.assert_array_equal(mesh.cell_data["DensityCoefficients"][0], self.mesh.coefficients)

    def test_notebooks_show_a_picture(self):
        text = self.mesh._repr_html_()
        self.assertIn("data:image/png;base64,iVBOR", text)
        self.assertIn("162 tetrahedra", text)

    @unittest.skipIf(SANITIZED, "the sanitizer keeps freed memory")
    def test_memory_does_not_grow(self):
        def cycle(count):
            for _ in range(count):
                mesh = linear(box((1, 1, 1)))
                mesh.evaluate([[1, 1, 1]])
                view = mesh.points
                del mesh
                self.assertEqual(view.shape, (8, 3))

        cycle(300)
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        cycle(3000)
        self.assertLess(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before, 4000)


class Others(unittest.TestCase):
    def test_hierarchy(self):
        fine, coarse = linear(box()), linear(box((2, 2, 2)))
        hierarchy = bonetk.DensityHierarchy([fine, coarse])
        del fine, coarse
        gc.collect()
        self.assertEqual([len(level.tetrahedra) for level in hierarchy], [162, 48])
        self.assertEqual(len(hierarchy[-1].tetrahedra), 48)
        self.assertEqual(hierarchy.pick_by_count(100), 1)
        with self.assertRaises(IndexError):
            hierarchy[2]
        mesh = hierarchy[1]
        del hierarchy
        gc.collect()
        self.assertEqual(mesh.points.shape, (27, 3))

    def test_contours(self):
        angle = np.linspace(0, 2 * np.pi, 20, endpoint=False)
        circle = np.stack([10 * np.cos(angle), 10 * np.sin(angle), 0 * angle], axis=1)
        stack = bonetk.ContourStack([[bonetk.Contour(circle + [0, 0, z])] for z in (0, 5, 10)])
        self.assertEqual(len(stack), 3)
        np.testing.assert_array_equal(stack[1][0].points, circle + [0, 0, 5])
        self.assertFalse(stack[1][0].points.flags.writeable)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.vtp")
            bonetk.write_contours(stack, path)
            np.testing.assert_allclose(bonetk.read_contours(path)[2][0].points, circle + [0, 0, 10])
        circle[[3, 4]] = circle[[4, 3]]
        with self.assertRaises(bonetk.DataError):
            bonetk.ContourStack([[bonetk.Contour(circle)]])

    def test_model(self):
        rng = np.random.default_rng(3)
        mean = linear(box())
        modes = rng.normal(size=(2, 64, 3))
        subjects = {
            f"s{i}": mean.replace(points=mean.points + 0.2 * (a * modes[0] + b * modes[1]))
            for i, (a, b) in enumerate(rng.normal(size=(6, 2)))
        }
        model = bonetk.train(subjects)
        self.assertEqual(model.shape_modes.shape[0], 192)
        gram = model.shape_modes.T @ model.shape_modes
        np.testing.assert_allclose(gram, gram[0, 0] * np.eye(len(gram)), atol=1e-6)
        self.assertFalse(model.shape_modes.flags.writeable)
        self.assertEqual(list(model.subjects), list(subjects))
        names = list(subjects)
        first = bonetk.train({name: subjects[name] for name in names[:4]}, variance_proportion=1.0)
        both = bonetk.train({name: subjects[name] for name in names[4:]}, atlas=first)
        self.assertEqual(list(both.subjects), names)
        np.testing.assert_allclose(both.shape_variances, model.shape_variances, rtol=0.02)
        with self.assertRaisesRegex(bonetk.Error, "in the atlas already"):
            bonetk.train(subjects, atlas=first)
        np.testing.assert_allclose(model.synthesize().points, model.mean.points)
        made = model.synthesize([1.5]).points - model.mean.points
        wanted = 1.5 * np.sqrt(model.shape_variances[0]) * model.shape_modes[:, 0].reshape(-1, 3)
        np.testing.assert_allclose(made, wanted, atol=1e-9)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.h5")
            bonetk.write_model(model, path)
            np.testing.assert_array_equal(bonetk.read_model(path).shape_modes, model.shape_modes)
        view = model.shape_modes
        kept = view.copy()
        del model
        gc.collect()
        np.testing.assert_array_equal(view, kept)

    def test_geometry(self):
        view = bonetk.XRayGeometry.framing((0, 0, 0), (30, 24, 36), pixels=64)
        self.assertEqual(max(view.size), 64)
        again = bonetk.XRayGeometry.from_dict(view.to_dict())
        self.assertEqual(again.to_dict(), view.to_dict())
        self.assertEqual(pickle.loads(pickle.dumps(view)).to_dict(), view.to_dict())
        pixel = view.project([view.pixel_point(5, 9)])[0]
        np.testing.assert_allclose(pixel, (5, 9), atol=1e-9)
        x = np.array([3.0, 4.0, 5.0, 1.0])
        image = view.projection_matrix @ x
        np.testing.assert_allclose(image[:2] / image[2], view.project([x[:3]])[0])
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.json")
            bonetk.write_geometry([view, bonetk.XRayGeometry.carm(30, -10)], path)
            self.assertEqual(bonetk.read_geometry(path)[0].to_dict(), view.to_dict())
        with self.assertRaisesRegex(bonetk.UsageError, "detectorU"):
            bonetk.XRayGeometry.from_dict({"source": (0, 0, 0), "detectorOrigin": (0, 0, 0)})


if __name__ == "__main__":
    unittest.main()
