"""How far things go in the picture between two times: what must be known to look at a trail often enough."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.moment import Moment
from render.model.scene import Batch, Scene
from render.optics.view import PinholeView

_CORNERS, _INSTANCES = 256, 256  # of a geometry and of a batch at most, taken evenly
_MARGIN = 0.05  # of the picture's size: what is a little outside of it may be blurred into it


def farthest_travel_px(before: Moment, after: Moment, width: int, height: int) -> float:
    """The longest way that any surface in the picture has gone, straight from its place then to its place now.

    Looked at are some hundred corners of each piece of geometry, whether they are hidden or not. Pieces that are there at one
    time only have gone nowhere.

    Args:
        before: scene and camera.
        after: likewise, at another time.
        width: of the picture in pixels.
        height: likewise.
    """
    views = [PinholeView.from_camera(moment.camera, width, height) for moment in (before, after)]
    longest = 0.0
    for one, other in _pairs(before.scene, after.scene):
        (then, seen_then), (now, seen_now) = (
            _places(batch, view) for batch, view in zip((one, other), views, strict=True)
        )
        both = seen_then & seen_now & (_inside(then, width, height) | _inside(now, width, height))
        if both.any():
            longest = max(longest, float(np.hypot(*(now - then)[both].T).max()))
    return longest


def moment_of(scene: Scene, camera: Camera) -> Moment:
    """A scene and a camera that look at it, with all of the light."""
    return Moment(scene, camera, np.ones((1, 1, 1), np.float32))


def _pairs(before: Scene, after: Scene) -> list[tuple[Batch, Batch]]:
    """Batches that are the same things at both times."""
    if len(before.batches) != len(after.batches):
        return []
    return [
        (one, other)
        for one, other in zip(before.batches, after.batches, strict=True)
        if one.geometry.positions.shape == other.geometry.positions.shape and one.poses.shape == other.poses.shape
    ]


def _places(batch: Batch, view: PinholeView) -> tuple[DoubleArray, NDArray[np.bool_]]:
    """``(n, 2)`` pixels of some corners of all instances, and which of them are before the camera."""
    corners = batch.geometry.positions[:: max(1, len(batch.geometry.positions) // _CORNERS)].astype(np.float64)
    poses = batch.poses[:: max(1, len(batch.poses) // _INSTANCES)]
    to_camera = view.camera_from_world @ poses
    points = np.einsum("kij,nj->kni", to_camera[:, :3, :3], corners) + to_camera[:, None, :3, 3]
    points = points.reshape(-1, 3)
    seen = points[:, 2] < -view.near_m
    depth = np.where(seen, -points[:, 2], 1.0)
    x = view.cx + view.fx * points[:, 0] / depth
    y = view.cy - view.fy * points[:, 1] / depth
    return np.stack([x, y], axis=-1), seen


def _inside(places: DoubleArray, width: int, height: int) -> NDArray[np.bool_]:
    size = np.array([width, height])
    return np.asarray(((places > -_MARGIN * size) & (places < (1 + _MARGIN) * size)).all(axis=-1))
