"""What stands between an eye and places in a scene, and how much it lets pass: numpy alone.

Lines are carried into each geometry's own space, where a hierarchy of boxes around its triangles says which of them they may
meet. The boxes are made once for each geometry, which lives as long as nothing moves its points (`render.model.scene`). Lines and
triangles meet as Möller & Trumbore 1997 have it, "Fast, minimum storage ray/triangle intersection".
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
_OPAQUE = 0.999  # from which opacity on a surface hides what is behind it altogether, as for the layers
_CELLS = 1024  # along each side of a geometry's box, when its triangles are sorted by place
_SAME_PLACE = 1e-9  # share of a way within which two triangles are met at once
_EDGE = 1e-9  # by which triangles overlap, in barycentric coordinates, so that no line slips between two


@dataclass(frozen=True, eq=False)
class Lines:
    """From each of n places a bundle of r straight lines to the eye: ``place + t · way``, t from 0 at the place to 1.

    Attributes:
        places: ``(n, 3)`` metres.
        ways: ``(n, r, 3)`` to the eye, metres.
        first: ``(n,)`` least t that counts.
        last: ``(n,)`` largest.
    """

    places: DoubleArray
    ways: DoubleArray
    first: DoubleArray
    last: DoubleArray

    def carried(self, which: IndexArray, matrices: DoubleArray) -> Lines:
        """Some of the bundles, each carried by a matrix of its own, ``(m, 4, 4)``; t stays what it is."""
        turn = matrices[:, :3, :3].transpose(0, 2, 1)
        places = (self.places[which, None] @ turn)[:, 0] + matrices[:, :3, 3]
        return Lines(places, self.ways[which] @ turn, self.first[which], self.last[which])

    @property
    def middle(self) -> DoubleArray:
        """``(n, 3)`` the way in the middle of each bundle."""
        return np.asarray((self.ways.min(axis=1) + self.ways.max(axis=1)) / 2)

    @property
    def spread(self) -> DoubleArray:
        """``(n, 3)`` how far along each axis a bundle's ways lie from its middle at most, at the eye."""
        return np.asarray(np.ptp(self.ways, axis=1) / 2)


def passed(scene: Scene, lines: Lines) -> DoubleArray:
    """How much of each line comes through: 1 where nothing stands in its way, 0 where something opaque does.

    Surfaces that are partly clear, by their material, texture or displayOpacity, let that part through; holes of cut-outs let
    all through. One-sided surfaces stand in the way of those alone who look at their front, as they are drawn.

    Args:
        scene: what is there.
        lines: in the world.

    Returns:
        ``(n, r)`` from 0 to 1.
    """
    through = np.ones(lines.ways.shape[:2])
    for batch, to_local, bundle in _roots_met(scene, lines):
        open_ = through[bundle].any(axis=1)
        local = lines.carried(bundle[open_], to_local[open_])
        met = _boxes_of(batch.geometry).met(local, two_sided=batch.double_sided)
        opacity = opacity_at(batch, batch.geometry.triangles[met.triangle], met.u, met.v)
        clear = np.where(opacity >= _OPAQUE, 0.0, 1 - opacity)
        np.multiply.at(through, (bundle[open_][met.bundle], met.line), clear)
    return through


def _roots_met(scene: Scene, lines: Lines) -> Iterator[tuple[Batch, DoubleArray, IndexArray]]:
    """For each batch, what carries bundles to the space of instances that may be in their way, and which bundles."""
    batches = [batch for batch in scene.batches if len(batch.poses) and len(batch.geometry.triangles)]
    if not batches or not lines.ways.size:
        return
    counts = np.array([len(batch.poses) for batch in batches])
    poses = np.concatenate([batch.poses for batch in batches])
    own = np.array([(b.low, b.high) for b in (_boxes_of(batch.geometry) for batch in batches)])
    middle, half = (own[:, 1] + own[:, 0]) / 2, (own[:, 1] - own[:, 0]) / 2
    middle, half = (np.repeat(value, counts, axis=0)[:, :, None] for value in (middle, half))
    centres = (poses[:, :3, :3] @ middle)[..., 0] + poses[:, :3, 3]
    radii = np.linalg.norm((np.abs(poses[:, :3, :3]) @ half)[..., 0], axis=1)
    pose, bundle = np.nonzero(_meets_ball(lines, centres, radii))
    ends = np.searchsorted(pose, np.cumsum([0, *counts]))
    for number in np.flatnonzero(np.diff(ends)):
        part = slice(ends[number], ends[number + 1])
        matrices = poses[pose[part]]
        solid = np.abs(np.linalg.det(matrices[:, :3, :3])) > 0  # what is flattened to nothing hides nothing
        if solid.any():
            yield batches[number], np.linalg.inv(matrices[solid]), bundle[part][solid]


def _meets_ball(lines: Lines, centres: DoubleArray, radii: DoubleArray) -> NDArray[np.bool_]:
    """``(balls, n)`` whether bundles may meet balls: a bundle is a cone about its middle, which a cylinder holds."""
    length = np.linalg.norm(lines.middle, axis=1)
    ahead = lines.middle / length[:, None]
    along = centres @ ahead.T - np.sum(lines.places * ahead, axis=1)
    square = np.sum(centres**2, axis=1)[:, None] - 2 * centres @ lines.places.T + np.sum(lines.places**2, axis=1)
    reach = radii[:, None] + np.linalg.norm(lines.spread, axis=1)
    slack = 1e-9 * (square + along**2)
    beside = square - along**2 <= reach**2 + slack
    return np.asarray(beside & (along >= -reach) & (along <= length + reach))


@dataclass(frozen=True, eq=False)
class _Met:
    """Meetings of lines and triangles.

    Attributes:
        bundle: of the line.
        line: which of its bundle.
        triangle: which it meets.
        u: barycentric coordinate of the triangle's second corner there.
        v: and of the third.
    """

    bundle: IndexArray
    line: IndexArray
    triangle: IndexArray
    u: DoubleArray
    v: DoubleArray

    def among(self, which: IndexArray) -> _Met:
        """Some of the meetings."""
        return _Met(self.bundle[which], self.line[which], self.triangle[which], self.u[which], self.v[which])


def _once(bundle: IndexArray, line: IndexArray, t: DoubleArray) -> IndexArray:
    """Which meetings to count, so that who passes an edge that two triangles share meets one surface and not two."""
    order = np.lexsort((t, line, bundle))
    another = (np.diff(bundle[order]) != 0) | (np.diff(line[order]) != 0) | (np.diff(t[order]) > _SAME_PLACE)
    return np.asarray(order[np.append(True, another)[: len(order)]])


class _Boxes:
    """A hierarchy of boxes around the triangles of one geometry, in its own space.

    Attributes:
        low: ``(3,)`` corner of the box around all.
        high: likewise.
    """

    def __init__(self, geometry: Geometry) -> None:
        # the geometry itself is not kept, so that it can go when the scene does
        self._positions, self._triangles = geometry.positions, geometry.triangles
        self.low = self._positions.min(axis=0).astype(np.float64)
        self.high = self._positions.max(axis=0).astype(np.float64)
        self._sorted: tuple[IndexArray, list[tuple[DoubleArray, DoubleArray]]] | None = None

    def met(self, lines: Lines, *, two_sided: bool) -> _Met:
        """Every meeting of a line and a triangle.

        Args:
            lines: in the geometry's own space.
            two_sided: whether backs are met too.
        """
        bundle, triangle = self._candidates(lines)
        corners = self._positions[self._triangles[triangle]].astype(np.float64)
        a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        from_corner = lines.places[bundle] - corners[:, 0]
        across, ways = np.cross(from_corner, a), lines.ways[bundle]
        with np.errstate(divide="ignore", invalid="ignore"):
            facing = (ways @ np.cross(a, b)[..., None])[..., 0]  # positive where the eye looks at the front
            u = (ways @ np.cross(from_corner, b)[..., None])[..., 0] / facing
            v = -(ways @ across[..., None])[..., 0] / facing
            t = -np.sum(b * across, axis=1)[:, None] / facing
            hit = (u >= -_EDGE) & (v >= -_EDGE) & (u + v <= 1 + _EDGE) & ((facing > 0) | (two_sided & (facing < 0)))
            hit &= (t >= lines.first[bundle, None]) & (t <= lines.last[bundle, None])
        which, line = np.nonzero(hit)
        met = _Met(bundle[which], line, triangle[which], u[hit], v[hit])
        return met.among(_once(met.bundle, line, t[hit]))

    def _candidates(self, lines: Lines) -> tuple[IndexArray, IndexArray]:
        """Pairs of a bundle and a triangle that share a lowest box."""
        if self._sorted is None:
            self._sorted = _sorted_into_boxes(self._positions, self._triangles)
        order, levels = self._sorted
        middle, spread = lines.middle, lines.spread
        bundle, box = np.arange(len(lines.places)), np.zeros(len(lines.places), np.int64)
        for level, (low, high) in enumerate(levels):
            if level:
                bundle = np.repeat(bundle, _BRANCHES)
                box = (box[:, None] * _BRANCHES + np.arange(_BRANCHES)).ravel()
            kept = _meets_box(lines, middle, bundle, low[box] - spread[bundle], high[box] + spread[bundle])
            bundle, box = bundle[kept], box[kept]
        triangle = order.reshape(-1, _LEAF)[box].ravel()
        return np.repeat(bundle, _LEAF)[triangle >= 0], triangle[triangle >= 0]


_BOXES: WeakKeyDictionary[Geometry, _Boxes] = WeakKeyDictionary()


def _boxes_of(geometry: Geometry) -> _Boxes:
    boxes = _BOXES.get(geometry)
    if boxes is None:
        boxes = _BOXES[geometry] = _Boxes(geometry)
    return boxes


def _sorted_into_boxes(
    positions: FloatArray, triangles: NDArray[np.int32]
) -> tuple[IndexArray, list[tuple[DoubleArray, DoubleArray]]]:
    """Triangles in an order that keeps neighbours together, -1 for none at its end, and the boxes from the root down."""
    a, b, c = (positions[triangles[:, i]] for i in range(3))
    low, high = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
    order = np.argsort(_morton_codes(((low + high) / 2).astype(np.float32))).astype(np.int64)
    spare = -len(order) % _LEAF
    filled = np.pad(order, (0, spare), mode="edge")
    boxes = low[filled].reshape(-1, _LEAF, 3).min(axis=1), high[filled].reshape(-1, _LEAF, 3).max(axis=1)
    levels = [(boxes[0].astype(np.float64), boxes[1].astype(np.float64))]
    while len(levels[0][0]) > 1:
        # NaN is no box, and no line meets it
        full = [np.pad(side, ((0, -len(side) % _BRANCHES), (0, 0)), constant_values=np.nan) for side in levels[0]]
        lows, highs = (side.reshape(-1, _BRANCHES, 3) for side in full)
        levels[:1] = [(np.fmin.reduce(lows, axis=1), np.fmax.reduce(highs, axis=1)), (full[0], full[1])]
    return np.pad(order, (0, spare), constant_values=-1), levels


def _morton_codes(places: FloatArray) -> NDArray[np.uint32]:
    """``(n,)`` numbers along a curve that visits near places one after another (Morton 1966)."""
    low = places.min(axis=0)
    size = places.max(axis=0) - low
    share = (places - low) / np.where(size > 0, size, 1)
    cell = np.minimum(share * _CELLS, _CELLS - 1).astype(np.uint32)
    for shift, mask in ((16, 0x030000FF), (8, 0x0300F00F), (4, 0x030C30C3), (2, 0x09249249)):
        cell = (cell | (cell << np.uint32(shift))) & np.uint32(mask)
    return np.asarray(cell[:, 0] | (cell[:, 1] << np.uint32(1)) | (cell[:, 2] << np.uint32(2)), np.uint32)


def _meets_box(
    lines: Lines, ways: DoubleArray, bundle: IndexArray, low: DoubleArray, high: DoubleArray
) -> NDArray[np.bool_]:
    """Whether lines meet boxes with sides along the axes, one each (Kay & Kajiya 1986, "Ray tracing complex scenes")."""
    places = lines.places[bundle]
    with np.errstate(divide="ignore", invalid="ignore"):
        per_way = 1 / ways[bundle]
        a, b = (low - places) * per_way, (high - places) * per_way
    # NaN, of a line that runs within a side, is no bound
    enters, leaves = np.fmin(a, b), np.fmax(a, b)
    first = np.fmax(np.fmax(enters[:, 0], enters[:, 1]), np.fmax(enters[:, 2], lines.first[bundle]))
    last = np.fmin(np.fmin(leaves[:, 0], leaves[:, 1]), np.fmin(leaves[:, 2], lines.last[bundle]))
    return np.asarray((first <= last) & ~np.isnan(low[:, 0]))
