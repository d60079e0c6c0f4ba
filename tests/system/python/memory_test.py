"""Views: without a copy, read-only, and alive as long as anybody looks."""

import gc
import unittest
import weakref

import numpy as np

import asperity
from support import file_of, model


class Views(unittest.TestCase):
    def test_a_view_outlives_its_owner(self):
        for name in ("vertices", "triangles", "uvs", "texels"):
            owner = asperity.load(file_of("block"))
            view = getattr(owner, name)
            kept = view.copy()
            self.assertIs(view.base, owner)
            self.assertFalse(view.flags.owndata)
            self.assertFalse(view.flags.writeable)
            del owner
            gc.collect()
            other = [asperity.load(file_of("block")) for _ in range(2)]  # would take freed memory
            del other
            np.testing.assert_array_equal(view, kept)

    def test_two_views_are_the_same_memory(self):
        self.assertTrue(np.shares_memory(model("gear").texels, model("gear").texels))

    def test_a_renderer_keeps_its_models(self):
        probe, fixed = asperity.load(file_of("block")), asperity.load(file_of("gear"))
        feel = asperity.Renderer(probe, fixed)
        vertices = feel.probe.vertices
        del probe, fixed, feel
        gc.collect()
        self.assertEqual(vertices.shape, model("block").vertices.shape)

    def test_arrays_have_the_model_in_them(self):
        m = model("gear")
        np.testing.assert_array_equal(m.vertices.min(axis=0), m.low)
        np.testing.assert_array_equal(m.vertices.max(axis=0), m.high)
        self.assertEqual(m.triangles.max() + 1, len(m.vertices))
        self.assertTrue((m.uvs >= 0).all() and (m.uvs <= 1).all())
        self.assertEqual(np.isfinite(m.texels[..., 0]).sum() > 1000, True)


if __name__ == "__main__":
    unittest.main()
