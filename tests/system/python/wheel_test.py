"""`pip install` without a network: the wheel has the whole package, and an interpreter without our paths finds it."""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import asperity
from support import SOURCE, file_of

BUILD = Path(asperity.__file__).absolute().parents[2]


class Wheel(unittest.TestCase):
    def test_pip_installs_the_package_offline(self):
        plain = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([sys.executable, "-m", "pip", "install", "--no-build-isolation", "--no-index", "--no-deps",
                                   "--config-settings", f"build-dir={BUILD}", "--config-settings", "jobs=1",
                                   "--target", folder, os.path.join(SOURCE, "tools", "python")],
                                  env={**plain, "PIP_NO_CACHE_DIR": "1"}, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            theirs = {p.name for p in Path(asperity.__file__).parent.iterdir() if p.name != "__pycache__"}
            ours = {p.name for p in Path(folder, "asperity").iterdir() if p.name != "__pycache__"}
            self.assertEqual(ours, theirs)
            self.assertTrue(all(not p.is_symlink() for p in Path(folder, "asperity").iterdir()))
            program = ("import sys, asperity, importlib.metadata as m\n"
                       "model = asperity.load(sys.argv[1])\n"
                       "print(asperity.__file__, m.version('asperity') == asperity.__version__, model.name)")
            said = subprocess.run([sys.executable, "-c", program, file_of("block")], cwd=folder, env=plain,
                                  capture_output=True, text=True)
            self.assertEqual(said.stdout.split(), [os.path.join(folder, "asperity", "__init__.py"), "True", "block"],
                             said.stderr)


if __name__ == "__main__":
    unittest.main()
