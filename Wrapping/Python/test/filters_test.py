"""Filters and functions in memory: laziness, parameters, lifetimes, interruption, and that none is missing."""
import gc
import os
import pathlib
import re
import resource
import signal
import threading
import time
import unittest

import numpy as np

import bonetk
from bodies import SANITIZED, box, linear, ramp_image

# Classes that are made by New() and are no filters of Python, and why.
NOT_FILTERS = {
    "ContourStack": "data",
    "DensityHierarchy": "data",
    "DensityMesh": "data",
    "MeshTrainingSet": "data: StatisticalModelEstimator.add_subject takes meshes",
    "FileTrainingSet": "data in files: bonetk.commands.train",
    "StatisticalModel": "data",
    "XRayGeometry": "data",
    "PlacementFilter": "a step of build, whose models are in their place",
    "RigidCostMetric": "for ITK's optimisers; those of Python take Projector",
}
FILTERS = [
    "SnakeContourFilter", "ContourSliceFilter", "ContourResampleFilter", "MedialAxisFilter", "ContourTilingMeshSource",
    "MeshQualityFilter", "TetraSmoothingFilter", "TetraSwapFilter", "TetraCollapseFilter", "HierarchyLevelFilter",
    "CorticalThicknessFilter", "DensityFitFilter", "DensityCalibrationFilter", "DensityImageFilter", "PhantomImageSource", "DRRImageFilter",
    "DRRDerivativeImageFilter", "DRRAdjointFilter", "VoxelDRRImageFilter", "AttenuationImageFilter",
    "IntensityImageFilter", "NoiseImageFilter", "StatisticalModelEstimator", "AtlasRegistrationFilter",
    "RigidRadiographRegistration", "DeformableRadiographRegistration", "AtlasVolumeRegistration",
    "RadiographPreprocessFilter",
]


class Inventory(unittest.TestCase):
    def test_every_filter_of_the_headers_is_wrapped(self):
        modules = pathlib.Path(__file__).resolve().parents[3] / "Modules"
        if not modules.is_dir():
            self.skipTest("the sources are not there")
        found = set()
        for header in modules.glob("*/include/**/*.h"):
            text = header.read_text()
            for body in re.split(r"\nclass (?=\w)", text)[1:]:
                if re.search(r"^\s*itk(Simple)?NewMacro\(Self\)", body.split("\n};")[0], re.MULTILINE):
                    found.add(re.match(r"\w+", body).group())
        self.assertIn("DensityFitFilter", found)
        missing = {name for name in found if not hasattr(bonetk, name)} - set(NOT_FILTERS)
        self.assertEqual(missing, set())
        self.assertEqual(set(NOT_FILTERS) - found, set())
        self.assertEqual(set(FILTERS), found - set(NOT_FILTERS))

    def test_every_parameter_reads_back(self):
        for name in FILTERS:
            f = getattr(bonetk, name)()
            for parameter in f.parameter_names:
                value = getattr(f, parameter)
                setattr(f, parameter, value)
                self.assertEqual(getattr(f, parameter), value, f"{name}.{parameter}")
                self.assertIn("Default:", getattr(type(f), parameter).__doc__)
            self.assertIn(name, repr(f))


class Parameters(unittest.TestCase):
    def test_out_of_range_is_refused_with_the_line_of_the_table(self):
        f = bonetk.DensityFitFilter()
        with self.assertRaisesRegex(bonetk.UsageError, r"^Degree is 9, but must be 0 to 8\.$"):
            f.degree = 9
        self.assertEqual(f.degree, 3)
        for value, pattern in (("3", "whole number"), (2.5, "whole number"), (True, "whole number"), (10**30, "whole")):
            with self.assertRaisesRegex(bonetk.UsageError, pattern):
                f.degree = value
        with self.assertRaisesRegex(bonetk.UsageError, "Interpolator .*none of linear, bspline"):
            f.interpolator = "cubic"
        with self.assertRaisesRegex(bonetk.UsageError, "True or False"):
            f.continuous = 1
        with self.assertRaisesRegex(bonetk.UsageError, "Tikhonov"):
            f.tikhonov = float("nan")

    def test_unknown_names_are_refused(self):
        with self.assertRaises(AttributeError):
            bonetk.DensityFitFilter().degre = 2
        with self.assertRaisesRegex(bonetk.UsageError, '"degre"; it has .*degree'):
            bonetk.fit_density(ramp_image(), box(), degre=2)

    def test_numpy_numbers_are_numbers(self):
        f = bonetk.DensityFitFilter()
        f.degree = np.int64(2)
        f.tikhonov = np.float32(0.5)
        f.continuous = np.bool_(True)
        self.assertEqual((f.degree, f.tikhonov, f.continuous), (2, 0.5, True))

    def test_lists(self):
        f = bonetk.TetraCollapseFilter()
        f.levels = np.array([100, 50])
        self.assertEqual(f.levels, [100, 50])
        with self.assertRaisesRegex(bonetk.UsageError, "Levels must be a whole number"):
            f.levels = [10.5]


class Pipelines(unittest.TestCase):
    def setUp(self):
        self.image = ramp_image()
        self.f = bonetk.DensityFitFilter()
        self.f.image = self.image
        self.f.mesh = box()
        self.f.degree = 1

    def test_a_fit_of_a_linear_image_is_exact(self):
        self.f.update()
        x = np.random.default_rng(4).uniform((1, 1, 1), (29, 23, 35), (200, 3))
        np.testing.assert_allclose(self.f.output.evaluate(x), 100 + x @ [3, -2, 5], rtol=1e-4)

    def test_thickness_of_a_rod(self):
        x, y, z = np.meshgrid(np.arange(40.0), np.arange(40.0), np.arange(40.0), indexing="ij")
        depth = np.clip(14.5 - np.hypot(x - 19.5, y - 19.5), -0.5, 4.5)
        values = np.where(depth < 4, np.clip(depth + 0.5, 0, 1), np.clip(4.5 - depth, 0, 1)) * 1400 + np.where(depth > 4, 200, 0)
        ct = bonetk.Image(values.transpose(2, 1, 0).astype(np.float32))
        mask = (np.hypot(x - 19.5, y - 19.5) < 14.5) & (z > 3) & (z < 36)
        labels = bonetk.Image(mask.transpose(2, 1, 0).astype(np.int16))
        f = bonetk.CorticalThicknessFilter()
        f.mesh = bonetk.build(ct, labels, tetrahedra=2000)[0]
        f.image = ct
        f.point_spread = 1.0
        f.cortical_density = 1400
        f.update()
        found = f.map["status"] == 1
        self.assertEqual(f.map["points"].shape, (len(found), 3))
        self.assertLess(f.map["triangles"].max(), len(found))
        np.testing.assert_array_equal(np.isnan(f.map["thickness"]), ~found)
        middle = found & (np.abs(f.map["points"][:, 2] - 19.5) < 10)
        self.assertGreater(middle.sum(), 50)
        self.assertAlmostEqual(np.median(f.map["thickness"][middle]), 4.0, delta=0.4)

    def test_runs_only_where_something_changed(self):
        runs = []
        self.f.update(runs.append)
        self.assertGreater(len(runs), 0)
        self.assertEqual(runs, sorted(runs))
        self.assertEqual(runs[-1], 1)
        runs.clear()
        self.f.degree = 1
        self.f.update(runs.append)
        self.assertEqual(runs, [])
        self.f.degree = 2
        self.f.update(runs.append)
        self.assertGreater(len(runs), 0)
        self.assertEqual(self.f.output.maximum_degree, 2)
        runs.clear()
        self.image.array[:] += 1
        self.image.modified()
        self.f.update(runs.append)
        self.assertGreater(len(runs), 0)

    def test_filters_in_a_row(self):
        level = bonetk.TetraCollapseFilter()
        level.mesh = self.f.output
        level.levels = [120]
        level.update()
        self.assertEqual(len(level.output), 2)
        self.assertEqual(level.output[0].maximum_degree, 1)
        self.f.degree = 2
        level.update()
        self.assertEqual(level.output[0].maximum_degree, 2)

    def test_a_filter_lives_as_long_as_its_output_is_needed(self):
        level = bonetk.TetraCollapseFilter()
        level.mesh = self.f.output
        level.levels = [120]
        del self.f
        gc.collect()
        level.update()
        self.assertEqual(level.output[0].maximum_degree, 1)
        output = level.output
        del level
        gc.collect()
        mesh = output[1]
        del output
        gc.collect()
        self.assertGreater(mesh.volume, 0)

    def test_arrays_stay_what_they_were(self):
        self.f.update()
        coefficients = self.f.output.coefficients
        kept = coefficients.copy()
        drr = bonetk.DRRImageFilter()
        drr.mesh = self.f.output
        drr.geometry = bonetk.XRayGeometry.framing((0, 0, 0), (30, 24, 36), pixels=40)
        drr.update()
        pixels = drr.output.array
        image = pixels.copy()
        self.f.degree = 3
        drr.geometry = bonetk.XRayGeometry.framing((0, 0, 0), (30, 24, 36), pixels=90)
        drr.update()
        np.testing.assert_array_equal(coefficients, kept)
        np.testing.assert_array_equal(pixels, image)
        self.assertNotEqual(drr.output.array.shape, pixels.shape)
        del drr
        self.f = None
        gc.collect()
        np.testing.assert_array_equal(coefficients, kept)
        np.testing.assert_array_equal(pixels, image)

    def test_outputs_before_an_update(self):
        raster = bonetk.DensityImageFilter()
        with self.assertRaisesRegex(bonetk.UsageError, "update"):
            raster.output.array
        with self.assertRaises(bonetk.DataError):
            bonetk.DensityFitFilter().update()

    def test_labels_must_be_whole(self):
        f = bonetk.SnakeContourFilter()
        with self.assertRaisesRegex(bonetk.UsageError, "int16"):
            f.labels = self.image

    def test_what_a_function_made_stands_alone(self):
        mesh = bonetk.fit_density(self.image, box(), degree=2)
        self.assertEqual(mesh.coefficients.ctypes.data, mesh.coefficients.ctypes.data)
        sampled = bonetk.sample(mesh, self.image, outside_value=-5.0)
        inside = sampled.array != -5
        self.assertGreater(inside.sum(), 1000)
        np.testing.assert_allclose(sampled.array[inside], self.image.array[inside], rtol=1e-3)

    def test_calibration_is_linear(self):
        mesh = linear(box())
        made = bonetk.calibrate(mesh, line=[10, 2], quantity="ha")
        self.assertEqual(made.quantity, "ha")
        np.testing.assert_allclose(made.coefficients, 10 + 2 * mesh.coefficients)

    @unittest.skipIf(SANITIZED, "the sanitizer keeps freed memory")
    def test_memory_does_not_grow(self):
        image = ramp_image(shape=(24, 22, 24))
        mesh = linear(box((1, 1, 1)))

        def cycle(count, make, **inputs):
            """Filters are made, run and let go."""
            for _ in range(count):
                f = make()
                f.mesh = mesh
                for name, value in inputs.items():
                    setattr(f, name, value)
                f.update()
                output = f.output
                view = output.coefficients
                del f
                self.assertEqual(view.shape, (6, 4))
                del output

        for count, make, inputs in ((10000, bonetk.DensityCalibrationFilter, dict(line=[1, 2], quantity="ha")),
                                    (1000, bonetk.DensityFitFilter, dict(image=image, degree=1))):
            cycle(count // 2, make, **inputs)
            before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
            cycle(count, make, **inputs)
            self.assertLess(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before, 1000, make.__name__)

    @unittest.skipIf(SANITIZED, "the sanitizer keeps freed memory")
    def test_asking_for_an_output_again_costs_nothing(self):
        output = self.f.output
        gc.collect()
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        for _ in range(200000):
            self.f.output
        self.assertLess(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before, 3000)
        self.assertIs(self.f.output, output)


class Interruption(unittest.TestCase):
    def setUp(self):
        self.f = bonetk.DensityFitFilter()
        self.f.image = ramp_image()
        self.f.mesh = box((12, 12, 12))
        self.f.degree = 4

    def test_what_progress_raises_comes_out(self):
        def progress(share):
            if share > 0.1:
                raise KeyError("enough")

        with self.assertRaisesRegex(KeyError, "enough"):
            self.f.update(progress)
        self.f.update()
        self.assertEqual(self.f.output.maximum_degree, 4)

    def test_what_is_raised_in_a_row_comes_out(self):
        level = bonetk.TetraCollapseFilter()
        level.mesh = self.f.output
        level.levels = [2000]
        with self.assertRaises(ZeroDivisionError):
            level.update(lambda share: 1 / 0)

    def test_ctrl_c_ends_the_work(self):
        phantom = bonetk.PhantomImageSource()
        phantom.set_phantom("femur")
        phantom.spacing = (0.5, 0.5, 0.5)
        timer = threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT))
        start = time.monotonic()
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            phantom.update()
        self.assertLess(time.monotonic() - start, 3)

    def test_other_threads_go_on(self):
        count = 0
        done = threading.Event()

        def work():
            self.f.update()
            done.set()

        thread = threading.Thread(target=work)
        thread.start()
        while not done.is_set():
            count += 1
            time.sleep(0.001)
        thread.join()
        self.assertGreater(count, 3)


class Stages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.ct, cls.labels = bonetk.phantom("femur", spacing=(3, 3, 3))

    def test_from_a_ct_to_levels(self):
        ct, labels = self.ct, self.labels
        stack = bonetk.contours(ct, labels)
        mesh = bonetk.tile(bonetk.medial_axes(bonetk.resample(stack, maximum_spacing=12)))
        self.assertTrue(mesh.validate()["valid"])
        mesh = bonetk.fit_density(ct, bonetk.improve(mesh, labels=labels), degree=1)
        levels = bonetk.simplify(mesh, [0.5])
        self.assertLess(len(levels[1].tetrahedra), 0.55 * len(levels[0].tetrahedra))
        self.assertAlmostEqual(levels[1].mass / levels[0].mass, 1, delta=0.02)

    def test_build(self):
        ct, labels = self.ct, self.labels
        seen = []
        model = bonetk.build(
            ct, bonetk.Image((labels.array > 0).astype(np.int16), labels.origin, labels.spacing, labels.direction),
            degree=1, tetrahedra=3000, levels=[0.5], progress=lambda stage, share: seen.append(stage),
        )
        self.assertEqual(len(model), 2)
        self.assertEqual(model[0].maximum_degree, 1)
        self.assertAlmostEqual(len(model[0].tetrahedra) / 3000, 1, delta=0.2)
        self.assertGreater(len(set(seen)), 5)
        with self.assertRaisesRegex(bonetk.UsageError, 'no parameter "levles"'):
            bonetk.build(ct, labels, levles=[1])
        with self.assertRaisesRegex(bonetk.UsageError, "Tetrahedra is 3"):
            bonetk.build(ct, labels, tetrahedra=3)

        def stop(stage, share):
            raise ValueError("enough")

        with self.assertRaisesRegex(ValueError, "enough"):
            bonetk.build(ct, labels, tetrahedra=3000, progress=stop)


if __name__ == "__main__":
    unittest.main()
