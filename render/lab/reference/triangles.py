"""The nearest triangle of a scene along each of many rays, in float64, on the processor.

Rays are given as the lens gives them: where they pass the plane of the entrance pupil and by how much they move to the right and
up for each metre of depth. In the coordinates ``(x/z, y/z, w = 1/z)`` they are straight lines and triangles stay triangles, so
the boxes of a bounding volume hierarchy fit there as tightly as a picture needs. Neighbours go down the hierarchy together.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray

IndexArray = NDArray[np.int64]

_LEAF = 8  # triangles
_PAIRS_AT_ONCE = 32  # packets with leaves, so few that their numbers fit a cache
_EDGE = 1e-9  # by which triangles overlap, in barycentric coordinates, so that no ray slips between two
_DEPTH_SHARE = 0.25  # how much a box's depth counts against its breadth where boxes are split


@dataclass(frozen=True, eq=False)
class Hits:
    """Hits of rays, in the shape ``(packets, rays)`` of the rays.

    Attributes:
        w: inverse depth, 1/m; 0 where a ray met nothing.
        triangle: index of the triangle, -1 for none.
        u: barycentric coordinate of the second corner.
        v: barycentric coordinate of the third corner.
    """

    w: DoubleArray
    triangle: IndexArray
    u: DoubleArray
    v: DoubleArray


class TriangleTracer:
    """Finds what rays meet among fixed triangles."""

    def __init__(self, corners: DoubleArray, two_sided: NDArray[np.bool_], *, near_m: float, far_m: float) -> None:
        """Sort the triangles into boxes.

        Args:
            corners: ``(n, 3, 3)`` camera space, metres: triangle, corner, coordinate. Counter-clockwise from the front.
            two_sided: ``(n,)`` whether the back is seen too.
            near_m: nearest depth at which anything is seen.
            far_m: farthest depth, may be infinite.
        """
        self._w_range = (1 / far_m, 1 / near_m)
        low, high = _bounds(corners, near_m)
        self._boxes = _Boxes.around(low, high)
        self._to_plane = _barycentric_rows(corners)[
            self._boxes.leaves
        ]  # a row of zeros stands where a leaf is not full
        self._two_sided = np.append(two_sided, False)[self._boxes.leaves]

    def nearest(self, offsets: DoubleArray, slopes: DoubleArray, behind_w: DoubleArray | None = None) -> Hits:
        """The nearest hit of each ray.

        Args:
            offsets: ``(packets, rays, 2)`` where rays pass the entrance pupil's plane, metres to the right and up.
            slopes: ``(packets, rays, 2)`` metres to the right and up for a metre of depth; NaN for rays that do not count.
            behind_w: ``(packets, rays)`` only what has less inverse depth than this counts. By default all.
        """
        limit = np.full(offsets.shape[:2], np.inf) if behind_w is None else behind_w
        packets, leaves = self._boxes.met_by(offsets, slopes)
        hits = Hits(*(np.full(limit.shape, fill) for fill in (0.0, -1, 0.0, 0.0)))
        counts = np.isfinite(slopes).all(-1) & (limit > 0)
        for chosen in _rounds(packets, -self._boxes.leaf_w[leaves]):
            for first in range(0, len(chosen), _PAIRS_AT_ONCE):
                part = chosen[first : first + _PAIRS_AT_ONCE]
                packet, leaf = packets[part], leaves[part]
                floor = np.where(counts[packet], hits.w[packet], np.inf).min(axis=1)
                kept = self._boxes.leaf_w[leaf] > floor
                if kept.any():
                    self._test(packet[kept], leaf[kept], offsets, slopes, limit, hits)
        return hits

    def _test(
        self,
        packet: IndexArray,
        leaf: IndexArray,
        offsets: DoubleArray,
        slopes: DoubleArray,
        limit: DoubleArray,
        hits: Hits,
    ) -> None:
        """Test the rays of packets with the triangles of a leaf each, no packet twice, and keep what is nearer."""
        rows = self._to_plane[leaf]  # (pairs, triangles, 3 barycentric rows, 4)
        pairs, size = rows.shape[:2]
        across = rows[..., [0, 1, 3]].reshape(pairs, 3 * size, 3).transpose(0, 2, 1)
        along = (rows[..., :3] * [1, 1, -1]).reshape(pairs, 3 * size, 3).transpose(0, 2, 1)
        ones = np.ones((pairs, offsets.shape[1], 1))
        at_pupil = np.concatenate([offsets[packet], ones], -1) @ across
        per_metre = np.concatenate([slopes[packet], ones], -1) @ along
        a, b = (m.reshape(pairs, -1, size, 3) for m in (at_pupil, per_metre))
        with np.errstate(divide="ignore", invalid="ignore"):
            w = -b[..., 2] / a[..., 2]
            u, v = a[..., 0] + b[..., 0] / w, a[..., 1] + b[..., 1] / w
            seen = (u >= -_EDGE) & (v >= -_EDGE) & (u + v <= 1 + _EDGE) & (w < limit[packet][..., None])
            seen &= (w >= self._w_range[0]) & (w <= self._w_range[1])
            seen &= (b[..., 2] < 0) | self._two_sided[leaf][:, None, :]
        w = np.where(seen, w, 0.0)
        best = w.argmax(axis=-1)[..., None]
        nearest = np.take_along_axis(w, best, -1)[..., 0]
        pair, ray = np.nonzero(nearest > hits.w[packet])
        which = best[pair, ray, 0]
        place = packet[pair], ray
        hits.w[place] = nearest[pair, ray]
        hits.triangle[place] = self._boxes.leaves[leaf[pair], which]
        hits.u[place] = u[pair, ray, which]
        hits.v[place] = v[pair, ray, which]


@dataclass(frozen=True, eq=False)
class _Boxes:
    """A bounding volume hierarchy: a complete binary tree. Node i has the children 2i + 1 and 2i + 2; the last nodes are leaves.

    Attributes:
        low: ``(nodes, 3)`` corner in (x/z, y/z, w).
        high: the same, upper corner.
        leaves: ``(leaves, size)`` triangles, -1 where there is none.
    """

    low: DoubleArray
    high: DoubleArray
    leaves: IndexArray

    @classmethod
    def around(cls, low: DoubleArray, high: DoubleArray) -> _Boxes:
        """Boxes around triangles by their own boxes, halved at the median along their longest side."""
        there = np.flatnonzero((low <= high).all(axis=1))
        leaves = 1 << int(np.ceil(np.log2(max(len(there), _LEAF) / _LEAF)))
        padding = -len(there) % leaves or (leaves if len(there) == 0 else 0)
        parts = np.pad(there, (0, padding), constant_values=-1)[None]
        middle = np.zeros((len(low) + 1, 3))  # the last stands for no triangle
        middle[there] = (low[there] + high[there]) / 2 * [1, 1, _DEPTH_SHARE]
        while len(parts) < leaves:
            places = middle[parts]
            longest = np.ptp(places, axis=1).argmax(axis=1)
            key = np.take_along_axis(places, longest[:, None, None], axis=2)[..., 0]
            order = np.argpartition(key, parts.shape[1] // 2, axis=1)
            parts = np.take_along_axis(parts, order, axis=1).reshape(2 * len(parts), -1)
        nothing = np.full((1, 3), np.inf)
        lows = [np.concatenate([low, nothing])[parts].min(axis=1)]
        highs = [np.concatenate([high, -nothing])[parts].max(axis=1)]
        while len(lows[0]) > 1:
            lows.insert(0, lows[0].reshape(-1, 2, 3).min(axis=1))
            highs.insert(0, highs[0].reshape(-1, 2, 3).max(axis=1))
        return cls(np.concatenate(lows), np.concatenate(highs), parts)

    @property
    def leaf_w(self) -> DoubleArray:
        """``(leaves,)`` largest inverse depth of each."""
        return self.high[len(self.high) - len(self.leaves) :, 2]

    def met_by(self, offsets: DoubleArray, slopes: DoubleArray) -> tuple[IndexArray, IndexArray]:
        """Pairs of packet and leaf whose boxes overlap; the rays' part is bounded by ``slope + offset·w``, end by end."""
        slope = np.fmin.reduce(slopes, axis=1), np.fmax.reduce(slopes, axis=1)
        offset = np.fmin.reduce(offsets, axis=1), np.fmax.reduce(offsets, axis=1)
        packet, node = np.arange(len(offsets)), np.zeros(len(offsets), np.int64)
        if not np.isfinite(self.high[0]).all():  # nothing is there
            return packet[:0], node[:0]
        found: list[tuple[IndexArray, IndexArray]] = []
        first_leaf = len(self.low) - len(self.leaves)
        while len(packet):
            near, far = (np.clip(corner[node, 2:], 0.0, self.high[0, 2]) for corner in (self.high, self.low))
            least, most = (s[packet] + o[packet] * near for s, o in zip(slope, offset, strict=True))
            least = np.minimum(least, slope[0][packet] + offset[0][packet] * far)
            most = np.maximum(most, slope[1][packet] + offset[1][packet] * far)
            met = ((least <= self.high[node, :2]) & (most >= self.low[node, :2])).all(1)
            packet, node = packet[met], node[met]
            leaf = node >= first_leaf
            found.append((packet[leaf], node[leaf] - first_leaf))
            packet = np.repeat(packet[~leaf], 2)
            node = (2 * node[~leaf][:, None] + [1, 2]).ravel()
        return np.concatenate([p for p, _ in found]), np.concatenate([n for _, n in found])


def _rounds(packets: IndexArray, urgency: DoubleArray) -> list[IndexArray]:
    """Indices of pairs in rounds that hold no packet twice, each packet's most urgent (least) first."""
    order = np.lexsort((urgency, packets))
    starts = np.flatnonzero(np.diff(packets[order], prepend=-1))
    rank = np.arange(len(order)) - np.repeat(starts, np.diff(starts, append=len(order)))
    by_rank = np.argsort(rank, kind="stable")
    return np.split(order[by_rank], np.cumsum(np.bincount(rank))[:-1])


def _bounds(corners: DoubleArray, near_m: float) -> tuple[DoubleArray, DoubleArray]:
    """``(n, 3)`` least and largest (x/z, y/z, w) of the parts of triangles behind the near plane; none has least > largest."""
    ends = np.roll(corners, -1, axis=1)
    start_depth, end_depth = -corners[..., 2], -ends[..., 2]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = (near_m - start_depth) / (end_depth - start_depth)
        cuts = corners + share[..., None] * (ends - corners)
    cuts[..., 2] = -near_m
    points = np.concatenate([corners, cuts], axis=1)
    counts = np.concatenate([start_depth >= near_m, (start_depth < near_m) != (end_depth < near_m)], axis=1)
    depth = np.where(counts, -points[..., 2], 1.0)
    places = np.stack([points[..., 0] / depth, points[..., 1] / depth, 1 / depth], axis=-1)
    low = np.where(counts[..., None], places, np.inf).min(axis=1)
    return low, np.where(counts[..., None], places, -np.inf).max(axis=1)


def _barycentric_rows(corners: DoubleArray) -> DoubleArray:
    """``(n + 1, 3, 4)`` rows that take a point ``(x, y, z, 1)`` to u, v and the distance from the plane over its normal.

    Triangles without area, and one more at the end, have zeros: no ray meets them.
    """
    edges = np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=2)
    normal = np.cross(edges[..., 0], edges[..., 1])
    frame = np.concatenate([edges, normal[..., None]], axis=2)
    flat = ~(np.linalg.det(frame) > 0)
    frame[flat] = np.eye(3)
    turn = np.linalg.inv(frame)
    rows = np.concatenate([turn, -(turn @ corners[:, 0, :, None])], axis=2)
    rows[flat] = 0.0
    return np.concatenate([rows, np.zeros((1, 3, 4))])
