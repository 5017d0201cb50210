"""Boxes around what is drawn, and whether a view can see any of a box."""

from __future__ import annotations

import numpy as np

from render.scene import Batch, DoubleArray


class BoxCache:
    """World boxes of batches. A geometry's own box is found once, a batch's corners whenever its poses change.

    Geometry is recognised by identity; `forget` drops what is no longer drawn.
    """

    def __init__(self) -> None:
        self._own: dict[int, tuple[object, DoubleArray]] = {}

    def corners(self, batch: Batch) -> DoubleArray:
        """``(k·8, 3)`` corners of the instances' boxes in the world, metres; ``(0, 3)`` where nothing is."""
        geometry = batch.geometry
        if id(geometry) not in self._own:
            p = geometry.positions
            own = np.zeros((3, 0)) if len(p) == 0 else _box_corners(p.min(0), p.max(0))
            self._own[id(geometry)] = (geometry, own)
        own = self._own[id(geometry)][1]
        placed = batch.poses[:, :3, :3] @ own + batch.poses[:, :3, 3:]
        return np.asarray(placed.transpose(0, 2, 1).reshape(-1, 3))

    def forget(self, drawn: tuple[Batch, ...]) -> None:
        """Keep only the boxes of what is drawn."""
        kept = {id(batch.geometry) for batch in drawn}
        self._own = {key: value for key, value in self._own.items() if key in kept}


def may_be_seen(corners: DoubleArray, clip_from_world: DoubleArray) -> bool:
    """Whether the hull of the corners may reach into the view's frustum: false only when one of its planes has all outside.

    Args:
        corners: ``(n, 3)`` metres.
        clip_from_world: ``(4, 4)``, zero-to-one depth.
    """
    if len(corners) == 0:
        return False
    clip = corners @ clip_from_world[:, :3].T + clip_from_world[:, 3]
    x, y, z, w = clip.T
    outside = ((x > w).all(), (x < -w).all(), (y > w).all(), (y < -w).all(), (z > w).all(), (z < 0).all())
    return not any(outside)


def _box_corners(low: DoubleArray, high: DoubleArray) -> DoubleArray:
    """``(3, 8)``."""
    return np.array(np.meshgrid(*zip(low, high, strict=True)), np.float64).reshape(3, 8)
