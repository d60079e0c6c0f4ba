"""What users read: every public name has a docstring and a type, examples in docstrings run, plots are drawn."""

import ast
import inspect
import os
import subprocess
import sys
import tempfile
import unittest

import asperity
from asperity import _asperity
from support import SOURCE, model, poses, renderer, fresh_random


class Names(unittest.TestCase):
    def test_every_public_name_has_a_docstring(self):
        missing = []
        for owner in (asperity, _asperity):
            for name, value in vars(owner).items():
                if name.startswith("_") or not (inspect.isclass(value) or callable(value)):
                    continue
                members = vars(value).items() if inspect.isclass(value) and value.__module__.startswith("asperity") else ()
                parts = [(f"{name}.{n}", v) for n, v in members
                         if not n.startswith("_") and (callable(v) or isinstance(v, (property, staticmethod)))]
                missing += [n for n, v in [(name, value), *parts] if not (v.__doc__ or "").strip()]
        self.assertEqual(missing, [])

    def test_types_hold_and_every_name_is_declared(self):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([sys.executable, "-m", "mypy", "--strict", os.path.join(SOURCE, "tools/python/asperity")],
                                  cwd=folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        with open(os.path.join(SOURCE, "tools/python/asperity/_asperity.pyi")) as declarations:
            told = {}
            for node in ast.parse(declarations.read()).body:
                if isinstance(node, ast.ClassDef):
                    told[node.name] = {n.name for n in node.body if not n.name.startswith("_")}
                elif isinstance(node, ast.FunctionDef):
                    told[node.name] = None
        real = {n: {m for m in vars(v) if not m.startswith("_")} if inspect.isclass(v) else None
                for n, v in vars(_asperity).items() if callable(v) and not n.startswith("_")}
        self.assertEqual(told, real)


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
