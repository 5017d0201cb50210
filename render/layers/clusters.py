"""Clusters of triangles, and their culling: a pass draws the runs of clusters that may leave a fragment in it.

A cluster is `CLUSTER_TRIANGLES` successive triangles of a geometry, in one place; its order is that of the geometry, so that
leaving clusters out changes no pixel. It is left out where its box lies beside the view; where all of its triangles face away
from the eye, in draws without back faces; and in a later layer where the layer before hides all of it (`render.layers.hidden`).

Cones of normals: Shirman & Abi-Ezzi 1993, "The cone of normals technique for fast processing of curved patches", section 3.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from render.layers.bounds import CLUSTER_TRIANGLES
from render.model.arrays import DoubleArray, FloatArray, IndexArray
from render.model.scene import Batch, Geometry
from render.optics.view import PinholeView

MOST_CLUSTERS = 1_000_000
"""Limit on the clusters of one draw; instances of a draw that would have more are one cluster each."""
_CHUNK = 1 << 18  # triangles whose corners are gathered at once
_GAP_TRIANGLES, _MOST_RANGES = 128, 512
"""Hidden triangles that cost no more than another draw call; most ranges of one pass beside those of separate instances."""
_ROUNDING = 4e-6  # of a product in float32 on the device, of its largest term
_EDGE_ON = 0.02  # sine of the angle from which a triangle surely faces away when its vertices are rounded to the raster
_EACH = slice(None)
_RIGHT_ANGLE = np.array([0, 1], np.float32)  # cosine and sine
_CORNERS = (np.arange(8)[:, None] >> np.arange(3)) & 1


class Drawn(Protocol):
    """A draw, as far as its clusters depend on it (`render.layers.index.Draw`)."""

    @property
    def batch(self) -> Batch:
        """Batch that is drawn."""
        ...

    @property
    def instances(self) -> IndexArray:
        """Indices of the batch's poses."""
        ...

    @property
    def has_backs(self) -> bool:
        """Whether back faces are drawn."""
        ...


@dataclass(frozen=True)
class DrawRange:
    """Range of a draw: triangles of one instance, or whole instances.

    Attributes:
        first_triangle: first triangle of each instance.
        triangles: number of triangles.
        first_instance: first instance of the draw.
        instances: number of instances.
    """

    first_triangle: int
    triangles: int
    first_instance: int
    instances: int


@dataclass(frozen=True, eq=False)
class GeometryClusters:
    """Clusters of one geometry, in its own space.

    Attributes:
        low: ``(c, 3)`` float32 least corner of each cluster's box, metres.
        high: ``(c, 3)`` float32 greatest corner.
        axis: ``(c, 3)`` float32 unit axis of the cone that holds the triangles' normals.
        spread: ``(c, 2)`` float32 cosine and sine of the cone's half angle; ``(0, 1)`` from a right angle on.
    """

    low: FloatArray
    high: FloatArray
    axis: FloatArray
    spread: FloatArray


def cut_clusters(geometry: Geometry, *, cones: bool) -> GeometryClusters:
    """Cut a geometry into clusters.

    Args:
        geometry: geometry, of one triangle or more.
        cones: whether the cones of normals are needed; without, all are right angles.
    """
    parts = [
        _cut(geometry.positions[geometry.triangles[first : first + _CHUNK]], cones)
        for first in range(0, len(geometry.triangles), _CHUNK)
    ]
    return GeometryClusters(*(np.concatenate(arrays) for arrays in zip(*parts, strict=True)))


def _cut(points: FloatArray, cones: bool) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Boxes and cones of the clusters of ``(m, 3, 3)`` triangles."""
    first = np.arange(0, len(points), CLUSTER_TRIANGLES)
    a, b, c = points[:, 0], points[:, 1], points[:, 2]  # numpy is slow along an axis of three
    low = np.minimum.reduceat(np.minimum(np.minimum(a, b), c), first)
    high = np.maximum.reduceat(np.maximum(np.maximum(a, b), c), first)
    axis, spread = np.zeros((len(first), 3), np.float32), np.tile(_RIGHT_ANGLE, (len(first), 1))
    if cones:
        normals = np.cross(b - a, c - a)
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        normals = normals / np.where(length > 0, length, 1)
        axis = np.add.reduceat(normals, first)
        axis = axis / np.maximum(np.linalg.norm(axis, axis=1, keepdims=True), 1e-20)
        inner = np.sum(normals * np.repeat(axis, np.diff(first, append=len(points)), axis=0), axis=1)
        inner[length[:, 0] == 0] = 1.0  # it covers no pixel
        cosine = np.clip(np.minimum.reduceat(inner, first) - np.float32(1e-4), 0, 1)
        spread = np.stack([cosine, np.sqrt(1 - cosine * cosine)], axis=1)
    return low, high, axis.astype(np.float32), spread.astype(np.float32)


@dataclass(frozen=True, eq=False)
class _Placed:
    """Clusters of some draws in the world, in the order of drawing.

    Attributes:
        low: ``(n, 3)`` metres.
        high: ``(n, 3)`` metres.
        axis: ``(n, 3)`` float32 axes of the cones of normals.
        spread: ``(n, 2)`` float32 cosine and sine of their half angles.
        first: ``(n,)`` first triangle.
        triangles: ``(n,)`` number of triangles.
        instance: ``(n,)`` instance of the draw.
        whole: ``(n,)`` whether it is all of its instance.
    """

    low: DoubleArray
    high: DoubleArray
    axis: FloatArray
    spread: FloatArray
    first: IndexArray
    triangles: IndexArray
    instance: IndexArray
    whole: NDArray[np.bool_]


class ClusterIndex:
    """Clusters of a list of draws.

    Clusters of geometries and of unchanged draws are kept from one list to the next; both are recognised by identity.
    """

    def __init__(self) -> None:
        self._geometries: dict[tuple[int, bool], tuple[Geometry, GeometryClusters]] = {}
        self._placed: dict[tuple[int, int, bool], tuple[Batch, _Placed]] = {}
        self.draws: tuple[Drawn, ...] = ()
        self._all = _join([])
        self._owner: IndexArray = np.zeros(0, np.intp)
        self._before: IndexArray = np.zeros(1, np.int64)

    def update(self, draws: Sequence[Drawn], other: ClusterIndex | None = None) -> None:
        """Index other draws.

        Args:
            draws: draws in the order of drawing.
            other: index whose clusters are shared, where it has the same draws; None for none.
        """
        shared = {} if other is None else other._placed
        kept: dict[tuple[int, int, bool], tuple[Batch, _Placed]] = {}
        placed = []
        for draw in draws:
            first = int(draw.instances[0]) if len(draw.instances) else -1
            key = id(draw.batch), first, draw.has_backs
            kept[key] = self._placed.get(key) or shared.get(key) or (draw.batch, self._place(draw))
            placed.append(kept[key][1])
        used = {id(draw.batch.geometry) for draw in draws}
        self._geometries = {key: value for key, value in self._geometries.items() if key[0] in used}
        self._placed, self.draws = kept, tuple(draws)
        self._all = _join(placed)
        self._owner = np.repeat(np.arange(len(placed)), [len(one.first) for one in placed])
        self._before = np.concatenate([[0], np.cumsum(self._all.triangles, dtype=np.int64)])

    def hold(self, geometry: Geometry, clusters: GeometryClusters) -> None:
        """Take clusters, with cones, of a geometry that the next list of draws may have, in place of cutting it."""
        self._geometries[id(geometry), True] = geometry, clusters

    def select(
        self,
        clip_from_world: DoubleArray,
        draws: Iterable[Drawn] | None = None,
        eye: DoubleArray | None = None,
        among: IndexArray | None = None,
        both_sides: Iterable[int] = (),
    ) -> IndexArray:
        """Indices of the clusters that may be seen, ascending.

        Args:
            clip_from_world: ``(4, 4)``, zero-to-one depth.
            draws: those among the indexed draws that are considered; None for all.
            eye: ``(3,)`` point of view in the world: triangles that face away from it are not drawn, where their draw has no back
                faces; None where both sides are drawn.
            among: ascending indices of the clusters that are considered; None for all.
            both_sides: indices of draws whose triangles are drawn all the same.
        """
        chosen = np.arange(len(self._owner)) if among is None else among
        if draws is not None:
            ids = {id(draw) for draw in draws}
            chosen = chosen[np.array([id(draw) in ids for draw in self.draws], bool)[self._owner[chosen]]]
        chosen = chosen[in_frustum(self._all.low[chosen], self._all.high[chosen], clip_from_world)]
        if eye is None:
            return chosen
        has_backs = np.zeros(len(self.draws), bool)
        has_backs[list(both_sides)] = True
        return chosen[has_backs[self._owner[chosen]] | ~self._face_away(chosen, eye)]

    def draws_of(self, clusters: IndexArray) -> list[int]:
        """Indices of the draws that clusters belong to, ascending."""
        return np.flatnonzero(np.bincount(self._owner[clusters])).tolist()

    def members(self, clusters: IndexArray | slice = _EACH) -> tuple[IndexArray, IndexArray, IndexArray]:
        """Draw, first triangle and instance of the draw of clusters, of all by default."""
        return self._owner[clusters], self._all.first[clusters], self._all.instance[clusters]

    def boxes(self, clusters: IndexArray | slice = _EACH) -> tuple[DoubleArray, DoubleArray]:
        """Least and greatest corners ``(n, 3)`` of clusters in the world, metres; of all by default."""
        return self._all.low[clusters], self._all.high[clusters]

    def triangle_counts(self, clusters: IndexArray) -> IndexArray:
        """Number of triangles of each of some clusters."""
        return self._all.triangles[clusters]

    def is_whole(self, clusters: IndexArray) -> NDArray[np.bool_]:
        """Whether clusters are all of their instance each."""
        return self._all.whole[clusters]

    def nearest_depths(self, clusters: IndexArray, view: PinholeView) -> DoubleArray:
        """Least depth of clusters in a view, ``(n,)`` metres, no less than that of its near plane."""
        return nearest_depths(self._all.low[clusters], self._all.high[clusters], view)

    def rectangles(self, clusters: IndexArray, view: PinholeView) -> tuple[DoubleArray, DoubleArray, DoubleArray]:
        """Rectangles of clusters in a view: low and high ``(n, 2)`` in pixels, and the least inverse depth ``(n,)`` from the
        view's base, 1/m.

        All three err by a pixel, and by a little more than rounding, towards more that may be seen.
        """
        clip_from_world = view.projection_matrix() @ view.camera_from_world
        low, high = self._all.low[clusters], self._all.high[clusters]
        corners = np.where(_CORNERS, high[:, None], low[:, None])
        x, y, depth = np.moveaxis(corners @ clip_from_world[[0, 1, 3], :3].T + clip_from_world[[0, 1, 3], 3], -1, 0)
        nearest, farthest = depth.min(1), depth.max(1)
        crosses = nearest <= 0.5 * view.near_m
        depth = np.maximum(depth, 0.5 * view.near_m)
        pixels = np.stack([x, y], axis=-1) / depth[..., None] * 0.5 + 0.5
        pixels *= (view.width, view.height)
        low_px, high_px = pixels.min(1) - 1, pixels.max(1) + 1
        low_px[crosses], high_px[crosses] = 0, (view.width, view.height)
        w = 1 / np.maximum(farthest, view.near_m)
        range_w = 1 / np.maximum(nearest, view.near_m) - w
        return low_px, high_px, (w - view.base_w) * (1 - 1e-5) - 0.02 * range_w

    def ranges(self, clusters: IndexArray) -> dict[int, list[DrawRange]]:
        """Ranges of each draw, by its index, that cover clusters (ascending), in the order of drawing.

        Ranges that are a few hidden triangles apart are joined.
        """
        if not len(clusters):
            return {}
        before, after = clusters[:-1], clusters[1:]
        a = self._all
        same_draw = self._owner[before] == self._owner[after]
        joinable = same_draw & ((a.instance[before] == a.instance[after]) | (a.whole[before] & a.whole[after]))
        gaps = self._before[after] - self._before[before + 1]
        breaks = ~joinable | (gaps > _GAP_TRIANGLES)
        optional = breaks & joinable
        if np.count_nonzero(optional) > _MOST_RANGES:
            least = np.partition(gaps[optional], -_MOST_RANGES)[-_MOST_RANGES]
            breaks &= ~joinable | (gaps >= least)
        at = np.flatnonzero(breaks)
        firsts, lasts = clusters[np.concatenate([[0], at + 1])], clusters[np.concatenate([at, [len(clusters) - 1]])]
        found: dict[int, list[DrawRange]] = {}
        columns = (
            self._owner[firsts],
            a.first[firsts],
            np.where(a.whole[firsts], a.triangles[firsts], a.first[lasts] + a.triangles[lasts] - a.first[firsts]),
            a.instance[firsts],
            a.instance[lasts] - a.instance[firsts] + 1,
        )
        for owner, *numbers in np.stack(columns, axis=1).tolist():
            found.setdefault(owner, []).append(DrawRange(*numbers))
        return found

    def _face_away(self, clusters: IndexArray, eye: DoubleArray) -> NDArray[np.bool_]:
        """Whether all triangles of clusters surely face away from a point."""
        low, high = self._all.low[clusters], self._all.high[clusters]
        from_eye = (low + high) / 2 - eye
        distance, radius = np.linalg.norm(from_eye, axis=1), np.linalg.norm(high - low, axis=1) / 2
        along = np.sum(from_eye * self._all.axis[clusters], axis=1)
        across = np.sqrt(np.maximum(distance**2 - along**2, 0))
        cosine, sine = self._all.spread[clusters].T
        return np.asarray(along * cosine - across * sine > radius + _EDGE_ON * distance)

    def _clusters_of(self, geometry: Geometry, *, cones: bool) -> GeometryClusters:
        """Clusters of a geometry; without cones, those that were cut or held with cones do as well."""
        key = id(geometry), cones
        held = self._geometries.get((id(geometry), True))
        if held is not None and not cones:
            self._geometries[key] = geometry, replace(held[1], spread=np.zeros_like(held[1].spread) + _RIGHT_ANGLE)
        if key not in self._geometries:
            self._geometries[key] = geometry, cut_clusters(geometry, cones=cones)
        return self._geometries[key][1]

    def _place(self, draw: Drawn) -> _Placed:
        """Clusters of a draw's instances."""
        geometry = draw.batch.geometry
        if not len(geometry.triangles) or not len(draw.instances):
            return _join([])
        cones = not draw.has_backs
        own = self._clusters_of(geometry, cones=cones)
        total, count = len(geometry.triangles), len(draw.instances)
        first = np.arange(len(own.low)) * CLUSTER_TRIANGLES
        size = np.minimum(CLUSTER_TRIANGLES, total - first)
        if len(first) > 1 and len(first) * count > MOST_CLUSTERS:
            own = _as_one(own)
            first, size = np.zeros(1, np.intp), np.array([total])
        poses = draw.batch.poses[draw.instances]
        low, high = _carry(own.low, own.high, poses)
        axis, spread = _turn(own, poses)
        instance = np.repeat(np.arange(count), len(first))
        return _Placed(
            low,
            high,
            axis,
            spread,
            np.tile(first, count),
            np.tile(size, count),
            instance,
            np.full(len(instance), len(first) == 1),
        )


def _carry(low: FloatArray, high: FloatArray, poses: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    """Boxes in the world, ``(k·c, 3)``, around ``(c, 3)`` boxes carried by ``(k, 4, 4)`` poses."""
    centre, half = (low.astype(np.float64) + high) / 2, (high.astype(np.float64) - low) / 2
    linear = poses[:, :3, :3].transpose(0, 2, 1)
    centres = (centre @ linear + poses[:, None, :3, 3]).reshape(-1, 3)
    halves = (half @ np.abs(linear)).reshape(-1, 3)
    return centres - halves, centres + halves


def _turn(own: GeometryClusters, poses: DoubleArray) -> tuple[FloatArray, FloatArray]:
    """Cones in the world; right angles where a pose scales unevenly. The outside stays outside where it mirrors."""
    linear = poses[:, :3, :3]
    scale = np.cbrt(np.abs(np.linalg.det(linear)))
    turned = linear / np.where(scale > 0, scale, 1)[:, None, None]
    even = np.abs(turned @ turned.transpose(0, 2, 1) - np.eye(3)).max((1, 2)) < 1e-4
    axis = (own.axis @ turned.transpose(0, 2, 1)).reshape(-1, 3)
    spread = np.where(even[:, None, None], own.spread, _RIGHT_ANGLE).reshape(-1, 2)
    return axis.astype(np.float32), spread.astype(np.float32)


def _as_one(own: GeometryClusters) -> GeometryClusters:
    """All clusters of a geometry as one."""
    low, high = own.low.min(0, keepdims=True), own.high.max(0, keepdims=True)
    return GeometryClusters(low, high, np.zeros((1, 3), np.float32), _RIGHT_ANGLE[None])


def nearest_depths(low: DoubleArray, high: DoubleArray, view: PinholeView) -> DoubleArray:
    """Least depth of boxes in a view, ``(n,)`` metres, no less than that of its near plane.

    Args:
        low: ``(n, 3)`` least corners in the world, metres.
        high: ``(n, 3)`` greatest corners.
        view: the view.
    """
    axis = (view.projection_matrix() @ view.camera_from_world)[3]
    nearest = np.minimum(low * axis[:3], high * axis[:3]).sum(axis=1) + axis[3]
    return np.asarray(np.maximum(nearest, view.near_m))


def _join(placed: Sequence[_Placed]) -> _Placed:
    """Clusters of several draws one after the other."""
    if not placed:
        corners, none = np.zeros((0, 3)), np.zeros(0, np.intp)
        cones = np.zeros((0, 3), np.float32), np.zeros((0, 2), np.float32)
        return _Placed(corners, corners, *cones, none, none, none, np.zeros(0, bool))
    return _Placed(*(np.concatenate([vars(one)[name] for one in placed]) for name in vars(placed[0])))


def in_frustum(low: DoubleArray, high: DoubleArray, clip_from_world: DoubleArray) -> NDArray[np.bool_]:
    """Whether boxes may reach into a frustum: false for those that lie outside one of its planes by more than rounding.

    Args:
        low: ``(n, 3)`` least corners in the world, metres.
        high: ``(n, 3)`` greatest corners.
        clip_from_world: ``(4, 4)``, zero-to-one depth.
    """
    x, y, z, w = clip_from_world
    planes = np.stack([w - x, w + x, w - y, w + y, w - z, z])
    centre, half = (low + high) / 2, (high - low) / 2
    inside = np.ones(len(low), bool)
    for plane in planes:
        normal, offset = plane[:3], plane[3]
        reach = half @ np.abs(normal)
        size = np.abs(centre) @ np.abs(normal) + reach + abs(offset)
        inside &= centre @ normal + offset + reach >= -_ROUNDING * size
    return inside
