"""Bounding boxes of draws and of clusters of their triangles."""

from __future__ import annotations

import numpy as np

from render.model.arrays import DoubleArray, FloatArray
from render.model.scene import Batch, Geometry

CLUSTER_TRIANGLES = 64
"""Triangles in a cluster, in the geometry's order, where neighbours mostly follow each other."""


class BoxCache:
    """Cache of the batches' boxes in the world and of the boxes of geometries' clusters.

    A geometry's own boxes are computed once; a batch's corners are computed from its poses at each call. Geometry is
    recognised by identity; `forget` drops the geometries that are no longer drawn.
    """

    def __init__(self) -> None:
        self._own: dict[int, tuple[Geometry, DoubleArray]] = {}
        self._clusters: dict[int, tuple[Geometry, DoubleArray]] = {}

    def corners(self, batch: Batch) -> DoubleArray:
        """Corners ``(k·8, 3)`` of the instances' boxes in the world, metres; ``(0, 3)`` without instances."""
        geometry = batch.geometry
        if id(geometry) not in self._own:
            p = geometry.positions
            own = np.zeros((0, 3)) if len(p) == 0 else _box_corners(p.min(0)[None], p.max(0)[None])[0]
            self._own[id(geometry)] = (geometry, own)
        own = self._own[id(geometry)][1]
        placed = own @ batch.poses[:, :3, :3].transpose(0, 2, 1) + batch.poses[:, None, :3, 3]
        return np.asarray(placed.reshape(-1, 3))

    def insides(self, batch: Batch) -> DoubleArray:
        """The boxes ``Batch.insides`` of each instance in the world, ``(k, n, 2, 3)`` metres; the batch has some."""
        if batch.insides is None:
            raise ValueError("the batch has no closed surfaces")
        linear, origin = batch.poses[:, None, :3, :3], batch.poses[:, None, :3, 3]
        middle, half = batch.insides.mean(axis=1), np.ptp(batch.insides, axis=1) / 2
        middles = (linear @ middle[..., None])[..., 0] + origin
        halves = (np.abs(linear) @ half[..., None])[..., 0]
        return np.stack([middles - halves, middles + halves], axis=2)

    def clusters(self, geometry: Geometry) -> DoubleArray:
        """Corners ``(c, 8, 3)`` of boxes around each `CLUSTER_TRIANGLES` triangles of a geometry, in its own space."""
        if id(geometry) not in self._clusters:
            first = np.arange(0, len(geometry.triangles), CLUSTER_TRIANGLES)
            points = geometry.positions[geometry.triangles]
            low, high = np.minimum.reduceat(points, first).min(1), np.maximum.reduceat(points, first).max(1)
            self._clusters[id(geometry)] = (geometry, _box_corners(low, high))
        return self._clusters[id(geometry)][1]

    def forget(self, drawn: tuple[Batch, ...]) -> None:
        """Keep only the boxes of the drawn batches."""
        kept = {id(batch.geometry) for batch in drawn}
        for boxes in (self._own, self._clusters):
            for key in boxes.keys() - kept:
                del boxes[key]


def _box_corners(low: FloatArray, high: FloatArray) -> DoubleArray:
    """``(n, 8, 3)`` corners of ``(n, 3)`` boxes; corners that differ in one bit of their number share an edge."""
    bits = (np.arange(8)[:, None] >> np.arange(3)) & 1
    return np.where(bits, high[:, None], low[:, None]).astype(np.float64)
