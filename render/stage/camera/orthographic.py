"""Orthographic cameras, as perspective ones that stand far back: ten thousand times as far as what they see is deep.

Sizes then differ between the nearest and the farthest thing by a ten-thousandth, which is a twentieth of a pixel at the edges of
a picture of 960 pixels. `render.layers.drawing_space` keeps positions and depths exact in single precision.

Its lens is one of parallel rays, telecentric towards the scene, and its film is as large as what it sees, since USD gives the
apertures of an orthographic camera in the scene's own length. At a magnification of one, what is ``d`` before or behind the
plane of focus is blurred to a disc of the diameter ``d / N`` in the scene, wherever the focus lies; the focal length has no
meaning. A thin lens of the same f-number N far back, of a focal length that is its distance, has such rays.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from pxr import Usd, UsdGeom

from render.model.arrays import DoubleArray
from render.model.camera import Camera, Orthographic
from render.model.lens import THIN_LENS
from render.stage.assembly.poses import world_pose
from render.stage.camera.plate_places import plate_corners
from render.stage.camera_list import list_cameras
from render.stage.geometry.splat_boxes import box_below
from render.stage.limits import PlaceError
from render.stage.options import PURPOSES
from render.stage.world import rigid_frame, world_from_stage
from usd_schemas.units import metres_per_unit

_DEPTHS_AWAY = 10_000
"""Distance of the camera, in depths of what it sees."""
_BOXED = list(PURPOSES)  # whatever is drawn lies in the box
_MARGIN = 1e-3  # of that depth, around it


def stand_back(camera: Camera, stage: Usd.Stage, time: Usd.TimeCode, near_m: float) -> Camera:
    """Perspective camera that shows what an orthographic one does, with its iris, f-number, squeeze and transmittance.

    Focus at infinity, as of a camera without a focus distance, is that on the farthest thing.

    Args:
        camera: the orthographic one, its gate as large as what it sees.
        stage: the stage.
        time: when the stage's box is measured.
        near_m: near clipping distance, which may be negative: an orthographic camera sees what is behind it, too.
    """
    first, last = _depths(camera, stage, time)
    first, last = max(first, near_m), min(last, camera.far_m)
    depth = last - first if first < last < np.inf else 1.0
    stated = Orthographic(0.0, camera.focal_length_mm)
    there = replace(
        camera,
        focal_length_mm=1000 * (first + depth / 2),
        focus_distance_m=camera.focus_distance_m if 0 < camera.focus_distance_m < math.inf else first + depth,
        near_m=first,
        far_m=first + depth,
        lens=replace(
            THIN_LENS, name=camera.lens.name, squeeze=camera.lens.squeeze, transmittance=camera.lens.transmittance
        ),
        breathing=False,
        circles_by_image_distance=False,
        orthographic=stated,
    )
    return _step_back(there, stated, _DEPTHS_AWAY * depth - first)


def stand_together(cameras: Sequence[Camera]) -> tuple[Camera, ...]:
    """Return one camera at several times with the same distance of its pupil and the same clipping range, if it is orthographic.

    Then inverse depths mean the same at all times, so that they can be smoothed and merged over time.

    Args:
        cameras: from `stand_back`, or perspective ones, which stay as they are.
    """
    farthest_m = max(camera.set_back_m for camera in cameras)
    together = [
        camera
        if camera.orthographic is None
        else _step_back(camera, camera.orthographic, farthest_m - camera.set_back_m)
        for camera in cameras
    ]
    near_m, far_m = min(camera.near_m for camera in together), max(camera.far_m for camera in together)
    return tuple(
        camera if camera.orthographic is None else replace(camera, near_m=near_m, far_m=far_m) for camera in together
    )


def _step_back(camera: Camera, stated: Orthographic, by_m: float) -> Camera:
    pose = camera.world_from_camera.copy()
    pose[:3, 3] += pose[:3, 2] * by_m
    return replace(
        camera,
        world_from_camera=pose,
        focal_length_mm=camera.focal_length_mm + 1000 * by_m,
        focus_distance_m=camera.focus_distance_m + by_m,
        near_m=camera.near_m + by_m,
        far_m=camera.far_m + by_m,
        clip_planes=tuple((a, b, c, d + c * by_m) for a, b, c, d in camera.clip_planes),
        orthographic=replace(stated, set_back_m=stated.set_back_m + by_m),
    )


def _depths(camera: Camera, stage: Usd.Stage, time: Usd.TimeCode) -> tuple[float, float]:
    """Least and greatest depth of the stage's box and of the back plates that a camera sees, in front of it, with a margin,
    metres; infinite where there is nothing."""
    bounds = box_below(stage.GetPseudoRoot(), time, _BOXED)
    corners = np.array([[*bounds.GetCorner(i), 1.0] for i in range(8)])
    camera_from_stage = np.linalg.inv(camera.world_from_camera) @ world_from_stage(stage)
    depths = _plate_depths(camera, stage, time)
    if not bounds.IsEmpty() and np.isfinite(corners).all():
        depths = np.append(depths, -(corners @ camera_from_stage[2]))
    if not depths.size:
        return -np.inf, np.inf
    margin = _MARGIN * float(np.ptp(depths)) or _MARGIN
    return float(depths.min()) - margin, float(depths.max()) + margin


def _plate_depths(camera: Camera, stage: Usd.Stage, time: Usd.TimeCode) -> DoubleArray:
    """Depths ``(n,)`` in front of a camera of the corners of the back plates that it sees, metres."""
    camera_from_world, transforms = np.linalg.inv(camera.world_from_camera), UsdGeom.XformCache(time)
    depths = []
    for path in {camera.path, *list_cameras(stage)}:
        other = UsdGeom.Camera(stage.GetPrimAtPath(path))
        corners = metres_per_unit(stage) * plate_corners(other, time, shown_to_all=path != camera.path)
        if not len(corners):
            continue
        try:
            frame = rigid_frame(world_pose(other.GetPrim(), transforms, world_from_stage(stage)))
        except PlaceError:
            continue  # the plate is not drawn, and the stage reader says so
        matrix = camera_from_world @ frame
        depths.append(-(corners @ matrix[2, :3] + matrix[2, 3]))
    return np.concatenate([np.zeros(0), *depths])
