"""What the tests share: two small models, poses drawn anew in each run, the command."""

import functools
import json
import os
import subprocess

import numpy as np

import asperity

MODELS = os.environ["ASPERITY_PYTHON_MODELS"]
COMMAND = os.environ["ASPERITY_COMMAND"]
SOURCE = os.environ["ASPERITY_SOURCE"]


def file_of(name):
    return os.path.join(MODELS, name + ".glb")


@functools.lru_cache(maxsize=None)
def model(name):
    return asperity.load(file_of(name))


@functools.lru_cache(maxsize=None)
def renderer(formulation="least-motion"):
    return asperity.Renderer(model("block"), model("gear"), formulation=formulation)


def fresh_random():
    """A generator of its own for each run; its seed is printed for whoever has to repeat one."""
    seed = int.from_bytes(os.urandom(4), "little")
    print("seed", seed)
    return np.random.default_rng(seed)


def poses(random, count):
    """From a gap of a quarter of a millimetre to as much overlap, turned by up to 30 mrad."""
    out = np.zeros((count, 7))
    out[:, :3] = random.uniform(-5e-4, 5e-4, (count, 3)) * [2.0, 2.0, 0.5]
    out[:, 2] += model("gear").high[2] - model("block").low[2] + 5e-4
    out[:, 3:6] = random.uniform(-0.015, 0.015, (count, 3))
    out[:, 6] = np.sqrt(1.0 - np.sum(out[:, 3:6] ** 2, axis=1))
    return out


def command(*arguments):
    """The document of the command with --json."""
    done = subprocess.run([COMMAND, "--json", *arguments], capture_output=True, check=True)
    return json.loads(done.stdout)
