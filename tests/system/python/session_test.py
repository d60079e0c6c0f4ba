"""Sessions: the numbers of `asperity run`, faults, recordings there and back."""

import ctypes
import os
import subprocess
import tempfile
import unittest

import numpy as np

import asperity
from support import COMMAND, file_of, fresh_random, model, renderer


class Sessions(unittest.TestCase):
    def test_a_session_has_the_numbers_of_the_command(self):
        seed = int(fresh_random().integers(1, 2**31))
        with tempfile.TemporaryDirectory() as folder:
            out = os.path.join(folder, "session.csv")
            subprocess.run([COMMAND, "--quiet", "run", "--probe", file_of("block"), "--fixed", file_of("gear"),
                            "--seconds", "1", "--seed", str(seed), "--record", out], check=True, capture_output=True)
            told = asperity.load_recording(out)
            packed = os.path.join(folder, "session.npz")
            subprocess.run([COMMAND, "--quiet", "run", "--probe", file_of("block"), "--fixed", file_of("gear"),
                            "--seconds", "1", "--seed", str(seed), "--record", packed], check=True, capture_output=True)
            same = asperity.load_recording(packed)
        self.assertEqual(list(same), list(told))
        for name in told:
            np.testing.assert_array_equal(same[name], told[name], name)
            self.assertEqual(same[name].dtype, told[name].dtype)
        session = asperity.Session(renderer("planes"), asperity.SimulatedDevice(seed=seed))
        ours = asperity.Recording.join([session.run(0.4), session.run(0.6), session.stop()])
        self.assertEqual(list(ours), list(told))
        for name in told:
            np.testing.assert_array_equal(ours[name], told[name], name)
        self.assertGreater(np.abs(ours.hand_wrench[:, 2]).max(), 0.1)

    def test_a_fault_shuts_the_gate(self):
        session = asperity.Session(renderer("planes"), asperity.SimulatedDevice(faults=[("depart", 0.1, 0.2)]))
        felt = session.run(1.0)
        self.assertEqual(session.fault, "device departed")
        self.assertLess(felt.time_s[-1], 0.2)
        with self.assertRaisesRegex(ValueError, "nan_pose, "):
            asperity.SimulatedDevice(faults=[("flood", 0, 1)])

    def test_a_stopped_session_is_over(self):
        session = asperity.Session(renderer("planes"))
        session.stop()
        with self.assertRaises(asperity.Error):
            session.run(0.1)


START = np.array([0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 1.0])
WALL_C = """
#include <stddef.h>
void wall(const double *probe, const double *bodies, size_t count, double *wrench, double *stiffness) {
  const double depth = 0.097 - probe[2];
  (void)bodies, (void)count;
  if (depth > 0.0) {
    wrench[2] = 2000.0 * depth;
    stiffness[6 * 2 + 2] = -2000.0;
  }
}
"""


def wall(probe, bodies):
    """A plate of 2000 N/m at a height of 97 mm."""
    assert bodies.shape == (1, 7)
    wrench, stiffness = np.zeros(6), np.zeros((6, 6))
    depth = 0.097 - probe[2]
    if depth > 0:
        wrench[2], stiffness[2, 2] = 2000 * depth, -2000
    return wrench, stiffness


def down(time_s, probe):
    return START - [0, 0, 0.02 * min(time_s, 0.5), 0, 0, 0, 0]


class Policies(unittest.TestCase):
    """A contact and a hand of one's own."""

    def session(self, **more):
        return asperity.Session(renderer("least-motion"), start_pose=START, coupling_n_per_m=1000.0, **more)

    def test_a_press_on_a_wall_is_what_springs_say(self):
        felt = self.session(contact=wall, hand=down).run(1.5)
        # Wall, coupling and the hand's own 300 N/m in a row, over 7 mm.
        wanted = 0.007 / (1 / 2000 + 1 / 1000 + 1 / 300)
        self.assertAlmostEqual(felt.hand_wrench[-200:, 2].mean(), wanted, delta=0.02 * wanted)
        depth = 0.097 - felt.probe_pose[-200:, 2].mean()
        self.assertAlmostEqual(2000 * depth, wanted, delta=0.02 * wanted)
        self.assertEqual(np.abs(felt.contact_wrench[:120]).max(), 0.0, "above the wall")

    def test_a_compiled_contact_is_the_same(self):
        with tempfile.TemporaryDirectory() as folder:
            source, library = os.path.join(folder, "wall.c"), os.path.join(folder, "wall.so")
            with open(source, "w") as out:
                out.write(WALL_C)
            subprocess.run(["g++", "-xc", "-shared", "-fPIC", "-O1", "-ffp-contract=off", source, "-o", library], check=True)
            address = ctypes.cast(ctypes.CDLL(library).wall, ctypes.c_void_p).value
            ours = self.session(contact=wall, hand=down).run(0.6)
            theirs = self.session(contact=address, hand=down).run(0.6)
        for name in ours:
            np.testing.assert_array_equal(ours[name], theirs[name], name)
        self.assertGreater(ours.hand_wrench[-1, 2], 0.5)

    def test_a_hand_goes_where_it_is_led(self):
        goal = START + [0.01, -0.02, 0.03, 0, 0, 0, 0]
        goal[3:] = [0.0, 0.6, 0.0, 0.8]
        times = []

        def hand(time_s, probe):
            times.append(time_s)
            return goal

        felt = self.session(contact=lambda probe, bodies: np.zeros(6), hand=hand).run(1.0)
        np.testing.assert_allclose(felt.probe_pose[-1, :3], goal[:3], atol=3e-4)
        np.testing.assert_allclose(felt.probe_pose[-1, 3:], goal[3:], atol=0.01)
        np.testing.assert_allclose(np.diff(times), 1e-3, atol=1e-12)

    def test_what_they_raise_ends_the_run_and_is_told(self):
        class Mine(Exception):
            pass

        def breaks(probe, bodies):
            if probe[2] < 0.0985:
                raise Mine("at the door")
            return np.zeros(6)

        session = self.session(contact=breaks, hand=down)
        with self.assertRaisesRegex(Mine, "at the door"):
            session.run(1.0)
        self.assertLess(session.time_s, 0.3)
        with self.assertRaises(Mine):
            session.run(1.0)
        for returned, why in ((np.zeros(3), r"shape \(3,\)"), ((np.zeros(6), np.zeros(6)), r"shape \(6,\)"), ("nothing", "wrench"),
                              (np.full(6, np.nan), "not finite"), ((1, 2, 3), "pair")):
            with self.assertRaisesRegex((ValueError, TypeError), why):
                self.session(contact=lambda probe, bodies, told=returned: told).run(0.1)
        with self.assertRaisesRegex(asperity.Error, "hand's pose"):
            self.session(contact=wall, hand=lambda time_s, probe: np.zeros(7)).run(0.1)
        with self.assertRaisesRegex(ValueError, "hand's pose"):
            self.session(contact=wall, hand=lambda time_s, probe: np.zeros(6)).run(0.1)
        for neither, why in (("wall", "callable"), (0, "address 0")):
            with self.assertRaisesRegex((TypeError, ValueError), why):
                self.session(contact=neither)
        with self.assertRaisesRegex(TypeError, "callable"):
            self.session(hand=7)


class Recordings(unittest.TestCase):
    def test_there_and_back(self):
        recorded = asperity.Session(renderer("planes"), asperity.SimulatedDevice(motion="press")).run(0.7)
        with tempfile.TemporaryDirectory() as folder:
            for name in ("a.npz", "a.csv"):
                file = os.path.join(folder, name)
                recorded.save(file)
                back = asperity.load_recording(file)
                self.assertEqual(list(back), list(recorded))
                for column in recorded:
                    np.testing.assert_array_equal(back[column], recorded[column], column)
            with np.load(os.path.join(folder, "a.npz")) as plain:
                self.assertEqual(plain["time_s"].shape, (recorded.rows,))
            self.assertEqual(sorted(os.listdir(folder)), ["a.csv", "a.npz"])
            with open(os.path.join(folder, "b.npz"), "wb") as bad:
                bad.write(b"no archive")
            with open(os.path.join(folder, "b.csv"), "w") as bad:
                bad.write("time_s,depth_m\n1,2\n3\n")
            for name, code in (("b.npz", "bad_format"), ("b.csv", "bad_format"), ("c.csv", "io_failed"),
                               ("d.mcap", "unsupported")):
                with self.assertRaises(asperity.Error) as caught:
                    asperity.load_recording(os.path.join(folder, name))
                self.assertEqual(caught.exception.code, code)


if __name__ == "__main__":
    unittest.main()
