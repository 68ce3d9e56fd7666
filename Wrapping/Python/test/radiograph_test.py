"""Radiographs and their derivatives against closed forms and finite differences."""
import unittest

import numpy as np

import bonetk
from bodies import box, bump, linear, ramp_image

try:
    import torch
except ImportError:
    torch = None


def view(pixels=48):
    return bonetk.XRayGeometry.framing((-3, -3, -3), (33, 27, 39), beam=(0.6, 1, 0.5), up=(-0.2, -0.4, 1), pixels=pixels)


class Radiographs(unittest.TestCase):
    def setUp(self):
        self.mesh = linear(box())
        self.view = view()

    def test_a_box_of_ones_shows_its_chords(self):
        ones = box().replace(coefficients=np.ones((162, 1)))
        image = bonetk.drr(ones, self.view).array[0]
        columns, rows = self.view.size
        source = np.array(self.view.source)
        for column, row in ((columns // 2, rows // 2), (columns // 3, rows // 2), (columns // 2, rows // 4)):
            way = np.array(self.view.pixel_point(column, row)) - source
            with np.errstate(divide="ignore"):
                cuts = np.sort([(np.zeros(3) - source) / way, (np.array([30, 24, 36]) - source) / way], axis=0)
            chord = max(0.0, cuts[1].min() - cuts[0].max()) * np.linalg.norm(way)
            self.assertAlmostEqual(image[row, column], chord, delta=1e-3)

    def test_all_ways_to_a_radiograph_agree(self):
        image = bonetk.drr(self.mesh, self.view)
        self.assertEqual(image.array.shape, (1, self.view.size[1], self.view.size[0]))
        projector = bonetk.Projector(self.mesh)
        scale = image.array.max()
        value, _ = bonetk.drr_vjp(self.mesh, self.view)
        derived, _ = bonetk.drr_derivatives(self.mesh, self.view)
        for other in (projector(self.view), value, derived):
            np.testing.assert_allclose(other, image.array[0], atol=1e-5 * scale)

    def test_parameters_reach_the_kernels(self):
        half = bonetk.Projector(self.mesh, maximum_region=1)(self.view)
        rest = bonetk.Projector(self.mesh, minimum_region=2)(self.view)
        np.testing.assert_allclose(half + rest, bonetk.Projector(self.mesh)(self.view), atol=0.1)
        water = bonetk.Projector(self.mesh, hu_to_attenuation="water")(self.view)
        self.assertLess(water.max(), 2)
        with self.assertRaisesRegex(bonetk.UsageError, 'no parameter "region"'):
            bonetk.Projector(self.mesh, region=1)
        with self.assertRaises(bonetk.DataError):
            bonetk.Projector(box())

    def test_a_ct_and_its_mask(self):
        image = ramp_image()
        whole = bonetk.drr(image, self.view)
        mask = np.zeros(image.shape, dtype=np.int16)
        mask[5:10] = 3
        part = bonetk.drr(image, self.view, mask=bonetk.Image(mask, image.origin, image.spacing), mask_label=3)
        self.assertGreater(whole.array.max(), part.array.max())
        self.assertGreater(part.array.max(), 0)

    def test_a_pose_moves_the_mesh(self):
        pose = np.array([2.0, -1.0, 3.0, 0.2, -0.1, 0.3])
        projector = bonetk.Projector(self.mesh)
        centre = np.array(projector.centre)
        angle = np.linalg.norm(pose[3:])
        axis = pose[3:] / angle
        cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
        turn = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
        moved = self.mesh.replace(points=(self.mesh.points - centre) @ turn.T + centre + pose[:3])
        image = bonetk.Projector(moved)(self.view)
        np.testing.assert_allclose(projector(self.view, pose), image, atol=1e-4 * image.max())

    def test_a_view_holds_a_box_of_any_depth(self):
        lower, upper = (-300, 0, 0), (300, 50, 50)
        view = bonetk.XRayGeometry.framing(lower, upper, beam=(1, 0, 0), pixels=64)
        self.assertLessEqual(np.max(view.project([lower, upper])), 64)
        usual = bonetk.XRayGeometry.framing(lower, upper)
        self.assertEqual(usual.to_dict(), bonetk.XRayGeometry.framing(lower, upper, source_to_centre=1000).to_dict())
        with self.assertRaisesRegex(bonetk.DataError, "1300.* between the source and the detector at 1200 mm"):
            bonetk.XRayGeometry.framing(lower, upper, beam=(1, 0, 0), source_to_detector=1200)

    def test_many_poses_at_once_are_those_of_each(self):
        poses = np.random.default_rng(1).uniform(-0.2, 0.2, (40, 6))
        projector = bonetk.Projector(self.mesh)
        images = projector(self.view, poses)
        self.assertEqual(images.shape, (40, self.view.size[1], self.view.size[0]))
        for pose, image in zip(poses, images):
            np.testing.assert_array_equal(image, projector(self.view, pose))
        self.assertEqual(projector(self.view, poses[:1]).shape, (1, *images.shape[1:]))
        self.assertEqual(projector(self.view, poses[:0]).shape, (0, *images.shape[1:]))
        with self.assertRaisesRegex(bonetk.UsageError, "n x 6"):
            projector(self.view, np.zeros((6, 5)))
        with self.assertRaisesRegex(bonetk.UsageError, "six numbers"):
            projector(self.view, "there")


class Derivatives(unittest.TestCase):
    """Of a smooth number of radiographs without edges, as single pixels and edges have kinks."""

    def setUp(self):
        self.mesh = bump(box((4, 4, 4)))
        self.view = view(160)
        rows, columns = self.view.size[1], self.view.size[0]
        r, c = np.meshgrid(np.linspace(-1, 1, rows), np.linspace(-1, 1, columns), indexing="ij")
        self.weights = (np.cos(1.3 * r + 0.4) * np.cos(1.1 * c - 0.2)).astype(np.float32)
        self.pose = np.array([1.0, -2.0, 0.5, 0.15, -0.1, 0.2])
        self.projector = bonetk.Projector(self.mesh)

    def number(self, image):
        return float((self.weights.astype(float) * image).sum())

    def differences(self, of, at, step):
        return np.array([(of(at + step * e) - of(at - step * e)) / (2 * step) for e in np.eye(len(at))])

    def test_pose(self):
        for pose in (np.zeros(6), self.pose):
            wanted = self.differences(lambda p: self.number(self.projector(self.view, p)), pose, 0.004)
            value, pullback = self.projector.vjp(self.view, pose)
            gradient = pullback(self.weights)["pose"]
            np.testing.assert_allclose(gradient, wanted, atol=0.002 * np.abs(wanted).max())
            image, derivatives = self.projector.derivatives(self.view, pose)
            forward = np.array([self.number(d) for d in derivatives])
            np.testing.assert_allclose(forward, gradient, atol=2e-4 * np.abs(wanted).max())
            np.testing.assert_allclose(image, value, atol=1e-4 * value.max())

    def test_coefficients_are_exact(self):
        change = np.random.default_rng(5).normal(size=self.mesh.coefficients.shape)
        gradient = self.projector.vjp(self.view, self.pose)[1](self.weights)["coefficients"]
        changed = bonetk.Projector(self.mesh.replace(coefficients=self.mesh.coefficients + change))
        centre = self.projector.centre
        wanted = self.number(changed(self.view, self.pose, centre)) - self.number(self.projector(self.view, self.pose))
        self.assertAlmostEqual((gradient * change).sum() / wanted, 1, delta=1e-3)
        _, forward = self.projector.derivatives(self.view, self.pose, by_pose=False, density=[change])
        self.assertEqual(forward.shape, (1, *self.weights.shape))
        self.assertAlmostEqual(self.number(forward[0]) / wanted, 1, delta=1e-3)

    def test_points(self):
        shift = np.random.default_rng(6).normal(size=self.mesh.points.shape)
        centre = self.projector.centre

        def of(step):
            moved = bonetk.Projector(self.mesh.replace(points=self.mesh.points + step[0] * shift))
            return self.number(moved(self.view, self.pose, centre))

        wanted = self.differences(of, np.zeros(1), 0.02)[0]
        gradient = self.projector.vjp(self.view, self.pose)[1](self.weights)["points"]
        self.assertAlmostEqual((gradient * shift).sum() / wanted, 1, delta=0.02)
        _, forward = self.projector.derivatives(self.view, self.pose, by_pose=False, shape=[shift])
        self.assertAlmostEqual(self.number(forward[0]) / (gradient * shift).sum(), 1, delta=1e-3)

    def test_filters_give_the_same(self):
        f = bonetk.DRRDerivativeImageFilter()
        f.mesh = self.mesh
        f.geometry = self.view
        f.set_modes(pose=True, pose_centre=self.projector.centre)
        f.update()
        _, derivatives = self.projector.derivatives(self.view)
        for mode in range(6):
            np.testing.assert_allclose(
                f.derivative(mode).array[0], derivatives[mode], atol=1e-4 * np.abs(derivatives[mode]).max()
            )
        with self.assertRaisesRegex(bonetk.UsageError, "no mode 6"):
            f.derivative(6)
        adjoint = bonetk.DRRAdjointFilter()
        adjoint.mesh = self.mesh
        adjoint.geometry = self.view
        adjoint.image = self.weights[np.newaxis]
        adjoint.update()
        gradient = bonetk.drr_vjp(self.mesh, self.view)[1](self.weights)
        np.testing.assert_allclose(adjoint.output.coefficients, gradient["coefficients"])
        np.testing.assert_allclose(adjoint.point_gradient, gradient["points"])

    def test_a_wrong_cotangent_is_refused(self):
        _, pullback = bonetk.drr_vjp(self.mesh, self.view)
        with self.assertRaisesRegex(bonetk.UsageError, "radiograph's"):
            pullback(self.weights[:-1])
        with self.assertRaisesRegex(bonetk.UsageError, "six numbers"):
            bonetk.drr_vjp(self.mesh, self.view, [1, 2])

    def test_a_radiograph_is_a_node_of_a_graph(self):
        """Of a number that depends on it by Beer's law, and it on logarithms of densities: by torch where it is there."""
        change = np.random.default_rng(7).normal(size=self.mesh.coefficients.shape)
        start = 0.1 * np.random.default_rng(8).normal(size=change.shape)
        attenuation = 1 / bonetk.drr(self.mesh, self.view).array.max()

        def node(coefficients):
            value, pullback = bonetk.drr_vjp(self.mesh.replace(coefficients=coefficients), self.view)
            return value, lambda cotangent: pullback(cotangent.astype(np.float32))["coefficients"]

        def gradient_by_hand():
            coefficients = self.mesh.coefficients * np.exp(start)
            integrals, pullback = node(coefficients)
            of_integrals = -attenuation * self.weights * np.exp(-attenuation * integrals)
            return pullback(of_integrals) * coefficients

        def gradient_by_torch():
            class Radiograph(torch.autograd.Function):
                @staticmethod
                def forward(context, coefficients):
                    value, context.pullback = node(coefficients.detach().numpy())
                    return torch.from_numpy(value.copy())

                @staticmethod
                def backward(context, cotangent):
                    return torch.from_numpy(context.pullback(cotangent.numpy()))

            parameters = torch.from_numpy(start).requires_grad_()
            integrals = Radiograph.apply(torch.from_numpy(self.mesh.coefficients) * torch.exp(parameters))
            (torch.from_numpy(self.weights) * torch.exp(-attenuation * integrals)).sum().backward()
            return parameters.grad.numpy()

        def cost(step):
            integrals, _ = node(self.mesh.coefficients * np.exp(start + step[0] * change))
            return self.number(np.exp(-attenuation * integrals.astype(float)))

        wanted = self.differences(cost, np.zeros(1), 0.02)[0]
        gradient = gradient_by_torch() if torch else gradient_by_hand()
        self.assertAlmostEqual((gradient * change).sum() / wanted, 1, delta=0.005)

    def test_a_pose_is_found_again(self):
        from scipy.optimize import minimize

        wanted = self.projector(self.view, [1.5, 0, -2, 0.05, 0.08, -0.04])

        def cost(pose):
            image, pullback = self.projector.vjp(self.view, pose)
            error = image - wanted
            return float((error.astype(float) ** 2).mean()), pullback(2 * error / error.size)["pose"]

        found = minimize(cost, np.zeros(6), jac=True, method="BFGS", options={"gtol": 1e-3})
        self.assertLess(found.fun, 1e-3 * cost(np.zeros(6))[0])


class Registration(unittest.TestCase):
    def test_rigid(self):
        ct, labels = bonetk.phantom("femur", spacing=(3, 3, 3))
        stack = bonetk.contours(ct, labels)
        mesh = bonetk.tile(bonetk.medial_axes(bonetk.resample(stack, maximum_spacing=12)))
        mesh = bonetk.fit_density(ct, mesh, degree=1)
        lower, upper = mesh.points.min(axis=0) - 10, mesh.points.max(axis=0) + 10
        views = [bonetk.XRayGeometry.framing(lower, upper, beam=b, pixels=128) for b in ((0, 1, 0), (1, 0, 0))]
        pose = [2, -1, 1, 0.02, -0.03, 0.04]
        projector = bonetk.Projector(mesh, hu_to_attenuation="water")
        result = bonetk.register_rigid(
            mesh, [(projector(v, pose), v) for v in views], search_translation=5, search_rotation=5
        )
        self.assertEqual(result["quality"], "ok")
        moved = (result["transform"] @ [*projector.centre, 1])[:3]
        np.testing.assert_allclose(moved, np.array(projector.centre) + pose[:3], atol=0.3)


if __name__ == "__main__":
    unittest.main()
