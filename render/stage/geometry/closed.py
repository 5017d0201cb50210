"""Whether polygons close: whether they bound solids whose outside they face. numpy alone.

From outside of such a solid its front faces hide its back faces, so that a renderer may leave those out.
"""

from __future__ import annotations

import numpy as np

from render.model.arrays import BoolArray, FloatArray, LongArray
from render.stage.geometry.packs import Pack
from render.stage.geometry.polygons import Polygons, merge_duplicates

_SAME_PLACE = 1e-3  # share of the mean edge within which points are at one place
_MOST_SEAM_CORNERS = 1 << 20
"""Corners of polygons up to which seams are looked for, since that takes sorting."""
_FLAT = 1e-9
"""Volume, in cubes of a surface's size, up to which rounding may turn a flat solid inside out."""


def find_closed(pack: Pack, seams: BoolArray) -> BoolArray:
    """Which surfaces pass each edge as often in one direction as in the other, with each connected part facing outwards.

    With seams, points of a surface at the same place, up to a thousandth of an edge, are one. A part faces outwards where the
    volume that its triangles enclose (divergence theorem) is not negative; folds that turn only some of a part inside out are
    not found.

    Args:
        pack: surfaces as `render.stage.geometry.polygons.check` accepts them.
        seams: ``(k,)`` whether edges with points of their own may close where they meet.

    Returns:
        ``(k,)``.
    """
    here, after = _edges(pack.polygons)
    closed = _cancel(here, after, pack.corners)
    joined = ~closed & seams & (np.diff(pack.corners) <= _MOST_SEAM_CORNERS)
    if joined.any():
        chosen = joined[pack.owners(pack.corners)]
        here[chosen], after[chosen] = _join_seams(pack, here[chosen], after[chosen])
        closed = _cancel(here, after, pack.corners)
    closed &= ~_have_holes(pack)
    if closed.any():
        of_closed = closed[pack.owners(pack.corners)]
        part = _parts(here[of_closed], after[of_closed], len(pack.polygons.points))
        closed &= _face_outwards(pack, closed, part[here])
    return closed


def _have_holes(pack: Pack) -> BoolArray:
    """``(k,)`` whether some faces of a surface are not drawn."""
    holes = pack.polygons.holes
    found = np.zeros(pack.count, bool)
    if holes is not None:
        found[np.searchsorted(pack.faces, holes, side="right") - 1] = True
    return found


def _edges(polygons: Polygons) -> tuple[LongArray, LongArray]:
    """``(c,)`` point at each corner, and at the next corner of its face."""
    counts = polygons.counts[polygons.counts > 0].astype(np.int64)
    after = np.arange(1, len(polygons.corners) + 1)
    ends = np.cumsum(counts) - 1
    after[ends] = ends - counts + 1
    here = polygons.corners.astype(np.int64)
    return here, here[after]


def _join_seams(pack: Pack, here: LongArray, after: LongArray) -> tuple[LongArray, LongArray]:
    """Edges whose ends at one place of a surface are one point, of the edges that have no opposite.

    Points are at one place that share a cell of either of two grids, of which one is shifted by half a cell, so that few
    neighbours are apart in both.
    """
    points, owner = pack.polygons.points, pack.owners(pack.points)
    edges, opposites = here * len(points) + after, np.sort(after * len(points) + here)
    nearest = np.minimum(np.searchsorted(opposites, edges), len(edges) - 1)
    is_open = opposites[nearest] != edges
    is_end = np.zeros(len(points), bool)
    is_end[here[is_open]] = is_end[after[is_open]] = True
    ends = np.flatnonzero(is_end)
    if not len(ends):
        return here, after
    cells = _cells(pack, owner[here[is_open]], points[after[is_open]] - points[here[is_open]])
    places = points[ends] / cells[owner[ends]]
    firsts = []
    for shift in (0.0, 0.5):
        rows = np.concatenate([np.round(places + np.float32(shift)), owner[ends, None]], axis=1)
        _, number = merge_duplicates(rows.astype(np.float32))
        first = np.full(len(ends), len(ends))
        np.minimum.at(first, number, np.arange(len(ends)))
        firsts.append(first[number])
    place = np.arange(len(points))
    place[ends] = ends[_parts(np.concatenate(firsts), np.tile(np.arange(len(ends)), 2), len(ends))]
    return place[here], place[after]


def _cells(pack: Pack, owner: LongArray, edges: FloatArray) -> FloatArray:
    """``(k, 1)`` widths of the cells in which points of a surface are at one place.

    Args:
        pack: the surfaces.
        owner: ``(n,)`` the surface of each open edge.
        edges: ``(n, 3)`` from end to end.
    """
    length = np.bincount(owner, np.linalg.norm(edges, axis=1), pack.count)
    width = _SAME_PLACE * length / np.maximum(np.bincount(owner, minlength=pack.count), 1)
    return np.where(width > 0, width, 1.0).astype(np.float32)[:, None]


def _cancel(here: LongArray, after: LongArray, corners: LongArray) -> BoolArray:
    """``(k,)`` whether a surface's directed edges occur as often as their opposites.

    The sums of 64-bit hashes (splitmix64's mixer) of all edges and of all opposites are compared, since sorting edges takes ten
    times as long.
    """
    edges, opposites = (np.add.reduceat(_hash(*ends), corners[:-1]) for ends in ((here, after), (after, here)))
    return np.asarray(edges == opposites)


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


def _face_outwards(pack: Pack, chosen: BoolArray, part: LongArray) -> BoolArray:
    """``(k,)`` whether no connected part of a surface has a negative volume.

    Args:
        pack: the surfaces.
        chosen: ``(k,)`` which of them are asked for.
        part: ``(c,)`` point that stands for the connected part of each corner.
    """
    polygons, first = pack.polygons, pack.points[:-1]
    fans = pack.fan.corners[chosen[pack.owners(pack.triangles)]]
    corners = polygons.corners[fans]
    owner = pack.owners(pack.points)
    middle = np.add.reduceat(polygons.points, first, axis=0, dtype=np.float64) / np.diff(pack.points)[:, None]
    x, y, z = (polygons.points - middle[owner]).T.copy()  # one array each: numpy gathers rows slowly
    a, b, c = corners.T.copy()
    volumes = (
        x[a] * (y[b] * z[c] - z[b] * y[c]) + y[a] * (z[b] * x[c] - x[b] * z[c]) + z[a] * (x[b] * y[c] - y[b] * x[c])
    )
    volume = np.bincount(part[fans[:, 0]], volumes / 6, len(polygons.points))
    least, most = (reduce.reduceat(polygons.points, first, axis=0) for reduce in (np.minimum, np.maximum))
    size = (most - least).max(axis=1).astype(np.float64)
    inwards = (-volume if polygons.left_handed else volume) < -_FLAT * size[owner] ** 3
    outwards = np.ones(pack.count, bool)
    outwards[owner[inwards]] = False
    return outwards
