"""Orthographic cameras, as perspective ones that stand far back: a thousand times as far as what they see is deep.

Sizes then differ between the nearest and the farthest thing by a thousandth, which is less than half a pixel at the edges of a
picture of 960 pixels. The layers' inverse depths need some distance to tell depths apart: what is a ten-thousandth of the whole
depth apart may not be. A camera farther away would have the first error smaller and the second larger.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from pxr import Usd, UsdGeom

from render.model.camera import Camera
from render.model.lens import THIN_LENS
from render.stage.camera.plate_places import plate_depths
from render.stage.options import PURPOSES
from render.stage.world import world_from_stage
from usd_schemas.units import metres_per_unit

_DEPTHS_AWAY = 1000
"""Distance of the camera, in depths of what it sees."""
_BOXED = list(PURPOSES)  # whatever is drawn lies in the box
_MARGIN = 1e-3  # of that depth, around it


def stand_back(camera: Camera, stage: Usd.Stage, time: Usd.TimeCode, near_m: float) -> Camera:
    """Perspective camera that shows what an orthographic one does. All is sharp: parallel rays have no lens here.

    Args:
        camera: the orthographic one. Its gate is in tenths of scene units, so that a millimetre of it is a metre of the scene.
        stage: the stage.
        time: when the stage's box is measured.
        near_m: near clipping distance, which may be negative: an orthographic camera sees what is behind it, too.
    """
    first, last = _depths(camera, stage, time)
    first, last = max(first, near_m), min(last, camera.far_m)
    depth = last - first if first < last < np.inf else 1.0
    distance = _DEPTHS_AWAY * depth
    back = distance - first  # how far it steps back
    pose = camera.world_from_camera.copy()
    pose[:3, 3] += pose[:3, 2] * back
    return replace(
        camera,
        world_from_camera=pose,
        focal_length_mm=1000 * (distance + depth / 2),
        f_stop=0.0,
        focus_distance_m=distance + depth / 2,
        near_m=distance,
        far_m=distance + depth,
        lens=THIN_LENS,
        focal_surface=None,
        breathing=False,
        clip_planes=tuple((a, b, c, d + c * back) for a, b, c, d in camera.clip_planes),
    )


def _depths(camera: Camera, stage: Usd.Stage, time: Usd.TimeCode) -> tuple[float, float]:
    """Least and greatest depth of the stage's box and of the camera's own back plates in front of it, with a margin, metres;
    infinite where there is nothing."""
    box = UsdGeom.BBoxCache(time, _BOXED, useExtentsHint=True).ComputeWorldBound(stage.GetPseudoRoot())
    bounds = box.ComputeAlignedRange()
    corners = np.array([[*bounds.GetCorner(i), 1.0] for i in range(8)])
    camera_from_stage = np.linalg.inv(camera.world_from_camera) @ world_from_stage(stage)
    depths = plate_depths(UsdGeom.Camera(stage.GetPrimAtPath(camera.path)), time) * metres_per_unit(stage)
    if not bounds.IsEmpty() and np.isfinite(corners).all():
        depths = np.append(depths, -(corners @ camera_from_stage[2]))
    if not depths.size:
        return -np.inf, np.inf
    margin = _MARGIN * float(np.ptp(depths)) or _MARGIN
    return float(depths.min()) - margin, float(depths.max()) + margin
