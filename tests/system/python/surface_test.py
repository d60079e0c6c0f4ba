"""What users read: every public name has a docstring, a type, and of an array its shape; plots are drawn."""

import ast
import importlib
import importlib.util
import inspect
import os
import re
import subprocess
import sys
import tempfile
import unittest

import asperity
from support import SOURCE, model, poses, renderer, fresh_random

COMPILED = ["_asperity"] + (["_mujoco"] if importlib.util.find_spec("asperity._mujoco") else [])
MODULES = ["asperity", "asperity.plot", "asperity.dataset", *(f"asperity.{name}" for name in COMPILED)]
MODULES += ["asperity.mujoco"] if "_mujoco" in COMPILED else []
# (6,), (N, 7), (nbody, 4)
EXTENT = r"(\d+|[A-Z]|n[a-z]+)"
SHAPE = re.compile(rf"\({EXTENT}(,|(, {EXTENT})+)\)")


def members(value):
    """(name, member) of a class of ours."""
    ours = inspect.isclass(value) and value.__module__.startswith("asperity")
    return [(n, v) for n, v in (vars(value).items() if ours else ())
            if not n.startswith("_") and (callable(v) or isinstance(v, (property, staticmethod)))]


class Names(unittest.TestCase):
    def test_every_public_name_has_a_docstring(self):
        missing, seen = [], 0
        for owner in map(importlib.import_module, MODULES):
            self.assertTrue((owner.__doc__ or "").strip(), owner.__name__)
            for name, value in vars(owner).items():
                if name.startswith("_") or not callable(value) or not getattr(value, "__module__", "").startswith("asperity"):
                    continue
                seen += 1
                parts = [(f"{name}.{n}", v) for n, v in members(value)]
                missing += [f"{owner.__name__}.{n}" for n, v in [(name, value), *parts] if not (v.__doc__ or "").strip()]
        self.assertEqual(missing, [])
        self.assertGreater(seen, 40)

    def test_what_returns_an_array_tells_its_shape(self):
        silent, seen = [], 0
        for name in COMPILED:
            module = importlib.import_module(f"asperity.{name}")
            for owner, node in self.declared(name):
                returned = ast.unparse(node.returns)
                if not ("_Floats" in returned or "NDArray" in returned) or owner == "SessionLoop":
                    continue
                seen += 1
                told = getattr(getattr(module, owner) if owner else module, node.name).__doc__
                if not SHAPE.search(told):
                    silent.append(f"{owner}.{node.name}: {told}")
        for told in (asperity.Recording, asperity.mujoco if "_mujoco" in COMPILED else None):
            for name, value in vars(told).items() if told else ():
                of = value.fget if isinstance(value, property) else value
                if inspect.isfunction(of) and not name.startswith("_") and "Floats" in str(of.__annotations__.get("return")):
                    seen += 1
                    silent += [] if SHAPE.search(value.__doc__) else [f"{name}: {value.__doc__}"]
        self.assertEqual(silent, [])
        self.assertGreater(seen, 40)

    def declared(self, name):
        """(class or "", function) of a module's declarations."""
        with open(os.path.join(SOURCE, f"tools/python/asperity/{name}.pyi")) as declarations:
            for node in ast.parse(declarations.read()).body:
                if isinstance(node, ast.ClassDef):
                    yield from ((node.name, n) for n in node.body if isinstance(n, ast.FunctionDef))
                elif isinstance(node, ast.FunctionDef):
                    yield "", node

    def test_types_hold_and_every_name_is_declared(self):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([sys.executable, "-m", "mypy", "--strict", os.path.join(SOURCE, "tools/python/asperity")],
                                  cwd=folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        for name in COMPILED:
            module, told = importlib.import_module(f"asperity.{name}"), {}
            for owner, node in self.declared(name):
                told.setdefault(owner, set()).add(node.name)
            functions = told.pop("", set())
            real = {n: {m for m in vars(v) if not m.startswith("_")} for n, v in vars(module).items()
                    if inspect.isclass(v) and not n.startswith("_")}
            self.assertEqual({n: {m for m in members if not m.startswith("_")} for n, members in told.items()}, real)
            self.assertEqual(functions, {n for n, v in vars(module).items() if inspect.isbuiltin(v)})


class Plots(unittest.TestCase):
    def test_plots_are_drawn(self):
        try:
            import matplotlib
        except ImportError:
            self.skipTest("matplotlib is not there")
        matplotlib.use("Agg")
        from asperity import plot

        recorded = asperity.Session(renderer("planes")).run(0.7)
        self.assertEqual(len(plot.trace(recorded).lines), 3)
        self.assertEqual(len(plot.trace(recorded, "depth_m").lines), 1)
        line = plot.spectrum([float(i % 8 < 4) for i in range(800)], 1000.0).lines[0]
        self.assertAlmostEqual(line.get_xdata()[line.get_ydata().argmax()], 125.0)
        pose = poses(fresh_random(), 1)[0]
        plot.contacts(renderer().query(pose), renderer(), pose)


if __name__ == "__main__":
    unittest.main()
