"""Transmittance of a scene along bundles of lines to an eye, with numpy alone.

Lines are transformed into each geometry's own space, where a bounding volume hierarchy selects the triangles that they may
meet. A hierarchy is built once for each geometry, which lives as long as its points stay (`render.model.scene`). Lines and
triangles are intersected by Möller & Trumbore 1997, "Fast, minimum storage ray/triangle intersection".
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray, FloatArray
from render.model.scene import Batch, Geometry, Scene
from render.shot.focus.opacity import opacity_at

IndexArray = NDArray[np.int64]

_LEAF = 8  # triangles in a box of the lowest level
_BRANCHES = 4  # boxes in a box of the level above
_OPAQUE = 0.999  # opacity from which on a surface is opaque, as for the layers
_CELLS = 1024  # along each side of a geometry's box, for the Morton order of its triangles
_SAME_T = 1e-9  # hits within this distance in t are one hit
_EDGE = 1e-9  # by which triangles overlap, in barycentric coordinates, so that no line passes between two


@dataclass(frozen=True, eq=False)
class Lines:
    """From each of n origins a bundle of r straight lines to the eye: ``origin + t · way``, t from 0 at the origin to 1.

    Attributes:
        origins: ``(n, 3)`` metres.
        ways: ``(n, r, 3)`` to the eye, metres.
        first: ``(n,)`` least t that counts.
        last: ``(n,)`` largest.
    """

    origins: DoubleArray
    ways: DoubleArray
    first: DoubleArray
    last: DoubleArray

    def transform(self, which: IndexArray, matrices: DoubleArray) -> Lines:
        """Select bundles and transform each by its own matrix, ``(m, 4, 4)``; t is unchanged."""
        turn = matrices[:, :3, :3].transpose(0, 2, 1)
        origins = (self.origins[which, None] @ turn)[:, 0] + matrices[:, :3, 3]
        return Lines(origins, self.ways[which] @ turn, self.first[which], self.last[which])

    @property
    def middle(self) -> DoubleArray:
        """``(n, 3)`` the middle way of each bundle."""
        return np.asarray((self.ways.min(axis=1) + self.ways.max(axis=1)) / 2)

    @property
    def spread(self) -> DoubleArray:
        """``(n, 3)`` largest distance of a bundle's ways from its middle along each axis, at the eye."""
        return np.asarray(np.ptp(self.ways, axis=1) / 2)


def transmittance(scene: Scene, lines: Lines) -> DoubleArray:
    """Compute the transmittance of a scene along each line: 1 where nothing is in the way, 0 behind something opaque.

    Surfaces that are partly clear, by their material, texture or displayOpacity, let that part through; holes of cut-outs let
    all through. Surfaces whose back faces are not drawn are met from the front alone.

    Args:
        scene: the scene.
        lines: in the world.

    Returns:
        ``(n, r)`` from 0 to 1.
    """
    through = np.ones(lines.ways.shape[:2])
    for batch, poses, to_local, bundle in _candidate_instances(scene, lines):
        open_ = through[bundle].any(axis=1)
        local = lines.transform(bundle[open_], to_local[open_])
        hits = _hierarchy_of(batch.geometry).intersect(local, two_sided=batch.has_backs)
        opacity = opacity_at(batch, batch.geometry.triangles[hits.triangle], hits.u, hits.v, poses[open_][hits.bundle])
        clear = np.where(opacity >= _OPAQUE, 0.0, 1 - opacity)
        np.multiply.at(through, (bundle[open_][hits.bundle], hits.line), clear)
    return through


def _candidate_instances(scene: Scene, lines: Lines) -> Iterator[tuple[Batch, IndexArray, DoubleArray, IndexArray]]:
    """For each batch, instances that may be in the way of bundles, transforms to their space, and which bundles."""
    batches = [
        batch
        for batch in scene.batches
        if len(batch.poses) and len(batch.geometry.triangles) and batch.camera_role != "unseen"
    ]
    if not batches or not lines.ways.size:
        return
    counts = np.array([len(batch.poses) for batch in batches])
    poses = np.concatenate([batch.poses for batch in batches])
    own = np.array([(b.low, b.high) for b in (_hierarchy_of(batch.geometry) for batch in batches)])
    middle, half = (own[:, 1] + own[:, 0]) / 2, (own[:, 1] - own[:, 0]) / 2
    middle, half = (np.repeat(value, counts, axis=0)[:, :, None] for value in (middle, half))
    centres = (poses[:, :3, :3] @ middle)[..., 0] + poses[:, :3, 3]
    radii = np.linalg.norm((np.abs(poses[:, :3, :3]) @ half)[..., 0], axis=1)
    pose, bundle = np.nonzero(_meets_ball(lines, centres, radii))
    ends = np.searchsorted(pose, np.cumsum([0, *counts]))
    for number in np.flatnonzero(np.diff(ends)):
        part = slice(ends[number], ends[number + 1])
        matrices = poses[pose[part]]
        solid = np.abs(np.linalg.det(matrices[:, :3, :3])) > 0  # an instance scaled to nothing hides nothing
        if solid.any():
            instances = pose[part][solid] - (counts[:number].sum())
            yield batches[number], instances, np.linalg.inv(matrices[solid]), bundle[part][solid]


def _meets_ball(lines: Lines, centres: DoubleArray, radii: DoubleArray) -> NDArray[np.bool_]:
    """``(balls, n)`` true where a bundle may meet a ball. A bundle is a cone about its middle, bounded by a cylinder."""
    length = np.linalg.norm(lines.middle, axis=1)
    ahead = lines.middle / length[:, None]
    along = centres @ ahead.T - np.sum(lines.origins * ahead, axis=1)
    square = np.sum(centres**2, axis=1)[:, None] - 2 * centres @ lines.origins.T + np.sum(lines.origins**2, axis=1)
    reach = radii[:, None] + np.linalg.norm(lines.spread, axis=1)
    slack = 1e-9 * (square + along**2)
    beside = square - along**2 <= reach**2 + slack
    return np.asarray(beside & (along >= -reach) & (along <= length + reach))


@dataclass(frozen=True, eq=False)
class _Hits:
    """Intersections of lines and triangles.

    Attributes:
        bundle: of the line.
        line: which of its bundle.
        triangle: of the hit.
        u: barycentric coordinate of the triangle's second corner there.
        v: and of the third.
    """

    bundle: IndexArray
    line: IndexArray
    triangle: IndexArray
    u: DoubleArray
    v: DoubleArray

    def select(self, which: IndexArray) -> _Hits:
        """Some of the hits."""
        return _Hits(self.bundle[which], self.line[which], self.triangle[which], self.u[which], self.v[which])


def _unique_hits(bundle: IndexArray, line: IndexArray, t: DoubleArray) -> IndexArray:
    """Indices of hits without repetition: a line through the shared edge of two triangles meets one surface, not two."""
    order = np.lexsort((t, line, bundle))
    is_new = (np.diff(bundle[order]) != 0) | (np.diff(line[order]) != 0) | (np.diff(t[order]) > _SAME_T)
    return np.asarray(order[np.append(True, is_new)[: len(order)]])


class _BoxHierarchy:
    """Bounding volume hierarchy of the triangles of one geometry, in its own space.

    Attributes:
        low: ``(3,)`` corner of the box around all.
        high: likewise.
    """

    def __init__(self, geometry: Geometry) -> None:
        # The geometry itself is not kept, so that it is freed with its scene.
        self._positions, self._triangles = geometry.positions, geometry.triangles
        self.low = self._positions.min(axis=0).astype(np.float64)
        self.high = self._positions.max(axis=0).astype(np.float64)
        self._sorted: tuple[IndexArray, list[tuple[DoubleArray, DoubleArray]]] | None = None

    def intersect(self, lines: Lines, *, two_sided: bool) -> _Hits:
        """Find every intersection of a line and a triangle.

        Args:
            lines: in the geometry's own space.
            two_sided: true to meet backs too.
        """
        bundle, triangle = self._candidates(lines)
        corners = self._positions[self._triangles[triangle]].astype(np.float64)
        a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        from_corner = lines.origins[bundle] - corners[:, 0]
        across, ways = np.cross(from_corner, a), lines.ways[bundle]
        with np.errstate(divide="ignore", invalid="ignore"):
            facing = (ways @ np.cross(a, b)[..., None])[..., 0]  # positive where the eye looks at the front
            u = (ways @ np.cross(from_corner, b)[..., None])[..., 0] / facing
            v = -(ways @ across[..., None])[..., 0] / facing
            t = -np.sum(b * across, axis=1)[:, None] / facing
            hit = (u >= -_EDGE) & (v >= -_EDGE) & (u + v <= 1 + _EDGE) & ((facing > 0) | (two_sided & (facing < 0)))
            hit &= (t >= lines.first[bundle, None]) & (t <= lines.last[bundle, None])
        which, line = np.nonzero(hit)
        hits = _Hits(bundle[which], line, triangle[which], u[hit], v[hit])
        return hits.select(_unique_hits(hits.bundle, line, t[hit]))

    def _candidates(self, lines: Lines) -> tuple[IndexArray, IndexArray]:
        """Pairs of a bundle and a triangle that share a lowest box."""
        if self._sorted is None:
            self._sorted = _build_boxes(self._positions, self._triangles)
        order, levels = self._sorted
        middle, spread = lines.middle, lines.spread
        bundle, box = np.arange(len(lines.origins)), np.zeros(len(lines.origins), np.int64)
        for level, (low, high) in enumerate(levels):
            if level:
                bundle = np.repeat(bundle, _BRANCHES)
                box = (box[:, None] * _BRANCHES + np.arange(_BRANCHES)).ravel()
            kept = _meets_box(lines, middle, bundle, low[box] - spread[bundle], high[box] + spread[bundle])
            bundle, box = bundle[kept], box[kept]
        triangle = order.reshape(-1, _LEAF)[box].ravel()
        return np.repeat(bundle, _LEAF)[triangle >= 0], triangle[triangle >= 0]


_HIERARCHIES: WeakKeyDictionary[Geometry, _BoxHierarchy] = WeakKeyDictionary()


def _hierarchy_of(geometry: Geometry) -> _BoxHierarchy:
    hierarchy = _HIERARCHIES.get(geometry)
    if hierarchy is None:
        hierarchy = _HIERARCHIES[geometry] = _BoxHierarchy(geometry)
    return hierarchy


def _build_boxes(
    positions: FloatArray, triangles: NDArray[np.int32]
) -> tuple[IndexArray, list[tuple[DoubleArray, DoubleArray]]]:
    """Triangles in Morton order, padded with -1, and the boxes of all levels from the root down."""
    a, b, c = (positions[triangles[:, i]] for i in range(3))
    low, high = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
    order = np.argsort(_morton_codes(((low + high) / 2).astype(np.float32))).astype(np.int64)
    spare = -len(order) % _LEAF
    filled = np.pad(order, (0, spare), mode="edge")
    boxes = low[filled].reshape(-1, _LEAF, 3).min(axis=1), high[filled].reshape(-1, _LEAF, 3).max(axis=1)
    levels = [(boxes[0].astype(np.float64), boxes[1].astype(np.float64))]
    while len(levels[0][0]) > 1:
        # a box of NaN pads a level; no line meets it
        full = [np.pad(side, ((0, -len(side) % _BRANCHES), (0, 0)), constant_values=np.nan) for side in levels[0]]
        lows, highs = (side.reshape(-1, _BRANCHES, 3) for side in full)
        levels[:1] = [(np.fmin.reduce(lows, axis=1), np.fmax.reduce(highs, axis=1)), (full[0], full[1])]
    return np.pad(order, (0, spare), constant_values=-1), levels


def _morton_codes(positions: FloatArray) -> NDArray[np.uint32]:
    """``(n,)`` positions along the Z-order curve, on which near points are near (Morton 1966)."""
    low = positions.min(axis=0)
    size = positions.max(axis=0) - low
    share = (positions - low) / np.where(size > 0, size, 1)
    cell = np.minimum(share * _CELLS, _CELLS - 1).astype(np.uint32)
    for shift, mask in ((16, 0x030000FF), (8, 0x0300F00F), (4, 0x030C30C3), (2, 0x09249249)):
        cell = (cell | (cell << np.uint32(shift))) & np.uint32(mask)
    return np.asarray(cell[:, 0] | (cell[:, 1] << np.uint32(1)) | (cell[:, 2] << np.uint32(2)), np.uint32)


def _meets_box(
    lines: Lines, ways: DoubleArray, bundle: IndexArray, low: DoubleArray, high: DoubleArray
) -> NDArray[np.bool_]:
    """True where a line meets its axis-aligned box (Kay & Kajiya 1986, "Ray tracing complex scenes")."""
    origins = lines.origins[bundle]
    with np.errstate(divide="ignore", invalid="ignore"):
        per_way = 1 / ways[bundle]
        a, b = (low - origins) * per_way, (high - origins) * per_way
    # NaN, from a line within the plane of a side, is no bound
    enters, leaves = np.fmin(a, b), np.fmax(a, b)
    first = np.fmax(np.fmax(enters[:, 0], enters[:, 1]), np.fmax(enters[:, 2], lines.first[bundle]))
    last = np.fmin(np.fmin(leaves[:, 0], leaves[:, 1]), np.fmin(leaves[:, 2], lines.last[bundle]))
    return np.asarray((first <= last) & ~np.isnan(low[:, 0]))
