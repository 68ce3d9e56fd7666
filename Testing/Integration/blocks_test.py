#!/usr/bin/env python3
"""Every block of code in the documentation, run as it is written by an installed BoneTK.

A block's language says what is done with it, page by page, in the page's order and in one folder a page:

    sh       is run
    python   is run
    cpp      is written to the file that its first line names (`// name.cxx`), for the page's own CMakeLists.txt and commands to
             build and run; without a name it is a part of a program, and compiled and linked with all others of that kind
    cmake    is written to the file that its first line names (`# CMakeLists.txt`)
    json     is read
    text     is output or a picture, and left alone

Any other language is an error, and so is a block without one. A comment right before a block changes that:

    <!-- not run: REASON -->     it is left alone; the test counts and prints these
    <!-- given: DECLARATIONS --> what a part of a C++ program takes from its surroundings, as parameters of a function
    <!-- before: COMMANDS -->    run in the shell first: what the page's reader has, and the test has not
"""
import collections
import filecmp
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = os.environ["BONETK_BUILD"]
LANGUAGES = ("sh", "python", "cpp", "cmake", "json", "text")
COMMENTS = ("not run", "given", "before")
Block = collections.namedtuple("Block", "page line language text comments")


def pages():
    skipped = {"build", "node_modules", ".git"}
    return sorted(path for path in ROOT.rglob("*.md") if not skipped & set(path.relative_to(ROOT).parts))


def blocks_of(page, text):
    """The blocks of a page, each with the comments right before it."""
    found = []
    pattern = r"((?:^<!--(?:(?!-->).)*-->\n)*)^```([^\n]*)\n(.*?)^```$"
    for match in re.finditer(pattern, text, re.MULTILINE | re.DOTALL):
        comments = {}
        for name, value in re.findall(r"<!-- ([a-z ]+):\s(.*?)\s?-->", match[1], re.DOTALL):
            assert name in COMMENTS, f"{page}: a comment says {name}, which is none of {COMMENTS}"
            comments[name] = value
        assert match[2] in LANGUAGES, f"{page}: a block of {match[2] or 'no language'}, which is none of {LANGUAGES}"
        found.append(Block(page, text[: match.start(3)].count("\n") + 1, match[2], match[3], comments))
    ticks = len(re.findall(r"^\s*```", text, re.MULTILINE))
    assert ticks == 2 * len(found), f"{page}: {ticks} lines of ``` make no {ticks / 2} blocks"
    return found


def file_name(block):
    """That which the first line of a block names, or None."""
    match = re.match(r"(?://|#) (\w[\w.]*\.(?:cxx|txt))\n", block.text)
    return match and match[1]


def fragment(block, number):
    """A part of a program as a function, with the page's lines."""
    includes = "".join(re.findall(r"^#include .*\n", block.text, re.MULTILINE))
    body = re.sub(r"^#include .*$", "", block.text, flags=re.MULTILINE)
    given = block.comments.get("given", "")
    return includes, f'void Part{number}({given})\n{{\n#line {block.line} "{block.page}"\n{body}}}\n'


class Blocks(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.folder = pathlib.Path(temporary.name)
        prefix = cls.folder / "prefix"
        subprocess.run(["cmake", "--install", BUILD, "--prefix", prefix], check=True, capture_output=True)
        cls.environment = dict(os.environ, PATH=f"{prefix}/bin:/usr/bin:{os.environ['PATH']}", CMAKE_PREFIX_PATH=str(prefix),
                               PYTHONPATH=f"{prefix}/lib/python3/dist-packages", CMAKE_GENERATOR="Ninja")
        cls.pages = {page: blocks_of(str(page.relative_to(ROOT)), page.read_text()) for page in pages()}

    def run_in(self, folder, block, *command, **options):
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, env=self.environment, **options)
        self.assertEqual(done.returncode, 0, f"{block.page}, line {block.line}: {done.stdout[-2000:]}{done.stderr[-4000:]}")

    def run_block(self, folder, block):
        if "before" in block.comments:
            self.run_in(folder, block, "bash", "-euc", block.comments["before"])
        if "not run" in block.comments or block.language == "text":
            return
        if block.language == "sh":
            self.run_in(folder, block, "bash", "-euo", "pipefail", "-c", block.text)
        elif block.language == "python":
            self.run_in(folder, block, sys.executable, "-", input=block.text)
        elif block.language == "json":
            json.loads(block.text)
        elif block.language in ("cmake", "cpp") and file_name(block):
            (folder / file_name(block)).write_text(block.text)
        else:
            self.assertEqual(block.language, "cpp", f"{block.page}, line {block.line}: what is to be done with this block?")

    def run_page(self, page):
        folder = self.folder / str(page.relative_to(ROOT)).replace("/", "_")
        folder.mkdir()
        for block in self.pages[page]:
            self.run_block(folder, block)
        cmake = folder / "CMakeLists.txt"
        for source in folder.glob("*.cxx"):
            self.assertIn(source.name, cmake.read_text() if cmake.exists() else "", f"{page}: {source.name} is never built")
        return folder

    def assert_same(self, folder, *names):
        one, other = (folder / name for name in names)
        self.assertTrue(filecmp.cmp(one, other, shallow=False), f"{one} and {other} differ")

    def assert_alike(self, folder, *names):
        """Models of one bone by the same steps in another order of voxels."""
        tetrahedra, volumes = [], []
        for name in names:
            block = Block(name, 0, "sh", f"bonetk info {name} > info.txt", {})
            self.run_block(folder, block)
            text = (folder / "info.txt").read_text()
            tetrahedra.append(int(re.search(r"^tetrahedra +(\d+)", text, re.MULTILINE)[1]))
            volumes.append(float(re.search(r"^volume \(mm\^3\) +([0-9.]+)", text, re.MULTILINE)[1]))
        self.assertLess(abs(tetrahedra[0] / tetrahedra[1] - 1), 0.08)
        self.assertLess(abs(volumes[0] / volumes[1] - 1), 0.005)

    def test_pages(self):
        promises = {"ct.md": self.keep_ct, "cpp.md": self.keep_cpp, "xray.md": self.keep_xray}
        for page, blocks in self.pages.items():
            if any(block.language not in ("text", "cpp") or file_name(block) for block in blocks):
                with self.subTest(page=page):
                    folder = self.run_page(page)
                    if page.parent.name == "tutorials" and page.name in promises:
                        promises.pop(page.name)(folder)
        self.assertEqual(promises, {})

    def keep_ct(self, folder):
        """Steps give the contours of the build and models that are as good, a build from a report gives its files."""
        self.assert_same(folder, "c.vtp", "femur/contours.vtp")
        for level in (1, 2):  # the third ends where thin layers allow no more
            self.assert_alike(folder, f"levels_L{level}.vtu", f"femur/model_L{level}.vtu")
        for name in os.listdir(folder / "femur"):
            if not name.startswith("report"):
                self.assert_same(folder, f"again/{name}", f"femur/{name}")
        self.assert_same(folder, "degree_2/contours.vtp", "femur/contours.vtp")
        self.assertFalse(filecmp.cmp(folder / "degree_2/model_L1.vtu", folder / "femur/model_L1.vtu", shallow=False))

    def keep_cpp(self, folder):
        """The whole job writes what the command does, the stages in the CT's space something like it."""
        text = (ROOT / "Documentation/tutorials/cpp.md").read_text()
        options = " ".join(re.search(r"first level of `bonetk build (.*?)`", text, re.DOTALL)[1].split())
        block = Block("cpp.md", 0, "sh", "bonetk build ct.nii.gz --labels labels.nii.gz --tetrahedra 4000 --no-page -o whole\n"
                      f"bonetk build bone.mha --labels bone_labels.mha {options} --no-page -o stage", {})
        self.run_block(folder, block)
        for level in (1, 2, 3):
            self.assert_same(folder, f"whole_job_L{level}.vtu", f"whole/model_L{level}.vtu")
        self.assert_alike(folder, "stages.vtu", "stage/model_L1.vtu")

    def keep_xray(self, folder):
        """The pose is found, and the bone."""
        pose = json.loads((folder / "pose.json").read_text())
        for i, row in enumerate(pose["transform"][:3]):
            for j, value in enumerate(row):
                self.assertAlmostEqual(value, float(i == j), delta=0.02 if j < 3 else 0.5)
        mass = [{measure["name"]: measure["value"] for measure in json.loads((folder / name).read_text())["measures"]}["model.mass"]
                for name in ("found_measures.json", "true_measures.json")]
        self.assertAlmostEqual(mass[0] / mass[1], 1.0, delta=0.03)

    def test_parts_of_programs(self):
        """All parts of C++ programs, as one program that calls none of them."""
        parts = [block for blocks in self.pages.values() for block in blocks
                 if block.language == "cpp" and not file_name(block) and "not run" not in block.comments]
        self.assertGreater(len(parts), 10)
        made = [fragment(block, number) for number, block in enumerate(parts)]
        folder = self.folder / "parts"
        folder.mkdir()
        (folder / "parts.cxx").write_text("".join(part[0] for part in made) + "".join(part[1] for part in made) + "int main() {}\n")
        (folder / "CMakeLists.txt").write_text("""cmake_minimum_required(VERSION 3.25)
project(Parts C CXX)
find_package(BoneTK REQUIRED)
add_executable(parts parts.cxx)
target_compile_options(parts PRIVATE -O0)
target_link_libraries(parts PRIVATE BoneTK::Phantom BoneTK::Evaluation BoneTK::Registration BoneTK::Measurement BoneTK::Export)
""")
        self.run_in(folder, parts[0], "bash", "-ec", "cmake -S . -B build && cmake --build build")

    def test_what_is_not_run(self):
        blocks = [block for blocks in self.pages.values() for block in blocks]
        ran = [block for block in blocks if block.language != "text" and "not run" not in block.comments]
        skipped = [block for block in blocks if "not run" in block.comments]
        print(f"{len(ran)} blocks are run, {len(blocks) - len(ran) - len(skipped)} are text, {len(skipped)} are not run:")
        for block in skipped:
            print(f"  {block.page}, line {block.line}: {block.comments['not run']}")
        self.assertGreater(len(ran), 40)
        self.assertLess(len(skipped), 10)

    def test_what_is_wrong_is_seen(self):
        def block(text):
            (found,) = blocks_of("page.md", text)
            return found

        folder = self.folder / "wrong"
        folder.mkdir()
        for text in ("```\nls\n```\n", "```bash\nls\n```\n", "```sh\nfalse\ntrue\n```\n", "```sh\necho $unset\n```\n",
                     "```python\n1 / 0\n```\n", "```json\n{,}\n```\n", "```cmake\nproject(P)\n```\n",
                     "<!-- before: false -->\n```text\n```\n", "<!-- skipped: no reason -->\n```sh\ntrue\n```\n", "```sh\ntrue\n"):
            with self.assertRaises((AssertionError, ValueError), msg=text):
                self.run_block(folder, block(text))
        with self.assertRaises(AssertionError):
            block("<!-- not run: it is not a language -->\n```bash\nls\n```\n")
        self.run_block(folder, block("<!-- not run: it fails -->\n```sh\nfalse\n```\n"))
        self.run_block(folder, block("<!-- before: touch made -->\n```sh\nls made\n```\n"))
        self.run_block(folder, block("```cpp\n// never.cxx\nint main() {}\n```\n"))
        self.assertTrue((folder / "never.cxx").exists())


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v", *sys.argv[1:]])
