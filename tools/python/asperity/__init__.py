"""asperity: what a hand feels when one textured object is pressed and scraped against another.

Five lines from two baked models to a wrench::

    import asperity
    probe, plate = asperity.load("probe.glb"), asperity.load("plate.glb")
    renderer = asperity.Renderer(probe, plate)
    z = plate.high[2] - probe.low[2] - 0.0005  # on top of it, half a millimetre too deep
    print(renderer.step([0, 0, z, 0, 0, 0, 1]))  # force (N) and torque (N m)

Everything is in SI units. A pose is x y z qx qy qz qw (m, unit quaternion), a wrench is force and torque about the
probe's centre of mass, in world axes; many of them are arrays (N, 7) and (N, 6) of float64. What calculates for longer
than some microseconds lets other threads of Python run, and what takes long can be ended with Ctrl-C. Examples in
docstrings go on from the lines above, with numpy as np.
"""

from ._asperity import (
    Body,
    Contact,
    Material,
    Mesh,
    Model,
    Plane,
    Renderer,
    Scene,
    SimulatedDevice,
    Touch,
    __version__,
    benchmark_coarse_mesh,
    benchmark_mesh,
    device_faults,
    load,
    load_mesh,
    step_each,
)
from ._errors import BakeRemark, Error
from .baking import bake
from .recording import Recording, load_recording
from .session import SceneUse, Session

__all__ = [
    "BakeRemark",
    "Body",
    "Contact",
    "Error",
    "Material",
    "Mesh",
    "Model",
    "Plane",
    "Recording",
    "Renderer",
    "Scene",
    "SceneUse",
    "Session",
    "SimulatedDevice",
    "Touch",
    "__version__",
    "bake",
    "benchmark_coarse_mesh",
    "benchmark_mesh",
    "device_faults",
    "load",
    "load_mesh",
    "load_recording",
    "step_each",
]
