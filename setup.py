"""pip install . builds the Python package by CMake, in build/pip or in the build tree that BONETK_BUILD_DIR names;
CMAKE_ARGS holds further options. See Wrapping/Python/README.md."""
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).resolve().parent


class CMakeBuild(build_ext):
    def run(self):
        build = pathlib.Path(os.environ.get("BONETK_BUILD_DIR") or ROOT / "build/pip").absolute()
        options = [f"-DPython_EXECUTABLE={sys.executable}", *shlex.split(os.environ.get("CMAKE_ARGS", ""))]
        if not (build / "CMakeCache.txt").exists():
            options += ["-DCMAKE_BUILD_TYPE=Release", "-DBUILD_TESTING=OFF", "-DBONETK_BUILD_EXAMPLES=OFF"]
            options += ["-G", "Ninja"] if shutil.which("ninja") else []
        subprocess.check_call(["cmake", "-S", ROOT, "-B", build, *options])
        subprocess.check_call(["cmake", "--build", build, "--parallel", "--target", "bonePython"])

        prefix = pathlib.Path(self.build_temp).absolute() / "prefix"
        subprocess.check_call(["cmake", "--install", build, "--prefix", prefix, "--component", "python", "--strip"])
        installed = next(prefix.rglob("_bonetk.*")).parent
        package = pathlib.Path(self.build_lib) / "bonetk"
        shutil.copytree(installed, package, dirs_exist_ok=True)
        shutil.copy(next(prefix.rglob("copyright")), package)


setup(
    version=re.search(r"project\(BoneTK VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1],
    packages=[],
    ext_modules=[Extension("bonetk._bonetk", [])],  # that the wheel is of one machine and one Python
    cmdclass={"build_ext": CMakeBuild},
)
