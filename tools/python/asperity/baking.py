"""From a full-resolution mesh to a textured model."""

from __future__ import annotations

import os
import warnings
from pathlib import Path
from typing import Callable, Optional, Union

from . import _asperity
from ._errors import BakeRemark

PathLike = Union[str, "os.PathLike[str]"]


def _mesh_of(given: Union[_asperity.Mesh, PathLike], scale: float) -> _asperity.Mesh:
    if isinstance(given, _asperity.Mesh):
        if scale != 1.0:
            raise ValueError("scale is for files: a Mesh is in metres")
        return given
    return _asperity.load_mesh(given, scale=scale)


def bake(
    mesh: Union[_asperity.Mesh, PathLike],
    output: Optional[PathLike] = None,
    *,
    name: Optional[str] = None,
    triangles: Optional[int] = None,
    texture: int = 1024,
    coarse: Union[_asperity.Mesh, PathLike, None] = None,
    pieces: Optional[int] = None,
    scale: float = 1.0,
    repair: str = "keep",
    wrap: bool = False,
    material: Union[_asperity.Material, str, None] = None,
    field: bool = True,
    threads: int = 0,
    progress: Optional[Callable[[str, float], Optional[bool]]] = None,
) -> _asperity.Model:
    """Turns a full-resolution mesh into a textured model, as `asperity bake` does, and returns it.

    mesh: a Mesh, or a file (.ply, .obj, .stl, .gltf, .glb).
    output: a .glb to write as well. It appears whole or not at all.
    name: kept in the model; by default the file's name without extension, or "mesh".
    triangles: of the coarse mesh, to aim for; by default 600, or more where the mesh has too many handles for these.
    texture: texels per side.
    coarse: a coarse mesh to use in place of simplifying. pieces: convex pieces to aim for.
    scale: metres per unit of the files, 0.001 for millimetres.
    repair: what becomes of a mesh that is not closed: keep (mended, or refused), wrap (wrapped where it cannot be
        mended) or strict (refused). wrap: lay a closed surface around it in any case.
    material: a Material, or the name of a preset: steel, wood, rubber, ice.
    field: keep the depth field, without which every renderer has to make it.
    threads: 0 takes all; the result does not depend on it.
    progress: called as progress(stage, done), with done from 0 to 1, on this thread; returning False cancels.

    Raises Error with its code; cancelled where progress says so. Ctrl-C ends a bake within half a second. What was done
    differently from what was asked is told as a warning, BakeRemark.

    >>> asperity.bake(asperity.benchmark_mesh("torus"), name="ring", triangles=200, texture=128, material="wood")
    Model('ring', 200 triangles, texture 128 x 128)
    """
    if name is None:
        name = "mesh" if isinstance(mesh, _asperity.Mesh) else Path(mesh).stem
    model, remarks = _asperity.bake_mesh(
        _mesh_of(mesh, scale),
        name=name,
        triangles=triangles,
        texture=texture,
        coarse=None if coarse is None else _mesh_of(coarse, 1.0 if isinstance(coarse, _asperity.Mesh) else scale),
        pieces=pieces,
        repair=repair,
        wrap=wrap,
        material=_asperity.Material.preset(material) if isinstance(material, str) else material,
        field=field,
        threads=threads,
        progress=progress,
    )
    if output is not None:
        model.save(output)
    for remark in remarks:
        warnings.warn(remark, BakeRemark, stacklevel=2)
    return model
