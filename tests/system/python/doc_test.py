"""Examples run and print what they say: those of docstrings, and the Python of the documentation's pages.

A page's ```python blocks run in order, as one program; a ```text block after one is what that one prints. Numbers may be off by
a millionth of themselves or of one, since compilers round differently.
"""

import contextlib
import doctest
import importlib
import importlib.util
import inspect
import io
import math
import os
import re
import tempfile
import unittest

import numpy as np

import asperity
from support import SOURCE, file_of

MODULES = ["asperity", "asperity.plot", "asperity.dataset"]
if importlib.util.find_spec("asperity._mujoco"):
    MODULES.append("asperity.mujoco")
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")


def same(told, got):
    """Whether two texts agree: words to the letter, numbers to a millionth."""
    if NUMBER.sub("#", " ".join(told.split())) != NUMBER.sub("#", " ".join(got.split())):
        return False
    return all(math.isclose(float(a), float(b), rel_tol=1e-6, abs_tol=1e-6)
               for a, b in zip(NUMBER.findall(told), NUMBER.findall(got)))


class Checker(doctest.OutputChecker):
    def check_output(self, want, got, optionflags):
        return super().check_output(want, got, optionflags) or same(want, got)


@contextlib.contextmanager
def folder_with_models():
    """A folder of one's own, with block.glb and gear.glb as the tutorials make them."""
    before = os.getcwd()
    with tempfile.TemporaryDirectory() as folder:
        for name in ("block", "gear"):
            os.symlink(file_of(name), os.path.join(folder, name + ".glb"))
        os.chdir(folder)
        try:
            yield folder
        finally:
            os.chdir(before)


def public(module):
    """(name, value) of a module's own public names."""
    for name in getattr(module, "__all__", vars(module)):
        value = getattr(module, name)
        if not name.startswith("_") and (hasattr(module, "__all__") or getattr(value, "__module__", "") == module.__name__):
            yield name, value


def docstrings():
    """(name, docstring) of every module, public name and member."""
    for module_name in MODULES:
        module = importlib.import_module(module_name)
        yield module_name, module.__doc__
        for name, value in public(module):
            yield f"{module_name}.{name}", value.__doc__
            if inspect.isclass(value):
                for member, inside in vars(value).items():
                    if not member.startswith("_") or member == "__init__":
                        yield f"{module_name}.{name}.{member}", getattr(inside, "__doc__", None)


def lines_before():
    """What every example may use: the five lines of the package's docstring."""
    names = {"np": np}
    exec("import asperity\n"
         "probe, fixed = asperity.load('block.glb'), asperity.load('gear.glb')\n"
         "renderer = asperity.Renderer(probe, fixed)\n"
         "z = fixed.high[2] - probe.low[2] - 0.0005\n", names)
    return names


class Docstrings(unittest.TestCase):
    def test_examples_print_what_they_say(self):
        parser, ran = doctest.DocTestParser(), set()
        with folder_with_models():
            names = lines_before()
            for name, text in docstrings():
                test = parser.get_doctest(text or "", dict(names), name, None, None)
                if not test.examples:
                    continue
                ran.add(name)
                with self.subTest(name):
                    said = io.StringIO()
                    runner = doctest.DocTestRunner(Checker(), verbose=False)
                    runner.run(test, out=said.write)
                    self.assertEqual(runner.summarize(verbose=False).failed, 0, said.getvalue())
        # What one comes across first has an example.
        for name in (".Material", ".Mesh", ".Model", ".Recording", ".Renderer", ".Session", ".SimulatedDevice", ".Touch",
                     ".bake", ".benchmark_mesh", ".load", ".load_recording"):
            self.assertTrue(any(r == "asperity" + name or r.startswith(f"asperity{name}.") for r in ran), name)

    def test_a_wrong_example_is_seen(self):
        for told, got, agree in (("1.5 N\n", "1.50000001 N\n", True), ("1.5 N\n", "1.51 N\n", False),
                                 ("1 contact", "1 plane", False), ("[1. 2.]", "[1. 2. 3.]", False), ("0.0", "1e-12", True)):
            self.assertEqual(same(told, got), agree, (told, got))


def blocks(page):
    """(code, what it prints or None) of a page's Python, in order."""
    with open(os.path.join(SOURCE, "docs", page)) as lines:
        found = re.findall(r"```(python|text)\n(.*?)```", lines.read(), re.S)
    out = []
    for kind, text in found:
        if kind == "python":
            out.append([text, None])
        elif out and out[-1][1] is None:
            out[-1][1] = text
    return out


class Pages(unittest.TestCase):
    def run_page(self, page, least, **names):
        """Runs a page here. Returns its names."""
        printing = 0
        for code, told in blocks(page):
            said = io.StringIO()
            with contextlib.redirect_stdout(said):
                exec(compile(code, page, "exec"), names)
            if told is not None:
                printing += 1
                self.assertTrue(same(told, said.getvalue()), f"{page} says\n{told}\nand its code prints\n{said.getvalue()}")
        self.assertGreaterEqual(printing, least, f"{page} shows less than it did")
        return names

    def test_five_lines(self):
        with folder_with_models():
            names = self.run_page("tutorial/five-lines-in-python.md", 5)
            self.assertTrue(os.path.getsize("felt.png") > 10000)
            self.assertTrue((asperity.load_recording("felt.npz")["time_s"] == names["felt"].time_s).all())

    def test_a_thousand_bakes(self):
        from asperity import dataset

        with folder_with_models():
            # Of the page's three meshes the one that it looks at, and of its four hands the first.
            os.makedirs("meshes")
            mesh = asperity.benchmark_mesh("hammer")
            with open("meshes/hammer.obj", "w") as out:
                for x, y, corner in mesh.vertices:
                    out.write(f"v {x!r} {y!r} {corner!r}\n")
                for a, b, c in mesh.triangles + 1:
                    out.write(f"f {a} {b} {c}\n")
            report = dataset.make("meshes", "out", dataset.Plan("block.glb", sessions=1))
            self.assertEqual(report.made, ("models/hammer.glb", "sessions/hammer-1.npz"))
            self.run_page("tutorial/a-thousand-bakes.md", 1)

    def test_reference(self):
        with folder_with_models():
            names = lines_before()
            names["above"] = np.array([0, 0, names["z"] + 0.01, 0, 0, 0, 1])
            names["wanted"] = lambda time_s: names["above"]
            self.run_page("reference/python.md", 0, **names)

    def test_change_the_scene(self):
        with folder_with_models():
            self.run_page("how-to/change-the-scene.md", 1)

    def test_materials(self):
        with folder_with_models():
            self.run_page("how-to/materials.md", 0)
            self.assertIsNone(asperity.load("pebble.glb").material)
            for name in ("steel", "wood", "rubber"):
                self.assertEqual(asperity.load(name + ".glb").material.name, name)

    @unittest.skipUnless("asperity.mujoco" in MODULES, "asperity was built without MuJoCo")
    def test_texture_in_mujoco(self):
        with folder_with_models():
            self.run_page("tutorial/texture-in-mujoco.md", 1)


if __name__ == "__main__":
    unittest.main()
