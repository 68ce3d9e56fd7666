#!/usr/bin/env python3
"""What a command tells of its progress: the line on a terminal, --verbose, and the status file for programs."""
import fcntl
import json
import os
import pty
import re
import signal
import subprocess
import threading
import time

from bonetk_testing import BONETK, TestCase, bonetk, main, phantom

BUILD = ["build", "ct.nii.gz", "--labels", "l.nii.gz", "--tetrahedra", "3000", "-o", "out"]


def lines_of(path):
    with open(path) as file:
        return [json.loads(line) for line in file]


class Progress(TestCase):
    def setUp(self):
        super().setUp()
        phantom(every=2)

    def check(self, lines, code):
        """Of the lines of any run: what each has, and that nothing falls or comes twice."""
        first, last = lines[0], lines[-1]
        self.assertEqual((first["stage"], first["share"], first["warnings"]), ("start", 0, []))
        self.assertEqual((last["stage"], last["exit"]), ("end", code))
        self.assertEqual("error" in last, code != 0)
        self.assertTrue(all("exit" not in line for line in lines[:-1]))
        for key in ("share", "seconds"):
            values = [line[key] for line in lines]
            self.assertEqual(values, sorted(values), key)
        self.assertTrue(all(0 <= line["share"] <= 1 for line in lines))
        new = [warning for line in lines[:-1] for warning in line["warnings"]]
        self.assertEqual(new, last["warnings"][:len(new)])
        self.assertLess(len(lines), 5 * last["seconds"] + 4)

    def test_status_of_a_build(self):
        started = time.monotonic()
        _, err = self.succeed(*BUILD, "--status", "s.jsonl")
        seconds = time.monotonic() - started
        lines = lines_of("s.jsonl")
        self.check(lines, 0)
        self.assertEqual(lines[0]["command"], "build")
        self.assertRegex(lines[0]["version"], r"^\d+\.\d+\.\d+$")
        self.assertEqual(lines[0]["inputs"], ["ct.nii.gz", "l.nii.gz"])
        last = lines[-1]
        self.assertEqual(last["share"], 1)
        self.assertAlmostEqual(last["seconds"], seconds, delta=0.5)
        self.assertTrue(last["warnings"])
        for warning in last["warnings"]:
            self.assertIn(warning, err)
        self.assertIn("quality", {line["stage"] for line in lines})  # shorter ones may pass between two lines
        # A stage that runs again, as in the search for the resolution, still moves the share: it is near the time's.
        far = max(abs(line["share"] - line["seconds"] / last["seconds"]) for line in lines)
        self.assertLess(far, 0.35)
        self.assertGreater(len({line["share"] for line in lines}), 0.4 * len(lines))
        self.succeed("phantom", "-o", "p.mha", "--status", "s.jsonl")  # one of an earlier run is replaced
        self.check(lines_of("s.jsonl"), 0)
        self.assertEqual(sorted(os.listdir()), ["ct.nii.gz", "l.nii.gz", "out", "p.mha", "s.jsonl"])

    def test_status_of_several_bones(self):
        self.succeed("build", "ct.nii.gz", "--labels", "l.nii.gz", "--label", 1, "--label", 2, "--tetrahedra", 2000, "-o", "out",
                     "--status", "s.jsonl")
        lines = lines_of("s.jsonl")
        self.check(lines, 0)
        subjects = [line["subject"] for line in lines if "subject" in line]
        self.assertEqual(list(dict.fromkeys(subjects)), ["label_1", "label_2"])
        begun = next(line["share"] for line in lines if line.get("subject") == "label_2")
        self.assertAlmostEqual(begun, 0.52, delta=0.06)

    def test_status_of_what_fails(self):
        def fail(code, *arguments):
            got, _, err = bonetk(*arguments, "--status", "s.jsonl")
            self.assertEqual(got, code, err)
            lines = lines_of("s.jsonl")
            self.check(lines, code)
            self.assertLess(lines[-1]["share"], 1)
            self.assertEqual(err.splitlines()[-1], f"bonetk {arguments[0]}: " + lines[-1]["error"])
            return lines[-1]["error"]

        self.assertIn("nowhere.nii.gz", fail(1, "contours", "nowhere.nii.gz", "--labels", "l.nii.gz", "-o", "c.vtp"))
        self.assertIn("label 9", fail(1, *BUILD, "--label", "9"))
        self.assertIn("--labels", fail(2, "build", "ct.nii.gz", "-o", "out"))

    def test_status_of_what_is_interrupted(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            process = subprocess.Popen([BONETK] + BUILD + ["--status", "s.jsonl", "--quiet"])
            while not os.path.exists("s.jsonl") or len(lines_of("s.jsonl")) < 2:
                time.sleep(0.02)
            process.send_signal(number)
            self.assertEqual(process.wait(20), 128 + number)
            lines = lines_of("s.jsonl")
            self.check(lines, 128 + number)
            self.assertEqual(lines[-1]["error"], "interrupted by " + number.name)
            self.assertEqual(sorted(os.listdir()), ["ct.nii.gz", "l.nii.gz", "s.jsonl"])
            os.remove("s.jsonl")

    def test_status_by_pipes(self):
        command = ["contours", "ct.nii.gz", "--labels", "l.nii.gz", "--slice-step", 4, "-o", "c.vtp"]
        out, _ = self.succeed(*command, "--quiet", "--status", "/dev/stdout")
        self.check([json.loads(line) for line in out.splitlines()], 0)

        reader, writer = os.pipe()
        code, _, err = bonetk(*command, "--status", f"/dev/fd/{writer}", pass_fds=[writer])
        self.assertEqual(code, 0, err)
        os.close(writer)
        with os.fdopen(reader) as file:
            self.check([json.loads(line) for line in file], 0)

        os.mkfifo("fifo")
        seen = []
        thread = threading.Thread(target=lambda: seen.extend(lines_of("fifo")))
        thread.start()
        self.succeed(*command, "--status", "fifo")
        thread.join()
        self.check(seen, 0)

    def test_readers_that_go_or_sleep(self):
        reader, writer = os.pipe()
        os.close(reader)
        code, _, err = bonetk("phantom", "-o", "p.mha", "--status", f"/dev/fd/{writer}", pass_fds=[writer])
        self.assertEqual((code, err), (0, ""))
        os.close(writer)

        reader, writer = os.pipe()
        size = fcntl.fcntl(writer, 1032)  # F_GETPIPE_SZ: a full pipe takes no line
        os.write(writer, b" " * size)
        process = subprocess.Popen([BONETK, "phantom", "-o", "q.mha", "--status", f"/dev/fd/{writer}"],
                                   pass_fds=[writer])
        time.sleep(0.5)
        self.assertIsNone(process.poll())
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(5), 130)
        self.assertNotIn("q.mha", os.listdir())

    def test_status_files_that_are_refused(self):
        os.mkdir("folder")
        for path, says in (("nowhere/s.jsonl", "No such file"), ("folder", "folder"), ("ct.nii.gz", "no status file"),
                           ("/dev/fd/57", "Bad file descriptor"),
                           ("p.mha", "output"), ("./folder/../p.mha", "output"), ("p.txt", "output")):
            self.refuse_usage("phantom", "-o", "p.mha", "--status", path, says=says)
        self.refuse("phantom", "-o", "p.mha", "--status", "/dev/full", code=3, says="No space left")
        os.mkdir("out")
        self.refuse_usage(*BUILD, "--status", "out/report.json", says="output")
        self.refuse_usage("simplify", "m.vtu", "-o", "m", "--status", "m_L1.vtu", says="output")
        self.succeed("phantom", "-o", "p.mha", "--status", "p.jsonl")
        self.check(lines_of("p.jsonl"), 0)
        with open("precious.txt", "w") as file:
            file.write("mine")
        self.refuse_usage("phantom", "-o", "p.mha", "--status", "precious.txt", says="no status file")
        with open("precious.txt") as file:
            self.assertEqual(file.read(), "mine")

    def test_verbose(self):
        _, err = self.succeed("contours", "ct.nii.gz", "--labels", "l.nii.gz", "--slice-step", 6, "--verbose", "-o", "c.vtp")
        stages = [line for line in err.splitlines() if "warning" not in line]
        self.assertTrue(all(re.fullmatch(r"bonetk contours: [a-z ]+ \d+\.\d s", line) for line in stages), err)
        self.assertEqual([line.split(": ")[1].rsplit(" ", 2)[0] for line in stages],
                         ["contours", "slices", "resample", "medial axis"])
        self.refuse_usage("phantom", "--quiet", "--verbose", "-o", "p.mha", says="excludes")

    def on_terminal(self, *arguments):
        """What a terminal on standard error gets."""
        ours, theirs = pty.openpty()
        process = subprocess.Popen([BONETK, *arguments], stdout=subprocess.DEVNULL, stderr=theirs)
        os.close(theirs)
        text = b""
        try:
            while piece := os.read(ours, 4096):
                text += piece
        except OSError:
            pass  # its other end was closed
        os.close(ours)
        self.assertEqual(process.wait(), 0)
        return text.decode()

    def test_terminal(self):
        text = self.on_terminal(*BUILD)
        shown = [line for line in re.split("[\r\n]+", text) if "%" in line]
        self.assertGreater(len(shown), 1)  # five a second at most, after the first second
        pattern = r"bonetk build: ([a-z]+(?: [a-z]+)*(?: L\d)?) +(\d+) %(, about \d+ s left)? *"
        found = [re.fullmatch(pattern, line) for line in shown]
        self.assertTrue(all(found), shown)
        shares = [int(match.group(2)) for match in found]
        self.assertEqual(shares, sorted(shares))
        self.assertTrue(all(match.group(3) for match in found if int(match.group(2)) > 2))
        self.assertTrue({"quality", "collapse", "evaluation", "writing"} & {match.group(1) for match in found})
        self.assertRegex(text, r"%[^\r\n]*\r +\r[^%]*$")  # nothing stays
        self.assertNotIn("%", self.on_terminal(*BUILD, "--quiet"))


if __name__ == "__main__":
    main()
