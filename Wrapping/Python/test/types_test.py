"""Type stubs: the package and the examples are right by mypy, and the stubs agree with the extension, name by name and
argument by argument."""
import ast
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import bonetk
from bonetk import _bonetk

PACKAGE = pathlib.Path(bonetk.__file__).parent
EXAMPLES = pathlib.Path(__file__).resolve().parents[3] / "Examples" / "Python"
ENVIRONMENT = dict(os.environ, MYPYPATH=str(PACKAGE.parent), MYPY_CACHE_DIR=str(PACKAGE.parent / "mypy_cache"))

GOOD = """
import pathlib
import bonetk
def show(stage: str, share: float) -> None: ...
result = bonetk.commands.build(pathlib.Path('ct'), labels='l', label=[1, 'hip'], output='o', levels=0.5,
                               degree=3, no_page=True, progress=show)
text: str = result.text
bonetk.commands.measure('m', ball=[(0, 0, 1, 2)], output='o')
bonetk.commands.profile('m', from_=(0, 0, 1), to=[1, 2, 3], output=pathlib.Path('p'))
bonetk.set_threads(2)
version: str = bonetk.__version__
f = bonetk.DensityFitFilter()
f.image, f.mesh, f.degree, f.interpolator = 'ct.nii.gz', bonetk.read_mesh('m.vtu'), 2, 'bspline'
f.update(lambda share: print(share))
mass: float = f.output.mass
share: float = f.outside_fraction
c = bonetk.TetraCollapseFilter()
c.levels = range(100, 50, -10)
first: int = c.levels[0]
try:
    bonetk.commands.info('x')
except bonetk.DataError as error:
    print(str(error))
"""
# Each line but the first is wrong.
BAD = """import bonetk
bonetk.commands.fit('ct', 'mesh', output='o', degree='three')
bonetk.commands.fit('ct', output='o')
bonetk.commands.phantom(output='o', bone='skull')
bonetk.DensityFitFilter().degre = 3
bonetk.DensityFitFilter().degree = 'three'
bonetk.DensityFitFilter().interpolator = 'nearest'
bonetk.DensityFitFilter().output = bonetk.read_mesh('m.vtu')
bonetk.read_mesh('m.vtu').point
bonetk.read_mesh('m.vtu').replace(mesh=1)
bonetk.TetraCollapseFilter().levels = 3
bonetk.XRayGeometry.framing((0, 0, 0), (1, 1, 1), pixel=2)
bonetk.drr(bonetk.read_mesh('m.vtu'), 'view')
"""


def run(module, *arguments):
    done = subprocess.run([sys.executable, "-m", module, *map(str, arguments)], capture_output=True, text=True, env=ENVIRONMENT)
    return done.returncode, done.stdout + done.stderr


class ByMypy(unittest.TestCase):
    def test_package_examples_and_calls(self):
        with tempfile.TemporaryDirectory() as folder:
            good, bad = (pathlib.Path(folder) / name for name in ("good.py", "bad.py"))
            good.write_text(GOOD)
            bad.write_text(BAD)
            # Of other packages, as matplotlib, there may be none, or no types.
            # Of other packages, as matplotlib, there may be no types, or not even the package.
            check = lambda *what: run("mypy", "--strict", "--ignore-missing-imports", *what)
            code, text = check("-p", "bonetk")
            self.assertEqual(code, 0, text)
            examples = sorted(EXAMPLES.glob("*.py"))
            self.assertEqual(len(examples), 2)
            code, text = check(good, *examples)
            self.assertEqual(code, 0, text)
            _, text = check(bad)
            found = sorted({int(line) for line in re.findall(r"^\S*bad.py:(\d+): error", text, re.M)})
            self.assertEqual(found, list(range(2, 1 + len(BAD.splitlines()))), text)

    def test_stubs_name_what_the_extension_has(self):
        code, text = run("mypy.stubtest", "bonetk._bonetk")
        self.assertEqual(code, 0, text)


def split(text):
    """At commas that no bracket or quote encloses."""
    parts, depth = [""], 0
    for character in text:
        depth += (character in "([{<") - (character in ")]}>")
        if character == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += character
    return [part.strip() for part in parts if part.strip()]


def signature_of(doc):
    """Arguments (name, type, whether it has a default) with "*" and "**", and the result, of pybind11's first line."""
    found = re.match(r"[^(]*\((.*)\) -> (.+)$", doc.splitlines()[0].replace("->", "-> ").replace("->  ", "-> "))
    arguments = []
    for part in split(found[1]):
        name, _, rest = part.partition(":")
        kind, equals, _ = rest.partition(" = ")
        arguments.append(("**", "", False) if name.startswith("**") else (name, kind.strip(), bool(equals)))
    return arguments, found[2]


def declared_of(node):
    """The same of a stub."""
    text = lambda annotation: ast.unparse(annotation) if annotation else ""
    names = node.args.args
    first = len(names) - len(node.args.defaults)
    arguments = [(a.arg, text(a.annotation), i >= first) for i, a in enumerate(names)]
    if node.args.kwonlyargs:
        arguments.append(("*", "", False))
        arguments += [(a.arg, text(a.annotation), d is not None) for a, d in zip(node.args.kwonlyargs, node.args.kw_defaults)]
    if node.args.kwarg:
        arguments.append(("**", "", False))
    return arguments, text(node.returns)


class ByTheExtension(unittest.TestCase):
    """pybind11's functions say their arguments in their docstrings only, which stubtest does not read."""

    def same_type(self, real, declared, where):
        real = real.replace("bonetk._bonetk.", "").replace("_bonetk.", "")
        if real in ("int", "float", "str", "bool", "None") or hasattr(_bonetk, real):
            # Pointers may be None where the stub says so; choices are names.
            plain = re.sub(r"^Optional\[(.*)\]$", r"\1", declared)
            plain = "str" if plain == "_Quantity" else plain
            self.assertEqual(plain, real, where)

    def compare(self, doc, node, where, method):
        arguments, result = signature_of(doc)
        declared, declared_result = declared_of(node)
        names = [(name, default) for name, _, default in declared]
        # One that C++ gives no name is arg0, arg1, ....
        self.assertEqual([(names[i][0] if re.match(r"arg\d", name) and i < len(names) else name, default)
                          for i, (name, _, default) in enumerate(arguments)], names, where)
        for (name, kind, _), (_, declared_kind, _) in list(zip(arguments, declared))[method:]:
            self.same_type(kind, declared_kind, f"{where}: {name}")
        self.same_type(result, declared_result, where)

    def test_arguments(self):
        tree = ast.parse((PACKAGE / "_bonetk.pyi").read_text())
        compared = 0
        scopes = [("", _bonetk, tree.body)] + [
            (node.name + ".", getattr(_bonetk, node.name), node.body)
            for node in tree.body if isinstance(node, ast.ClassDef) and hasattr(_bonetk, node.name)]
        for prefix, owner, body in scopes:
            for node in body:
                if not isinstance(node, ast.FunctionDef):
                    continue
                decorators = [ast.unparse(d) for d in node.decorator_list]
                value = vars(owner)[node.name]
                where = prefix + node.name
                if "property" in decorators:
                    self.same_type(signature_of(value.fget.__doc__)[1], declared_of(node)[1], where)
                elif type(getattr(owner, node.name)).__name__ in ("builtin_function_or_method", "instancemethod"):
                    if "overload" in decorators or node.name.startswith("__") and node.name not in ("__init__", "__call__"):
                        continue
                    method = bool(prefix) and "staticmethod" not in decorators
                    self.compare(getattr(owner, node.name).__doc__, node, where, method)
                    compared += 1
        self.assertGreater(compared, 60)


if __name__ == "__main__":
    try:
        import mypy  # noqa: F401
    except ImportError:
        print("mypy is not installed")
        sys.exit(77)
    unittest.main()
