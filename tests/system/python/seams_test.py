"""The code of docs/how-to/robosuite-and-isaac-lab.md, against stand-ins of what it plugs into."""

import os
import re
import sys
import types
import unittest

import numpy as np

import asperity
import asperity.mujoco as am
from support import SOURCE, fresh_random, model, poses

with open(os.path.join(SOURCE, "docs/how-to/robosuite-and-isaac-lab.md")) as page:
    BLOCKS = re.findall(r"```python\n(.*?)```", page.read(), re.S)


def stand_in(test, name, **members):
    module = types.ModuleType(name)
    vars(module).update(members)
    sys.modules[name] = module
    test.addCleanup(sys.modules.pop, name, None)
    return module


class Robosuite(unittest.TestCase):
    """Its MujocoEnv.step() as in robosuite/environments/base.py; sim.model._model and sim.data._data are the bindings' own."""

    def test_an_environments_step_has_the_contacts(self):
        geom = "<geom type='box' size='.01 .01 .01'/>"
        scene = am.Simulation.from_text(
            f"<mujoco><option timestep='.002' gravity='0 0 0'/><worldbody><body name='gear'>{geom}</body>"
            f"<body name='block'><freejoint/>{geom}</body></worldbody></mujoco>")
        stand_in(self, "bindings", mj_version=lambda: am.mujoco_version)
        part = type("Part", (), {"__module__": "bindings"})
        m, d = part(), part()
        m._address, d._address = scene.model_address, scene.data_address
        m.owner = d.owner = scene

        class Sim:
            model, data = types.SimpleNamespace(_model=m), types.SimpleNamespace(_data=d)
            forward, step = scene.forward, scene.step

        class Env:
            sim, actions = Sim(), []

            def _pre_action(self, action, policy_step=False):
                self.actions.append((action, policy_step))

            def step(self, action):
                policy_step = True
                for _ in range(25):
                    self.sim.forward()
                    self._pre_action(action, policy_step)
                    self.sim.step()
                    policy_step = False

        env, names = Env(), {}
        exec(BLOCKS[0], names)
        pair = am.Pair(model("block"), "block", model("gear"), "gear")
        felt = names["TexturedContacts"](env, [pair])
        depth = 2e-4
        scene.qpos[:3] = 0.0, 0.0, model("gear").high[2] - model("block").low[2] - depth
        scene.forward()
        env.step("up")
        self.assertEqual(env.actions, [("up", True)] + [("up", False)] * 24)
        # It was pushed out, and what was added is not added up.
        self.assertGreater(scene.qvel[2], 0.0)
        np.testing.assert_allclose(scene.xfrc_applied[scene.body("block"), :3], felt.force(), atol=0.0)


class HaplyStandIn:
    """push_force() as in isaaclab/devices/haply/se3_haply.py: rows by index, added up, cut at the limit."""

    limit_force = 2.0

    def push_force(self, forces, position):
        if forces.shape[0] == 0:
            raise ValueError("No forces provided")
        selected = forces[position] if position.ndim > 0 else forces[position][None]
        self.sent = np.clip(selected.sum(axis=0), -self.limit_force, self.limit_force)


class IsaacLab(unittest.TestCase):
    def test_a_device_is_given_the_force_in_its_axes(self):
        stand_in(self, "torch", float32=np.float32, tensor=lambda data, dtype=None: np.array(data, dtype=dtype))
        names = {}
        exec(BLOCKS[1], names)
        turned = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
        renderer = asperity.Renderer(model("block"), model("gear"), period_s=1 / 200)
        felt, device = 0, HaplyStandIn()
        contacts = {first: names["FeltContact"](model("block"), model("gear"), first, turned) for first in (False, True)}
        for at in poses(fresh_random(), 10):
            for scalar_first, contact in contacts.items():
                order = [3, 0, 1, 2] if scalar_first else [0, 1, 2, 3]
                wrench = contact.push(device, at[:3], at[3:][order], [0, 0, 0], np.array([0.0, 0, 0, 1])[order])
                np.testing.assert_allclose(wrench, renderer.step(at), atol=1e-9)
                np.testing.assert_allclose(device.sent, np.clip(turned @ wrench[:3], -2.0, 2.0), atol=1e-6)
                felt += bool(np.any(wrench))
        self.assertGreater(felt, 3)


if __name__ == "__main__":
    unittest.main()
