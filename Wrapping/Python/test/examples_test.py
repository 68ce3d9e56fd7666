"""The examples in Examples/Python, on small models: they end, make their figures, and say what must come out."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

EXAMPLES = pathlib.Path(__file__).resolve().parents[3] / "Examples" / "Python"


class Examples(unittest.TestCase):
    def run_example(self, name, *arguments):
        """What it printed."""
        with tempfile.TemporaryDirectory() as folder:
            figure = os.path.join(folder, "figure.png")
            done = subprocess.run([sys.executable, EXAMPLES / name, figure, *map(str, arguments)], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            with open(figure, "rb") as file:
                self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")
            self.assertEqual(os.listdir(folder), ["figure.png"])
        return done.stdout

    def test_density_along_screw(self):
        text = self.run_example("density_along_screw.py", "--spacing", 3, "--tetrahedra", 3000)
        length, density, difference = map(float, re.search(
            r"([\d.]+) mm of .* density (\d+) HU\n.*: (\d+) HU", text).groups())
        self.assertGreater(length, 80)
        self.assertLess(length, 95)
        self.assertAlmostEqual(density, 348, delta=20)
        self.assertLess(difference, 40)

    def test_subject_from_two_radiographs(self):
        text = self.run_example("subject_from_two_radiographs.py", "--subjects", 4, "--spacing", 3, "--tetrahedra", 1500,
                                "--pixels", 96, "--iterations", 4)
        dice, volume, mass = map(float, re.search(r"Dice ([\d.]+); volume ([-+\d.]+)%, mass ([-+\d.]+)%", text).groups())
        self.assertGreater(dice, 0.93)
        self.assertLess(abs(volume), 5)
        self.assertLess(abs(mass), 8)


if __name__ == "__main__":
    try:
        import matplotlib  # noqa: F401
    except ImportError:
        sys.exit(77)
    unittest.main()
