"""A folder of meshes becomes a folder of models and of touches: tasks that one machine does in turn, or a cluster shares.

    python3 -m asperity.dataset MESHES OUT --probe probe.glb --sessions 4 --workers 2

Each mesh is one task that bakes it, and one task for each session in which a simulated hand scrubs it. A task writes one file,
whole or not at all, and its file says that it is done: what was cut off goes on where it was, on any number of machines that
share the folder. Which worker did a task changes no byte.
"""

from __future__ import annotations

import argparse
import dataclasses
import hashlib
import importlib
import json
import os
import sys
import warnings
from pathlib import Path
from typing import Any, Callable, Dict, Iterable, List, Optional, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _asperity
from ._errors import BakeRemark, Error
from ._files import write_whole
from ._spectra import amplitudes
from .baking import bake
from .session import Session

PathLike = Union[str, "os.PathLike[str]"]
_MESHES = (".ply", ".obj", ".stl", ".gltf", ".glb")


@dataclasses.dataclass(frozen=True)
class Plan:
    """What is made of each mesh. A folder is made by one plan; another one is refused there.

    probe: a baked model (.glb) that the hand holds.
    sessions: touches of each mesh, seeds 1 to this. seconds: length of each, s of the session's clock.
    triangles, texture: of the bakes. scale: metres per unit of the meshes.
    """

    probe: str
    sessions: int = 4
    seconds: float = 1.0
    triangles: int = 600
    texture: int = 512
    scale: float = 1.0


@dataclasses.dataclass(frozen=True)
class Report:
    """What a run did.

    made, kept: files, those of this run and those that were there already.
    refused: why there is no file, by the file's name: a mesh that no bake takes, a session that found nothing to touch.
    """

    made: Tuple[str, ...]
    kept: Tuple[str, ...]
    refused: Dict[str, str]


def _write_json(file: Path, document: Any) -> None:
    def write(part: Path) -> None:
        part.write_text(json.dumps(document, indent=1, sort_keys=True) + "\n")

    write_whole(file, write)


def _bake_task(mesh: str, out: str, plan: Plan) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", BakeRemark)
        model = bake(mesh, name=Path(mesh).stem, triangles=plan.triangles, texture=plan.texture, scale=plan.scale, threads=1)
    write_whole(Path(out), lambda part: model.save(part))


def spectrum(force: npt.ArrayLike, rate_hz: float) -> Tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Amplitude of evenly spaced forces (N, 3) over frequency: (F,) Hz and (F, 3) N, the mean taken off, Hann window.

    >>> from asperity import dataset
    >>> turning = 2 * np.pi * 50 * np.arange(1000) / 1000
    >>> hz, amplitude = dataset.spectrum(np.stack([np.sin(turning), 0 * turning, 2 + 0 * turning], axis=1), 1000.0)
    >>> hz[amplitude[:, 0].argmax()], amplitude[50].round(3)
    (50.0, array([1., 0., 0.]))
    """
    values = np.asarray(force, dtype=np.float64)
    if values.ndim != 2 or values.shape[1] != 3 or values.shape[0] < 2:
        raise ValueError(f"force has shape {values.shape}: give (N, 3), N, with two rows at least")
    return amplitudes(values, rate_hz)


def _touch_task(model: str, out: str, seed: int, plan: Plan) -> None:
    probe, fixed = _asperity.load(plan.probe), _asperity.load(model)
    renderer = _asperity.Renderer(probe, fixed, formulation="planes")
    felt = Session(renderer, _asperity.SimulatedDevice(seed=seed)).run(plan.seconds)
    rate_hz = 1000.0
    frequency_hz, amplitude_n = spectrum(felt.hand_wrench[:, :3], rate_hz)
    columns: Dict[str, Any] = {
        "time_s": felt.time_s, "probe_pose": felt.probe_pose, "hand_wrench": felt.hand_wrench,
        "contact_wrench": felt.contact_wrench, "depth_m": felt["depth_m"], "contacts": felt["contacts"],
        "spectrum_hz": frequency_hz, "spectrum_n": amplitude_n, "seed": np.int64(seed)}
    write_whole(Path(out), lambda part: np.savez(part, **columns))


# (kind, what it reads, what it writes, seed); the files of one kind do not depend on each other.
_Task = Tuple[str, str, str, int]


def _do(task: _Task, plan: Plan) -> Optional[str]:
    """Does a task. Returns why it cannot be done, where it is refused."""
    kind, given, out, seed = task
    try:
        if kind == "bake":
            _bake_task(given, out, plan)
        else:
            _touch_task(given, out, seed, plan)
    except (Error, ValueError) as why:
        return str(why)
    return None


def _distributed() -> Any:
    # Not at the top: a serial run does without it.
    return importlib.import_module("distributed")


def _share(client: Any, tasks: List[_Task], plan: Plan) -> Iterable[Tuple[_Task, Optional[str]]]:
    if client is None:
        for task in tasks:
            yield task, _do(task, plan)
        return
    # A worker that dies takes its task with it; the scheduler gives that to another one.
    futures = {client.submit(_do, task, plan, pure=False, retries=3): task for task in tasks}
    for done in _distributed().as_completed(list(futures)):
        yield futures[done], done.result()


def _plan_of(folder: Path, plan: Plan) -> None:
    told = dataclasses.asdict(plan)
    told["probe"] = hashlib.sha256(Path(plan.probe).read_bytes()).hexdigest()
    file = folder / "plan.json"
    if not file.exists():
        _write_json(file, told)
        return
    before = json.loads(file.read_text())
    if before != told:
        changed = ", ".join(sorted(k for k in told if before.get(k) != told[k]))
        raise ValueError(f"{file} was made by another plan ({changed} differ): use another folder, or delete this one")


def make(
    meshes: PathLike,
    output: PathLike,
    plan: Plan,
    *,
    client: Any = None,
    told: Optional[Callable[[str, int, int], None]] = None,
) -> Report:
    """Bakes every mesh of a folder and touches it; files that are there already are kept.

    meshes: folder of .ply, .obj, .stl, .gltf and .glb files. Their names without extension have to differ.
    output: folder; gets plan.json, models/NAME.glb, sessions/NAME-SEED.npz and refused.json.
    client: a dask.distributed.Client whose workers see both folders under the same names; None: this process does all.
    told: called as told(file, done, of) after each task.

    Raises ValueError for a folder of another plan and for names that clash, OSError where nothing can be read or written.
    """
    folder = Path(output).resolve()
    sources = sorted(p.resolve() for p in Path(meshes).iterdir() if p.suffix.lower() in _MESHES)
    names = [p.stem for p in sources]
    twice = sorted({n for n in names if names.count(n) > 1})
    if twice:
        raise ValueError(f"several meshes are called {', '.join(twice)}: their models would be the same file")
    plan = dataclasses.replace(plan, probe=str(Path(plan.probe).resolve()))
    for part in ("models", "sessions"):
        (folder / part).mkdir(parents=True, exist_ok=True)
    _plan_of(folder, plan)
    bakes: List[_Task] = [("bake", str(p), str(folder / "models" / f"{p.stem}.glb"), 0) for p in sources]
    of = len(bakes) * (1 + plan.sessions)
    made: List[str] = []
    kept: List[str] = []
    refused: Dict[str, str] = {}

    def work(tasks: List[_Task]) -> None:
        here = [t for t in tasks if Path(t[2]).exists()]
        kept.extend(os.path.relpath(t[2], folder) for t in here)
        for task, why in _share(client, [t for t in tasks if t not in here], plan):
            name = os.path.relpath(task[2], folder)
            if why is None:
                made.append(name)
            else:
                refused[name] = why
            if told is not None:
                told(name, len(made) + len(kept) + len(refused), of)

    work(bakes)
    touches: List[_Task] = []
    for _, _, model, _ in bakes:
        if not Path(model).exists():
            continue
        for seed in range(1, plan.sessions + 1):
            touches.append(("touch", model, str(folder / "sessions" / f"{Path(model).stem}-{seed}.npz"), seed))
    work(touches)
    _write_json(folder / "refused.json", refused)
    return Report(tuple(sorted(made)), tuple(sorted(kept)), refused)


def _main() -> int:
    line = argparse.ArgumentParser(prog="python3 -m asperity.dataset", description="Bakes a folder of meshes and touches each of them.")
    line.add_argument("meshes", help="folder of meshes")
    line.add_argument("output", help="folder to write; goes on with what is there")
    line.add_argument("--probe", required=True, help="baked model that the hand holds (.glb)")
    for name, unit in (("sessions", int), ("seconds", float), ("triangles", int), ("texture", int), ("scale", float)):
        line.add_argument(f"--{name}", type=unit, default=getattr(Plan, name), help="%(default)s by default")
    line.add_argument("--workers", type=int, default=0, help="processes of this machine, through dask.distributed; by default one, without it")
    line.add_argument("--scheduler", help="address of a dask.distributed scheduler whose workers see the folders")
    asked = line.parse_args()
    plan = Plan(asked.probe, asked.sessions, asked.seconds, asked.triangles, asked.texture, asked.scale)

    def told(name: str, done: int, of: int) -> None:
        print(f"{done}/{of} {name}", file=sys.stderr)

    try:
        if asked.workers > 0 or asked.scheduler:
            more = {"address": asked.scheduler} if asked.scheduler else {"n_workers": asked.workers, "threads_per_worker": 1, "dashboard_address": None}
            with _distributed().Client(**more) as client:
                report = make(asked.meshes, asked.output, plan, client=client, told=told)
        else:
            report = make(asked.meshes, asked.output, plan, told=told)
    except (ValueError, OSError, Error) as why:
        print(f"asperity.dataset: {why}", file=sys.stderr)
        return 1
    except ImportError:
        print("asperity.dataset: --workers and --scheduler need dask.distributed (Debian: python3-distributed)", file=sys.stderr)
        return 1
    for name, reason in report.refused.items():
        print(f"{name}: {reason}", file=sys.stderr)
    print(f"{len(report.made)} files made, {len(report.kept)} were there, {len(report.refused)} refused")
    return 0


if __name__ == "__main__":
    sys.exit(_main())
