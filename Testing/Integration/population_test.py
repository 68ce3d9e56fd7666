#!/usr/bin/env python3
"""Examples/Population: many subjects by the Slurm scripts, here without Slurm, and by Snakemake where that is installed."""
import csv
import json
import os
import shutil
import unittest

from bonetk_testing import BONETK, TestCase, main, phantom, read_json, run

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Examples", "Population")
BUILD = "--tetrahedra 1500 --levels 0.5 --degree 1 --no-page"
REGISTER = "--degree 1"
TRAIN = "--no-page"

# In place of bonetk: notes each call; kills the first build of s1, every one of oom, and the first registration of s2; the first
# build of s2 finds a full disk; the standard of `bad` is not there.
WORKER = f"""#!/bin/sh
echo "$*" >> calls.txt
case "$*" in
  *registered/s2*) mkdir killed2 2> /dev/null && kill -9 $$ ;;
  *registered/bad*) for last; do :; done; exec {BONETK} register subject gone.vtu "$4" -o r.vtu --status "$last" ;;
  *models/s1*) mkdir killed 2> /dev/null && kill -9 $$ ;;
  *models/s2*) mkdir full 2> /dev/null && exit 3 ;;
  *models/oom*) kill -9 $$ ;;
esac
exec {BONETK} "$@"
"""
FAILURES = [["subject", "exit", "reason"],
            ["other_label", "1", "l0.nii.gz: The label map has no label 7"],
            ["no_ct", "1", "gone.nii.gz: there is no such file"],
            ["oom", "137", "killed by signal 9 in the stage start"]]


def read(path):
    with open(path, "rb") as file:
        return file.read()


class Population(TestCase):
    def setUp(self):
        super().setUp()
        os.environ["PYTHONDONTWRITEBYTECODE"] = "1"
        os.environ["POPULATION"] = FOLDER
        with open("bonetk", "w") as file:
            file.write(WORKER)
        os.chmod("bonetk", 0o755)
        self.rows = [["subject", "ct", "labels", "label"], ["other_label", "ct0.nii.gz", "l0.nii.gz", "7"],
                     ["no_ct", "gone.nii.gz", "l0.nii.gz", ""], ["oom", "ct0.nii.gz", "l0.nii.gz", ""]]
        for subject in range(3):
            self.add(subject)

    def add(self, subject):
        phantom("--subject", subject, ct=f"ct{subject}.nii.gz", labels=f"l{subject}.nii.gz", every=3)
        self.rows.append([f"s{subject}", f"ct{subject}.nii.gz", f"l{subject}.nii.gz", ""])
        with open("subjects.csv", "w", newline="") as file:
            csv.writer(file).writerows(self.rows)

    def calls(self):
        """The subjects of the builds since the last call, of the registrations, sorted, and how many atlases were trained."""
        if not os.path.exists("calls.txt"):
            return [], [], 0
        with open("calls.txt") as file:
            calls = [line.split() for line in file]
        os.remove("calls.txt")
        made = {what: sorted(os.path.basename(call[call.index("-o") + 1]) for call in calls if call[0] == what)
                for what in ("build", "register", "train")}
        self.assertEqual(sum(map(len, made.values())), len(calls))
        return made["build"], made["register"], len(made["train"])

    def check(self, results, subjects):
        """The table of failures and, in the atlas, the others."""
        with open(f"{results}/failures.csv", newline="") as file:
            failures = list(csv.reader(file))
        self.assertEqual([row[:2] for row in failures], [row[:2] for row in FAILURES])
        for row, expected in zip(failures, FAILURES):
            self.assertEqual(row[2][:len(expected[2])], expected[2])
        self.assertEqual([subject["name"] for subject in read_json(f"{results}/atlas.json")["subjects"]], subjects)
        used = sum(subject["used"] for subject in read_json(f"{results}/atlas.json")["subjects"])
        self.assertRegex(self.succeed("info", f"{results}/atlas.h5")[0], rf"\nsubjects +{used}\n")

    def array(self, step, options):
        """What Slurm runs: a task a subject, requeued or not."""
        environment = dict(os.environ, BONETK="./bonetk", BONETK_OPTIONS=options)
        for task in range(1, len(self.rows)):
            code, out, err = run("bash", f"{FOLDER}/array.sbatch", step, "subjects.csv", "array",
                                 env=dict(environment, SLURM_ARRAY_TASK_ID=str(task)))
            self.assertEqual(code, 0, out + err)

    def train(self):
        code, out, err = run("bash", f"{FOLDER}/train_after.sbatch", "subjects.csv", "array",
                             env=dict(os.environ, BONETK="./bonetk", BONETK_OPTIONS=TRAIN))
        self.assertEqual(code, 0, out + err)
        return err

    def test_array(self):
        # A task that was requeued so often that no attempt is left says where the last one was.
        requeued = dict(os.environ, SLURM_ARRAY_TASK_ID="3", SLURM_RESTART_COUNT="3", BONETK="./bonetk")
        self.assertEqual(run("bash", f"{FOLDER}/array.sbatch", "build", env=requeued)[0], 0)
        self.assertEqual(self.calls(), ([], [], 0))
        with open("results/outcomes/oom.csv") as file:
            self.assertEqual(file.read(), "oom,,no end in the stage start\n")

        self.array("build", BUILD)
        self.assertEqual(self.calls(), (["no_ct", "oom", "oom", "oom", "other_label", "s0", "s1", "s1", "s2", "s2"], [], 0))
        self.array("build", BUILD)  # as Slurm may: nothing is done twice
        self.assertEqual(self.calls(), ([], [], 0))
        self.array("register", REGISTER)
        self.assertEqual(self.calls(), ([], ["s0.vtu", "s1.vtu", "s2.vtu", "s2.vtu"], 0))
        self.array("register", REGISTER)
        self.assertEqual(self.calls(), ([], [], 0))
        self.assertNotIn("standard.vtu", self.train())
        self.check("array", ["s0", "s1", "s2"])

        # What a build doubts is in a table.
        report = read_json("array/models/s1/report.json")
        for doubts in ([], ["a doubt, with a comma", "another"]):
            with open("array/models/s1/report.json", "w") as file:
                json.dump({**report, "doubts": doubts}, file)
            self.train()
            with open("array/doubts.csv", newline="") as file:
                rows = list(csv.reader(file))
            self.assertEqual(rows[0], ["subject", "doubt"])
            self.assertEqual([row[1] for row in rows if row[0] == "s1"], doubts)

        # A subject that is built anew is registered anew, to the same standard.
        self.calls()
        standard = read("array/standard.vtu")
        os.remove("array/outcomes/s0.csv")
        self.array("build", BUILD.replace("1500", "1200") + " --force")
        self.array("register", REGISTER)
        self.assertEqual(self.calls(), (["s0"], ["s0.vtu"], 0))
        self.assertEqual(read("array/standard.vtu"), standard)
        self.assertIn("array/standard.vtu, which is not the present model of s0", self.train())

    def test_registration_that_fails(self):
        self.rows = self.rows[:1] + [["bad", "ct0.nii.gz", "l0.nii.gz", ""]] + self.rows[4:]
        self.add(3)
        self.array("build", BUILD)
        self.array("register", REGISTER)
        self.train()
        with open("array/failures.csv", newline="") as file:
            failures = list(csv.reader(file))
        self.assertEqual([row[:2] for row in failures], [["subject", "exit"], ["bad", "1"]])
        self.assertRegex(failures[1][2], r"^registration: gone\.vtu")
        self.assertEqual([subject["name"] for subject in read_json("array/atlas.json")["subjects"]], ["s0", "s1", "s2", "s3"])

    def snakemake(self, *options):
        code, out, err = run("snakemake", "--snakefile", f"{FOLDER}/Snakefile", "--cores", 2, *options, "--config",
                             "bonetk=./bonetk", f"build={BUILD}", f"register={REGISTER}", f"train={TRAIN}",
                             env=dict(os.environ, HOME=os.getcwd()))
        self.assertEqual(code, 0, out + err)
        return out + err

    @unittest.skipUnless(shutil.which("snakemake"), "snakemake is not installed")
    def test_snakemake(self):
        self.snakemake()
        self.assertEqual(self.calls(), (["no_ct", "oom", "oom", "oom", "other_label", "s0", "s1", "s1", "s2", "s2"],
                                        ["s0.vtu", "s1.vtu", "s2.vtu", "s2.vtu"], 1))
        self.check("results", ["s0", "s1", "s2"])
        self.assertIn("Nothing to be done", self.snakemake())
        self.assertEqual(self.calls(), ([], [], 0))

        self.add(3)
        self.snakemake()
        self.assertEqual(self.calls(), (["s3"], ["s3.vtu"], 1))
        self.check("results", ["s0", "s1", "s2", "s3"])

        shutil.copy("ct0.nii.gz", "gone.nii.gz")  # a file that was missing has come
        self.snakemake("results/outcomes/no_ct.csv")
        self.assertEqual(self.calls(), (["no_ct"], [], 0))

    def test_table(self):
        def refused(text, says):
            with open("bad.csv", "w") as file:
                file.write(text)
            code, _, err = run("python3", f"{FOLDER}/population.py", "collect", "bad.csv", "--results", "r")
            self.assertNotEqual(code, 0)
            self.assertEqual(len(err.splitlines()), 1, err)
            self.assertIn(says, err)

        refused("subject,ct\na,b.nii\n", "subject number 1 has no labels")
        refused("subject,ct,labels\na,b,c\na,b,c\n", "'a' is there twice")
        refused("subject,ct,labels\n../a,b,c\n", "'../a'")


if __name__ == "__main__":
    main()
