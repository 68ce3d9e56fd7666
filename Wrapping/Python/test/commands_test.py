#!/usr/bin/env python3
"""bonetk.commands: the same bytes as the program, errors, progress, what stops the work, and an argument for each option."""
import inspect
import json
import keyword
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy

import bonetk
from bonetk import commands
from bonetk._bonetk import describe_commands
from bodies import box, linear
from bonetk_testing import bonetk as program, write_json
from deform_test import SIZES, write_subject

VIEW = {"source": [0, -900, -60], "detectorOrigin": [-189, 300, 129], "detectorU": [1, 0, 0], "detectorV": [0, 0, -1],
        "size": [64, 64], "spacing": [6, 6]}
SECONDS = re.compile(rb"(?m)^seconds: .*$")
SHARED = {"quiet", "verbose", "status", "threads"}


def function_of(name):
    return getattr(commands, name.replace(" ", "_"))


def argument_of(option):
    name = option["name"].replace("-", "_")
    return name + "_" if keyword.iskeyword(name) else name


# Each command, what its function gets, and the words of the program that mean the same.
CASES = [
    ("phantom", (), dict(bone="femur", subject=2, spacing=3, noise=7.5, output="ct.mha", labels=pathlib.Path("l.mha")),
     "--bone femur --subject 2 --spacing 3 --noise 7.5 -o ct.mha --labels l.mha"),
    ("crop", ("ct.mha",), dict(labels="l.mha", label=1, margin=4.5, output="crop.mha", write_labels="crop_l.mha"),
     "ct.mha --labels l.mha --label 1 --margin 4.5 -o crop.mha --write-labels crop_l.mha"),
    ("contours", ("ct.mha",), dict(labels="l.mha", slice_step=6, contour_spacing=8.0, axis="z", output=["c.vtp", "c.mha"]),
     "ct.mha --labels l.mha --slice-step 6 --contour-spacing 8 --axis z -o c.vtp -o c.mha"),
    ("mesh", ("c.vtp",), dict(ct="ct.mha", metric="span", output="plain.vtu"), "c.vtp --ct ct.mha --metric span -o plain.vtu"),
    ("smooth", (pathlib.Path("plain.vtu"),), dict(method="smart", iterations=2, output="s.vtu"),
     "plain.vtu --method smart --iterations 2 -o s.vtu"),
    ("fit", ("ct.mha", "plain.vtu"), dict(degree=1, continuous=True, output="d.vtu"), "ct.mha plain.vtu --degree 1 --continuous -o d.vtu"),
    ("fit", ("ct.mha", "plain.vtu"), dict(degree=1, continuous=False, output="bone.vtu", report="fit.json"),
     "ct.mha plain.vtu --degree 1 -o bone.vtu --report fit.json"),
    ("fit", ("ct.mha", "plain.vtu"), dict(continuous_gradient=True, output="c1.vtu"), "ct.mha plain.vtu --continuous-gradient -o c1.vtu"),
    ("calibrate", ("bone.vtu",), dict(line=(-4, 0.8), to="k2hpo4", law=["les1994", "schileo2008"], output="k.vtu"),
     "bone.vtu --line -4 0.8 --to k2hpo4 --law les1994 schileo2008 -o k.vtu"),
    ("voxels", ("bone.vtu",), dict(spacing=4, outside=-2000, output="v.nii.gz"), "bone.vtu --spacing 4 --outside -2000 -o v.nii.gz"),
    ("profile", ("bone.vtu",), dict(from_=(-30, 0, -60), to=[30, 0, -60], points=61, ct="ct.mha", output="p.csv"),
     "bone.vtu --from -30 0 -60 --to 30 0 -60 --points 61 --ct ct.mha -o p.csv"),
    ("simplify", ("bone.vtu",), dict(tetrahedra=[1500, 1000], output="h"), "bone.vtu --tetrahedra 1500 1000 -o h"),
    ("build", ("ct.mha",), dict(labels="l.mha", tetrahedra=2000, levels=0.5, degree=1, no_page=True, output="built"),
     "ct.mha --labels l.mha --tetrahedra 2000 --levels 0.5 --degree 1 --no-page -o built"),
    ("drr", ("bone.vtu",), dict(geometry="view.json", region="cortical", output="x.mha"),
     "bone.vtu --geometry view.json --region cortical -o x.mha"),
    ("train", ("list.txt",), dict(registered="meshes", no_page=True, output="atlas.h5"), "list.txt --registered meshes --no-page -o atlas.h5"),
    ("register subject", ("s0.vtu", "bone.vtu"), dict(ct="ct.mha", degree=1, output="subject.vtu"),
     "s0.vtu bone.vtu --ct ct.mha --degree 1 -o subject.vtu"),
    ("sample", ("atlas.h5",), dict(shape=["1=1", "2=-0.5"], density="1=1", output="sample.vtu"),
     "atlas.h5 --shape 1=1 2=-0.5 --density 1=1 -o sample.vtu"),
    ("evaluate", ("s0.vtu", "atlas.h5"), dict(mirror="never", no_page=True, output="e.json"), "s0.vtu atlas.h5 --mirror never --no-page -o e.json"),
    ("register rigid", ("bone.vtu",), dict(xray="full.mha", geometry="view.json", pixels=64, searches=1, population=10,
                                           search=(2, 1), collimator=False, no_page=True, output="rigid"),
     "bone.vtu --xray full.mha --geometry view.json --pixels 64 --searches 1 --population 10 --search 2 1 --no-collimator "
     "--no-page -o rigid"),
    ("register deform", ("atlas.h5",), dict(xray=["full.mha"], geometry="view.json", pixels=64, search_pixels=32, population=10,
                                            smooth_modes=6, iterations=2, search=(2, 1), intensities=False,
                                            translation_deviation=2, rotation_deviation=1.0, no_page=True, output="deform"),
     "atlas.h5 --xray full.mha --geometry view.json --pixels 64 --search-pixels 32 --population 10 --smooth-modes 6 "
     "--iterations 2 --search 2 1 --no-intensities --translation-deviation 2 --rotation-deviation 1 --no-page -o deform"),
    ("register volume", ("atlas.h5", "ct.mha"), dict(hypotheses=50000, smooth_modes=60, no_page=True, output="volume"),
     "atlas.h5 ct.mha --hypotheses 50000 --smooth-modes 60 --no-page -o volume"),
    ("label", ("ct.mha",), dict(atlas="atlas.h5", hypotheses=50000, smooth_modes=60, output="found.mha"),
     "ct.mha --atlas atlas.h5 --hypotheses 50000 --smooth-modes 60 -o found.mha"),
    ("measure", ("bone.vtu",), dict(ball=[(0, 0, -60, 9), (5, 0, -60, 9.5)], half_space=(0, 0, -60, 0, 0, 1), no_page=True,
                                    output="measures.json"),
     "bone.vtu --ball 0 0 -60 9 --ball 5 0 -60 9.5 --half-space 0 0 -60 0 0 1 --no-page -o measures.json"),
    ("thickness", ("bone.vtu", "ct.mha"), dict(point_spread=4, cortical_density=1500, report="thickness.json", output="t.vtp"),
     "bone.vtu ct.mha --point-spread 4 --cortical-density 1500 --report thickness.json -o t.vtp"),
    ("plan", ("bone.vtu",), dict(resection=[[0, 0, -60, 0, 0, 1]], path=(0, -40, -60, 0, 40, -60), radius=3, output="plan.json"),
     "bone.vtu --resection 0 0 -60 0 0 1 --path 0 -40 -60 0 40 -60 --radius 3 -o plan.json"),
    ("export", ("bone.vtu",), dict(format="gmsh", law="keller1994", line=(0, 0.001), no_page=True, output="fe.msh"),
     "bone.vtu --format gmsh --law keller1994 --line 0 0.001 --no-page -o fe.msh"),
    ("validate", ("bone.vtu",), {}, "bone.vtu"),
    ("info", ("bone.vtu",), dict(threads=1), "bone.vtu --threads 1"),
]


def contents():
    """Every file below this folder; of reports without how long it took."""
    found = {}
    for path in sorted(pathlib.Path().rglob("*")):
        if path.is_file():
            content = path.read_bytes()
            if path.suffix == ".json":
                content = without_seconds(json.loads(content))
            elif path.name == "report.txt":
                content = SECONDS.sub(b"", content)
            found[str(path)] = content
    return found


def without_seconds(content):
    if isinstance(content, dict):
        return {key: without_seconds(value) for key, value in content.items() if "seconds" not in key.lower()}
    return [without_seconds(value) for value in content] if isinstance(content, list) else content


class TestCase(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder.name)


class SameBytes(TestCase):
    def inputs(self, command):
        """What a command needs that none before it makes."""
        if command == "drr":
            write_json(VIEW, "view.json")
        if command == "train":
            for i, size in enumerate(SIZES):
                write_subject("bone.vtu", f"s{i}.vtu", size, 150.0 * (-1) ** i)
            pathlib.Path("list.txt").write_text("".join(f"s{i}.vtu\n" for i in range(len(SIZES))))
        if command == "register rigid":
            code, _, err = program("drr", "ct.mha", "--geometry", "view.json", "-o", "full.mha")
            self.assertEqual(code, 0, err)

    def test_every_command(self):
        self.assertEqual({case[0] for case in CASES}, {command["name"] for command in describe_commands()})
        top = os.getcwd()
        for folder in ("of_program", "of_python"):
            os.mkdir(folder)
        for name, arguments, keywords, words in CASES:
            with self.subTest(command=name, words=words):
                os.chdir(os.path.join(top, "of_program"))
                self.inputs(name)
                code, out, err = program(*name.split(), *words.split())
                self.assertEqual(code, 0, err)
                there = contents()
                os.chdir(os.path.join(top, "of_python"))
                self.inputs(name)
                before = contents()
                result = function_of(name)(*arguments, **keywords)
                here = {path: content for path, content in contents().items() if path not in before}
                there = {path: content for path, content in there.items() if path not in before}
                self.assertEqual(sorted(here), sorted(there))
                self.assertEqual([path for path in here if here[path] != there[path]], [])
                self.assertEqual(SECONDS.sub(b"", result.text.encode()), SECONDS.sub(b"", out.encode()))
                self.assertEqual(result.messages, err)
                self.assertEqual(err.count("warning: "), len(result.warnings))
                outputs = [os.path.realpath(output) for output in result.outputs]
                for path in map(os.path.realpath, here):
                    self.assertTrue(any(path == o or path.startswith(o + "/") for o in outputs), (path, outputs))
                self.assertTrue(all(os.path.exists(output) for output in result.outputs), result)
                self.assertEqual(len(result.outputs) > 0, len(here) > 0)


class Arguments(TestCase):
    def setUp(self):
        super().setUp()
        bonetk.write_mesh(linear(box((2, 2, 2))), "m.vtu")

    def test_every_option_is_an_argument(self):
        for command in describe_commands():
            function = function_of(command["name"])
            parameters = inspect.signature(function).parameters
            self.assertEqual({argument_of(option) for option in command["options"]} | {"progress"}, set(parameters))
            for option in command["options"]:
                parameter = parameters[argument_of(option)]
                self.assertEqual(parameter.kind == parameter.KEYWORD_ONLY, not option["positional"])
                self.assertEqual(parameter.default is parameter.empty, option["required"])
                self.assertIn(f"\n    {parameter.name}: ", function.__doc__)
            self.assertTrue(SHARED < set(parameters))
            self.assertIn(function.__name__, commands.__all__)

    def test_the_words_of_values(self):
        """By what the program says it was called with."""
        def words(**keywords):
            return commands.profile("m.vtu", from_=(1, 2, 3), **{"to": (9, 9, 9), "output": "p.csv", **keywords}).command

        self.assertEqual(words(points=3, quiet=True), "bonetk profile m.vtu --from 1 2 3 --to 9 9 9 --points 3 --output p.csv "
                                                      "--quiet")
        self.assertIn("--to 2.5 7 -0.1 ", words(to=(numpy.float32(2.5), numpy.int64(7), -0.1)))
        self.assertIn("--to 4 5 6 ", words(to=numpy.array([4, 5, 6])))
        self.assertIn("--points 7 ", words(points=numpy.int64(7)))
        for wrong in (dict(points=True), dict(points=object()), dict(quiet=1), dict(output="a\0b")):
            with self.assertRaises((TypeError, ValueError)):
                words(**wrong)
        with self.assertRaises(TypeError):
            words(no_such_option=1)
        self.assertEqual(sorted(os.listdir()), ["m.vtu", "p.csv"])

    def test_names_of_files(self):
        for name in ("-x.csv", "with blank's.csv", "ö.csv", os.fsdecode(b"\xff.csv")):
            result = commands.profile("m.vtu", from_=(1, 2, 3), to=(9, 9, 9), output=name)
            self.assertTrue(os.path.exists(name), name)
            self.assertEqual([os.path.normpath(output) for output in result.outputs], [name])
        os.rename("m.vtu", "-m.vtu")
        self.assertRegex(commands.info("-m.vtu").text, r"tetrahedra +48\n")

    def test_result(self):
        result = commands.voxels("m.vtu", spacing=5, output="v.mha")
        self.assertEqual(repr(result), "<bonetk.commands.Result of 'bonetk voxels m.vtu --spacing 5 --output v.mha': "
                                       "1 outputs, 0 warnings>")
        text = commands.info("v.mha").text
        self.assertEqual(commands.info("v.mha", quiet=True).text, "")
        self.assertEqual(str(commands.info("v.mha")), text)


class Errors(TestCase):
    def raised(self, error, function, *arguments, **keywords):
        with self.assertRaises(error) as caught:
            function(*arguments, **keywords)
        self.assertIs(type(caught.exception), error)
        self.assertEqual(len(str(caught.exception).splitlines()), 1)
        return str(caught.exception)

    def test_lines_of_the_program(self):
        for error, code, name, arguments, keywords in (
                (bonetk.DataError, 1, "info", ["nowhere.mha"], {}),
                (bonetk.UsageError, 2, "phantom", [], {"spacing": -1, "output": "p.mha"}),
                (bonetk.UsageError, 2, "phantom", [], {"output": "p.txt"}),
                (bonetk.UsageError, 2, "phantom", [], {"bone": "skull", "output": "p.mha"})):
            line = self.raised(error, function_of(name), *arguments, **keywords)
            words = [word for key, value in keywords.items() for word in ("--" + key, value)]
            got, _, err = program(name, *arguments, *words)
            self.assertEqual((got, err), (code, f"bonetk {name}: {line}\n"))
        self.assertTrue(issubclass(bonetk.DataError, bonetk.Error) and issubclass(bonetk.UsageError, bonetk.Error))
        self.assertEqual(os.listdir(), [])

    def test_standard_streams_stay(self):
        """A command touches neither the process's streams nor its handlers, and gives the number of threads back."""
        script = ("import bonetk, os, signal\n"
                  "before = signal.getsignal(signal.SIGINT)\n"
                  "bonetk.set_threads(2)\n"
                  "bonetk.commands.profile('m.vtu', from_=(1, 2, 3), to=(9, 9, 9), output='p.csv', threads=1)\n"
                  "assert bonetk.get_threads() == 2 and signal.getsignal(signal.SIGINT) is before\n"
                  "os.write(1, b'out'); os.write(2, b'err')\n")
        bonetk.write_mesh(linear(box()), "m.vtu")
        done = subprocess.run([sys.executable, "-c", script], capture_output=True)
        self.assertEqual((done.stdout, done.stderr, done.returncode), (b"out", b"err", 0))

    def test_threads(self):
        bonetk.set_threads(1)
        self.assertEqual(bonetk.get_threads(), 1)
        bonetk.set_threads(0)
        self.assertGreaterEqual(bonetk.get_threads(), 1)
        for wrong in (-1, 1025):
            with self.assertRaises(ValueError):
                bonetk.set_threads(wrong)
        self.assertRegex(bonetk.__version__, r"^\d+\.\d+\.\d+$")


class Running(TestCase):
    """A build that takes some seconds."""
    @classmethod
    def setUpClass(cls):
        cls.common = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.common.cleanup)
        cls.ct, cls.labels = (os.path.join(cls.common.name, name) for name in ("ct.mha", "l.mha"))
        commands.phantom(spacing=3, output=cls.ct, labels=cls.labels)

    def build(self, output, **keywords):
        return commands.build(self.ct, labels=self.labels, output=output, tetrahedra=3000, no_page=True, **keywords)

    def test_progress(self):
        told, threads = [], set()

        def progress(stage, share):
            told.append((stage, share))
            threads.add(threading.get_ident())

        self.build("out", progress=progress)
        shares = [share for _, share in told]
        self.assertEqual((told[0], told[-1]), (("start", 0.0), ("end", 1.0)))
        self.assertEqual(shares, sorted(shares))
        self.assertGreater(len(set(shares)), 20)
        self.assertLess(max(b - a for a, b in zip(shares, shares[1:])), 0.3)
        self.assertIn("quality", {stage for stage, _ in told})  # shorter ones may pass untold
        self.assertEqual(threads, {threading.get_ident()})

    def test_exception_of_progress(self):
        class Enough(Exception):
            pass

        for limit in (0.0, 0.01, 0.3, 0.7):
            stopped = []

            def progress(stage, share):
                if share >= limit:
                    stopped.append(time.monotonic())
                    raise Enough(stage)

            with self.subTest(limit=limit):
                with self.assertRaises(Enough):
                    self.build("out", progress=progress)
                self.assertEqual(len(stopped), 1)
                self.assertLess(time.monotonic() - stopped[0], 1.0)
                self.assertEqual(os.listdir(), [])
        commands.crop(self.ct, labels=self.labels, output="next.mha")  # nothing is left of what was stopped

    def interrupted(self, share, call):
        """Seconds from SIGINT, soon after the work is so far, to the KeyboardInterrupt that comes out."""
        sent = []
        timer = threading.Timer(0.05, lambda: (sent.append(time.monotonic()), signal.raise_signal(signal.SIGINT)))

        def progress(_, done):
            if done >= share and timer.ident is None:
                timer.start()

        with self.assertRaises(KeyboardInterrupt):
            try:
                call(progress=progress)
            finally:
                timer.cancel()
        return time.monotonic() - sent[0]

    def test_keyboard_interrupt(self):
        for share in (0.0, 0.2, 0.5, 0.8):
            with self.subTest(share=share):
                seconds = self.interrupted(share, lambda **keywords: self.build("out", **keywords))
                print(f"interrupted at {share:.0%}: came out in {seconds:.2f} s", file=sys.stderr)
                self.assertLess(seconds, 1.0)
                self.assertEqual(os.listdir(), [])

    def test_a_file_that_is_there_stays(self):
        pathlib.Path("p.mha").write_text("mine")
        self.interrupted(0.0, lambda **keywords: commands.phantom(spacing=0.4, output="p.mha", **keywords))
        self.assertEqual(pathlib.Path("p.mha").read_text(), "mine")
        self.assertEqual(os.listdir(), ["p.mha"])

    def test_from_several_threads(self):
        """One waits for the other; a call from a progress function would wait for itself."""
        done = []
        crop = lambda output, **keywords: commands.crop(self.ct, labels=self.labels, output=output, **keywords)
        threads = [threading.Thread(target=lambda i=i: done.append(crop(f"{i}.mha"))) for i in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(sorted(os.listdir()), ["0.mha", "1.mha", "2.mha"])
        with self.assertRaisesRegex(RuntimeError, "progress function"):
            crop("p.mha", progress=lambda *_: commands.info("0.mha"))
        self.assertNotIn("p.mha", os.listdir())

    def test_other_threads_of_python_go_on(self):
        counted = []
        stop = threading.Event()

        def count():
            while not stop.wait(0.01):
                counted.append(time.monotonic())

        thread = threading.Thread(target=count, daemon=True)
        thread.start()
        self.build("out")
        stop.set()
        thread.join()
        # If the build kept them waiting, one gap would be all of it.
        self.assertLess(max(b - a for a, b in zip(counted, counted[1:])), 0.5 * (counted[-1] - counted[0]))


class Import(TestCase):
    def test_import_leaves_numpy_alone(self):
        """Its 20 MB are for those who work with arrays."""
        subprocess.run([sys.executable, "-c", "import bonetk, sys; assert 'numpy' not in sys.modules"], check=True)

    def test_what_is_exported(self):
        modules = {"functions", "images", "interop"}
        self.assertEqual(set(bonetk.__all__), {name for name in dir(bonetk) if name[0] != "_"} - modules | {"__version__"})


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v", *sys.argv[1:]])
