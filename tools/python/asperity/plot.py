"""Pictures of recordings and touches, with matplotlib, which is imported when one is drawn."""

from __future__ import annotations

from typing import Any, Optional

import numpy as np
import numpy.typing as npt

from . import _asperity
from ._spectra import amplitudes
from .recording import Recording

_axes_names = ("x", "y", "z")


def _axes(given: Optional[Any]) -> Any:
    if given is not None:
        return given
    from matplotlib import pyplot  # type: ignore[import]

    return pyplot.subplots(figsize=(8.0, 3.5), layout="constrained")[1]


def trace(recording: Recording, what: str = "hand_wrench", axes: Optional[Any] = None) -> Any:
    """Draws force over time and returns the matplotlib axes.

    what: hand_wrench or contact_wrench, three lines of force (N); probe_pose or device_pose, three of position (mm); or
        the name of a column.
    axes: matplotlib axes to draw in; None: new ones.
    """
    if what not in ("hand_wrench", "contact_wrench", "probe_pose", "device_pose") and what not in recording:
        raise ValueError(f"there is no {what} in the recording: there are {', '.join(recording)}")
    to = _axes(axes)
    if what in recording:
        to.plot(recording.time_s, recording[what], linewidth=1.0)
        to.set_ylabel(what)
    else:
        is_pose = what.endswith("pose")
        for i, name in enumerate(_axes_names):
            values = getattr(recording, what)[:, i] * (1000.0 if is_pose else 1.0)
            to.plot(recording.time_s, values, linewidth=1.0, label=name)
        to.set_ylabel("position (mm)" if is_pose else "force (N)")
        to.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.0, ncols=3, frameon=False)
    to.set_xlabel("time (s)")
    to.margins(x=0.0)
    to.grid(alpha=0.3)
    return to


def spectrum(values: npt.ArrayLike, rate_hz: float, axes: Optional[Any] = None, **line: Any) -> Any:
    """Draws the amplitude spectrum of evenly spaced values (N,) and returns the matplotlib axes.

    The mean is taken off and a Hann window laid on. rate_hz: values per second. line: of matplotlib's plot().
    """
    x = np.asarray(values, dtype=np.float64)
    if x.ndim != 1 or len(x) < 8:
        raise ValueError(f"values has shape {x.shape}: give (N,), 8 values or more")
    if not rate_hz > 0.0:
        raise ValueError("rate_hz has to be above 0: values per second")
    frequency_hz, amplitude = amplitudes(x, rate_hz)
    to = _axes(axes)
    to.semilogy(frequency_hz[1:], amplitude[1:], **{"linewidth": 1.0, **line})
    to.set_xlabel("frequency (Hz)")
    to.set_ylabel("amplitude")
    to.margins(x=0.0)
    to.grid(alpha=0.3)
    return to


def contacts(touch: _asperity.Touch, renderer: _asperity.Renderer, pose: npt.ArrayLike, axes: Optional[Any] = None) -> Any:
    """Draws both bodies' vertices, the contacts and the force on the probe, seen along y, and returns the axes.

    pose: of the probe (7,), the one of the touch. axes: matplotlib axes to draw in; None: new ones.
    """
    from matplotlib.patches import Polygon  # type: ignore[import]

    to = _axes(axes)
    bodies = [(renderer.probe, np.asarray(pose, dtype=np.float64), "tab:blue", "probe")]
    for model, at in zip(renderer.fixed, renderer.fixed_poses):
        bodies.append((model, at, "tab:gray", "fixed"))
    for model, at, colour, label in bodies:
        points = 1000.0 * _placed(model.vertices, at)
        for corners in points[model.triangles]:
            to.add_patch(Polygon(corners[:, [0, 2]], closed=True, facecolor=colour, edgecolor="none", alpha=0.12))
        to.plot(points[:, 0], points[:, 2], ".", markersize=1.0, color=colour, label=label)
    at_mm = np.array([1000.0 * c.point for c in touch.contacts]).reshape(-1, 3)
    to.plot(at_mm[:, 0], at_mm[:, 2], "o", markersize=5.0, color="tab:red", label="contacts")
    force = touch.force
    length = float(np.linalg.norm(force))
    if length > 0.0:
        start = 1000.0 * touch.centre_of_mass
        arrow = 0.4 * 1000.0 * renderer.probe.diagonal_m * force / length
        to.annotate(
            "",
            xy=(start[0] + arrow[0], start[2] + arrow[2]),
            xytext=(start[0], start[2]),
            arrowprops={"arrowstyle": "-|>", "color": "tab:red", "linewidth": 1.5},
        )
    to.set_title(f"{len(touch.contacts)} contacts, {length:.2f} N on the probe", fontsize="medium")
    to.set_xlabel("x (mm)")
    to.set_ylabel("z (mm)")
    to.set_aspect("equal")
    to.legend(loc="upper right", frameon=False)
    return to


def _placed(points: npt.NDArray[np.float64], pose: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    x, y, z, w = pose[3:]
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    placed: npt.NDArray[np.float64] = points @ turn.T + pose[:3]
    return placed
