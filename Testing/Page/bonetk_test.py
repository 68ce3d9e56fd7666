#!/usr/bin/env python3
"""The pages that bonetk writes, in headless Chromium: is each bead where its place in the world says, in CTs of any orientation;
has the cut the model's density; do all commands' pages open. Run by run.mjs; BONETK is the program."""
import base64
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import nibabel
import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkMetaImageReader
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader, vtkXMLUnstructuredGridWriter

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
sys.path.insert(0, str(HERE.parent / "Integration"))
import bead_phantom as phantom  # noqa: E402
from bonetk_testing import bonetk, read_json, write_json  # noqa: E402

LETTERS = {letter: sign * numpy.eye(3)[axis] for axis, pair in enumerate(("LR", "PA", "SI")) for letter, sign in zip(pair, (1, -1))}
PLANES = {"sagittal": (0, "left"), "coronal": (1, "anterior"), "axial": (2, "superior")}  # axis, and whence it is seen
# To the right and upward in the picture, by whence it is seen.
VIEWS = {"anterior": "LS", "posterior": "RS", "left": "PS", "right": "AS", "superior": "RA", "inferior": "LA"}
YELLOW = (253, 231, 37)  # the colours' upper end


def must(*command):
    code, out, err = bonetk(*command)
    assert code == 0, f"bonetk {command}: {out}{err}"


def look(page, **request):
    """What look.mjs sees on a page."""
    with tempfile.TemporaryDirectory() as folder:
        asked, seen = os.path.join(folder, "asked.json"), os.path.join(folder, "seen.json")
        write_json({"page": os.path.abspath(page), **request}, asked)
        done = subprocess.run(["node", HERE / "look.mjs", asked, seen], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return read_json(seen)


def numbers(text, kind=numpy.float64):
    return numpy.frombuffer(base64.b64decode(text), kind)


def picture(seen):
    """Red, green, blue and alpha by row and column."""
    return numbers(seen["data"], numpy.uint8).reshape(seen["rows"], seen["columns"], 4).astype(int)


def eroded(mask, reach):
    """Pixels whose square of `reach` pixels on each side is in the mask."""
    size = 2 * reach + 1
    for axis in (0, 1):
        sums = numpy.cumsum(numpy.insert(mask.astype(int), 0, 0, axis), axis)
        length = sums.shape[axis]
        full = sums.take(range(size, length), axis) - sums.take(range(length - size), axis) == size
        padding = [(0, 0), (0, 0)]
        padding[axis] = (reach, reach)
        mask = numpy.pad(full, padding)
    return mask


def centre_of(mask):
    """Column and row."""
    rows, columns = numpy.nonzero(mask)
    assert len(rows), "there is nothing"
    return numpy.array([columns.mean(), rows.mean()])


def read_grid(path):
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def triangle_weights(degree, places):
    """The weights of a triangle's coefficients at barycentric coordinates (a row each)."""
    factorial = numpy.cumprod([1, *range(1, degree + 1)])
    terms = [(i, j, degree - i - j) for i in range(degree, -1, -1) for j in range(degree - i, -1, -1)]
    weights = [factorial[degree] / numpy.prod(factorial[list(term)]) for term in terms]
    return numpy.stack([weight * numpy.prod(places ** term, axis=1) for weight, term in zip(weights, terms)], axis=1)


def coefficients_of(model):
    return vtk_to_numpy(read_grid(model).GetCellData().GetArray("DensityCoefficients"))


class Cut:
    """A page's cut across an axis: triangles, each with a polynomial."""

    def __init__(self, seen, axis):
        self.corners = numbers(seen["points"]).reshape(-1, 3, 3)
        self.degree = seen["degree"]
        self.coefficients = numbers(seen["coefficients"]).reshape(len(self.corners), -1)
        self.axis = axis
        self.position = float(self.corners[0, 0, axis])

    def samples(self, divisions=4):
        """Places in all triangles, the density there, and the share of the area that each stands for."""
        steps = range(divisions + 1)
        places = numpy.array([(i, j, divisions - i - j) for i in steps for j in steps if i + j <= divisions]) / divisions
        sides = self.corners[:, 1:] - self.corners[:, :1]
        areas = numpy.linalg.norm(numpy.cross(sides[:, 0], sides[:, 1]), axis=1)
        return ((places @ self.corners).reshape(-1, 3), (self.coefficients @ triangle_weights(self.degree, places).T).ravel(),
                numpy.repeat(areas, len(places)))

    def on_grid(self, origin, spacing, shape):
        """The density at a grid's points in the plane (index [first other axis, second]); NaN beside the triangles."""
        image = numpy.full(shape, numpy.nan)
        flat = (numpy.delete(self.corners, self.axis, axis=2) - origin) / spacing
        for (a, b, c), coefficients in zip(flat, self.coefficients):
            low, high = numpy.ceil(numpy.min((a, b, c), axis=0)).astype(int), numpy.floor(numpy.max((a, b, c), axis=0)).astype(int)
            area = numpy.linalg.det([b - a, c - a])
            if (high < low).any() or area == 0:
                continue
            points = numpy.stack(numpy.mgrid[low[0]:high[0] + 1, low[1]:high[1] + 1], axis=-1).reshape(-1, 2)
            later = (points - a) @ numpy.linalg.inv([b - a, c - a])
            places = numpy.column_stack([1 - later.sum(axis=1), later])
            inside = (places >= 0).all(axis=1)
            if inside.any():
                image[tuple(points[inside].T)] = triangle_weights(self.degree, places[inside]) @ coefficients
        return image


def cut_differences(model, seen, axis, folder, spacing=0.2):
    """How far a page's cut across an axis is from what `bonetk voxels` (DensityImageFilter) makes of the model's file in the cut's
    plane, at each pixel that both have: absolute differences, and how many pixels one alone has."""
    cut = Cut(seen, axis)
    others = [i for i in range(3) if i != axis]
    low, high = cut.corners.min(axis=(0, 1))[others], cut.corners.max(axis=(0, 1))[others]
    shape = numpy.ceil((high - low) / spacing).astype(int) + 1
    affine = numpy.eye(4)
    size = [2, 2, 2]  # of which the first slice is the plane
    affine[axis, 3] = cut.position
    for i, other in enumerate(others):
        affine[other, other], affine[other, 3], size[other] = spacing, low[i], shape[i]
    plane, values = pathlib.Path(folder, "plane.nii"), pathlib.Path(folder, "values.nii")
    nibabel.save(nibabel.Nifti1Image(numpy.zeros(size, numpy.int16), numpy.diag([-1.0, -1, 1, 1]) @ affine), plane)
    outside = -9999
    must("voxels", model, "--like", plane, "--outside", outside, "-q", "-o", values)
    expected = numpy.asarray(nibabel.load(values).dataobj, float).take(0, axis)
    found = cut.on_grid(low, spacing, shape)
    has = [expected != outside, ~numpy.isnan(found)]
    return numpy.abs(expected - found)[has[0] & has[1]], (has[0] != has[1]).sum()


class Beads(unittest.TestCase):
    """A build of the bone with beads in each orientation; its page is looked at once."""

    seen = {}  # by orientation

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        for name in phantom.ORIENTATIONS:
            place = pathlib.Path(cls.folder.name, name)
            place.mkdir()
            affine, size = phantom.write(name, place / "ct.nii.gz", place / "l.nii.gz")
            must("build", place / "ct.nii.gz", "--labels", place / "l.nii.gz", "--tetrahedra", 4000, "--levels", 0.4, "--degree", 2,
                 "-q", "-o", place / "m")
            index = numpy.linalg.inv(affine)
            wanted = [float((index[:3, :3] @ bead + index[:3, 3])[2]) for bead in phantom.BEADS.values()]
            first = list(phantom.BEADS.values())[0]
            cuts = [{"level": 0, "orientation": plane, "position": float(first[axis]), "view": view}
                    for plane, (axis, view) in PLANES.items()]
            if name == "oblique":
                cuts += [{"level": 1, "orientation": plane, "position": float(first[axis])} for plane, (axis, _) in PLANES.items()]
            points = {bead: x.tolist() for bead, x in phantom.BEADS.items()}
            cls.seen[name] = {"place": place, "affine": affine, "size": size,
                              **look(place / "m" / "report.html", points=points, slices=wanted, cuts=cuts)}

    def test_pages_are_rendered_and_ask_for_nothing(self):
        for seen in self.seen.values():
            self.assertEqual((seen["title"], seen["log"]), ("BoneTK report: ct.nii.gz \u2013 rendered", []))

    def test_slices_titles_name_the_slice_of_the_file_and_its_place(self):
        for seen in self.seen.values():
            affine = seen["affine"]
            for k, bead in zip(seen["slices"], phantom.BEADS.values()):
                normal = affine[:3, 2] / numpy.linalg.norm(affine[:3, 2])
                height = float(normal @ (affine @ [0, 0, k["number"], 1])[:3])
                self.assertTrue(0 <= k["number"] < seen["size"][2])
                self.assertLess(abs(normal @ bead - height), phantom.BEAD - 1)
                axis = numpy.abs(normal).argmax()
                if abs(normal[axis]) > 0.999:
                    said = re.fullmatch(r"CT slice \d+, ([xyz]) = (\S+) mm", k["title"].replace("\u2212", "-"))
                    self.assertEqual(said[1], "xyz"[axis])
                    self.assertAlmostEqual(float(said[2]), height * normal[axis], delta=0.051)
                    continue
                said = re.fullmatch(r"CT slice \d+, (\S+) mm along \((\S+), (\S+), (\S+)\)", k["title"].replace("\u2212", "-"))
                value, *along = map(float, said.groups())
                self.assertLess(abs(abs(numpy.dot(along, normal)) - 1), 0.01)
                self.assertAlmostEqual(value, height * numpy.sign(numpy.dot(along, normal)), delta=0.06)

    def test_slices_show_each_bead_where_the_letters_say(self):
        square = phantom.POSE @ numpy.diag(phantom.AXES ** 2) @ phantom.POSE.T
        for seen in self.seen.values():
            affine = seen["affine"]
            normal = affine[:3, 2] / numpy.linalg.norm(affine[:3, 2])
            world, shown = [], []
            for k, bead in zip(seen["slices"], phantom.BEADS.values()):
                grey = picture(k)[..., 0]
                mm = seen["millimetres"] / k["columns"]
                bone = grey > 20
                spot = eroded(bone, int(5.5 / mm)) & (grey > 160)
                shown.append(mm * (centre_of(spot) - centre_of(bone)))
                height = normal @ (affine @ [0, 0, k["number"], 1])[:3] - normal @ phantom.CENTRE
                middle = phantom.CENTRE + square @ normal * height / (normal @ square @ normal)
                offset = bead - middle
                world.append(offset - (offset @ normal) * normal)
            # Three beads say which directions of the plane run to the right and down.
            fit, *_ = numpy.linalg.lstsq(numpy.vstack([world, 100 * normal]), numpy.vstack([shown, [0, 0]]), rcond=None)
            error = numpy.abs(numpy.array(world) @ fit - shown).max()
            self.assertLess(error, 0.6, f"mm: {world} is shown at {shown}")
            right, down = fit.T
            self.assertLess(numpy.abs(fit.T @ fit - numpy.eye(2)).max(), 0.1, "neither stretched nor sheared")
            for side, direction in (("right", right), ("left", -right), ("bottom", down), ("top", -down)):
                letters = seen["letters"][side]
                self.assertEqual(numpy.abs(direction).argmax(), numpy.abs(LETTERS[letters[0]]).argmax(), f"{side} {letters}")
                for letter in letters:
                    self.assertGreater(direction @ LETTERS[letter], 0.15, f"{side} is said to be {letters}, and is {direction}")

    def test_views_show_each_bead_on_its_side(self):
        for seen in self.seen.values():
            for view, letters in VIEWS.items():
                places = {bead: numpy.array(place) for bead, place in seen["views"][view].items()}
                for a in phantom.BEADS:
                    for b in phantom.BEADS:
                        offset = phantom.BEADS[a] - phantom.BEADS[b]
                        rightward, downward = places[a] - places[b]
                        self.assertEqual(numpy.sign(round(rightward, 3)), numpy.sign(offset @ LETTERS[letters[0]]), view)
                        self.assertEqual(numpy.sign(round(-downward, 3)), numpy.sign(offset @ LETTERS[letters[1]]), view)

    def test_cuts_are_densest_at_the_bead_and_show_it_on_its_side(self):
        bead = phantom.BEADS["left anterior superior"]
        for seen in self.seen.values():
            for (plane, (axis, view)), cut in zip(PLANES.items(), seen["cuts"]):
                points, densities, areas = Cut(cut, axis).samples()
                self.assertLess(numpy.abs(points[:, axis] - bead[axis]).max(), 0.3)
                high = densities > 0.6 * phantom.DENSITY["bead"]
                dense = numpy.average(points[high], axis=0, weights=areas[high])
                self.assertLess(numpy.linalg.norm(dense - bead), 2, f"{plane}: {dense}, not {bead}")
                pixels = picture(cut["picture"])[:, :, :3]
                background = pixels[3, 3]
                bone = numpy.abs(pixels - background).max(axis=2) > 12
                bone[-110:, -110:] = False  # the cube that shows the directions
                spot = eroded(bone, 55) & (numpy.abs(pixels - YELLOW).max(axis=2) < 30)
                rightward, downward = centre_of(spot) - centre_of(bone)
                offset = bead - phantom.CENTRE
                self.assertGreater(rightward * (offset @ LETTERS[VIEWS[view][0]]), 0, f"{plane} seen from {view}")
                self.assertLess(downward * (offset @ LETTERS[VIEWS[view][1]]), 0, f"{plane} seen from {view}")

    def test_the_cut_has_the_models_density_all_over_the_plane(self):
        seen = self.seen["oblique"]
        models = [seen["place"] / "m" / f"model_L{level}.vtu" for level in (1, 2)]
        print(f"\n{'plane':9}{'level':>6}{'pixels':>7}  mean, largest difference (HU)")
        for k, cut in enumerate(seen["cuts"]):
            model, plane = models[k // 3], list(PLANES)[k % 3]
            self.assertEqual(cut["cells"], read_grid(model).GetNumberOfCells())
            differences, alone = cut_differences(model, cut, PLANES[plane][0], seen["place"])
            print(f"{plane:9}{k // 3 + 1:6}{len(differences):7}  {differences.mean():.2f}, {differences.max():.1f}")
            self.assertGreater(len(differences), 30000)
            self.assertLess(alone, 0.002 * len(differences))
            # A page rounds coefficients to a 500th of the range of 98 % of them: by a quarter of that on average, points besides.
            step = numpy.ptp(numpy.percentile(coefficients_of(model), (1, 99))) / 500
            self.assertLess(differences.mean(), 0.5 * step)

    def test_radiographs_show_each_bead_where_the_geometry_projects_it(self):
        for seen in self.seen.values():
            folder = seen["place"] / "m"
            geometry = read_json(folder / "drr_geometry.json")
            reader = vtkMetaImageReader()
            reader.SetFileName(str(folder / "drr_L1.mha"))
            reader.Update()
            columns, rows, _ = reader.GetOutput().GetDimensions()
            image = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).reshape(rows, columns)
            self.assertEqual([columns, rows], geometry["size"])
            source, origin, u, v = (numpy.array(geometry[key]) for key in ("source", "detectorOrigin", "detectorU", "detectorV"))
            for letters, direction in zip("LI", (u, v)):  # as one faces the patient
                self.assertGreater(direction @ LETTERS[letters], 0.9)
            beam = numpy.cross(u, v)
            for name, bead in phantom.BEADS.items():
                hit = source + (bead - source) * (beam @ (origin - source)) / (beam @ (bead - source))
                expected = numpy.array([u @ (hit - origin), v @ (hit - origin)]) / geometry["spacing"]
                found = self.peak(image, expected, 14 / geometry["spacing"][0])
                error = numpy.linalg.norm(found - expected) * geometry["spacing"][0]
                self.assertLess(error, 4.0, f"{name}: {found}, not {expected}")

    @staticmethod
    def peak(image, expected, reach):
        """Column and row of the middle of what is brighter than the surroundings within `reach` pixels of a place."""
        rows, columns = numpy.mgrid[:image.shape[0], :image.shape[1]]
        distance = numpy.hypot(columns - expected[0], rows - expected[1])
        ring, inside = (distance < reach) & (distance > 0.75 * reach), distance < reach
        terms = lambda mask: numpy.stack([numpy.ones(mask.sum()), columns[mask], rows[mask]], axis=1)
        plane, *_ = numpy.linalg.lstsq(terms(ring), image[ring], rcond=None)
        excess = numpy.zeros(image.shape)
        excess[inside] = image[inside] - terms(inside) @ plane
        return centre_of(excess > 0.6 * excess.max())


class Commands(unittest.TestCase):
    """Pages of the other commands open."""

    @classmethod
    def setUpClass(cls):
        """A small model in the folder of each test."""
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.place = pathlib.Path(folder.name)
        phantom.write("RAS", cls.place / "ct.nii.gz", cls.place / "l.nii.gz")
        must("build", cls.place / "ct.nii.gz", "--labels", cls.place / "l.nii.gz", "--tetrahedra", 2000, "--levels", 0.8, "--degree",
             1, "-q", "--no-page", "-o", cls.place / "m")
        cls.model = cls.place / "m" / "model_L1.vtu"

    def opened(self, page, **request):
        seen = look(self.place / page, **request)
        self.assertRegex(seen["title"], "^BoneTK report: .+ \u2013 rendered$")
        self.assertEqual(seen["log"], [])
        return seen

    def subject(self, path, longer, denser):
        """A model as the one at hand, longer and denser."""
        grid = read_grid(self.model)
        points = vtk_to_numpy(grid.GetPoints().GetData())
        points[:, 2] *= longer
        coefficients = vtk_to_numpy(grid.GetCellData().GetArray("DensityCoefficients"))
        coefficients *= denser
        grid.GetCellData().RemoveArray("MeanDensity")
        grid.GetPointData().RemoveArray("Density")
        writer = vtkXMLUnstructuredGridWriter()
        writer.SetFileName(str(path))
        writer.SetInputData(grid)
        writer.Write()

    def test_no_page_where_none_is_asked_for(self):
        self.assertFalse((self.place / "m" / "report.html").exists())

    def test_train(self):
        names = [f"s{i}.vtu" for i in range(4)]
        for name, longer, denser in zip(names, (0.9, 1.0, 1.04, 1.12), (1.0, 0.8, 1.3, 1.1)):
            self.subject(self.place / name, longer, denser)
        (self.place / "list.txt").write_text("\n".join(names) + "\n")
        must("train", self.place / "list.txt", "-q", "-o", self.place / "atlas.h5")
        for mode in ("shape", "density"):
            canvases = ["#view3d canvas", ".radiograph canvas"]
            seen = self.opened("atlas.html", change={"control": f"#mode-{mode}-1", "value": 2.5, "canvases": canvases})
            for canvas, before, after in zip(canvases, seen["before"], seen["after"]):
                before, after = picture(before), picture(after)
                self.assertEqual(before.shape, after.shape)
                self.assertGreater((before != after).any(axis=2).mean(), 0.005, f"{mode}: {canvas} stays as it is")

    def test_register(self):
        geometry = self.place / "m" / "drr_geometry.json"
        must("drr", self.model, "--geometry", geometry, "--attenuation", "-q", "-o", self.place / "x.mha")
        bonetk("register", "rigid", self.model, "--xray", self.place / "x.mha", "--geometry", geometry, "--pixels", 96, "-q", "-o",
               self.place / "pose")
        self.opened("pose.html")

    def test_measure(self):
        must("measure", self.model, "-q", "-o", self.place / "measures.json")
        self.opened("measures.html")

    def test_export(self):
        must("export", self.model, "--format", "calculix", "--law", "keyak1998", "--line", 0.02, 0.0008, "-q", "-o",
             self.place / "solid.inp")
        self.opened("solid.html")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v", *sys.argv[1:]])
