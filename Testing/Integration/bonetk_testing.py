"""What the integration tests share: running bonetk, small inputs, and the rules that every command keeps."""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import nibabel
import numpy

BONETK = os.environ["BONETK"]
EXAMPLES = os.environ.get("BONETK_EXAMPLES", "")


def bonetk(*arguments, **options):
    """Runs a command; returns exit code, standard output and standard error."""
    return run(BONETK, *arguments, **options)


def run(*command, **options):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, **options)
    return done.returncode, done.stdout, done.stderr


def write_image(path, voxels, spacing=(1.0, 1.0, 1.0)):
    """Writes an array indexed [x, y, z] as NIfTI; axes along R, A, S."""
    nibabel.save(nibabel.Nifti1Image(voxels, numpy.diag(list(spacing[:3]) + [1.0])), path)


def read_json(path):
    with open(path) as file:
        return json.load(file)


def write_json(content, path):
    with open(path, "w") as file:
        json.dump(content, file)


PHANTOMS = tempfile.TemporaryDirectory()  # of this process, by options


def phantom(*options, ct="ct.nii.gz", labels="l.nii.gz", every=1):
    """Puts a phantom's CT and label map into the present folder, as NIfTI with every so many voxels along each axis: fine
    phantoms are made sooner than coarse ones. Each is made once in a process."""
    options = [str(option) for option in options]
    files = {name: kind + name[name.index("."):] for name, kind in ((ct, "ct"), (labels, "labels"))}
    made = os.path.join(PHANTOMS.name, " ".join([*options, str(every), *files.values()]))
    if not os.path.exists(made):
        os.mkdir(made)
        paths = [os.path.join(made, kept) for kept in files.values()]
        code, out, err = bonetk("phantom", *options, "-o", paths[0], "--labels", paths[1])
        assert code == 0, out + err
        for path in paths if every > 1 else ():
            image = nibabel.load(path)
            sliced = image.slicer[::every, ::every, ::every]
            nibabel.save(nibabel.Nifti1Image(numpy.asarray(sliced.dataobj), sliced.affine, sliced.header), path)
    for name, kept in files.items():
        shutil.copyfile(os.path.join(made, kept), name)


class TestCase(unittest.TestCase):
    """A test in an empty folder of its own."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.before = os.getcwd()
        os.chdir(self.folder.name)
        self.addCleanup(os.chdir, self.before)

    def succeed(self, *arguments):
        code, out, err = bonetk(*arguments)
        self.assertEqual(code, 0, f"bonetk {arguments}: {err}")
        return out, err

    def refuse(self, *arguments, code=1, says="", lines=1, **options):
        """The command must fail with `lines` lines at most, the last of which says `says`, and leave nothing behind."""
        files = sorted(os.listdir())
        got, out, err = bonetk(*arguments, **options)
        self.assertEqual(got, code, f"bonetk {arguments}: {out}{err}")
        self.assertTrue(1 <= len(err.splitlines()) <= lines, f"bonetk {arguments}: {err}")
        self.assertTrue(err.splitlines()[-1].startswith("bonetk"), err)
        self.assertNotRegex(err, r"\b0x[0-9a-f]{4}")  # an address; names of temporary folders may hold 0x
        self.assertNotIn(".cxx", err)
        self.assertNotIn(".hxx", err)
        self.assertIn(says, err)
        self.assertEqual(sorted(os.listdir()), files, f"bonetk {arguments} left something behind")
        return err

    def refuse_usage(self, *arguments, says=""):
        return self.refuse(*arguments, code=2, says=says)


def main():
    unittest.main(argv=[sys.argv[0], "-v"])
