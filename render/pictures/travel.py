"""Travel of surfaces in the picture between two times, which decides how many moments a trail without gaps needs."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from render.layers.movement import batch_keys
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.moment import Moment
from render.model.scene import Batch, Scene
from render.optics.view import PinholeView

_CORNERS, _INSTANCES = 256, 256  # most vertices of a geometry and instances of a batch that are measured, taken evenly
_MARGIN = 0.05  # share of the picture's size around it, from where surfaces may be blurred into it


def measure_travel_px(before: Moment, after: Moment, width: int, height: int) -> float:
    """Measure the longest straight path of any surface in the picture, in pixels.

    Some hundred vertices of each geometry are measured, whether they are hidden or not. Geometry that is there at one of the
    times only has not moved.

    Args:
        before: scene and camera.
        after: likewise, at another time.
        width: of the picture in pixels.
        height: likewise.
    """
    views = [PinholeView.from_camera(moment.camera, width, height) for moment in (before, after)]
    longest = 0.0
    seen = [moment.scene.seen_by(moment.camera.path) for moment in (before, after)]
    for one, other in _pair_batches(*seen):
        (then, seen_then), (now, seen_now) = (
            _project_vertices(batch, view) for batch, view in zip((one, other), views, strict=True)
        )
        both = seen_then & seen_now & (_is_inside(then, width, height) | _is_inside(now, width, height))
        if both.any():
            longest = max(longest, float(np.hypot(*(now - then)[both].T).max()))
    return longest


def make_moment(scene: Scene, camera: Camera) -> Moment:
    """Make the moment of a scene and a camera that has all of the exposure."""
    return Moment(scene, camera, np.ones((1, 1, 1), np.float32))


def _pair_batches(before: Scene, after: Scene) -> list[tuple[Batch, Batch]]:
    """Pair the batches that are the same things at both times."""
    later = dict(batch_keys(after))
    pairs = ((one, later[key]) for key, one in batch_keys(before) if key in later)
    return [
        (one, other)
        for one, other in pairs
        if one.geometry.positions.shape == other.geometry.positions.shape and one.poses.shape == other.poses.shape
    ]


def _project_vertices(batch: Batch, view: PinholeView) -> tuple[DoubleArray, NDArray[np.bool_]]:
    """Project some vertices of some instances: ``(n, 2)`` pixels, and ``(n,)`` which are in front of the camera."""
    vertices = batch.geometry.positions[:: max(1, len(batch.geometry.positions) // _CORNERS)].astype(np.float64)
    poses = batch.poses[:: max(1, len(batch.poses) // _INSTANCES)]
    to_camera = view.camera_from_world @ poses
    points = np.einsum("kij,nj->kni", to_camera[:, :3, :3], vertices) + to_camera[:, None, :3, 3]
    points = points.reshape(-1, 3)
    in_front = points[:, 2] < -view.near_m
    depth = np.where(in_front, -points[:, 2], 1.0)
    x = view.cx + view.fx * points[:, 0] / depth
    y = view.cy - view.fy * points[:, 1] / depth
    return np.stack([x, y], axis=-1), in_front


def _is_inside(places_px: DoubleArray, width: int, height: int) -> NDArray[np.bool_]:
    size = np.array([width, height])
    return np.asarray(((places_px > -_MARGIN * size) & (places_px < (1 + _MARGIN) * size)).all(axis=-1))
