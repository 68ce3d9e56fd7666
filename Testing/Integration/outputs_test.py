#!/usr/bin/env python3
"""Outputs are whole or not there: interrupted runs, full disks, and the same bytes whatever the number of threads."""
import os
import resource
import shutil
import signal
import subprocess
import time

from bonetk_testing import BONETK, TestCase, bonetk, main, phantom

BUILD = ["--labels", "l.nii.gz", "--tetrahedra", "4000", "--degree", "2"]


class Outputs(TestCase):
    def setUp(self):
        super().setUp()
        phantom("--noise", 15, every=2)

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
        self.refuse(*arguments, "-q", lines=3,
                    preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))

    def test_full_disk(self):
        for name in ("x.nii.gz", "x.nii", "x.mha", "x.mhd", "x.nrrd"):
            self.full_disk(20000, "phantom", "-o", name)
        self.full_disk(20000, "build", "ct.nii.gz", *BUILD, "-o", "out")
        self.full_disk(200000, "build", "ct.nii.gz", *BUILD, "-o", "out")
        self.full_disk(2000, "contours", "ct.nii.gz", "--labels", "l.nii.gz", "--slice-step", 6, "-o", "c.vtp")
        self.succeed("contours", "ct.nii.gz", "--labels", "l.nii.gz", "--slice-step", 6, "-o", "c.vtp")
        self.full_disk(20000, "mesh", "c.vtp", "-o", "m.vtu")


if __name__ == "__main__":
    main()
