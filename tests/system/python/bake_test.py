"""Bakes: the bytes of the command's, progress, cancelling, Ctrl-C."""

import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import numpy as np

import asperity
from support import MODELS, command, file_of, model


def coarse_block(name="block"):
    return os.path.join(MODELS, "full", name + "_coarse.ply")


class Bakes(unittest.TestCase):
    def test_a_bake_has_the_bytes_of_the_command(self):
        with tempfile.TemporaryDirectory() as folder:
            out = os.path.join(folder, "gear.glb")
            asperity.bake(os.path.join(MODELS, "full", "gear.ply"), out, coarse=coarse_block("gear"), texture=256)
            with open(out, "rb") as ours, open(file_of("gear"), "rb") as theirs:
                self.assertTrue(ours.read() == theirs.read())

    def test_inspect_has_the_numbers_of_the_command(self):
        def compare(ours, theirs, where):
            for key, value in ours.items():
                if isinstance(value, dict):
                    compare(value, theirs[key], where + "." + key)
                else:
                    self.assertEqual(value, theirs[key], where + "." + key)

        compare(model("block").inspect(), command("inspect", file_of("block")), "block")

    def test_progress_is_told_and_cancels(self):
        mesh = asperity.benchmark_mesh("torus")
        stages = []
        with self.assertRaises(asperity.Error) as caught:
            asperity.bake(mesh, progress=lambda stage, done: stages.append(stage) or len(stages) < 4)
        self.assertEqual(caught.exception.code, "cancelled")
        self.assertGreaterEqual(len(stages), 4)
        with self.assertRaises(ZeroDivisionError):
            asperity.bake(mesh, progress=lambda stage, done: 1 / 0)

    def test_ctrl_c_ends_a_bake_and_leaves_nothing(self):
        program = ("import sys, time, asperity\n"
                   "mesh = asperity.benchmark_mesh('hammer')\n"
                   "print('begins', flush=True)\n"
                   "try: asperity.bake(mesh, sys.argv[1], texture=4096)\n"
                   "except KeyboardInterrupt: print('interrupted', time.monotonic(), flush=True)\n")
        for wait_s in (0.3, 1.5):
            with tempfile.TemporaryDirectory() as folder:
                run = subprocess.Popen([sys.executable, "-c", program, os.path.join(folder, "out.glb")],
                                       stdout=subprocess.PIPE, text=True)
                self.assertEqual(run.stdout.readline(), "begins\n")
                time.sleep(wait_s)
                sent = time.monotonic()
                run.send_signal(signal.SIGINT)
                word, at = run.stdout.read().split()
                self.assertEqual((word, run.wait()), ("interrupted", 0))
                print(f"interrupted after {1000 * (float(at) - sent):.0f} ms")
                self.assertLess(float(at) - sent, 5.0)  # half a second on a machine that is free
                self.assertEqual(os.listdir(folder), [])

    def test_a_mesh_of_arrays(self):
        corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
        faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6],
                 [0, 6, 4], [1, 5, 7], [1, 7, 3]]
        cube = asperity.bake(asperity.Mesh(0.02 * corners, faces), texture=64, triangles=12, material="steel")
        self.assertAlmostEqual(cube.volume_m3, 8e-6, delta=1e-12)  # positions are kept in float32
        self.assertEqual(cube.material.name, "steel")
        self.assertIsNone(cube.with_material(None).material)
        for wrong in ([[0, 1, 99]], [[0, 1, -1]], [[0, 1, 1.5]]):
            with self.assertRaises(ValueError):
                asperity.Mesh(corners, wrong)


if __name__ == "__main__":
    unittest.main()
