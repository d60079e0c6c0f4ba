"""Sessions of the two-rate loop with a simulated device, on a clock that is a number."""

from __future__ import annotations

from typing import Any, Callable, NamedTuple, Optional, Tuple, Union

import numpy.typing as npt

from . import _asperity
from .recording import Recording, recording_of


# A contact of your own: (probe (7,), bodies (N, 7)) -> wrench (6,), or (wrench, stiffness (6, 6)); or the address of a
# compiled function. A hand of your own: (time_s, probe (7,)) -> where the probe is wanted (7,).
Contact = Union[Callable[[Any, Any], Any], int]
Hand = Callable[[float, Any], Any]


class SceneUse(NamedTuple):
    """Which version of its Scene a session feels, and since when.

    version: of commit(); 0: of a scene that never changes, or none yet.
    tick: the first device tick with it; the session's first is 1. time_s: of that tick.
    """

    version: int
    tick: int
    time_s: float


class Session:
    """A control loop with a hand at a simulated device: contacts, virtual coupling, passivity guard and output gate.

    The clock is virtual, so a session runs as fast as the machine can and the same one gives the same numbers, those of
    `asperity run --record`. It has a renderer of its own, like the one given; formulation="planes" is the one for loops. Of a renderer of Scene.renderer() the
    bodies can change while it runs.

    >>> session = asperity.Session(asperity.Renderer(probe, fixed, formulation="planes"))
    >>> session.run(0.5)
    Recording(500 ticks, 37 columns)
    >>> session.time_s, session.fault
    (0.5, 'none')
    """

    def __init__(
        self,
        renderer: _asperity.Renderer,
        device: Optional[_asperity.SimulatedDevice] = None,
        *,
        start_pose: Optional[npt.ArrayLike] = None,
        device_rate_hz: float = 1000.0,
        contact_rate_hz: float = 1000.0,
        coupling_n_per_m: Optional[float] = None,
        coupling_n_m_per_rad: Optional[float] = None,
        scale: float = 1.0,
        friction: Optional[Tuple[float, float]] = None,
        contact: Optional[Contact] = None,
        hand: Optional[Hand] = None,
    ) -> None:
        """Arms the device and begins at time 0.

        renderer: whose bodies, poses of fixed bodies and formulation are taken.
        device: a SimulatedDevice; None: the usual one, which scrubs.
        start_pose: of the probe (7,); None: just above its first touch when it comes straight down.
        device_rate_hz, contact_rate_hz: of the two loops, 100 to 10000 Hz.
        coupling_n_per_m, coupling_n_m_per_rad: of the virtual coupling; None: what device and contacts allow.
        scale: metres of the world for a metre of the device.
        friction: coefficients, static and dynamic, in place of the materials'; planes only.
        contact: in place of the renderer's, a callable that is given the probe's pose (7,) and the fixed bodies' (N, 7) and
            returns the wrench on the probe (6,), N and N m about its centre of mass in world axes, or that and its
            derivative by the probe's motion (6, 6), which a stiff contact needs. It is called once a contact tick. What it
            raises ends run(). Or the address of a compiled function (numba's `cfunc.address`, cffi, ctypes):
            void f(const double *probe, const double *bodies, size_t count, double *wrench, double *stiffness).
            Wrench and stiffness, row by row, are zero before it is called.
        hand: in place of the device's motion, a callable that is given the time, s, and the probe's pose (7,), and returns
            where the probe is wanted (7,), once a device tick. The hand goes there smoothly, at 0.5 m/s and 5 rad/s at the
            most, and gives way as a spring does.

        Raises Error, or ValueError for a number out of range.
        """
        self._loop = _asperity.SessionLoop(
            renderer,
            device if device is not None else _asperity.SimulatedDevice(),
            start_pose=start_pose,
            device_rate_hz=device_rate_hz,
            contact_rate_hz=contact_rate_hz,
            coupling_n_per_m=coupling_n_per_m,
            coupling_n_m_per_rad=coupling_n_m_per_rad,
            scale=scale,
            friction=friction,
            contact=contact,
            hand=hand,
        )

    def run(self, seconds: float) -> Recording:
        """Runs for that much virtual time and returns the Recording of it: fewer ticks where the gate shuts.

        Call it again to go on. Raises Error after stop().
        """
        return recording_of(self._loop.run(seconds))

    def commit(self) -> int:
        """Hands over what was changed in the Scene since the last time: the next contact tick takes all of it at once.

        Returns the version; scene_in_use says when it is felt. While run() goes on in another thread as well. Raises
        Error: busy where the last changes were not taken yet, and these are kept for the next commit(); invalid_argument
        where the renderer was not made by Scene.renderer().
        """
        return self._loop.commit()

    @property
    def scene_in_use(self) -> SceneUse:
        """Which version of the Scene the hand feels, and since when."""
        return SceneUse(*self._loop.scene_in_use)

    def stop(self) -> Recording:
        """Ends the session: the wrench goes to zero, the device is disarmed. Returns the Recording of that."""
        return recording_of(self._loop.stop())

    @property
    def fault(self) -> str:
        """What shut the output gate; "none" while it is open."""
        return self._loop.fault

    @property
    def time_s(self) -> float:
        """Time of the next device tick, s."""
        return self._loop.time_s
