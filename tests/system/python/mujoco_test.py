"""asperity.mujoco: the same wrenches as the renderer's, other people's forces as they were, and whose structs it refuses."""

import sys
import types
import unittest

import numpy as np

import asperity
import asperity.mujoco as am
from support import fresh_random, model, poses

SCENE = """<mujoco><option timestep=".001" gravity="0 0 0"/><worldbody>
  <body name="gear"/>
  <body name="block"><freejoint/><inertial pos=".01 .02 -.03" mass=".1" diaginertia="2e-3 2e-3 2e-3"/></body>
  <body name="other"><freejoint/><geom size=".01"/></body>
</worldbody></mujoco>"""


def pair(**more):
    return am.Pair(model("block"), "block", model("gear"), "gear", damping_s=0.0, **more)


def rotated(q, v):
    """v turned by x y z w."""
    return v + 2.0 * np.cross(q[:3], np.cross(q[:3], v) + q[3] * v)


class Wrenches(unittest.TestCase):
    def test_are_the_renderers_at_the_centre_of_mass(self):
        simulation = am.Simulation.from_text(SCENE)
        contacts = am.contacts(simulation, [pair()])
        renderer = asperity.Renderer(model("block"), model("gear"), period_s=simulation.timestep)
        row, felt = simulation.body("block"), 0
        for at in poses(fresh_random(), 20):
            simulation.qpos[:3], simulation.qpos[3:7] = am.to_mujoco(at)
            simulation.step1()
            self.assertEqual(contacts.apply(), "ok")
            seen = am.from_mujoco(simulation.xpos[row], simulation.xquat[row])
            np.testing.assert_allclose(seen, at, atol=1e-12)
            np.testing.assert_array_equal(seen, simulation.pose("block"))
            touch = renderer.query(seen)
            wanted = np.array(touch.wrench)
            wanted[3:] += np.cross(touch.centre_of_mass - simulation.xipos[row], wanted[:3])
            scale = max(1.0, float(np.linalg.norm(wanted)))
            self.assertEqual(contacts.report()["force_share"], 1.0)
            # The two round the pose once each, and what is stiff makes more of that: 2e-12 for seed 3489149532.
            np.testing.assert_allclose(simulation.xfrc_applied[row], wanted, rtol=0.0, atol=1e-10 * scale)
            np.testing.assert_array_equal(contacts.report(0)["on_probe"], simulation.xfrc_applied[row])
            felt += bool(np.any(wanted))
            contacts.take_back()
            self.assertFalse(np.any(simulation.xfrc_applied))
        self.assertGreater(felt, 3)

    def test_leave_what_others_apply(self):
        simulation, random = am.Simulation.from_text(SCENE), fresh_random()
        contacts = am.contacts(simulation, [pair(formulation="planes")])
        touched = 0
        for at in poses(random, 20):
            simulation.qpos[:3], simulation.qpos[3:7] = am.to_mujoco(at)
            simulation.qvel[:] = 0.0
            theirs = random.uniform(-1.0, 1.0, simulation.xfrc_applied.shape)
            simulation.xfrc_applied[:] = theirs
            self.assertEqual(contacts.step(), "ok")
            touched += contacts.report()["contacts"]
            np.testing.assert_array_equal(simulation.xfrc_applied, theirs)
        self.assertGreater(touched, 3)


class Refusals(unittest.TestCase):
    def test_name_the_fault(self):
        simulation = am.Simulation.from_text(SCENE)
        for wrong, words in (
            (am.Pair(model("block"), "peg", model("gear"), "gear"), "no body 'peg'"),
            (am.Pair(model("block"), "block", model("gear"), "gear", kind="site"), "kind 'site' is not known"),
            (am.Pair(model("block"), "block", model("gear"), "gear", formulation="best"), "formulation 'best'"),
            (am.Pair(model("block"), "block", model("gear"), "gear", damping_s=-1.0), "damping_s"),
        ):
            with self.assertRaisesRegex(asperity.Error, words):
                am.contacts(simulation, [wrong])
        with self.assertRaisesRegex(asperity.Error, "cannot read the MJCF"):
            am.Simulation.from_text("<mujoco><body/></mujoco>")
        with self.assertRaisesRegex(TypeError, "_address"):
            am.contacts((object(), object()), [pair()])

    def test_contacts_of_mujocos_own(self):
        geom = '<geom name="{0}" type="box" size=".01 .01 .01"/>'
        simulation = am.Simulation.from_text(
            f"<mujoco><worldbody><body name='gear'>{geom.format('g')}</body><body name='block'><freejoint/>"
            f"{geom.format('b')}</body></worldbody></mujoco>")
        with self.assertRaisesRegex(asperity.Error, r"switch_off_own_contacts\(\)"):
            am.contacts(simulation, [pair()])
        am.switch_off_own_contacts(simulation, [pair()])
        self.assertEqual(len(am.contacts(simulation, [pair()])), 1)


class Bindings(unittest.TestCase):
    """A stand-in for DeepMind's bindings: objects with an _address, in a module that tells its MuJoCo's version."""

    def stand_in(self, version):
        module = types.ModuleType("stand_in_for_mujoco")
        if version is not None:
            module.mj_version = lambda: version
        sys.modules["stand_in_for_mujoco"] = module
        self.addCleanup(sys.modules.pop, "stand_in_for_mujoco", None)
        simulation = am.Simulation.from_text(SCENE)
        handle = type("Handle", (), {"__module__": "stand_in_for_mujoco"})
        m, d = handle(), handle()
        m._address, d._address, m.owner = simulation.model_address, simulation.data_address, simulation
        return simulation, (m, d)

    def test_are_taken_by_address(self):
        simulation, bound = self.stand_in(am.mujoco_version)
        contacts = am.contacts(bound, [pair()])
        simulation.qpos[:3] = 0.0, 0.0, model("gear").high[2] - model("block").low[2] - 2e-4
        simulation.step1()
        self.assertEqual(contacts.apply(), "ok")
        self.assertTrue(np.any(simulation.xfrc_applied[simulation.body("block")]))

    def test_of_another_version_are_refused(self):
        for version in (am.mujoco_version + 1, None):
            _, bound = self.stand_in(version)
            with self.assertRaisesRegex(asperity.Error, "structs"):
                am.contacts(bound, [pair()])


if __name__ == "__main__":
    unittest.main()
