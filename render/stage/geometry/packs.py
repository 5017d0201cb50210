"""Surfaces of several prims joined to one, so that numpy runs over all at once: a call costs more than a small surface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from render.model.arrays import FloatArray, LongArray
from render.stage.geometry.polygons import Fan, Polygons, Values, face_normals, fan, sum_at, value_index_of_corner

_SPLITS = ("uniform", "faceVarying")


@dataclass(frozen=True, eq=False)
class Pack:
    """Surfaces of several prims, one after another. Each has a corner at least.

    Attributes:
        polygons: all of them as one, without normals.
        points: ``(k + 1,)`` the first point of each surface, and the number of all points.
        faces: ``(k + 1,)`` the same for faces.
        corners: ``(k + 1,)`` the same for corners.
    """

    polygons: Polygons
    points: LongArray
    faces: LongArray
    corners: LongArray

    @property
    def count(self) -> int:
        """Number of surfaces."""
        return len(self.points) - 1

    @cached_property
    def fan(self) -> Fan:
        """Triangles of all surfaces."""
        return fan(self.polygons)

    @cached_property
    def triangles(self) -> LongArray:
        """``(k + 1,)`` the first triangle of each surface, and the number of all triangles."""
        return np.searchsorted(self.fan.face_ids, self.faces)

    def owners(self, bounds: LongArray) -> LongArray:
        """``(n,)`` the surface of each point, face, corner or triangle.

        Args:
            bounds: ``(k + 1,)`` of these.
        """
        return np.repeat(np.arange(self.count), np.diff(bounds))


@dataclass(frozen=True, eq=False)
class Field:
    """Values of a primvar at the corners of a surface.

    Attributes:
        values: ``(m, k)`` float32.
        index: ``(c,)`` which of the values each corner has.
        splits: ``(c,)`` the same where corners at one point may have different values, else None.
    """

    values: FloatArray
    index: LongArray
    splits: LongArray | None


def field_of(values: Values, polygons: Polygons) -> Field:
    """Values of a primvar at the corners of a surface.

    Raises:
        BadGeometry: they do not fit its faces.
    """
    index = value_index_of_corner(values, polygons)
    return Field(values.values, index, index if values.interpolation in _SPLITS else None)


def pack_surfaces(surfaces: Sequence[Polygons]) -> Pack:
    """Join surfaces, all of one orientation and smoothness."""
    points, faces, corners = (
        np.cumsum([0, *sizes])
        for sizes in (
            [len(each.points) for each in surfaces],
            [len(each.counts) for each in surfaces],
            [len(each.corners) for each in surfaces],
        )
    )
    holes = [_faces_among(each) + first for each, first in zip(surfaces, faces, strict=False) if each.holes is not None]
    joined_holes = np.concatenate(holes).astype(np.int32) if holes else None
    if len(surfaces) == 1:
        return Pack(replace(surfaces[0], normals=None, holes=joined_holes), points, faces, corners)
    joined = Polygons(
        points=np.concatenate([each.points for each in surfaces]),
        counts=np.concatenate([each.counts for each in surfaces]),
        corners=np.concatenate([each.corners for each in surfaces])
        + np.repeat(points[:-1], np.diff(corners)).astype(np.int32),
        left_handed=surfaces[0].left_handed,
        smooth=surfaces[0].smooth,
        holes=joined_holes,
    )
    return Pack(joined, points, faces, corners)


def _faces_among(polygons: Polygons) -> LongArray:
    """Holes of a surface that are faces of it."""
    holes = np.zeros(0, np.int64) if polygons.holes is None else polygons.holes.astype(np.int64)
    return holes[(holes >= 0) & (holes < len(polygons.counts))]


def join_fields(fields: Sequence[Field]) -> Field:
    """Values at the corners of a pack, of those of its surfaces."""
    if len(fields) == 1:
        return fields[0]
    firsts = np.cumsum([0, *(len(field.values) for field in fields[:-1])])
    splits = None
    if any(field.splits is not None for field in fields):
        splits = np.concatenate(
            [np.zeros_like(field.index) if field.splits is None else field.splits for field in fields]
        )
    return Field(
        np.concatenate([field.values for field in fields]),
        np.concatenate([field.index for field in fields]) + np.repeat(firsts, [len(field.index) for field in fields]),
        splits,
    )


def folded_shares(pack: Pack) -> FloatArray:
    """``(k,)`` the share of each surface's area where fans fold over themselves: in concave faces, unless their first corner is
    the reflex one."""
    polygons, triangles = pack.polygons, pack.fan
    if not (polygons.counts > 3).any():
        return np.zeros(pack.count, np.float32)
    normals = face_normals(polygons, triangles)
    whole = sum_at(triangles.face_ids, normals, len(polygons.counts))[triangles.face_ids]
    area, owner = np.linalg.norm(normals, axis=1), pack.owners(pack.triangles)
    folded = np.sum(normals * whole, axis=1) < 0
    folded_area, whole_area = (np.bincount(owner, weights, pack.count) for weights in (area * folded, area))
    return (folded_area / np.maximum(whole_area, np.finfo(np.float32).tiny)).astype(np.float32)
