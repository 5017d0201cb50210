"""Whether polygons close: whether they bound solids whose outside they face. numpy alone.

From outside of such a solid its front faces hide its back faces, so that a renderer may leave those out.
"""

from __future__ import annotations

import numpy as np

from render.model.arrays import FloatArray, LongArray
from render.stage.geometry.polygons import Polygons, fan, merge_duplicates

_SAME_PLACE = 1e-3  # share of the mean edge within which points are at one place
_MOST_SEAM_CORNERS = 1 << 20
"""Corners of polygons up to which seams are looked for, since that takes sorting."""
_FLAT = 1e-9
"""Volume, in cubes of a surface's size, up to which rounding may turn a flat solid inside out."""


def is_closed(polygons: Polygons, *, seams: bool = True) -> bool:
    """Whether faces pass each edge as often in one direction as in the other, and each connected part faces outwards.

    With ``seams``, points at the same place, up to a thousandth of an edge, are one. A part faces outwards where the volume that
    its triangles enclose (divergence theorem) is not negative; folds that turn only some of a part inside out are not found.

    Args:
        polygons: of one prim, as `render.stage.geometry.polygons.check` accepts them.
        seams: whether edges with points of their own may close where they meet.
    """
    has_holes = polygons.holes is not None and len(polygons.holes) > 0
    if has_holes or not len(polygons.corners):
        return False
    here, after = _edges(polygons)
    if not _cancel(here, after):
        if not seams:
            return False
        here, after = _join_seams(polygons.points, here, after)
        if not _cancel(here, after):
            return False
    part = _parts(here, after, len(polygons.points))
    return _face_outwards(polygons, part[here])


def _edges(polygons: Polygons) -> tuple[LongArray, LongArray]:
    """``(c,)`` point at each corner, and at the next corner of its face."""
    counts = polygons.counts[polygons.counts > 0].astype(np.int64)
    after = np.arange(1, len(polygons.corners) + 1)
    ends = np.cumsum(counts) - 1
    after[ends] = ends - counts + 1
    here = polygons.corners.astype(np.int64)
    return here, here[after]


def _join_seams(points: FloatArray, here: LongArray, after: LongArray) -> tuple[LongArray, LongArray]:
    """Edges whose ends at one place are one point, of the edges that have no opposite.

    Points are at one place that share a cell of either of two grids, of which one is shifted by half a cell, so that few
    neighbours are apart in both.
    """
    if len(here) > _MOST_SEAM_CORNERS:
        return here, after
    edges, opposites = here * len(points) + after, np.sort(after * len(points) + here)
    nearest = np.minimum(np.searchsorted(opposites, edges), len(edges) - 1)
    is_open = opposites[nearest] != edges
    is_end = np.zeros(len(points), bool)
    is_end[here[is_open]] = is_end[after[is_open]] = True
    ends = np.flatnonzero(is_end)
    if not len(ends):
        return here, after
    own = points[ends]
    cell = _SAME_PLACE * float(np.linalg.norm(points[after[is_open]] - points[here[is_open]], axis=1).mean()) or 1.0
    firsts = []
    for shift in (0.0, 0.5):
        _, number = merge_duplicates(np.round(own / cell + shift).astype(np.float32))
        first = np.full(len(own), len(own))
        np.minimum.at(first, number, np.arange(len(own)))
        firsts.append(first[number])
    place = np.arange(len(points))
    place[ends] = ends[_parts(np.concatenate(firsts), np.tile(np.arange(len(own)), 2), len(own))]
    return place[here], place[after]


def _cancel(here: LongArray, after: LongArray) -> bool:
    """Whether directed edges occur as often as their opposites.

    The sums of 64-bit hashes (splitmix64's mixer) of all edges and of all opposites are compared, since sorting edges takes ten
    times as long.
    """
    return bool(_hash(here, after).sum() == _hash(after, here).sum())


def _hash(one: LongArray, other: LongArray) -> np.ndarray[tuple[int, ...], np.dtype[np.uint64]]:
    mixed = one.astype(np.uint64) * np.uint64(0x9E3779B97F4A7C15) + other.astype(np.uint64)
    for shift, factor in ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB)):
        mixed = (mixed ^ (mixed >> np.uint64(shift))) * np.uint64(factor)
    return mixed ^ (mixed >> np.uint64(31))


def _parts(here: LongArray, after: LongArray, points: int) -> LongArray:
    """``(points,)`` least point that is connected to each (Shiloach & Vishkin 1982: hooking and pointer jumping)."""
    forward = here < after
    a, b = here[forward], after[forward]
    part = np.arange(points)
    while len(a):
        low, high = np.minimum(part[a], part[b]), np.maximum(part[a], part[b])
        np.minimum.at(part, high, low)
        while True:
            jumped = part[part]
            if np.array_equal(jumped, part):
                break
            part = jumped
        apart = part[a] != part[b]
        a, b = a[apart], b[apart]
    return part


def _face_outwards(polygons: Polygons, part: LongArray) -> bool:
    """Whether no connected part has a negative volume; ``part`` ``(c,)`` is that of each corner."""
    fans = fan(polygons).corners
    corners = polygons.corners[fans]
    x, y, z = (
        polygons.points - polygons.points.mean(axis=0, dtype=np.float64)
    ).T.copy()  # one array each: numpy gathers rows slowly
    a, b, c = corners.T.copy()
    volumes = (
        x[a] * (y[b] * z[c] - z[b] * y[c]) + y[a] * (z[b] * x[c] - x[b] * z[c]) + z[a] * (x[b] * y[c] - y[b] * x[c])
    )
    volume = np.bincount(part[fans[:, 0]], volumes / 6)
    size = float(np.ptp(polygons.points, axis=0).max())
    return bool(((-volume if polygons.left_handed else volume) >= -_FLAT * size**3).all())
