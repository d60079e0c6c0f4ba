"""A folder of meshes baked and touched: in turn, by processes of which one is killed, and gone on with."""

import importlib.util
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import asperity
from asperity import dataset
from support import file_of, fresh_random


def write_bumpy_ball(file, random):
    """A ball of 30 mm with drawn bumps, as an .obj."""
    rings, sides = 24, 48
    phase, rate = random.uniform(0, 6, 3), random.integers(5, 11, 3)
    with open(file, "w") as out:
        def point(theta, phi):
            n = np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])
            r = 0.03 * (1 + 0.01 * np.sin(rate * n * 3 + phase).sum())
            out.write("v {:.9f} {:.9f} {:.9f}\n".format(*(r * n)))

        point(0, 0)
        for i in range(1, rings):
            for j in range(sides):
                point(np.pi * i / rings, 2 * np.pi * j / sides)
        point(np.pi, 0)
        at = lambda i, j: 2 + (i - 1) * sides + j % sides  # noqa: E731
        last = 2 + (rings - 1) * sides
        for j in range(sides):
            out.write(f"f 1 {at(1, j)} {at(1, j + 1)}\n")
            for i in range(1, rings - 1):
                out.write(f"f {at(i, j)} {at(i + 1, j)} {at(i + 1, j + 1)}\nf {at(i, j)} {at(i + 1, j + 1)} {at(i, j + 1)}\n")
            out.write(f"f {at(rings - 1, j)} {last} {at(rings - 1, j + 1)}\n")


def bytes_of(folder):
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(pathlib.Path(folder).rglob("*")) if p.is_file()}


class Datasets(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.root = pathlib.Path(cls.folder.name)
        cls.meshes = cls.root / "meshes"
        cls.meshes.mkdir()
        random = fresh_random()
        for name in "abc":
            write_bumpy_ball(cls.meshes / f"{name}.obj", random)
        (cls.meshes / "broken.ply").write_text("no mesh\n")
        cls.plan = dataset.Plan(file_of("block"), sessions=2, seconds=0.3, triangles=200, texture=128)
        cls.serial = dataset.make(cls.meshes, cls.root / "serial", cls.plan)
        cls.wanted = bytes_of(cls.root / "serial")

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_every_mesh_is_baked_and_touched(self):
        files = [f"models/{n}.glb" for n in "abc"] + [f"sessions/{n}-{k}.npz" for n in "abc" for k in (1, 2)]
        self.assertEqual(list(self.serial.made), sorted(files))
        self.assertEqual(list(self.serial.refused), ["models/broken.glb"])
        self.assertEqual(sorted(self.wanted), sorted([*files, "plan.json", "refused.json"]))
        self.assertEqual(json.loads(self.wanted["refused.json"]), self.serial.refused)
        with np.load(self.root / "serial/sessions/b-2.npz") as felt:
            self.assertEqual(felt["probe_pose"].shape, (300, 7))
            self.assertEqual(felt["hand_wrench"].shape, (300, 6))
            self.assertGreater(np.abs(felt["hand_wrench"]).max(), 0.02)
            rows = felt["hand_wrench"][:, :3]
            self.assertEqual(felt["spectrum_n"].shape, (felt["spectrum_hz"].size, 3))
            self.assertEqual(felt["spectrum_hz"][-1], 500.0)
            self.assertTrue(np.isfinite(rows).all() and felt["spectrum_n"].max() > 0)
            first = felt["probe_pose"].copy()
        with np.load(self.root / "serial/sessions/b-1.npz") as other:
            self.assertFalse(np.array_equal(first, other["probe_pose"]), "another seed is another hand")

    def test_a_spectrum_has_the_amplitude_of_a_wave(self):
        random = fresh_random()
        hz, newtons = 4 * random.integers(5, 100), random.uniform(0.1, 2.0)
        t = np.arange(1000) / 1000.0
        force = np.stack([newtons * np.sin(2 * np.pi * hz * t), np.full(1000, 3.0), 0.0 * t], axis=1)
        at, amplitude = dataset.spectrum(force, 1000.0)
        self.assertEqual(at[amplitude[:, 0].argmax()], hz)
        self.assertAlmostEqual(amplitude[:, 0].max(), newtons, delta=0.01 * newtons)
        self.assertLess(amplitude[:, 1].max(), 1e-9)
        for bad in (np.zeros(5), np.zeros((5, 2)), np.zeros((1, 3))):
            with self.assertRaisesRegex(ValueError, r"give \(N, 3\)"):
                dataset.spectrum(bad, 1000.0)

    def test_what_was_cut_off_goes_on(self):
        out = self.root / "again"
        half = dataset.make(self.meshes, out, self.plan)
        self.assertEqual(bytes_of(out), self.wanted)
        os.remove(out / "models/a.glb")
        os.remove(out / "sessions/c-2.npz")
        report = dataset.make(self.meshes, out, self.plan)
        self.assertEqual(report.made, ("models/a.glb", "sessions/c-2.npz"))
        self.assertEqual(len(report.kept), len(half.made) - 2)
        self.assertEqual(bytes_of(out), self.wanted)

    def test_another_plan_needs_another_folder(self):
        before = bytes_of(self.root / "serial")
        other = dataset.Plan(file_of("gear"), sessions=2, seconds=0.3, triangles=200, texture=256)
        with self.assertRaisesRegex(ValueError, r"another plan \(probe, texture differ\)"):
            dataset.make(self.meshes, self.root / "serial", other)
        self.assertEqual(bytes_of(self.root / "serial"), before)
        clash = self.root / "clash"
        clash.mkdir(exist_ok=True)
        for name in ("x.obj", "x.stl"):
            (clash / name).write_text("")
        with self.assertRaisesRegex(ValueError, "several meshes are called x"):
            dataset.make(clash, self.root / "nowhere", self.plan)

    @unittest.skipUnless(importlib.util.find_spec("distributed"), "dask.distributed is not there (Debian: python3-distributed)")
    def test_workers_of_which_one_is_killed_make_the_same_bytes(self):
        from distributed import Client, LocalCluster

        out = self.root / "shared"
        killed = []
        with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50) as cluster, Client(cluster) as client:
            pids = list(client.run(os.getpid).values())
            self.assertEqual(len(set(pids)), 2)

            def told(name, done, of):
                if done == 2:
                    os.kill(pids[0], signal.SIGKILL)
                    killed.append(pids[0])

            report = dataset.make(self.meshes, out, self.plan, client=client, told=told)
        self.assertEqual(killed, pids[:1])
        self.assertEqual(report.made, self.serial.made)
        self.assertEqual(report.refused, self.serial.refused)
        self.assertEqual(bytes_of(out), self.wanted)

    def test_from_the_command_line(self):
        out = self.root / "line"
        call = [sys.executable, "-m", "asperity.dataset", str(self.meshes), str(out), "--probe", file_of("block"), "--sessions", "1",
                "--seconds", "0.1", "--triangles", "200", "--texture", "128"]
        done = subprocess.run(call, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stdout, "6 files made, 0 were there, 1 refused\n")
        self.assertIn("models/broken.glb: ", done.stderr)
        done = subprocess.run(call[:-1] + ["256"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertIn("another plan (texture differ)", done.stderr)


if __name__ == "__main__":
    unittest.main()
