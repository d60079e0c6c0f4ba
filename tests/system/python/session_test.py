"""Sessions: the numbers of `asperity run`, faults, recordings there and back."""

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
