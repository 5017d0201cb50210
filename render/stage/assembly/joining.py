"""Shapes put in place and joined to geometry that is drawn at once: numpy alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from render.model.arrays import DoubleArray, FloatArray, IntArray
from render.model.scene import Geometry
from render.stage.geometry.polygons import unit
from render.stage.geometry.shape import Shape


def place_shape(shape: Shape, prim_id: int, material_id: int, matrix: DoubleArray) -> Geometry:
    """A shape as geometry, carried by a ``(4, 4)`` matrix; a mirroring matrix turns the triangles about."""
    is_mirrored = np.linalg.det(matrix[:3, :3]) < 0
    positions = shape.positions.astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
    geometry = Geometry(
        positions=positions.astype(np.float32),
        normals=_transform_normals(shape.normals, matrix, is_mirrored),
        triangles=shape.triangles,
        prim_ids=np.full(len(shape.triangles), prim_id, np.int32),
        face_ids=shape.face_ids,
        fan_ids=shape.fan_ids,
        uvs=shape.uvs,
        colors=shape.colors,
        swapped=shape.swapped if shape.swapped.any() else None,
        material_ids=np.full(len(shape.triangles), material_id, np.int32) if material_id >= 0 else None,
    )
    return mirror_geometry(geometry) if is_mirrored else geometry


def mirror_geometry(geometry: Geometry) -> Geometry:
    """The same geometry with its triangles the other way around, for a transform that mirrors it."""
    swapped = np.zeros(len(geometry.triangles), bool) if geometry.swapped is None else geometry.swapped
    return replace(geometry, triangles=np.ascontiguousarray(geometry.triangles[:, [0, 2, 1]]), swapped=~swapped)


def join_geometry(parts: Sequence[Geometry]) -> Geometry:
    """Several geometries as one; parts without texture coordinates or colours get zeros and white."""
    if len(parts) == 1:
        return parts[0]
    firsts = np.cumsum([0, *(len(part.positions) for part in parts[:-1])])
    return Geometry(
        positions=np.concatenate([part.positions for part in parts]),
        normals=np.concatenate([part.normals for part in parts]),
        triangles=np.concatenate(
            [part.triangles + np.int32(first) for part, first in zip(parts, firsts, strict=True)], dtype=np.int32
        ),
        prim_ids=np.concatenate([part.prim_ids for part in parts]),
        face_ids=np.concatenate([part.face_ids for part in parts]),
        fan_ids=np.concatenate([part.fan_ids for part in parts]),
        uvs=_join_or_none([part.uvs for part in parts], parts, 0.0, 2),
        colors=_join_or_none([part.colors for part in parts], parts, 1.0, 4),
        swapped=_join_swaps(parts),
        material_ids=_join_materials(parts),
    )


def _join_or_none(
    arrays: Sequence[FloatArray | None], parts: Sequence[Geometry], filler: float, width: int
) -> FloatArray | None:
    if all(array is None for array in arrays):
        return None
    return np.concatenate(
        [
            np.full((len(part.positions), width), filler, np.float32) if array is None else array
            for array, part in zip(arrays, parts, strict=True)
        ]
    )


def _join_swaps(parts: Sequence[Geometry]) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]] | None:
    if all(part.swapped is None for part in parts):
        return None
    return np.concatenate(
        [np.zeros(len(part.triangles), bool) if part.swapped is None else part.swapped for part in parts]
    )


def _join_materials(parts: Sequence[Geometry]) -> IntArray | None:
    if all(part.material_ids is None for part in parts):
        return None
    none = [np.full(len(part.triangles), -1, np.int32) for part in parts]
    return np.concatenate(
        [other if part.material_ids is None else part.material_ids for part, other in zip(parts, none, strict=True)]
    )


def _transform_normals(normals: FloatArray, matrix: DoubleArray, is_mirrored: np.bool_) -> FloatArray:
    """Normals go by the inverse transpose; its cofactor form also does for flattened shapes."""
    sign = -1.0 if is_mirrored else 1.0
    return unit((sign * (normals.astype(np.float64) @ _cofactors(matrix[:3, :3]).T)).astype(np.float32))


def _cofactors(matrix: DoubleArray) -> DoubleArray:
    """Cofactors ``(3, 3)`` of a ``(3, 3)`` matrix. numpy's own cross product takes thirty times as long for so few numbers."""
    a, b, c = matrix.tolist()
    return np.array(
        [
            [v[1] * w[2] - v[2] * w[1], v[2] * w[0] - v[0] * w[2], v[0] * w[1] - v[1] * w[0]]
            for v, w in ((b, c), (c, a), (a, b))
        ]
    )
