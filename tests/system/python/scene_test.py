"""Scenes that change: whom a Body names, that nothing is felt before it is committed, and that what is committed feels as a
scene that was made so."""

import threading
import unittest

import numpy as np

import asperity
from support import fresh_random, model, poses, renderer

AWAY = np.array([0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0])


def scene_with_gear(**limits):
    scene = asperity.Scene(model("block"), **limits)
    return scene, scene.add(model("gear"))


class Renderers(unittest.TestCase):
    def assertFeelsAs(self, feel, other, at):
        """One and the other have the same bits at these poses, and there is something to feel."""
        ours, theirs = feel.step_batch(at), other.step_batch(at)
        self.assertEqual(ours.tobytes(), theirs.tobytes())
        self.assertGreater(np.abs(theirs[:, :3]).max(), 0.01)

    def test_a_scene_feels_as_fixed_bodies_do(self):
        scene, gear = scene_with_gear()
        feel, at = scene.renderer(), poses(fresh_random(), 40)
        self.assertFeelsAs(feel, renderer("planes"), at)
        self.assertFeelsAs(scene.renderer(threads=2), renderer("planes"), at)
        touch, fixed = feel.query(at[0]), renderer("planes").query(at[0])
        self.assertEqual([p.body for p in touch.planes], [p.body for p in fixed.planes])
        self.assertEqual(scene.body_in(touch.planes[0].body), gear)
        self.assertEqual([m.name for m in feel.fixed], ["gear"])
        self.assertEqual(feel.fixed_poses.tolist(), [[0, 0, 0, 0, 0, 0, 1]])
        self.assertEqual(repr(feel), repr(renderer("planes")))

    def test_changes_are_felt_from_the_commit_on(self):
        random = fresh_random()
        scene, gear = scene_with_gear()
        feel, at = scene.renderer(), poses(random, 30)
        before = feel.step_batch(at)
        by = random.uniform(-0.1, 0.1, 3)
        there = np.array([*by, 0, 0, 0, 1])

        scene.place(gear, there)
        self.assertEqual(feel.step_batch(at).tobytes(), before.tobytes(), "nobody committed")
        version = feel.commit()
        self.assertEqual(feel.commit(), version, "nothing is new")
        moved = at + [*by, 0, 0, 0, 0]
        np.testing.assert_allclose(feel.step_batch(moved), before, rtol=1e-6, atol=1e-6)
        np.testing.assert_array_equal(scene.pose(gear), there)
        np.testing.assert_array_equal(feel.fixed_poses, [there])

        # A twin where the gear was, and the gear is gone: as before, to the bit, in another slot.
        twin = scene.add(model("gear"))
        scene.remove(gear)
        self.assertGreater(feel.commit(), version)
        self.assertFeelsAs(feel, renderer("planes"), at)
        self.assertEqual({p.body for p in feel.query(at[0]).planes}, {twin.slot})
        self.assertNotEqual(twin.slot, gear.slot)

        scene.exchange(twin, model("block"))
        feel.commit()
        other = asperity.Renderer(model("block"), model("block"), formulation="planes")
        on_block = at + [0, 0, model("block").high[2] - model("gear").high[2], 0, 0, 0, 0]
        self.assertFeelsAs(feel, other, on_block)
        self.assertEqual(scene.model(twin).name, "block")

        scene.remove(twin)
        feel.commit()
        self.assertEqual(np.abs(feel.step_batch(at)).max(), 0.0)
        self.assertEqual(feel.fixed, [])

    def test_two_renderers_take_what_each_lacks(self):
        scene, gear = scene_with_gear()
        first = scene.renderer()
        scene.remove(gear)
        second = scene.renderer()  # of the scene as it is now
        at = poses(fresh_random(), 10)
        self.assertEqual(np.abs(second.step_batch(at)).max(), 0.0)
        self.assertGreater(np.abs(first.step_batch(at)).max(), 0.01)
        second.commit()
        first.commit()
        self.assertEqual(np.abs(first.step_batch(at)).max(), 0.0)


class Sessions(unittest.TestCase):
    def pressed(self, scene, **more):
        return asperity.Session(scene.renderer(), asperity.SimulatedDevice(motion="press"), **more)

    def test_a_session_of_a_scene_is_one_of_fixed_bodies(self):
        scene, _ = scene_with_gear()
        seed = int(fresh_random().integers(1, 2**31))
        ours = asperity.Session(scene.renderer(), asperity.SimulatedDevice(seed=seed)).run(0.9)
        theirs = asperity.Session(renderer("planes"), asperity.SimulatedDevice(seed=seed)).run(0.9)
        for name in theirs:
            np.testing.assert_array_equal(ours[name], theirs[name], name)
        self.assertGreater(ours.contact_wrench[-1, 2], 1.0)

    def test_a_body_goes_and_comes_under_the_hand(self):
        scene, gear = scene_with_gear()
        session = self.pressed(scene)
        self.assertEqual(session.scene_in_use, (0, 0, 0.0))
        self.assertGreater(session.run(0.8).contact_wrench[-1, 2], 1.0)
        felt = session.scene_in_use
        self.assertGreater(felt.version, 0)

        scene.remove(gear)
        self.assertGreater(session.run(0.05).contact_wrench[-1, 2], 1.0, "nobody committed")
        version = session.commit()
        gone = session.run(0.05)
        use = session.scene_in_use
        self.assertEqual(use.version, version)
        self.assertTrue(851 <= use.tick <= 854, use)
        self.assertAlmostEqual(use.time_s, (use.tick - 1) * 1e-3)
        self.assertEqual(np.abs(gone.contact_wrench[use.tick - 850:]).max(), 0.0)
        self.assertEqual(session.fault, "none")

        free = session.run(0.5).probe_pose[-1, 2]

        # Come back after a hundredth of a second, it holds the hand before it has gone on.
        scene, gear = scene_with_gear()
        session = self.pressed(scene)
        session.run(0.8)
        scene.remove(gear)
        session.commit()
        gone = session.run(0.01)
        scene.add(model("gear"))
        session.commit()
        back = session.run(0.6)
        self.assertGreater(back.contact_wrench[-1, 2], 1.0)
        self.assertGreater(back.probe_pose[-1, 2], gone.probe_pose[-1, 2] - 1e-3)
        self.assertGreater(back.probe_pose[-1, 2], free + 3e-3)

    def test_a_material_is_changed_under_the_hand(self):
        depth, slide = {}, {}
        for word in ("steel", "rubber"):
            scene, gear = scene_with_gear()
            session = self.pressed(scene)
            session.run(0.5)
            scene.set_material(gear, asperity.Material.preset(word))
            version = session.commit()
            felt = session.run(0.5)
            self.assertEqual(session.scene_in_use.version, version)
            self.assertEqual(scene.model(gear).material.name, word)
            depth[word], slide[word] = felt["depth_m"][-100:].mean(), felt.contact_wrench[-1, 2]
        self.assertGreater(depth["rubber"], 1.5 * depth["steel"])
        self.assertGreater(min(slide.values()), 1.0)

    def test_a_second_commit_waits_for_the_first(self):
        scene, gear = scene_with_gear()
        session = self.pressed(scene, start_pose=[0, 0, 0.1, 0, 0, 0, 1])
        session.run(0.01)
        scene.place(gear, AWAY)
        first = session.commit()
        scene.remove(gear)
        with self.assertRaisesRegex(asperity.Error, "has not taken the last change yet") as caught:
            session.commit()
        self.assertEqual(caught.exception.code, "busy")
        session.run(0.01)
        self.assertEqual(session.scene_in_use.version, first)
        second = session.commit()
        self.assertGreater(second, first)
        session.run(0.01)
        self.assertEqual(session.scene_in_use.version, second)

    def test_a_scene_is_changed_while_a_thread_runs_the_session(self):
        scene, gear = scene_with_gear()
        session, recorded = self.pressed(scene), []
        runs = threading.Thread(target=lambda: recorded.append(session.run(3.0)))
        runs.start()
        versions, busy = [], 0
        for i in range(200):
            scene.place(gear, [1e-5 * (i % 2), 0, 0, 0, 0, 0, 1])
            try:
                versions.append(session.commit())
            except asperity.Error as refused:
                self.assertEqual(refused.code, "busy")
                busy += 1
            _ = session.scene_in_use, session.fault
        runs.join()
        session.run(0.01)
        last = session.commit()
        session.run(0.01)
        self.assertEqual(session.scene_in_use.version, last)
        self.assertEqual(versions, sorted(versions))
        self.assertEqual(recorded[0].rows, 3000)
        self.assertEqual(session.fault, "none")

    def test_a_session_begins_without_a_body(self):
        scene = asperity.Scene(model("block"))
        with self.assertRaisesRegex(asperity.Error, "no body to begin at"):
            asperity.Session(scene.renderer())
        z = model("gear").high[2] - model("block").low[2]
        session = asperity.Session(scene.renderer(), asperity.SimulatedDevice(motion="press"), start_pose=[0, 0, z + 3e-3, 0, 0, 0, 1])
        self.assertEqual(np.abs(session.run(0.02).contact_wrench).max(), 0.0)
        scene.add(model("gear"))
        session.commit()
        self.assertGreater(session.run(0.8).contact_wrench[-1, 2], 1.0)


class Refusals(unittest.TestCase):
    def refused(self, code, sentence, call, *given):
        with self.assertRaisesRegex(asperity.Error, sentence) as caught:
            call(*given)
        self.assertEqual(caught.exception.code, code)

    def test_who_is_named(self):
        scene, gear = scene_with_gear(bodies=2)
        self.assertEqual(len(scene), 1)
        self.assertIn(gear, scene)
        self.assertEqual(scene.bodies, [gear])
        twin = scene.add(model("gear"), AWAY)
        self.assertEqual(scene.bodies, [gear, twin])
        self.refused("limit_exceeded", "which is all it has room for", scene.add, model("gear"))
        scene.remove(gear)
        for call, more in ((scene.remove, ()), (scene.place, (AWAY,)), (scene.exchange, (model("block"),)),
                           (scene.set_material, (None,)), (scene.model, ()), (scene.pose, ())):
            self.refused("invalid_argument", "was removed", call, gear, *more)
        other, _ = scene_with_gear()
        later = [other.add(model("gear")) for _ in range(2)][1]
        self.refused("invalid_argument", "was ever called", scene.remove, later)
        again = scene.add(model("gear"))
        self.assertEqual(again.slot, gear.slot)
        self.assertNotEqual(again, gear)
        self.assertEqual(len({again, gear, scene.body_in(again.slot)}), 2)
        self.assertNotIn(gear, scene)
        self.assertIsNone(scene.body_in(9))

    def test_what_no_scene_takes(self):
        scene, gear = scene_with_gear()
        self.refused("invalid_argument", "length 2", scene.place, gear, [0, 0, 0, 0, 0, 0, 2])
        self.refused("invalid_argument", "length 2", scene.add, model("gear"), [0, 0, 0, 0, 0, 0, 2])
        with self.assertRaisesRegex(ValueError, r"\(3,\).*\(7,\)"):
            scene.place(gear, [0, 0, 0])
        self.refused("invalid_argument", "scene_limits::bodies", lambda: asperity.Scene(model("block"), bodies=0))
        small = asperity.Scene(model("block"), balls=10)
        self.refused("limit_exceeded", "scene_limits::balls", small.add, model("gear"))
        self.refused("invalid_argument", "not in a Scene", renderer("planes").commit)
        self.refused("invalid_argument", "not in a Scene", asperity.Session(renderer("planes")).commit)
        feel = scene.renderer()
        self.refused("invalid_argument", r"place\(\) them there", setattr, feel, "fixed_poses", [[0, 0, 0, 0, 0, 0, 1]])
        self.refused("invalid_argument", "stiffness_n_per_m", lambda: scene.renderer(stiffness_n_per_m=-1.0))
        self.refused("invalid_argument", "period_s", lambda: scene.renderer(period_s=0.0))
        for more, why in (({"friction": (0.5, 0.4)}, "set_material"), ({"contact": lambda p, b: np.zeros(6)}, "knows no Scene")):
            with self.assertRaisesRegex(ValueError, why):
                asperity.Session(feel, **more)


if __name__ == "__main__":
    unittest.main()
