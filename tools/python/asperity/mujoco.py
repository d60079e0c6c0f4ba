"""Textured contact inside a MuJoCo simulation.

With the simulation that comes along::

    import asperity, asperity.mujoco as am
    simulation = am.Simulation("scene.xml")
    pair = am.Pair(asperity.load("peg.glb"), "peg", asperity.load("plate.glb"), "plate")
    contacts = am.contacts(simulation, [pair])
    while simulation.time < 1.0:
        contacts.step()

or with DeepMind's bindings, where their MuJoCo is of the version that asperity was compiled for::

    contacts = am.contacts((model, data), [pair])  # an mujoco.MjModel and its mujoco.MjData

MuJoCo's quaternions are w x y z, asperity's x y z w: to_mujoco() and from_mujoco() turn one into the other.
"""

import sys
from dataclasses import dataclass
from typing import Any, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import Model
from ._errors import Error

try:
    from ._mujoco import Contacts, Simulation, mujoco_version
    from ._mujoco import switch_off_own_contacts as _switch_off_own_contacts
except ImportError as why:
    raise ImportError(
        "asperity was built without MuJoCo, or libmujoco is not there: install libmujoco-dev and build asperity again"
    ) from why

__all__ = [
    "Contacts",
    "Pair",
    "Simulation",
    "contacts",
    "from_mujoco",
    "mujoco_version",
    "switch_off_own_contacts",
    "to_mujoco",
]

_Floats = npt.NDArray[np.float64]
_Where = Union[Simulation, Tuple[Any, Any]]


@dataclass
class Pair:
    """Two textured models on bodies or geoms of the simulation that feel each other.

    probe, fixed: the models; both may move, and at least one does.
    probe_name, fixed_name: of what they are on.
    kind: "body" or "geom", what the names are of.
    probe_pose, fixed_pose: x y z qx qy qz qw of the model's frame in that of the body or geom; None: the same frame. Of a
        mesh geom: in its body's frame, the pos and quat of the MJCF.
    stiffness_n_per_m: of a contact.
    damping_s: what touches is damped by this times its stiffness.
    formulation: "least-motion", whose force is a function of the poses, or "planes", quicker.
    reach_m: of planes; gaps beyond it are not looked at.
    """

    probe: Model
    probe_name: str
    fixed: Model
    fixed_name: str
    kind: str = "body"
    probe_pose: Optional[Sequence[float]] = None
    fixed_pose: Optional[Sequence[float]] = None
    stiffness_n_per_m: float = 2000.0
    damping_s: float = 2e-3
    formulation: str = "least-motion"
    reach_m: float = 1e-4


def _addresses(where: _Where) -> Tuple[int, int]:
    if isinstance(where, Simulation):
        return where.model_address, where.data_address
    model, data = where
    for part, what in ((model, "model"), (data, "data")):
        if not isinstance(getattr(part, "_address", None), int):
            raise TypeError(f"the {what} has no _address: give an asperity.mujoco.Simulation, or (MjModel, MjData) of mujoco")
    # Its structs are read in place, and they are others in every version.
    bindings = sys.modules.get(type(model).__module__.split(".")[0])
    told = getattr(bindings, "mj_version", None)
    if told is None:
        raise Error("unsupported", "the bindings of this model do not tell their MuJoCo's version (mj_version): their structs cannot be trusted")
    if told() != mujoco_version:
        raise Error(
            "unsupported",
            f"the bindings have MuJoCo {told()} and asperity was compiled for {mujoco_version}, whose structs are others: "
            "compile asperity with -DASPERITY_MUJOCO_INCLUDE and -DASPERITY_MUJOCO_LIBRARY of the bindings' own MuJoCo",
        )
    return int(model._address), int(data._address)


def contacts(where: _Where, pairs: Sequence[Pair]) -> Contacts:
    """Contacts of a Simulation, or of (MjModel, MjData) of DeepMind's bindings. Raises Error.

    MuJoCo must make no contacts of these objects itself: see switch_off_own_contacts().
    """
    model, data = _addresses(where)
    return Contacts(model, data, where, list(pairs))


def switch_off_own_contacts(where: _Where, pairs: Sequence[Pair]) -> None:
    """Changes contype and conaffinity so that MuJoCo makes no contacts between the geoms of each pair, and else as before."""
    _switch_off_own_contacts(_addresses(where)[0], list(pairs))


def from_mujoco(position: npt.ArrayLike, wxyz: npt.ArrayLike) -> _Floats:
    """A pose x y z qx qy qz qw (7,) from a position (3,) and a quaternion w x y z (4,).

    >>> asperity.mujoco.from_mujoco([0, 0, 0.1], [1, 0, 0, 0])
    array([0. , 0. , 0.1, 0. , 0. , 0. , 1. ])
    """
    q = np.asarray(wxyz, dtype=np.float64)
    return np.concatenate([np.asarray(position, dtype=np.float64), q[1:], q[:1]])


def to_mujoco(pose: npt.ArrayLike) -> Tuple[_Floats, _Floats]:
    """Position (3,) and quaternion w x y z (4,) of a pose x y z qx qy qz qw (7,).

    >>> asperity.mujoco.to_mujoco([0, 0, 0.1, 0, 0, 0, 1])
    (array([0. , 0. , 0.1]), array([1., 0., 0., 0.]))
    """
    p = np.asarray(pose, dtype=np.float64)
    return p[:3].copy(), np.concatenate([p[6:], p[3:6]])
