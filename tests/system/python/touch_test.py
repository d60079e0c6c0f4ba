"""Steps, queries and batches: the numbers of the command, and the same ones on any number of threads."""

import threading
import unittest

import numpy as np

import asperity
from support import command, file_of, fresh_random, model, poses, renderer


class Touches(unittest.TestCase):
    def test_a_step_has_the_numbers_of_the_command(self):
        for formulation in ("least-motion", "window"):
            pushed = 0.0
            for pose in poses(fresh_random(), 4):
                told = command("query", "--probe", file_of("block"), "--fixed", file_of("gear"), "--contacts",
                               formulation, "--probe-pose", " ".join(repr(float(x)) for x in pose))
                # Of windows each query of the command is the first.
                feel = asperity.Renderer(model("block"), model("gear"), formulation=formulation)
                touch = feel.query(pose)
                self.assertEqual(touch.wrench.tolist(), told["force"] + told["torque"])
                self.assertEqual([c.depth_m for c in touch.contacts], [c["depth"] for c in told["contacts"]])
                self.assertEqual(touch.stiffness.ravel().tolist(), told["stiffness"])
                pushed = max(pushed, np.abs(touch.force).max())
            self.assertGreater(pushed, 0.01)

    def test_a_batch_has_the_bits_of_single_steps_on_any_number_of_threads(self):
        for formulation in ("least-motion", "planes"):
            feel = renderer(formulation)
            at = poses(fresh_random(), 100)
            single = np.array([feel.step(pose) for pose in at])
            self.assertGreater(np.abs(single[:, :3]).max(), 0.01)
            self.assertGreater(len(np.unique(single[:, 2])), 10)
            for threads in (1, 2, 3, 4, 0):
                self.assertEqual(feel.step_batch(at, threads=threads).tobytes(), single.tobytes())

    def test_threads_that_share_a_step_change_no_bit(self):
        at = poses(fresh_random(), 60)
        for threads in (2, 3):
            alone, shared = renderer("planes"), asperity.Renderer(model("block"), model("gear"), formulation="planes", threads=threads)
            felt = np.array([shared.step(pose) for pose in at])
            self.assertGreater(np.abs(felt[:, :3]).max(), 0.01)
            self.assertEqual(felt.tobytes(), np.array([alone.step(pose) for pose in at]).tobytes())
            self.assertEqual(shared.step_batch(at, threads=3).tobytes(), felt.tobytes())

    def test_a_session_whose_contacts_are_shared_has_the_same_rows(self):
        alone, shared = (asperity.Session(asperity.Renderer(model("block"), model("gear"), formulation="planes", threads=n)).run(0.6)
                         for n in (1, 2))
        self.assertGreater(np.abs(alone.hand_wrench[:, 2]).max(), 0.1)
        for name in alone:
            np.testing.assert_array_equal(alone[name], shared[name], name)

    def test_a_batch_of_windows_goes_on_from_pose_to_pose(self):
        at = poses(fresh_random(), 70)
        first, second = (asperity.Renderer(model("block"), model("gear"), formulation="window") for _ in range(2))
        single = np.array([first.step(pose) for pose in at])
        self.assertEqual(second.step_batch(at, threads=4).tobytes(), single.tobytes())

    def test_an_empty_batch(self):
        self.assertEqual(renderer().step_batch(np.zeros((0, 7))).shape, (0, 6))
        self.assertEqual(asperity.step_each([], np.zeros((0, 7))).shape, (0, 6))

    def test_renderers_that_go_on_together_have_the_bits_of_each_alone(self):
        random = fresh_random()
        kinds = ("planes", "window", "planes", "window", "least-motion", "window")

        def pairs():
            return [asperity.Renderer(model("block"), model("gear"), formulation=kind) for kind in kinds]

        at = poses(random, 6 * 8).reshape(8, 6, 7)  # windows remember: eight steps, in order
        alone = np.array([[feel.step(pose) for feel, pose in zip(one, row)] for one in [pairs()] for row in at])
        self.assertGreater(np.abs(alone[:, 0::2, :3]).max(), 0.01)
        self.assertGreater(np.abs(alone[:, 1::2, :3]).max(), 0.01)
        for threads in (1, 3):
            together = pairs()
            felt = np.array([asperity.step_each(together, row, threads=threads) for row in at])
            self.assertEqual(felt.tobytes(), alone.tobytes())

        feel = renderer()
        for given, count, why in (([feel, feel], 2, "there twice"), ([feel], 2, r"\(2, 7\).*each of the 1"), ([model("gear")], 1, "Renderers")):
            with self.assertRaisesRegex((ValueError, TypeError), why):
                asperity.step_each(given, at[0, :count])
        with self.assertRaisesRegex(ValueError, "threads"):
            asperity.step_each([feel], at[0, :1], threads=1000)

    def test_four_threads_of_python_get_their_own_answers(self):
        at = poses(fresh_random(), 40)
        feel = renderer()
        alone = feel.step_batch(at, threads=1)
        wrong = []

        def work(k):
            for i in range(k, len(at), 2):
                if feel.step(at[i]).tobytes() != alone[i].tobytes():
                    wrong.append(i)
                if feel.query(at[i]).wrench.tobytes() != alone[i].tobytes():
                    wrong.append(i)
            if feel.step_batch(at[:40], threads=2).tobytes() != alone.tobytes():
                wrong.append("batch")

        threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
        for t in threads:
            t.start()
        for t in threads:
            t.join()
        self.assertEqual(wrong, [])

    def test_moving_the_fixed_body_is_moving_the_probe_back(self):
        pose = poses(fresh_random(), 1)[0]
        feel = asperity.Renderer(model("block"), model("gear"))
        felt = feel.step(pose)
        by = np.array([0.1, 0.2, -0.3])
        feel.fixed_poses = [[*by, 0, 0, 0, 1]]
        self.assertTrue((feel.fixed_poses[0, :3] == by).all())
        pose[:3] += by
        np.testing.assert_allclose(feel.step(pose), felt, rtol=1e-6, atol=1e-6)


class Refusals(unittest.TestCase):
    def test_a_wrong_shape_names_shape_and_unit(self):
        feel = renderer()
        for call, what in ((lambda: feel.step([0, 0, 0]), r"\(3,\).*\(7,\).*metres.*quaternion"),
                           (lambda: feel.step_batch(np.zeros((4, 6))), r"\(4, 6\).*\(N, 7\).*metres"),
                           (lambda: setattr(feel, "fixed_poses", np.zeros((2, 3))), r"\(2, 3\).*\(N, 7\)"),
                           (lambda: asperity.Mesh([[0, 0]], [[0, 0, 0]]), r"\(1, 2\).*\(N, 3\).*metres")):
            with self.assertRaisesRegex(ValueError, what):
                call()
        with self.assertRaisesRegex(TypeError, "no array of numbers"):
            feel.step("pose")

    def test_what_is_no_pose_has_our_code(self):
        feel = renderer()
        for pose, what in (([0, 0, 0, 0, 0, 0, 2], "length 2"), ([np.nan, 0, 0, 0, 0, 0, 1], "NaN")):
            with self.assertRaisesRegex(asperity.Error, what) as caught:
                feel.step(pose)
            self.assertEqual(caught.exception.code, "invalid_argument")
        at = poses(fresh_random(), 5)
        at[3, 6] = 0.0
        with self.assertRaisesRegex(asperity.Error, "row 3 of poses"):
            feel.step_batch(at)

    def test_files_and_settings(self):
        with self.assertRaises(asperity.Error) as caught:
            asperity.load("/no/such/model.glb")
        self.assertEqual(caught.exception.code, "io_failed")
        for wrong in ({"formulation": "springs"}, {"period_s": 0.0}, {"stiffness_n_per_m": -1.0}, {"grid": 1,
                      "formulation": "window"}, {"threads": 2}, {"threads": 17, "formulation": "planes"}):
            with self.assertRaises(asperity.Error) as caught:
                asperity.Renderer(model("block"), model("gear"), **wrong)
            self.assertEqual(caught.exception.code, "invalid_argument")


if __name__ == "__main__":
    unittest.main()
