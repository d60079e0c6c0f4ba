"""Backends on a GPU: the CPU's answers within what their headers promise, in any thread, and what is refused. Where there is
no GPU, Mesa's OpenGL in software is one."""

import os
import subprocess
import sys
import threading
import unittest

import numpy as np

import asperity
from support import MODELS, fresh_random, model, poses


def of(backend, **more):
    return asperity.Renderer(model("block"), model("gear"), backend=backend, **more)


def why_not():
    """Why there is no GPU to test, or None."""
    try:
        of("gl-compute", fallback=False)
    except asperity.Error as refused:
        return str(refused)
    return None


WHY_NOT = why_not()
IN_BUILD = "not part of this build" not in (WHY_NOT or "")


@unittest.skipIf(WHY_NOT, WHY_NOT or "")
class OnGpu(unittest.TestCase):
    def beside_the_cpu(self, backend, on_cpu, depth_m, force_n):
        gpu, cpu = of(backend), of("cpu", formulation="window", **on_cpu)
        touched = 0
        for pose in poses(fresh_random(), 12):
            ours, theirs = gpu.query(pose), cpu.query(pose)
            self.assertEqual(len(ours.contacts), len(theirs.contacts))
            for a, b in zip(ours.contacts, theirs.contacts):
                self.assertAlmostEqual(a.depth_m, b.depth_m, delta=depth_m)
                touched += a.depth_m > 0.0
            np.testing.assert_allclose(ours.force, theirs.force, atol=force_n, rtol=1e-3)
        self.assertGreater(touched, 3)
        told = gpu.gpu
        self.assertEqual((gpu.formulation, gpu.backend, told["ticks"], told["failed"], told["fallbacks"], told["problem"]),
                         ("window", backend, 12, 0, 0, ""))
        self.assertTrue(told["device"] and told["version"] and told["device_bytes"] > 0, told)
        self.assertIsNone(cpu.gpu)

    def test_compute_shaders(self):
        self.beside_the_cpu("gl-compute", {}, 1e-8, 1e-4)

    def test_occlusion_queries(self):
        self.beside_the_cpu("gl-occlusion", {"gradient": "central", "lookup": "paper"}, 2e-6, 0.02)

    def test_one_gpu_serves_one_thread_after_the_other(self):
        at = poses(fresh_random(), 40)
        feel = of("gl-compute")
        alone = feel.step_batch(at)
        self.assertGreater(np.abs(alone[:, :3]).max(), 0.01)
        # What windows remember of the pose before does not matter here: contacts are shallow.
        wrong = []

        def work(k):
            for i in range(k, len(at), 4):
                if not np.allclose(feel.step(at[i]), alone[i], atol=1e-9):
                    wrong.append(i)

        threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
        for t in threads:
            t.start()
        for t in threads:
            t.join()
        self.assertEqual((wrong, feel.gpu["failed"]), ([], 0))

    def test_a_session_on_a_gpu(self):
        ours = asperity.Session(of("gl-compute"), asperity.SimulatedDevice(motion="press"))
        parts = []
        runs = threading.Thread(target=lambda: parts.append(ours.run(0.2)))
        runs.start()
        runs.join()
        parts.append(ours.run(0.1))
        felt = asperity.Recording.join(parts)
        theirs = asperity.Session(of("cpu", formulation="window"), asperity.SimulatedDevice(motion="press")).run(0.3)
        np.testing.assert_allclose(felt.hand_wrench, theirs.hand_wrench, atol=0.05)
        self.assertGreater(np.abs(theirs.hand_wrench[:, 2]).max(), 0.2)


class Refusals(unittest.TestCase):
    def refused(self, code, sentence, **settings):
        with self.assertRaisesRegex(asperity.Error, sentence) as caught:
            asperity.Renderer(model("block"), model("gear"), **settings)
        self.assertEqual(caught.exception.code, code)

    def test_what_does_not_go_together(self):
        self.refused("invalid_argument", "give cpu, gl-compute or gl-occlusion", backend="cuda")
        self.refused("invalid_argument", "leave formulation='planes' out", backend="gl-compute", formulation="planes")
        self.refused("invalid_argument", "gradient='soft' needs", backend="gl-occlusion", gradient="soft")
        self.refused("invalid_argument", "lookup='exact' is not", backend="gl-occlusion", lookup="exact")
        self.refused("invalid_argument", "fallback is for a GPU", fallback=True)
        self.refused("invalid_argument", "gpu chooses among GPUs", gpu="0")

    @unittest.skipIf(WHY_NOT, WHY_NOT or "")
    def test_a_gpu_that_nobody_has(self):
        for fallback in (False, True):
            self.refused("invalid_argument", "no such GPU", backend="gl-compute", gpu="no such GPU", fallback=fallback)

    @unittest.skipIf(IN_BUILD, "OpenGL is part of this build")
    def test_a_build_without_says_so(self):
        self.refused("unsupported", "ASPERITY_BUILD_GL", backend="gl-compute")

    @unittest.skipUnless(IN_BUILD, "asperity was built without OpenGL")
    def test_without_a_gpu_the_cpu_answers_where_it_may(self):
        program = """if True:
            import sys, asperity
            block, gear = (asperity.load(f"{sys.argv[1]}/{name}.glb") for name in ("block", "gear"))
            try:
                asperity.Renderer(block, gear, backend="gl-compute")
            except asperity.Error as refused:
                print(refused.code, "fallback=True" in str(refused))
            feel = asperity.Renderer(block, gear, backend="gl-compute", fallback=True)
            cpu = asperity.Renderer(block, gear, formulation="window")
            pose = [0, 0, gear.high[2] - block.low[2] - 2e-4, 0, 0, 0, 1]
            same = [feel.step(pose).tobytes() == cpu.step(pose).tobytes() for _ in range(20)]
            print(all(same), abs(cpu.step(pose)).max() > 0.01)
            told = feel.gpu
            print(told["ticks"], told["fallbacks"], told["device"] == "", len(told["problem"]) > 20)
        """
        nowhere = {**os.environ, "__EGL_VENDOR_LIBRARY_DIRS": "/nowhere"}
        done = subprocess.run([sys.executable, "-c", program, MODELS], env=nowhere, capture_output=True, text=True)
        self.assertEqual(done.stdout.split("\n")[:3], ["unsupported True", "True True", "20 20 True True"], done.stderr)


if __name__ == "__main__":
    unittest.main()
