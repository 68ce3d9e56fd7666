"""The guide's commands and programs, as printed, on an installed BoneTK: steps, programs and `bonetk build` give the same
bytes. The phantom alone is coarser than the guide's."""
import filecmp
import os
import re
import shutil
import subprocess
import tempfile
import unittest

GUIDE = os.environ["BONETK_GUIDE"]
BUILD = os.environ["BONETK_BUILD"]


class Guide(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = cls.temporary.name
        cls.prefix = os.path.join(cls.folder, "prefix")
        with open(GUIDE) as file:
            cls.blocks = re.findall(r"^```(\w+)\n(.*?)^```$", file.read(), re.MULTILINE | re.DOTALL)
        cls.run_command("cmake", "--install", BUILD, "--prefix", cls.prefix)
        cls.first_model = cls.block("sh", "bonetk phantom").replace("--spacing 0.8", "--spacing 1.5")
        assert "1.5" in cls.first_model
        cls.shell(cls.first_model)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    @classmethod
    def run_command(cls, *command):
        environment = dict(os.environ, PATH=os.path.join(cls.prefix, "bin") + ":" + os.environ["PATH"])
        done = subprocess.run(command, cwd=cls.folder, capture_output=True, text=True, env=environment)
        if done.returncode != 0:
            raise AssertionError(f"{command}: {done.stdout}{done.stderr}")

    @classmethod
    def shell(cls, text):
        cls.run_command("bash", "-e", "-c", text)

    @classmethod
    def block(cls, language, beginning):
        """The one block of a language that begins so."""
        found = [text for kind, text in cls.blocks if kind == language and text.startswith(beginning)]
        assert len(found) == 1, f"{len(found)} blocks of the guide begin with {beginning}"
        return found[0]

    def path(self, name):
        return os.path.join(self.folder, name)

    def assert_same(self, one, other):
        self.assertTrue(filecmp.cmp(self.path(one), self.path(other), shallow=False), f"{one} and {other} differ")

    def test_1_steps_give_the_files_of_the_build(self):
        self.shell(self.block("sh", "bonetk crop"))
        self.assert_same("c.vtp", "model/contours.vtp")
        for level in (1, 2, 3):
            self.assert_same(f"levels_L{level}.vtu", f"model/model_L{level}.vtu")
        self.assert_same("drr.mha", "model/drr_L2.mha")

    def test_2_a_report_repeats_its_build(self):
        for name in ("ct", "labels"):
            shutil.copy(self.path(name + ".nii.gz"), self.path(f"other_{name}.nii.gz"))
        self.shell(self.block("sh", "bonetk build --parameters"))
        for name in os.listdir(self.path("model")):
            if not name.startswith("report"):
                self.assert_same("again/" + name, "model/" + name)
                self.assert_same("other/" + name, "model/" + name)
        self.assert_same("model_degree_2/contours.vtp", "model/contours.vtp")
        self.assertFalse(filecmp.cmp(self.path("model_degree_2/model_L1.vtu"), self.path("model/model_L1.vtu"), shallow=False))

    def test_3_programs_give_the_files_of_the_build(self):
        with open(self.path("CMakeLists.txt"), "w") as file:
            file.write(self.block("cmake", "cmake_minimum_required"))
        for name in ("whole_job.cxx", "stages.cxx"):
            with open(self.path(name), "w") as file:
                file.write(self.block("cpp", f"// {name}"))
        self.run_command("cmake", "-G", "Ninja", "-S", ".", "-B", "build", "-DCMAKE_BUILD_TYPE=Release",
                         "-DCMAKE_PREFIX_PATH=" + self.prefix)
        self.run_command("cmake", "--build", "build")
        self.run_command("build/whole_job")
        for level in (1, 2, 3):
            self.assert_same(f"whole_job_L{level}.vtu", f"model/model_L{level}.vtu")
        with open(GUIDE) as file:
            options = re.search(r"first level of `bonetk build (.*?)`", file.read(), re.DOTALL).group(1)
        self.shell(f"bonetk build bone.mha --labels bone_labels.mha {' '.join(options.split())} -o stages_model")
        self.run_command("build/stages")
        self.assert_same("stages.vtu", "stages_model/model_L1.vtu")


if __name__ == "__main__":
    unittest.main(argv=["guide_test.py", "-v"])
