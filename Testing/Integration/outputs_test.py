#!/usr/bin/env python3
"""Outputs are whole or not there: interrupted runs, full disks, and the same bytes whatever the number of threads."""
import os
import resource
import shutil
import signal
import subprocess
import time

import nibabel
import numpy

from bonetk_testing import BONETK, TestCase, bonetk, main, phantom

# Slices and points are given, as finding them for a number of tetrahedra takes half of the time.
BUILD = ["--labels", "l.nii.gz", "--slice-step", "12", "--contour-spacing", "16", "--degree", "2"]


class Outputs(TestCase):
    def setUp(self):
        super().setUp()
        phantom("--noise", 15, every=3)

    def contents(self, folder):
        """Bytes by file name; the report without the times it took."""
        files = {}
        for name in sorted(os.listdir(folder)):
            with open(os.path.join(folder, name), "rb") as file:
                data = file.read()
            if name.startswith("report."):
                data = data[:data.index(b'<section id="provenance"' if name.endswith(".html") else b"seconds")]
            files[name] = data
        return files

    def test_same_bytes_twice_and_for_any_number_of_threads(self):
        for threads, folder in ((1, "one"), (2, "two"), (2, "again")):
            self.succeed("build", "ct.nii.gz", *BUILD, "--threads", threads, "-o", folder)
        one = self.contents("one")
        for name in ("model_L1.vtu", "model_L2.vtu", "model_L3.vtu", "model.hierarchy.json", "contours.vtp", "report.json",
                     "report.txt", "report.html", "slices.png", "cut_plane.png", "radiographs.png"):
            self.assertIn(name, one)
        for folder in ("two", "again"):
            other = self.contents(folder)
            self.assertEqual(list(one), list(other))
            self.assertEqual([n for n in one if one[n] != other[n]], [])

    def test_build_into_a_folder_that_exists(self):
        os.mkdir("out")
        with open("out/mine.txt", "w") as file:
            file.write("kept")
        self.succeed("build", "ct.nii.gz", *BUILD, "-o", "out")
        self.assertTrue({"mine.txt", "model_L1.vtu", "report.json"} <= set(os.listdir("out")))
        with open("file", "w"):
            pass
        self.refuse("build", "ct.nii.gz", *BUILD, "-o", "file", says="file")

    def small_build(self, *options, folder="out", bones=(), labels="l.nii.gz"):
        """Makes a small build and returns what it printed, its warnings, and which of its reports are new."""
        reports = [os.path.join(folder, bone, "report.json") for bone in bones or [""]]
        before = [os.stat(report).st_mtime_ns if os.path.exists(report) else None for report in reports]
        out, err = self.succeed("build", "ct.nii.gz", "--labels", labels, "--slice-step", 15, "--contour-spacing", 30, "--no-page",
                                *options, "-o", folder)
        return out, err, [os.stat(report).st_mtime_ns != time_before for report, time_before in zip(reports, before)]

    def require_clean_sources(self):
        if "changed" in bonetk("--version")[1]:
            self.small_build()
            self.assertEqual(self.small_build()[2], [True])  # sources that differ from their commit have no name
            self.skipTest("the program's sources differ from their commit")

    def test_a_build_that_is_done_is_not_done_again(self):
        self.require_clean_sources()

        def built(*options):
            out, err, new = self.small_build("--degree", 1, *options)
            self.assertEqual(out == "out is done: the same inputs, parameters and program as before; --force builds it anew\n", not new[0])
            self.assertIn("warning", err)  # of a build that is left too
            return new[0]

        self.assertTrue(built())
        whole = self.contents("out")
        self.assertFalse(built())
        self.assertFalse(built("--threads", 1, "--status", "status.jsonl"))
        with open("status.jsonl") as file:
            self.assertIn('"exit":0', file.readlines()[-1])
        shutil.copyfile("ct.nii.gz", "same.nii.gz")
        os.replace("same.nii.gz", "ct.nii.gz")
        self.assertFalse(built())
        self.assertEqual(self.contents("out"), whole)
        self.assertTrue(built("--force"))
        self.assertTrue(built("--levels", 0.4))
        self.assertTrue(built())
        self.assertEqual(self.contents("out"), whole)
        for damage in (lambda: os.truncate("out/model_L2.vtu", 1000), lambda: os.remove("out/contours.vtp"),
                       lambda: os.truncate("out/report.json", os.path.getsize("out/report.json") - 10)):
            damage()
            self.assertTrue(built())
        self.assertEqual(self.contents("out"), whole)
        image = nibabel.load("ct.nii.gz")
        voxels = numpy.asarray(image.dataobj).copy()
        voxels[tuple(size // 2 for size in voxels.shape)] += 1
        nibabel.save(nibabel.Nifti1Image(voxels, image.affine, image.header), "ct.nii.gz")
        self.assertTrue(built())

    def test_voxels_in_another_file_are_always_built(self):
        self.require_clean_sources()
        image = nibabel.load("l.nii.gz")
        nibabel.save(nibabel.Nifti1Pair(numpy.asarray(image.dataobj), image.affine, image.header), "l.hdr")
        for _ in range(2):
            self.assertEqual(self.small_build(labels="l.hdr")[2], [True])

    def test_bones_that_are_done_are_left(self):
        self.require_clean_sources()
        image = nibabel.load("l.nii.gz")
        labels = numpy.asarray(image.dataobj)
        upper = numpy.arange(labels.shape[2]) > labels.shape[2] // 2
        nibabel.save(nibabel.Nifti1Image(numpy.where(labels > 0, 1 + upper, 0).astype(numpy.int16), image.affine), "two.nii.gz")
        bones = ["label_1", "label_2"]
        options = {"folder": "b", "bones": bones, "labels": "two.nii.gz"}
        choice = ("--degree", 1, "--label", "1,2")
        self.assertEqual(self.small_build(*choice, **options)[2], [True, True])
        warnings = self.small_build(*choice, **options)[1]
        self.assertIn("label_2: warning", warnings)
        os.remove("b/label_2/contours.vtp")
        out, err, new = self.small_build(*choice, **options)
        self.assertIn("b/label_1 is done", out)
        self.assertEqual((sorted(err.splitlines()), new), (sorted(warnings.splitlines()), [False, True]))
        shutil.copytree("b/label_1", "b/copy")
        shutil.rmtree("b/label_2")
        self.assertEqual(self.small_build(*choice, **options)[2], [False, True])
        self.assertEqual(self.small_build(*choice, **options),
                         ("b is done: the same inputs, parameters and program as before; --force builds it anew\n", warnings, [False, False]))
        self.assertEqual(self.small_build(*choice, "--force", **options)[2], [True, True])

    def snapshot(self, name):
        """What is under that name: nothing (None), a folder's contents, or a file's bytes."""
        if not os.path.exists(name):
            return None
        if os.path.isdir(name):
            return self.contents(name)
        with open(name, "rb") as file:
            return file.read()

    def remove(self, name):
        if os.path.isdir(name):
            shutil.rmtree(name)
        elif os.path.exists(name):
            os.remove(name)

    def new_files(self, before):
        """How many files and folders there are that were not there before, those in new folders with them."""
        count = 0
        for name in os.listdir():
            if name not in before:
                count += 1
                try:
                    count += len(os.listdir(name))
                except OSError:
                    pass  # a file, or gone by now
        return count

    def interrupted(self, number, code, command):
        """Ends a command at its start, and when it has so many files: its output is whole or not there, nothing is left."""
        output = command[command.index("-o") + 1]
        before = sorted(os.listdir())
        self.succeed(*command)
        whole = self.snapshot(output)
        codes = []
        for files in (0, 1, 2, 5, 9):
            self.remove(output)
            process = subprocess.Popen([BONETK] + command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            while process.poll() is None and self.new_files(before) < files:
                time.sleep(0.0005)
            process.send_signal(number)
            got = process.wait(60)
            codes.append(got)
            # A signal that comes before the handler is set ends the process the plain way; one that comes when the
            # output has just got its name finds it whole.
            self.assertIn(got, (0, code, -number))
            there = self.snapshot(output)
            if got == 0 or there is not None:
                self.assertEqual(there, whole)
            self.remove(output)
            self.assertEqual(sorted(os.listdir()), before)
        self.assertIn(code, codes, "no signal was heeded")

    def test_interrupted(self):
        self.interrupted(signal.SIGINT, 130, ["build", "ct.nii.gz", *BUILD, "-o", "out"])
        self.interrupted(signal.SIGTERM, 143, ["build", "ct.nii.gz", *BUILD, "-o", "out"])
        self.interrupted(signal.SIGINT, 130, ["phantom", "--spacing", "1", "-o", "big.nii.gz"])

    def full_disk(self, limit, *arguments):
        """A file may not grow beyond `limit` bytes, which writers see as they see a full disk.

        Before the command's own line there may be warnings, and messages of the NIfTI library."""
        self.refuse(*arguments, "-q", lines=3, code=3,
                    preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))

    def test_full_disk(self):
        for name in ("x.nii.gz", "x.nii", "x.mha", "x.mhd", "x.nrrd"):
            self.full_disk(20000, "phantom", "-o", name)
        self.full_disk(20000, "build", "ct.nii.gz", *BUILD, "-o", "out")
        self.full_disk(200000, "build", "ct.nii.gz", *BUILD, "-o", "out")
        self.full_disk(2000, "contours", "ct.nii.gz", "--labels", "l.nii.gz", "--slice-step", 6, "-o", "c.vtp")
        self.succeed("contours", "ct.nii.gz", "--labels", "l.nii.gz", "--slice-step", 6, "-o", "c.vtp")
        self.full_disk(20000, "mesh", "c.vtp", "-o", "m.vtu")

    def test_too_little_memory(self):
        limit = 1 << 30  # bytes of address space, of which the program's libraries take a part
        nibabel.save(nibabel.Nifti1Image(numpy.zeros((700, 700, 700), numpy.uint8), numpy.eye(4)), "big.nii.gz")
        for command in (["phantom", "--spacing", 0.2, "-o", "p.nii"], ["drr", "big.nii.gz", "--view", "ap", "-o", "x.mha"]):
            self.refuse(*command, "-q", code=3, says="memory", preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))


if __name__ == "__main__":
    main()
