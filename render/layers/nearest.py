"""Depth of the nearest triangle in a view: a best-first search through boxes, from instances over clusters to triangles.

The nearest surface has the largest blur and the smallest umbra, so it decides the layers' margin and their number. Boxes of
whole meshes are too coarse: a room's box contains the camera. A small depth picture would miss objects thinner than its pixels,
and wait for the device. The search always opens the nearest box and ends at the first triangle: it seldom opens more than a few.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from render.layers.bounds import CLUSTER_TRIANGLES
from render.layers.index import SceneIndex
from render.layers.selection import Indexed, seen_draws
from render.model.arrays import DoubleArray, FloatArray, IndexArray
from render.model.scene import Batch
from render.optics.view import PinholeView

MAX_STEPS = 200
"""Limit on the boxes that are opened; the depth of the next box is returned then, which is not farther than the surface."""
_CLUSTERS_AT_ONCE = 32
_BOX_EDGES = np.array([(i, i | bit) for bit in (1, 2, 4) for i in range(8) if not i & bit])
_TRIANGLE_EDGES = np.array([[0, 1], [1, 2], [2, 0]])


@dataclass(frozen=True)
class _Hulls:
    """Hulls that a view may see, nearest first.

    Attributes:
        depths_m: ``(n,)`` ascending.
        numbers: ``(n,)`` indices of the hulls, for ``open``.
        open: returns the contents of some hulls; None where they are triangles.
        at_once: number of hulls opened in one step.
    """

    depths_m: DoubleArray
    numbers: IndexArray
    open: Callable[[IndexArray], _Hulls] | None
    at_once: int = 1


def nearest_depth_m(index: SceneIndex, view: PinholeView) -> float:
    """Depth in metres of the nearest triangle in view, at least ``view.near_m``; infinite where there is none.

    The result may be too near and is never too far: back faces and holes count, and a triangle is clipped at each side of the
    view separately.
    """
    return _search(_instance_hulls(index, view))


def nearest_drawn_depth_m(index: Indexed, clusters: IndexArray, view: PinholeView) -> float:
    """Depth in metres of the nearest triangle of some clusters, as `nearest_depth_m`.

    Args:
        index: draws and their clusters.
        clusters: indices of those that are drawn.
        view: view that they are drawn in.
    """
    low, high = index.clusters.boxes(clusters)
    bits = (np.arange(8)[:, None] >> np.arange(3)) & 1
    counts = index.clusters.triangle_counts(clusters)

    def open_clusters(chosen: IndexArray) -> _Hulls:
        points = []
        for draw, first, instance, count in zip(
            *(column.tolist() for column in index.clusters.members(clusters[chosen])),
            counts[chosen].tolist(),
            strict=True,
        ):
            batch, pose = index.draws[draw].batch, index.draws[draw].instances[instance]
            own = batch.geometry.positions[batch.geometry.triangles[first : first + count]]
            points.append(own @ batch.poses[pose, :3, :3].T + batch.poses[pose, :3, 3])
        return _visible_hulls(np.concatenate(points), _TRIANGLE_EDGES, view.camera_from_world, view)

    boxes = np.where(bits, high[:, None], low[:, None])
    return _search(_visible_hulls(boxes, _BOX_EDGES, view.camera_from_world, view, open_clusters, _CLUSTERS_AT_ONCE))


def _search(first: _Hulls) -> float:
    """Depth of the nearest hull without contents; infinite where there is none."""
    levels = [first]
    queue: list[
        tuple[float, int, int]
    ] = []  # depth of the nearest hull left in a nest, the nest, the hull's place in it

    def push(number: int, position: int) -> None:
        if position < len(levels[number].depths_m):
            heapq.heappush(queue, (float(levels[number].depths_m[position]), number, position))

    push(0, 0)
    while queue:
        depth_m, number, position = heapq.heappop(queue)
        level = levels[number]
        if level.open is None or len(levels) > MAX_STEPS:
            return depth_m
        after = position + level.at_once
        levels.append(level.open(level.numbers[position:after]))
        push(number, after)
        push(len(levels) - 1, 0)
    return float("inf")


def _instance_hulls(index: SceneIndex, view: PinholeView) -> _Hulls:
    """Boxes of all instances of all draws that a camera sees."""
    draws = [draw for draw in seen_draws(index.draws) if len(draw.corners)]
    if not draws:
        return _Hulls(np.zeros(0), np.zeros(0, np.intp), None)
    corners = np.concatenate([draw.corners.reshape(-1, 8, 3)[draw.instances] for draw in draws])
    poses = np.concatenate([draw.instances for draw in draws])
    owners = np.repeat(np.arange(len(draws)), [len(draw.instances) for draw in draws])

    def open_instance(chosen: IndexArray) -> _Hulls:
        (i,) = chosen
        return _cluster_hulls(index, draws[owners[i]].batch, int(poses[i]), view)

    return _visible_hulls(corners, _BOX_EDGES, view.camera_from_world, view, open_instance)


def _cluster_hulls(index: SceneIndex, batch: Batch, pose: int, view: PinholeView) -> _Hulls:
    """Boxes of an instance's clusters of triangles."""
    camera_from_local = view.camera_from_world @ batch.poses[pose]
    positions, triangles = batch.geometry.positions, batch.geometry.triangles

    def open_clusters(chosen: IndexArray) -> _Hulls:
        own = [triangles[i * CLUSTER_TRIANGLES : (i + 1) * CLUSTER_TRIANGLES] for i in chosen]
        return _visible_hulls(positions[np.concatenate(own)], _TRIANGLE_EDGES, camera_from_local, view)

    boxes = index.boxes.clusters(batch.geometry)
    return _visible_hulls(boxes, _BOX_EDGES, camera_from_local, view, open_clusters, _CLUSTERS_AT_ONCE)


def _visible_hulls(
    points: DoubleArray | FloatArray,
    edges: IndexArray,
    camera_from_points: DoubleArray,
    view: PinholeView,
    open_hulls: Callable[[IndexArray], _Hulls] | None = None,
    at_once: int = 1,
) -> _Hulls:
    """Hulls of ``(n, k, 3)`` points that the view may see."""
    in_camera = points @ camera_from_points[:3, :3].T + camera_from_points[:3, 3]
    depths = _depths_in_view(in_camera, edges, view)
    order = np.argsort(depths, kind="stable")[: np.count_nonzero(np.isfinite(depths))]
    return _Hulls(depths[order], order, open_hulls, at_once)


def _depths_in_view(points: DoubleArray, edges: IndexArray, view: PinholeView) -> DoubleArray:
    """Least depth of each hull within the view: ``(n,)`` metres, infinite for a hull outside one of the view's planes.

    Args:
        points: ``(n, k, 3)`` points of the hulls, camera space.
        edges: ``(m, 2)`` edges of a hull, or more lines between its points.
        view: view that clips them.
    """
    depth = -points[..., 2]
    x, y = view.fx * (points[..., 0] - view.eye_x_m), view.fy * (points[..., 1] - view.eye_y_m)
    planes = [
        view.cx * depth + x,
        (view.width - view.cx) * depth - x,
        view.cy * depth - y,
        (view.height - view.cy) * depth + y,
        *(points @ plane[:3] + plane[3] for plane in view.clip_planes),
    ]
    nearest: DoubleArray = np.maximum(depth.min(1), view.near_m)
    nearest[(depth.max(1) < view.near_m) | (nearest > view.far_m)] = np.inf
    for inside in planes:  # positive on the view's side of it, px·m or, for clip planes, in their own unit
        within = np.where(inside >= 0, depth, np.inf).min(1)
        cut = np.flatnonzero((inside < 0).any(1) & np.isfinite(within))
        within[cut] = np.minimum(within[cut], _depths_at_cut(inside[cut][:, edges], depth[cut][:, edges]))
        nearest = np.maximum(nearest, within)
    return nearest


def _depths_at_cut(inside: DoubleArray, depth: DoubleArray) -> DoubleArray:
    """Least depth at which lines ``(n, m, 2)`` cross the plane; infinite where none does."""
    a, b = inside[..., 0], inside[..., 1]
    crosses = (a < 0) != (b < 0)
    share = a / np.where(crosses, a - b, 1.0)
    at_cut: DoubleArray = np.where(crosses, depth[..., 0] + share * (depth[..., 1] - depth[..., 0]), np.inf)
    return np.asarray(at_cut.min(1))
