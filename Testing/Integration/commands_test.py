#!/usr/bin/env python3
"""The commands one after the other on a small phantom, the example programs, and what `info` and `validate` say."""
import json
import os
import pathlib
import re
import subprocess

import numpy
import nibabel

from bonetk_testing import BONETK, EXAMPLES, TestCase, bonetk, main, phantom, read_json, run, write_json

GEOMETRY = {"source": [20, -900, -60], "detectorOrigin": [-100, 200, 80], "detectorU": [1, 0, 0],
            "detectorV": [0, 0, -1], "size": [64, 80], "spacing": [4, 4]}


class Commands(TestCase):
    def test_stage_by_stage(self):
        phantom("--bone", "femur", "--noise", 10, every=2)
        labels = numpy.asarray(nibabel.load("l.nii.gz").dataobj)
        self.assertEqual(sorted(numpy.unique(labels)), [0, 1, 2, 3])
        _, err = self.succeed("contours", "ct.nii.gz", "--labels", "l.nii.gz", "--slice-step", 6, "--contour-spacing", 7,
                              "-o", "c.vtp")
        self.assertIn("warning", err)  # the shaft is cut by the image's border
        out, _ = self.succeed("mesh", "c.vtp", "-o", "m.vtu")
        self.assertIn("span length", out)
        self.succeed("mesh", "c.vtp", "--ct", "ct.nii.gz", "-o", "m2.vtu")
        for method in ("laplacian", "smart", "enhanced"):
            self.succeed("smooth", "m.vtu", "--method", method, "--iterations", 2, "-o", method + ".vtu")
        self.succeed("smooth", "m.vtu", "--iterations", 2, "-o", "s.vtu")
        self.succeed("smooth", "m.vtu", "--contours", "c.vtp", "--labels", "l.nii.gz", "-o", "sl.vtu")
        self.refuse("smooth", "m.vtu", "--labels", "l.nii.gz", "--label", 9, "-o", "bad.vtu", says="label 9")
        self.refuse("smooth", "m.vtu", "--labels", "l.nii.gz", "--method", "smart", "-o", "bad.vtu", code=2,
                    says="--labels")
        self.succeed("fit", "ct.nii.gz", "s.vtu", "--degree", 2, "-o", "d.vtu")
        self.succeed("fit", "ct.nii.gz", "d.vtu", "--degree", 1, "--continuous", "-o", "d1.vtu")
        self.succeed("fit", "ct.nii.gz", "d.vtu", "--continuous-gradient", "-o", "c1.vtu")
        self.succeed("simplify", "d.vtu", "--tetrahedra", 2500, 1500, "-o", "h")
        self.assertEqual(sorted(f for f in os.listdir() if f.startswith("h")),
                         ["h.hierarchy.json", "h_L1.vtu", "h_L2.vtu", "h_L3.vtu"])
        for mesh in ("m.vtu", "m2.vtu", "smart.vtu", "enhanced.vtu", "s.vtu", "sl.vtu", "d.vtu", "d1.vtu", "c1.vtu", "h_L2.vtu", "h_L3.vtu"):
            out, _ = self.succeed("validate", mesh)
            self.assertNotIn("FAILED", out, mesh)
        levels = read_json("h.hierarchy.json")["levels"]
        self.assertLess(levels[1]["tetrahedra"], levels[0]["tetrahedra"])
        self.assertEqual(len(levels[2]["parentPoint"]), levels[2]["points"])

        write_json(GEOMETRY, "g.json")
        self.succeed("drr", "d.vtu", "--geometry", "g.json", "-o", "model.nii.gz")
        self.succeed("drr", "ct.nii.gz", "--mask", "l.nii.gz", "--geometry", "g.json", "-o", "ct_drr.nii.gz")
        model = numpy.asarray(nibabel.load("model.nii.gz").dataobj)
        voxels = numpy.asarray(nibabel.load("ct_drr.nii.gz").dataobj)
        self.assertEqual(model.shape[:2], (64, 80))
        self.assertLess(numpy.abs(model - voxels).mean(), 0.05 * voxels.max())
        write_json([GEOMETRY, GEOMETRY], "two.json")
        self.succeed("drr", "d.vtu", "--geometry", "two.json", "-o", "views.mha")
        self.assertTrue(os.path.exists("views_V1.mha") and os.path.exists("views_V2.mha"))
        self.drr_options(model)

        for file, says in (("ct.nii.gz", "image"), ("l.nii.gz", "image"), ("c.vtp", "contours"), ("d.vtu", "degree 2"),
                           ("h.hierarchy.json", "hierarchy"), ("g.json", "X-ray view"), ("views_V1.mha", "image")):
            out, err = self.succeed("info", file)
            self.assertIn(says, out)
            self.assertEqual(err, "")

    def drr_options(self, model):
        def pixels(*options):
            self.succeed("drr", "d.vtu", "--geometry", "g.json", *options, "-o", "o.nii.gz")
            return numpy.asarray(nibabel.load("o.nii.gz").dataobj)

        parts = [pixels("--region", region) for region in ("cortical", "trabecular", 3)]
        self.assertLess(numpy.abs(sum(parts) - model).max(), 1e-4 * model.max())
        integrals = pixels("--attenuation")
        seen = pixels("--attenuation", "--intensity", 1000)
        self.assertLess(numpy.abs(seen - 1000 * numpy.exp(-integrals)).max(), 0.01)
        noisy = pixels("--attenuation", "--intensity", 1000, "--noise", 7)
        self.assertLess(numpy.abs(noisy - numpy.round(noisy)).max(), 1e-3)
        self.assertAlmostEqual(((noisy - seen) ** 2 / seen).mean(), 1, delta=0.1)
        for convention, name in (("view", "v.json"), ("matrix", "m.json"), ("plastimatch", "p.json"), ("rtk", "r.xml")):
            out, _ = self.succeed("drr", "d.vtu", "--geometry", "g.json", "--save-geometry", name, "--convention",
                                  convention, "-o", "o.nii.gz")
            if convention == "rtk":
                numbers = re.search(r"size (\S+) (\S+), spacing +(\S+) +(\S+), origin +(\S+) +([^\s,]+)", out).groups()
                numbers = [float(n) for n in numbers]
                write_json({"rtk": name, "size": [int(n) for n in numbers[:2]], "spacing": numbers[2:4],
                            "origin": numbers[4:], "rowsDown": "direction" in out}, "r.json")
                name = "r.json"
            self.succeed("drr", "d.vtu", "--geometry", name, "-o", "again.nii.gz")
            again = numpy.asarray(nibabel.load("again.nii.gz").dataobj)
            self.assertLess(numpy.abs(again - model).mean(), 1e-4 * model.max(), convention)

    def test_density(self):
        """Fits with their options, calibration, voxels and profiles."""
        phantom("--spacing", 2)
        self.succeed("contours", "ct.nii.gz", "--labels", "l.nii.gz", "--slice-step", 8, "--contour-spacing", 8, "-o", "c.vtp")
        self.succeed("mesh", "c.vtp", "-o", "m.vtu")
        self.succeed("fit", "ct.nii.gz", "m.vtu", "--degree", 3, "-o", "d.vtu", "--report", "linear.json")
        spline = ["fit", "ct.nii.gz", "m.vtu", "--degree", 3, "--interpolator", "bspline", "--voxel-weight", 4]
        self.succeed(*spline, "-o", "s.vtu", "--report", "spline.json")
        self.succeed(*spline, "--overshoot-limit", 2, "-o", "limited.vtu", "--report", "limited.json")
        self.succeed("fit", "ct.nii.gz", "m.vtu", "--degree", 4, "--max-error", 60, "-o", "a.vtu", "--report", "adaptive.json")
        self.succeed("fit", "ct.nii.gz", "m.vtu", "--degree", 2, "--surface-margin", 1, "--interface-margin", 1, "--weights",
                     "l.nii.gz", "-o", "w.vtu")
        linear, spline, limited, adaptive = (read_json(name + ".json") for name in ("linear", "spline", "limited", "adaptive"))
        self.assertLess(spline["error"]["meanAbsolute"], linear["error"]["meanAbsolute"])
        self.assertGreater(limited["error"]["meanAbsolute"], spline["error"]["meanAbsolute"])
        self.assertLess(linear["error"]["meanAbsolute"], linear["heldOutError"]["meanAbsolute"])
        self.assertGreater(len(adaptive["tetrahedraByDegree"]), 2)
        self.assertEqual(sum(adaptive["tetrahedraByDegree"].values()), adaptive["tetrahedra"])
        self.refuse("fit", "ct.nii.gz", "m.vtu", "--degree", 2, "--max-error", 5, "--continuous", "-o", "x.vtu", code=2)
        self.refuse("fit", "ct.nii.gz", "m.vtu", "--max-error", 5, "--continuous-gradient", "-o", "x.vtu", code=2)
        self.refuse("fit", "ct.nii.gz", "m.vtu", "--degree", 2, "--continuous-gradient", "-o", "x.vtu", code=2, says="degree 3")

        write_json({"references": [{"name": "rod", "density": 0, "value": 0}, {"name": "cortex", "density": 1200, "label": 1},
                                   {"name": "soft tissue", "density": 40, "from": [-24, 0, -60], "to": [-24, 0, -66],
                                    "radius": 4}]}, "r.json")
        out, _ = self.succeed("calibrate", "d.vtu", "--references", "r.json", "--to", "ha", "--ct", "ct.nii.gz", "--labels",
                              "l.nii.gz", "--law", "keyak2005", "-o", "ash.vtu")
        self.assertIn("Keyak", out)
        self.assertIn("ash g/cm3", self.succeed("info", "ash.vtu")[0])
        self.succeed("calibrate", "ash.vtu", "--law", "schileo2008", "-o", "apparent.vtu")
        self.refuse("calibrate", "ash.vtu", "--law", "les1994", "-o", "x.vtu", says="K2HPO4")
        self.refuse("calibrate", "d.vtu", "--references", "r.json", "--to", "ha", "-o", "x.vtu", code=2)
        self.refuse("calibrate", "d.vtu", "-o", "x.vtu", code=2)
        self.succeed("calibrate", "d.vtu", "--line", -4, 0.8, "--to", "k2hpo4", "--law", "les1994", "schileo2008", "-o", "k.vtu")
        self.assertIn("apparent g/cm3", self.succeed("info", "k.vtu")[0])

        self.succeed("voxels", "d.vtu", "--like", "ct.nii.gz", "-o", "v.nii.gz")
        model, truth = (numpy.asarray(nibabel.load(name).dataobj) for name in ("v.nii.gz", "ct.nii.gz"))
        inside = model > -1024
        self.assertLess(numpy.abs(model - truth)[inside].mean(), 1.01 * linear["error"]["meanAbsolute"])
        self.succeed("voxels", "d.vtu", "--spacing", 4, "-o", "coarse.mha")
        self.succeed("profile", "d.vtu", "--from", -30, 0, -60, "--to", 30, 0, -60, "--ct", "ct.nii.gz", "--points", 61, "-o",
                     "p.csv")
        with open("p.csv") as file:
            self.assertEqual(len(file.readlines()), 62)

    def radiograph(self, model):
        self.succeed("drr", model, "--geometry", "m/drr_geometry.json", "-o", "r.nii.gz")
        return numpy.asarray(nibabel.load("r.nii.gz").dataobj)

    def test_continuous_gradient(self):
        """Every level gets a spline beside it, an ordinary model; levels are the same as without."""
        phantom(every=2)
        self.refuse("build", "ct.nii.gz", "--labels", "l.nii.gz", "--continuous-gradient", "--degree", 2, "-o", "x", code=2,
                    says="degree 3")
        build = ["build", "ct.nii.gz", "--labels", "l.nii.gz", "--tetrahedra", 2000, "--levels", 1000, "--no-page", "-o", "m"]
        self.succeed(*build)
        levels = [pathlib.Path(f"m/model_L{n}.vtu").read_bytes() for n in (1, 2)]
        self.succeed(*build, "--continuous-gradient")
        report = read_json("m/report.json")
        for n, level in enumerate(report["levels"], 1):
            self.assertEqual(pathlib.Path(f"m/model_L{n}.vtu").read_bytes(), levels[n - 1])
            self.assertEqual(level["spline"]["tetrahedra"], 12 * level["tetrahedra"])
            self.assertLess(level["spline"]["densityError"]["percentOfRange"], 5)
            self.assertNotIn("FAILED", self.succeed("validate", f"m/spline_L{n}.vtu")[0])
            drr, other = (self.radiograph(f"m/{name}_L{n}.vtu") for name in ("spline", "model"))
            self.assertLess(numpy.abs(drr - other).mean(), 0.02 * other.max())
        self.succeed(*build)
        self.assertFalse([f for f in os.listdir("m") if f.startswith("spline")])

    def test_compact(self):
        """Compact files are smaller, are read by every command, and are as near to the exact ones as they say."""
        phantom(every=2)
        self.succeed("build", "ct.nii.gz", "--labels", "l.nii.gz", "--tetrahedra", 2000, "-o", "exact")
        self.succeed("build", "ct.nii.gz", "--labels", "l.nii.gz", "--tetrahedra", 2000, "--compact", "--compact-error", 3, "-o",
                     "compact")
        self.assertEqual(read_json("compact/report.json")["parameters"]["storage"], {"compact": True, "compactError": 3.0})
        self.assertEqual(read_json("compact/model.hierarchy.json"), read_json("exact/model.hierarchy.json"))
        for level in ("model_L1", "model_L2", "model_L3"):
            size, exact = (os.path.getsize(f"{folder}/{level}.vtu") for folder in ("compact", "exact"))
            self.assertLess(size, 0.3 * exact)
            self.succeed("validate", f"compact/{level}.vtu")
            images = []
            for folder in ("compact", "exact"):
                self.succeed("voxels", f"{folder}/{level}.vtu", "--like", "ct.nii.gz", "--outside", -2000, "-o", "v.nii.gz")
                images.append(numpy.asarray(nibabel.load("v.nii.gz").dataobj).astype(float))
            inside = (images[0] > -2000) & (images[1] > -2000)
            self.assertGreater(inside.sum(), 1000)
            self.assertLess(numpy.abs(images[0] - images[1])[inside].max(), 3.1)
            self.assertGreater(numpy.abs(images[0] - images[1])[inside].max(), 0.3)
        self.succeed("simplify", "compact/model_L1.vtu", "--compact", "-o", "again")
        self.assertLess(os.path.getsize("again_L2.vtu"), 0.4 * os.path.getsize("exact/model_L2.vtu"))
        self.succeed("fit", "ct.nii.gz", "compact/model_L1.vtu", "--compact", "--compact-error", 3, "-o", "fit.vtu")
        self.assertLess(os.path.getsize("fit.vtu"), 0.3 * os.path.getsize("exact/model_L1.vtu"))
        self.refuse("fit", "ct.nii.gz", "compact/model_L1.vtu", "--compact-error", 3, "-o", "x.vtu", code=2, says="--compact")
        self.refuse("fit", "ct.nii.gz", "compact/model_L1.vtu", "--compact", "--compact-error", 1e-6, "-o", "x.vtu",
                    says="too small")
        self.refuse("build", "ct.nii.gz", "--labels", "l.nii.gz", "--continuous", "--max-error", 5, "-o", "x", code=2)

    def test_hemipelvis_branches(self):
        phantom("--bone", "hemipelvis", "--subject", 0, every=2)
        self.succeed("contours", "ct.nii.gz", "--labels", "l.nii.gz", "--slice-step", 6, "--contour-spacing", 6, "-o", "c.vtp")
        self.succeed("mesh", "c.vtp", "-o", "m.vtu")
        self.succeed("validate", "m.vtu")
        self.succeed("mesh", "c.vtp", "--metric", "span", "-o", "span.vtu")
        self.succeed("validate", "span.vtu")
        for branching in ("composite", "splitting", "filling"):
            self.succeed("mesh", "c.vtp", "--branching", branching, "-o", f"{branching}.vtu")
            self.succeed("validate", f"{branching}.vtu")
        out, _ = self.succeed("contours", "ct.nii.gz", "--labels", "l.nii.gz", "--slice-step", 5, "--tetrahedra", 15000,
                              "--write-all-slices", "all.vtp", "-o", "asked.vtp")
        self.assertRegex(out, r"on average 5(\.0\d*)? mm apart")
        self.succeed("mesh", "asked.vtp", "--ct", "ct.nii.gz", "-o", "asked.vtu")
        self.succeed("smooth", "asked.vtu", "--contours", "all.vtp", "--labels", "l.nii.gz", "-o", "smooth.vtu")
        count = int(re.search(r"tetrahedra\s+(\d+)", self.succeed("info", "smooth.vtu")[0]).group(1))
        predicted = int(re.findall(r"tiled for about (\d+) tetrahedra", out)[-1])
        self.assertLess(abs(predicted / count - 1), 0.15)
        self.assertLess(abs(count / 15000 - 1), 0.08)

    def test_initial_contours_alone(self):
        """A person draws one contour; the others follow from slice to slice."""
        phantom("--spacing", 1.5)
        angle = numpy.linspace(0, 2 * numpy.pi, 24, endpoint=False)
        points = [{"position": [17 * numpy.cos(a), 3 + 17 * numpy.sin(a), -100.5]} for a in angle]
        markup = {"markups": [{"type": "ClosedCurve", "coordinateSystem": "LPS", "controlPoints": points}]}
        write_json(markup, "init.mrk.json")
        out, _ = self.succeed("info", "init.mrk.json")
        self.assertIn("contours", out)
        self.succeed("contours", "ct.nii.gz", "--init", "init.mrk.json", "--slice-step", 6, "-o", "c.vtp")
        self.succeed("mesh", "c.vtp", "-o", "m.vtu")

    def test_label_map_of_a_few_slices(self):
        """With --follow, the bone is followed from the slices that are marked to those that are not."""
        phantom("--spacing", 1.5)
        whole = nibabel.load("l.nii.gz")
        few = numpy.asarray(whole.dataobj).copy()
        marked = [few.shape[2] // 8, few.shape[2] // 3]
        few[:, :, [k for k in range(few.shape[2]) if k not in marked]] = 0
        nibabel.save(nibabel.Nifti1Image(few, whole.affine, whole.header), "few.nii.gz")
        self.succeed("contours", "ct.nii.gz", "--labels", "few.nii.gz", "--follow", "--slice-step", 3, "-o", "c.vtp")
        self.succeed("mesh", "c.vtp", "-o", "m.vtu")
        self.succeed("contours", "ct.nii.gz", "--labels", "l.nii.gz", "--slice-step", 3, "-o", "all.vtp")
        counts = [int(next(word for word in self.succeed("info", name)[0].split() if word.isdigit()))
                  for name in ("c.vtp", "all.vtp")]
        self.assertGreater(counts[0], 0.8 * counts[1])
        self.refuse("contours", "ct.nii.gz", "--init", "c.vtp", "--follow", "-o", "x.vtp", code=2)

    def test_atlas(self):
        """Three subjects, each on its own mesh: one is the standard model, the others are registered."""
        lines = []
        for subject in range(3):
            phantom("--bone", "hemipelvis", "--subject", subject, ct=f"ct{subject}.nii.gz", every=2)
            self.succeed("contours", f"ct{subject}.nii.gz", "--labels", "l.nii.gz", "--slice-step", 6, "--contour-spacing", 8,
                         "-o", "c.vtp")
            self.succeed("mesh", "c.vtp", "-o", "m.vtu")
            self.succeed("smooth", "m.vtu", "-o", f"m{subject}.vtu")
            lines.append(f"m{subject}.vtu, ct{subject}.nii.gz")
        with open("subjects.txt", "w") as file:
            file.write("# shape, CT\n" + "\n".join(lines) + "\n")
        out, _ = self.succeed("train", "subjects.txt", "--degree", 1, "--variance", 1, "--registered", "meshes",
                              "--evaluation", "atlas.json", "--no-page", "-o", "atlas.h5")
        self.assertIn("shape modes                 2", out)
        meshes = [name for name in os.listdir("meshes") if name.endswith(".vtu")]
        self.assertEqual(len(meshes), 3)
        self.assertFalse(os.path.exists("atlas.html"))
        with open("atlas.json") as file:
            evaluation = json.load(file)
        self.assertEqual([s["name"] for s in evaluation["subjects"]], ["m0", "m1", "m2"])
        self.assertEqual([q["modes"] for q in evaluation["shape"]], [0, 1])
        for kind, error in (("shape", "generalisationMm"), ("density", "meanAbsolute")):
            none, one = evaluation[kind]
            self.assertEqual(none["compactness"], 0)
            self.assertTrue(0 < one["compactness"] < 1)
            self.assertTrue(0 < one[error]["mean"] < none[error]["mean"])
        self.succeed("evaluate", "m1.vtu", "atlas.h5", "--ct", "ct1.nii.gz", "-o", "e.json")
        with open("e.html") as file:
            self.assertIn("<title>BoneTK report: m1.vtu</title>", file.read())
        for mesh in meshes:
            self.succeed("validate", "meshes/" + mesh)
        out, _ = self.succeed("info", "atlas.h5")
        self.assertIn("statistical model", out)
        self.succeed("sample", "atlas.h5", "-o", "mean.vtu")
        self.succeed("validate", "mean.vtu")
        self.succeed("sample", "atlas.h5", "--shape", "1=1", "2=-0.5", "--density", "1=1", "-o", "s.vtu")
        self.succeed("sample", "atlas.h5", "--random", 3, "-o", "r.vtu")
        self.refuse("sample", "atlas.h5", "--shape", "3=1", "-o", "x.vtu", code=2, says="2 such modes")
        self.refuse("sample", "atlas.h5", "--shape", "1", "-o", "x.vtu", code=2)
        self.refuse("sample", "mean.vtu", "-o", "x.vtu")
        self.refuse("train", "missing.txt", "-o", "x.h5")
        with open("missing.txt", "w") as file:
            file.write("m0.vtu\nnone.vtu\n")
        self.refuse("train", "missing.txt", "--quiet", "-o", "x.h5", says="none.vtu")

    def test_cost(self):
        def cost(*arguments):
            """Seconds and MB that a build is said to take."""
            out, _ = self.succeed("info", "ct.nii.gz", "--cost", *arguments)
            return [int(re.search(what + r" +(\d+)\n", out)[1]) for what in ("seconds, about", r"memory, about \(MB\)")]

        phantom()
        small = ("--labels", "l.nii.gz", "--tetrahedra", 3000)
        process = subprocess.Popen([BONETK, "build", "ct.nii.gz", *map(str, small), "--degree", "1", "--no-page", "-q", "-o", "m"],
                                   stderr=subprocess.DEVNULL)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        self.assertEqual(process.returncode, 0)
        seconds, megabytes = cost(*small, "--threads", 1)
        self.assertLess(abs(megabytes / (usage.ru_maxrss * 1024 / 1e6) - 1), 0.2)
        self.assertLess(cost(*small, "--threads", 4)[0], seconds)
        self.assertGreater(min(a / b for a, b in zip(cost("--threads", 1, "--tetrahedra", 100000), (seconds, megabytes))), 3)
        twice = cost(*small, "--label", "1,2", "--threads", 1)
        self.assertAlmostEqual(twice[0], 2 * seconds, delta=3)
        self.assertLessEqual(twice[1], megabytes)
        # The header is enough.
        with open("ct.nii.gz", "rb") as file:
            head = file.read(20000)
        with open("ct.nii.gz", "wb") as file:
            file.write(head)
        self.assertEqual(cost(*small, "--threads", 1), [seconds, megabytes])
        self.refuse("info", "l.nii.gz", "--tetrahedra", 3000, code=2, says="--cost")
        self.refuse("info", "ct.nii.gz", "--cost", "--labels", "l.nii.gz", "--label", 9, says="label 9")

    def test_quiet(self):
        self.assertEqual(self.succeed("phantom", "--quiet", "--spacing", 4, "-o", "ct.nii.gz"), ("", ""))

    def test_invalid_mesh(self):
        """Two tetrahedra, one of them inside out."""
        with open("bad.vtu", "w") as file:
            file.write('<?xml version="1.0"?><VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">'
                       '<UnstructuredGrid><Piece NumberOfPoints="5" NumberOfCells="2"><Points>'
                       '<DataArray type="Float64" NumberOfComponents="3" format="ascii">'
                       '0 0 0 1 0 0 0 1 0 0 0 1 0 0 -1</DataArray></Points><Cells>'
                       '<DataArray type="Int64" Name="connectivity" format="ascii">0 1 2 3 0 1 2 4</DataArray>'
                       '<DataArray type="Int64" Name="offsets" format="ascii">4 8</DataArray>'
                       '<DataArray type="UInt8" Name="types" format="ascii">10 10</DataArray>'
                       '</Cells></Piece></UnstructuredGrid></VTKFile>')
        code, out, err = bonetk("validate", "bad.vtu")
        self.assertEqual(code, 1)
        self.assertIn("FAILED", out)
        self.assertEqual(len(err.splitlines()), 1)

    def test_example_programs(self):
        def example(name, *arguments):
            code, _, err = run(os.path.join(EXAMPLES, f"bone{name}Example"), *arguments)
            self.assertEqual(code, 0, f"{name}: {err}")

        example("Phantom", "ct.nii.gz", "l.nii.gz")
        example("Contour", "ct.nii.gz", "l.nii.gz", "c.vtp")
        example("Tiling", "c.vtp", "m.vtu")
        example("Smoothing", "m.vtu", "s.vtu")
        example("DensityFit", "ct.nii.gz", "s.vtu", "d.vtu")
        example("Simplification", "d.vtu", "h")
        example("Radiograph", "d.vtu", "drr.mha")
        example("BuildModel", "ct.nii.gz", "l.nii.gz", "model")
        self.assertTrue(os.path.exists("model_L2.vtu"))


if __name__ == "__main__":
    main()
