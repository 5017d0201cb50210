"""Pictures of primvars: their values at places on the faces of prims, interpolated as the prims' meshes say."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from pxr import Usd

from render.errors import SettingsError
from render.model.arrays import FloatArray
from render.model.surface_points import SurfacePoints
from render.stage.findings import FindingLog
from render.stage.geometry.generated import generated_polygons, is_generated
from render.stage.geometry.polygons import Polygons, Values, value_index_of_corner
from render.stage.geometry.primvars import FoundPrimvar, find_primvar
from render.stage.geometry.surface import mesh_faces
from render.stage.values import UNREADABLE

_MOST_NUMBERS = 4


def picture_primvar(
    stage: Usd.Stage, name: str, prim_paths: Sequence[str], points: SurfacePoints, time: Usd.TimeCode
) -> FloatArray:
    """Read a primvar at places on faces.

    A prim without it, or with one that does not fit its faces, has 0. Numbers that a prim lacks of the widest one's are 0 too.
    Instances of a PointInstancer have their prototype's.

    Args:
        stage: the stage.
        name: name of the primvar, without ``primvars:``.
        prim_paths: paths that the points index. All of them are asked for the number of channels, seen or not.
        points: the places.
        time: time code of the values.

    Returns:
        ``(height, width)`` or ``(height, width, 2..4)`` float32, 0 where nothing is. Integers and booleans are numbers.

    Raises:
        SettingsError: no prim has a primvar of that name with one to four numbers for each element.
    """
    found = find_numeric(stage, name, prim_paths)
    widths = {i: _width(primvar) for i, primvar in found.items()}
    picture = np.zeros((*points.mesh_ids.shape, max(widths.values())), np.float32)
    for number in np.unique(points.mesh_ids):
        if number not in found:
            continue
        values = found[number].read(time, widths[number])
        here = points.mesh_ids == number
        if values is not None:
            prim = stage.GetPrimAtPath(prim_paths[number])
            picture[here, : widths[number]] = _interpolate(prim, values, points, here, time)
    return picture[..., 0] if picture.shape[2] == 1 else picture


def find_numeric(stage: Usd.Stage, name: str, prim_paths: Sequence[str]) -> dict[int, FoundPrimvar]:
    """Find a primvar of one to four numbers for each element.

    Args:
        stage: the stage.
        name: name of the primvar, without ``primvars:``.
        prim_paths: prims to look at.

    Returns:
        The primvar by index of the prim.

    Raises:
        SettingsError: no prim has it.
    """
    every = ((i, _find(stage, path, name)) for i, path in enumerate(prim_paths))
    found = {i: primvar for i, primvar in every if primvar is not None and _width(primvar)}
    if not found:
        raise SettingsError(f"no prim that is drawn has a primvar {name} of one to four numbers")
    return found


def _find(stage: Usd.Stage, path: str, name: str) -> FoundPrimvar | None:
    prim = stage.GetPrimAtPath(path)
    return find_primvar(prim, name) if prim else None


def _width(primvar: FoundPrimvar) -> int:
    """Numbers of each element by the primvar's type; 0 where it holds no numbers, or more than four."""
    default = np.asarray(primvar.primvar.GetTypeName().scalarType.defaultValue)
    if default.dtype.kind not in "biuf" or default.ndim > 1 or default.size > _MOST_NUMBERS:
        return 0
    return default.size


def _interpolate(
    prim: Usd.Prim,
    values: Values,
    points: SurfacePoints,
    here: np.ndarray[tuple[int, ...], np.dtype[np.bool_]],
    time: Usd.TimeCode,
) -> FloatArray:
    """Values ``(n, k)`` at the marked points of a prim; 0 where they do not fit its faces."""
    try:
        polygons = _faces(prim, time)
        values = values if polygons.sampling is None else polygons.sampling.resample(values)
        index, counts = value_index_of_corner(values, polygons), polygons.counts
        faces, fans = points.faces[here].astype(np.int64), points.fans[here]
        first = (np.cumsum(counts, dtype=np.int64) - counts)[faces]
        of_corners = values.values[index[np.stack([first, first + fans + 1, first + fans + 2], axis=1)]]
    except UNREADABLE:
        return np.zeros((int(here.sum()), values.values.shape[1]), np.float32)
    interpolated: FloatArray = np.einsum("nc,nck->nk", points.weights[here], np.nan_to_num(of_corners)).astype(
        np.float32
    )
    return interpolated


def _faces(prim: Usd.Prim, time: Usd.TimeCode) -> Polygons:
    """Faces of a drawn prim; of a mesh without its points."""
    if is_generated(prim):
        return generated_polygons(prim, time, FindingLog())  # what is odd about it is noted where it is drawn
    return Polygons(np.zeros((0, 3), np.float32), *mesh_faces(prim, time))
