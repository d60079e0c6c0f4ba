"""Sessions as tables: one row per device tick, in numpy."""

from __future__ import annotations

import csv
import os
from pathlib import Path
from typing import Any, Dict, Iterable, Iterator, List, Mapping, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _asperity
from ._errors import Error
from ._files import write_whole

PathLike = Union[str, "os.PathLike[str]"]
Floats = npt.NDArray[np.float64]

_words = ("sample", "device", "fault")


class Recording(Mapping[str, npt.NDArray[Any]]):
    """A session, one row per device tick. recording["depth_m"] is a column; its name has the unit.

    device_pose and the others below put columns together. Wrenches are force (N) and torque (N m). Columns can be read
    by name, counted with len() and iterated over, as those of a dict.

    >>> felt = asperity.Session(asperity.Renderer(probe, fixed, formulation="planes")).run(0.7)
    >>> felt.hand_wrench.shape, felt["depth_m"].shape
    ((700, 6), (700,))
    >>> bool(felt.contact_wrench[-1, 2] > 1.0)  # N up, on the probe
    True
    """

    def __init__(self, columns: Mapping[str, npt.ArrayLike]) -> None:
        """Columns by name, all of the same length. Raises ValueError where they are not."""
        self._columns: Dict[str, npt.NDArray[Any]] = {name: np.asarray(c) for name, c in columns.items()}
        shapes = {name: c.shape for name, c in self._columns.items()}
        if len(set(shapes.values())) > 1 or any(len(s) != 1 for s in shapes.values()):
            raise ValueError(f"columns have shapes {shapes}: give one number per device tick in each")

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        """The column of that name (N,)."""
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        """How many columns there are; rows says how many ticks."""
        return len(self._columns)

    def __repr__(self) -> str:
        return f"Recording({self.rows} ticks, {len(self)} columns)"

    @property
    def rows(self) -> int:
        """How many device ticks there are."""
        return 0 if not self._columns else len(next(iter(self._columns.values())))

    @property
    def time_s(self) -> Floats:
        """Time of each device tick (N,), s."""
        return self._columns["time_s"]

    @property
    def device_pose(self) -> Floats:
        """The handle in the device's frame (N, 7): x y z (m) qx qy qz qw."""
        return self._together("device", "_x_m", "_y_m", "_z_m", "_qx", "_qy", "_qz", "_qw")

    @property
    def probe_pose(self) -> Floats:
        """The probe's body frame in the world (N, 7): x y z (m) qx qy qz qw."""
        return self._together("probe", "_x_m", "_y_m", "_z_m", "_qx", "_qy", "_qz", "_qw")

    @property
    def contact_wrench(self) -> Floats:
        """Of the contact on the probe, about its centre of mass, world axes (N, 6): N and N m."""
        return self._together("contact", "_fx_n", "_fy_n", "_fz_n", "_tx_n_m", "_ty_n_m", "_tz_n_m")

    @property
    def hand_wrench(self) -> Floats:
        """On the hand, about the handle's origin, axes of the device (N, 6): N and N m."""
        return self._together("hand", "_fx_n", "_fy_n", "_fz_n", "_tx_n_m", "_ty_n_m", "_tz_n_m")

    def _together(self, who: str, *axes: str) -> Floats:
        return np.stack([self._columns[who + axis] for axis in axes], axis=1)

    def to_pandas(self) -> Any:
        """The table as a pandas DataFrame, with the time as its index. Needs pandas."""
        import pandas  # type: ignore[import]

        return pandas.DataFrame(dict(self._columns)).set_index("time_s")

    def save(self, file: PathLike) -> None:
        """Writes .npz (numpy.load reads it, one array per column) or .csv, which has the same numbers to the last digit.

        The file appears whole or not at all. Raises Error: io_failed, or unsupported for another extension.
        """
        path = Path(file)
        write = {".npz": self._write_npz, ".csv": self._write_csv}.get(path.suffix.lower())
        if write is None:
            raise Error("unsupported", f"{path} has to end in .npz or .csv")
        try:
            write_whole(path, write)
        except OSError as e:
            raise Error("io_failed", f"{path} could not be written: {e.strerror}") from e

    def _write_npz(self, path: Path) -> None:
        with open(path, "wb") as to:
            np.savez(to, **self._columns)

    def _write_csv(self, path: Path) -> None:
        columns = [c.tolist() for c in self._columns.values()]
        with open(path, "w", newline="") as to:
            writer = csv.writer(to, lineterminator="\n")
            writer.writerow(self._columns)
            writer.writerows(zip(*columns))

    @staticmethod
    def join(parts: Iterable["Recording"]) -> "Recording":
        """One recording of several with the same columns, in their order."""
        parts = list(parts)
        if len({tuple(p) for p in parts}) > 1:
            raise ValueError("the recordings have different columns")
        return Recording({name: np.concatenate([p[name] for p in parts]) for name in (parts[0] if parts else ())})


def recording_of(loop_rows: Tuple[Floats, Any, Any, Any]) -> Recording:
    """A Recording of what SessionLoop.run() answers."""
    numbers, *words = loop_rows
    names = _asperity.recording_columns
    columns: Dict[str, npt.NDArray[Any]] = {n: numbers[:, i] for i, n in enumerate(names[: numbers.shape[1]])}
    columns.update(zip(names[numbers.shape[1] :], words))
    return Recording(columns)


def load_recording(file: PathLike) -> Recording:
    """The Recording in a .csv or .npz of `asperity run --record` or of Recording.save().

    Numbers come back as they were, to the last digit. Raises Error: io_failed, bad_format or unsupported.

    >>> asperity.Session(asperity.Renderer(probe, fixed, formulation="planes")).run(0.1).save("felt.npz")
    >>> asperity.load_recording("felt.npz")
    Recording(100 ticks, 37 columns)
    """
    path = Path(file)
    read = {".npz": _read_npz, ".csv": _read_csv}.get(path.suffix.lower())
    if read is None:
        raise Error("unsupported", f"{path} has to end in .npz or .csv")
    try:
        out = read(path)
    except OSError as e:
        raise Error("io_failed", f"{path} could not be read: {e.strerror or e}") from e
    except Exception as e:  # whatever csv, zipfile and numpy say of bytes that are something else
        raise Error("bad_format", f"{path} is no recording: {e}") from e
    if "time_s" not in out:
        raise Error("bad_format", f"{path} is no recording: it has no column time_s")
    return out


def _read_npz(path: Path) -> Recording:
    with np.load(path, allow_pickle=False) as archive:
        return Recording({name: archive[name] for name in archive.files})


def _read_csv(path: Path) -> Recording:
    with open(path, newline="", encoding="utf-8") as lines:
        rows: List[List[str]] = list(csv.reader(lines))
    if not rows:
        raise ValueError("it is empty")
    names = rows[0]
    for number, row in enumerate(rows[1:], start=2):
        if len(row) != len(names):
            raise ValueError(f"line {number} has {len(row)} columns where the header has {len(names)}")
    columns: Dict[str, npt.NDArray[Any]] = {}
    texts = list(zip(*rows[1:])) if len(rows) > 1 else [()] * len(names)
    for name, column in zip(names, texts):
        columns[name] = np.array(column, dtype="U32") if name in _words else np.array(column, dtype=np.float64)
    return Recording(columns)
