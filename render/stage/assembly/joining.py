"""Shapes put in place and joined to geometry that is drawn at once: numpy alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from render.model.arrays import DoubleArray, FloatArray
from render.model.face_places import FacePlaces
from render.model.scene import VALUES_WIDTH, Geometry
from render.stage.geometry.polygons import unit
from render.stage.geometry.shape import Shape


@dataclass(frozen=True, eq=False)
class PlacedShape:
    """A shape and where it stands.

    Attributes:
        shape: in its own space.
        prim_id: number of its prim, as in `render.model.scene.Geometry`.
        material_id: number of its material, -1 for none.
        matrix: ``(4, 4)`` that carries it.
    """

    shape: Shape
    prim_id: int
    material_id: int
    matrix: DoubleArray


def place_shapes(parts: Sequence[PlacedShape]) -> Geometry:
    """Join shapes where they stand; a mirroring matrix turns the triangles about.

    Parts without texture coordinates or colours get zeros and white, where others have any.
    """
    shapes = [part.shape for part in parts]
    sizes, counts = [len(shape.positions) for shape in shapes], [len(shape.triangles) for shape in shapes]
    firsts = np.cumsum([0, *sizes])
    linear = np.stack([part.matrix[:3, :3] for part in parts])
    is_mirrored = np.linalg.det(linear) < 0
    of_normals = _cofactors(linear) * np.where(is_mirrored, -1.0, 1.0)[:, None, None]
    positions, normals = (np.empty((firsts[-1], 3), np.float32) for _ in range(2))
    for part, first, size, turn in zip(parts, firsts, sizes, of_normals, strict=False):
        own, matrix = slice(first, first + size), part.matrix
        positions[own] = part.shape.positions.astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
        normals[own] = part.shape.normals.astype(np.float64) @ turn.T
    turned = np.repeat(is_mirrored, counts)
    swapped = np.concatenate([shape.swapped for shape in shapes]) ^ turned
    triangles = np.concatenate([shape.triangles for shape in shapes])
    triangles += np.repeat(firsts[:-1], counts).astype(np.int32)[:, None]
    triangles[turned] = triangles[turned][:, [0, 2, 1]]
    material_ids = np.array([part.material_id for part in parts], np.int32)
    return Geometry(
        positions=positions,
        normals=unit(normals),
        triangles=triangles,
        prim_ids=np.repeat(np.array([part.prim_id for part in parts], np.int32), counts),
        face_ids=np.concatenate([shape.face_ids for shape in shapes]),
        fan_ids=np.concatenate([shape.fan_ids for shape in shapes]),
        uvs=_join_or_none([shape.uvs for shape in shapes], sizes, 0.0, 2),
        colors=_join_or_none([shape.colors for shape in shapes], sizes, 1.0, 4),
        swapped=swapped if swapped.any() else None,
        material_ids=np.repeat(material_ids, counts) if (material_ids >= 0).any() else None,
        places=_join_places(shapes),
        values=_join_or_none([shape.values for shape in shapes], sizes, 0.0, VALUES_WIDTH),
    )


def _join_places(shapes: Sequence[Shape]) -> FacePlaces | None:
    if all(shape.places is None for shape in shapes):
        return None
    own = [
        shape.places or FacePlaces(np.zeros((count, 3, 2), np.float32), np.zeros(count, np.int32))
        for shape in shapes
        for count in [len(shape.triangles)]
    ]
    return FacePlaces(np.concatenate([each.places for each in own]), np.concatenate([each.sizes for each in own]))


def _join_or_none(
    arrays: Sequence[FloatArray | None], sizes: Sequence[int], filler: float, width: int
) -> FloatArray | None:
    if all(array is None for array in arrays):
        return None
    return np.concatenate(
        [
            np.full((size, width), filler, np.float32) if array is None else array
            for array, size in zip(arrays, sizes, strict=True)
        ]
    )


def _cofactors(matrices: DoubleArray) -> DoubleArray:
    """Cofactors ``(k, 3, 3)`` of matrices: inverse transposes but for a factor, and also those of matrices that flatten."""
    after, before = matrices[:, [1, 2, 0]], matrices[:, [2, 0, 1]]
    return np.asarray(after[..., [1, 2, 0]] * before[..., [2, 0, 1]] - after[..., [2, 0, 1]] * before[..., [1, 2, 0]])
