"""Polygons as USD gives them, cut into fans of triangles with shared vertices: numpy alone.

A face's fan is its corners ``(0, i + 1, i + 2)`` in authored order. Where the face points the other way (left-handed
orientation), the triangle's last two corners are swapped, so that triangles are counter-clockwise seen from outside.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray, FloatArray, IntArray, LongArray


@dataclass(frozen=True, eq=False)
class Values:
    """Primvar: values and their interpolation.

    Attributes:
        values: ``(m, k)`` float32.
        interpolation: constant, uniform, varying, vertex or faceVarying.
        indices: ``(n,)`` int32 into ``values``, or None where element i has value i.
    """

    values: FloatArray
    interpolation: str
    indices: IntArray | None = None


class Resampler(Protocol):
    """Brings primvars of a prim to the polygons that are made from it."""

    def resample(self, values: Values) -> Values:
        """Return a primvar's values at the polygons. Raises `BadGeometry` where there are fewer than elements."""


@dataclass(frozen=True, eq=False)
class AuthoredFaces:
    """Authored faces that polygons are parts of (`render.model.face_places`).

    Attributes:
        faces: ``(f,)`` int32 authored face of each face.
        sizes: ``(f,)`` int32 number of that face's corners.
        places: ``(c, 2)`` float32 place of each corner on that face.
    """

    faces: IntArray
    sizes: IntArray
    places: FloatArray


@dataclass(frozen=True, eq=False)
class Polygons:
    """The surface of one prim at one time, in its own space and units.

    Attributes:
        points: ``(n, 3)`` float32.
        counts: ``(f,)`` int32 corners of each face.
        corners: ``(c,)`` int32 point index of each corner.
        normals: authored normals, or None.
        left_handed: whether faces are clockwise seen from outside.
        smooth: whether missing normals are smooth (a subdivision cage) or one for each face.
        holes: face indices that are not drawn.
        sampling: resamples the prim's primvars, where they do not belong to these points and faces; else None.
        authored: the prim's own faces, where these are parts of them; else None.
    """

    points: FloatArray
    counts: IntArray
    corners: IntArray
    normals: Values | None = None
    left_handed: bool = False
    smooth: bool = False
    holes: IntArray | None = None
    sampling: Resampler | None = None
    authored: AuthoredFaces | None = None


@dataclass(frozen=True, eq=False)
class Fan:
    """Triangles of polygons.

    Attributes:
        corners: ``(m, 3)`` int64 index into ``Polygons.corners``, in fan order.
        face_ids: ``(m,)`` int32.
        fan_ids: ``(m,)`` int32.
        face_of_corner: ``(c,)`` int64.
    """

    corners: LongArray
    face_ids: IntArray
    fan_ids: IntArray
    face_of_corner: LongArray


# In the prim's own units; beyond it, squares of areas overflow single precision.
FARTHEST_POINT = 1e9


class BadGeometry(ValueError):  # noqa: N818 - it is a finding about a prim, not an error of ours
    """Inconsistent polygons; the message explains the fault."""


def check(polygons: Polygons) -> None:
    """Raise :class:`BadGeometry` where counts, indices or points cannot be used."""
    corners, points = polygons.corners, polygons.points
    check_counts(polygons.counts, corners)
    if len(corners) and (corners.min() < 0 or corners.max() >= len(points)):
        raise BadGeometry(
            f"faceVertexIndices run from {corners.min()} to {corners.max()}, but there are {len(points)} points"
        )
    check_finite(points)


def check_finite(points: FloatArray | DoubleArray) -> None:
    """Raise :class:`BadGeometry` where a point is not finite or out of range."""
    if np.abs(points).max(initial=0) <= FARTHEST_POINT:
        return
    if not np.isfinite(points).all():
        bad = int(np.flatnonzero(~np.isfinite(points).all(axis=1))[0])
        raise BadGeometry(f"point {bad} is not finite")
    bad = int(np.flatnonzero((np.abs(points) > FARTHEST_POINT).any(axis=1))[0])
    raise BadGeometry(f"point {bad} is out of range, {FARTHEST_POINT:g} units")


def check_counts(counts: IntArray, corners: IntArray) -> None:
    """Raise :class:`BadGeometry` where faces do not fit their corners."""
    if (counts < 0).any():
        raise BadGeometry("faceVertexCounts has a negative count")
    if int(counts.sum(dtype=np.int64)) != len(corners):
        raise BadGeometry(f"faceVertexCounts add up to {counts.sum()} corners, but there are {len(corners)} indices")


def fan(polygons: Polygons) -> Fan:
    """Cut each face into the fan of its corners, without holes and without faces of fewer than three corners."""
    counts = polygons.counts.astype(np.int64)
    starts = np.cumsum(counts) - counts
    triangles_of_face = np.maximum(counts - 2, 0)
    if polygons.holes is not None and len(polygons.holes):
        triangles_of_face[polygons.holes[(polygons.holes >= 0) & (polygons.holes < len(counts))]] = 0
    face_ids = np.repeat(np.arange(len(counts)), triangles_of_face)
    fan_ids = np.arange(len(face_ids)) - np.repeat(np.cumsum(triangles_of_face) - triangles_of_face, triangles_of_face)
    first = starts[face_ids]
    return Fan(
        np.stack([first, first + fan_ids + 1, first + fan_ids + 2], axis=1),
        face_ids.astype(np.int32),
        fan_ids.astype(np.int32),
        np.repeat(np.arange(len(counts)), counts),
    )


def value_index_of_corner(values: Values, polygons: Polygons) -> LongArray:
    """``(c,)`` which of the primvar's values each corner takes.

    Raises:
        BadGeometry: there are fewer values than the interpolation needs, or an index is out of range.
    """
    match values.interpolation:
        case "constant":
            element = np.zeros(len(polygons.corners), np.int64)
        case "uniform":
            element = np.repeat(np.arange(len(polygons.counts)), polygons.counts)
        case "vertex" | "varying":
            element = polygons.corners.astype(np.int64)
        case "faceVarying":
            element = np.arange(len(polygons.corners))
        case other:
            raise BadGeometry(f"interpolation {other!r} is not known")
    if values.indices is not None:
        _check_range(element, len(values.indices), "indices")
        element = values.indices[element].astype(np.int64)
    _check_range(element, len(values.values), "values")
    return element


def _check_range(index: LongArray, size: int, what: str) -> None:
    if len(index) and (index.max() >= size or index.min() < 0):
        raise BadGeometry(f"it needs {int(index.max()) + 1} {what} and has {size}")


def face_normals(polygons: Polygons, fan_: Fan) -> FloatArray:
    """``(m, 3)`` float64-summed normals of the triangles, twice as long as their areas, pointing outside."""
    a, b, c = (polygons.points[polygons.corners[fan_.corners[:, i]]].astype(np.float64) for i in range(3))
    cross = np.cross(b - a, c - a)
    return (-cross if polygons.left_handed else cross).astype(np.float32)


def compute_normals(polygons: Polygons, fan_: Fan) -> Values:
    """Normals for polygons that have none: smooth ones at the points of a subdivision cage, else one for each face.

    Smooth normals are sums over the corners at a point of the cross product of the two edges there, as in Hydra: they do not
    depend on how faces are cut into triangles.
    """
    if polygons.smooth:
        return Values(unit(sum_at(polygons.corners, _corner_normals(polygons, fan_), len(polygons.points))), "vertex")
    return Values(unit(sum_at(fan_.face_ids, face_normals(polygons, fan_), len(polygons.counts))), "uniform")


def _corner_normals(polygons: Polygons, fan_: Fan) -> FloatArray:
    """``(c, 3)`` cross product of the edges to the next and to the previous corner, pointing outside."""
    cross = np.cross(*corner_edges(polygons, fan_, polygons.points))
    return (-cross if polygons.left_handed else cross).astype(np.float32)


def corner_edges(polygons: Polygons, fan_: Fan, points: FloatArray) -> tuple[DoubleArray, DoubleArray]:
    """``(c, 3)`` each: from every corner to the next one of its face, and to the one before, with points at ``points``."""
    counts = polygons.counts.astype(np.int64)
    size, start = counts[fan_.face_of_corner], (np.cumsum(counts) - counts)[fan_.face_of_corner]
    number = np.arange(len(polygons.corners)) - start
    here, after, before = (
        points[polygons.corners[start + (number + step) % size]].astype(np.float64) for step in (0, 1, -1)
    )
    return after - here, before - here


def transfer_normals(polygons: Polygons, fan_: Fan, moved: FloatArray) -> Values | None:
    """Authored normals carried along as the points move, hard edges and all.

    At each corner the normal is a covector: its components along the two edges and across the face stay as the edges bend.

    Args:
        polygons: the surface at rest, with normals.
        fan_: its triangles.
        moved: ``(n, 3)`` where its points have gone.

    Returns:
        The normals after the deformation, or None without normals.

    Raises:
        BadGeometry: the normals do not fit the polygons.
    """
    if polygons.normals is None:
        return None
    index = value_index_of_corner(polygons.normals, polygons)
    normals = polygons.normals.values[index].astype(np.float64)
    after, before = corner_edges(polygons, fan_, polygons.points)
    moved_after, moved_before = corner_edges(polygons, fan_, moved)
    across, moved_across = _unit_and_length(np.cross(after, before))[0], np.cross(moved_after, moved_before)
    moved_across, area = _unit_and_length(moved_across)
    along_after = np.sum(normals * after, axis=1, keepdims=True) * np.cross(moved_before, moved_across)
    along_before = np.sum(normals * before, axis=1, keepdims=True) * np.cross(moved_across, moved_after)
    carried = (along_after + along_before) / area + np.sum(normals * across, axis=1, keepdims=True) * moved_across
    _, group = np.unique(polygons.corners * np.int64(len(polygons.normals.values)) + index, return_inverse=True)
    summed = sum_at(group, carried.astype(np.float32), int(group.max(initial=-1)) + 1)
    return Values(unit(summed), "faceVarying", group.astype(np.int32))


def _unit_and_length(vectors: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    length[length == 0] = np.finfo(np.float64).tiny
    return vectors / length, length


def sum_at(where: NDArray[np.integer], what: FloatArray, size: int) -> FloatArray:
    """``(size, 3)`` sums of vectors ``(n, 3)`` by the places ``(n,)`` that they go to."""
    return np.stack([np.bincount(where, what[:, i], size) for i in range(3)], axis=1).astype(np.float32)


def unit(vectors: FloatArray) -> FloatArray:
    """``(n, 3)`` vectors at unit length; those without a length point up."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    good = np.isfinite(length) & (length > 1e-20)
    out = np.where(good, vectors / np.where(good, length, 1), np.array([0, 1, 0], np.float32))
    return out.astype(np.float32)


def weld(polygons: Polygons, value_indices: Sequence[LongArray]) -> tuple[LongArray, LongArray]:
    """Find the corners that can share a vertex: same point and same value of everything that varies by face or corner.

    Args:
        polygons: the surface.
        value_indices: for each such primvar, ``(c,)`` the value each corner takes.

    Returns:
        ``(v,)`` one corner for each vertex, and ``(c,)`` the vertex of each corner.
    """
    if not value_indices:
        return _weld_points(polygons.corners, len(polygons.points))
    key = polygons.corners.astype(np.int64)
    for index in value_indices:
        # Both factors stay below 2^31, since the key is renumbered densely each time.
        _, key = np.unique(key, return_inverse=True)
        key = key * (int(index.max(initial=0)) + 1) + index
    _, corner_of_vertex, vertex_of_corner = np.unique(key, return_index=True, return_inverse=True)
    return corner_of_vertex, vertex_of_corner


def _weld_points(corners: IntArray, points: int) -> tuple[LongArray, LongArray]:
    """`weld` where corners at one point always share a vertex: without sorting."""
    first = np.full(points, -1)
    first[corners[::-1]] = np.arange(len(corners))[::-1]
    used = first >= 0
    return first[used], (np.cumsum(used) - 1)[corners]


def merge_duplicates(values: FloatArray) -> tuple[FloatArray, LongArray]:
    """Equal rows made one: ``(u, k)`` distinct rows and ``(m,)`` which of them each row is.

    Rows are compared by a 64-bit hash of their bits (splitmix64's mixer), since sorting whole rows is ten times slower;
    should two rows ever share a hash, nothing is merged.
    """
    bits = np.ascontiguousarray(values + np.float32(0)).view(np.uint32).astype(np.uint64)  # + 0 makes -0 and 0 equal
    hashed = np.zeros(len(values), np.uint64)
    for column in bits.T:
        hashed = (hashed ^ column) * np.uint64(0xBF58476D1CE4E5B9)
        hashed ^= hashed >> np.uint64(29)
    _, first, inverse = np.unique(hashed, return_index=True, return_inverse=True)
    distinct = values[first]
    if not np.array_equal(distinct[inverse], values, equal_nan=True):
        return values, np.arange(len(values))
    return distinct, inverse
