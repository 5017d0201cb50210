"""Clipping of a UsdGeomCamera: its clipping range, and planes in its own space."""

from __future__ import annotations

import numpy as np
from pxr import Gf, Usd, UsdGeom

from render.errors import CameraError
from render.model.arrays import DoubleArray
from render.model.limits import MAX_CLIP_PLANES
from render.stage.values import format_value


def read_clipping_range(usd: UsdGeom.Camera, time: Usd.TimeCode) -> tuple[float, float]:
    """Near and far clipping distance, in stage units.

    Raises:
        CameraError: it is not two numbers.
    """
    value = usd.GetClippingRangeAttr().Get(time)
    if not isinstance(value, Gf.Vec2f | Gf.Vec2d | Gf.Vec2h | Gf.Vec2i):
        path = str(usd.GetPath())
        raise CameraError(f"clippingRange of camera {path} must be two numbers, got {format_value(value)}", path=path)
    return float(value[0]), float(value[1])


def read_clip_planes(
    usd: UsdGeom.Camera, time: Usd.TimeCode, world_from_prim: DoubleArray, world_from_camera: DoubleArray
) -> tuple[tuple[float, float, float, float], ...]:
    """``clippingPlanes`` as `render.model.camera.Camera` holds them: in metres, the first `MAX_CLIP_PLANES` of them.

    Args:
        usd: the camera; the planes are in its own space, in stage units, scaled as the prim is (as in Hydra).
        time: when.
        world_from_prim: ``(4, 4)`` world in metres from that space.
        world_from_camera: ``(4, 4)`` rigid, metres.

    Raises:
        CameraError: they are not lists of four finite numbers.
    """
    planes = _authored_planes(usd, time)[:MAX_CLIP_PLANES]
    if not len(planes) or np.linalg.det(world_from_prim) == 0:  # a flat camera is an error of its own
        return ()
    planes = planes @ np.linalg.inv(world_from_prim) @ world_from_camera  # a plane is a covector
    length = np.linalg.norm(planes[:, :3], axis=1, keepdims=True)
    a, b, c, d = (planes / np.where(length > 0, length, 1.0)).T.tolist()
    return tuple(zip(a, b, c, d, strict=True))


def _authored_planes(usd: UsdGeom.Camera, time: Usd.TimeCode) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """``(n, 4)``, the last column in stage units."""
    value, path = usd.GetClippingPlanesAttr().Get(time), str(usd.GetPath())
    if value is None or (hasattr(value, "__len__") and len(value) == 0):
        return np.zeros((0, 4))
    try:
        planes = np.array(value, np.float64)
    except (TypeError, ValueError):
        planes = np.zeros(0)
    if planes.ndim != 2 or planes.shape[1] != 4 or not np.isfinite(planes).all():
        message = f"clippingPlanes of camera {path} must be four finite numbers each, got {format_value(value)}"
        raise CameraError(message, path=path)
    return planes
