"""Functions of the stage process that read the set from above."""

from __future__ import annotations

import math

import numpy as np

from render.model.arrays import DoubleArray
from render.shot import Shot
from service.models.base import Vector3
from service.models.top_view import CutPlace, Paths, PointPath, TopView
from service.stage.opened import OpenedShot, stage_function
from service.stage.read_points import point_names
from service.storage.store import ShotRecord

MAX_PATH_TIMES = 481
"""Times of a path; those of a longer shot are so many at equal steps."""
MAX_PATH_PLACES = 200_000
"""Times of a path times focus points; where there would be more, the times are fewer."""


@stage_function
def read_top_view(opened: OpenedShot, record: ShotRecord, camera: str | None, time: float) -> TopView:
    """Read the plan of a camera at one time. Raises `CameraError`."""
    with opened.use(record) as shot:
        plan = shot.plan.read(camera, time)
        return TopView(
            camera=plan.camera or None,
            time=time,
            position_m=_vector(plan.position_m),
            right=_vector(plan.right),
            ahead=_vector(plan.ahead),
            set_back_m=plan.set_back_m,
            gate_mm=plan.gate_mm,
            edges=(float(plan.slopes[0]), float(plan.slopes[-1])),
            axis=_place(0.0, plan.axis_w),
            cut=[_place(float(slope), w) for slope, w in zip(plan.slopes, plan.w, strict=True)],
        )


@stage_function
def read_paths(opened: OpenedShot, record: ShotRecord, edit_text: str, camera: str | None) -> Paths:
    """Read where a camera and its focus points are over the shot. Raises `CameraError`."""
    with opened.use(record, edit_text) as shot:
        times = path_times(shot, len(point_names(shot, camera)))
        paths = shot.plan.paths(camera, times)
        return Paths(
            camera=camera or shot.default_camera().path,
            times=times,
            camera_m=[_vector(position) for position in paths.camera_m],
            points=[
                PointPath(name=name, positions_m=[_vector_or_none(row[at]) for row in paths.points_m])
                for at, name in enumerate(paths.names)
            ],
        )


def path_times(shot: Shot, points: int) -> list[float]:
    """Return the time codes of the frames of a shot, first and last among them; fewer of a long one or for many points."""
    start, end = shot.frame_range.start, max(shot.frame_range.end, shot.frame_range.start)
    step = shot.stage.GetTimeCodesPerSecond() / shot.stage.GetFramesPerSecond()
    most = min(MAX_PATH_TIMES, max(MAX_PATH_PLACES // max(points, 1), 2))
    count = min(math.floor((end - start) / step + 1e-6) + 1, most)
    return [float(time) for time in np.linspace(start, end, count)]


def _place(slope: float, w: DoubleArray) -> CutPlace:
    near, focus, far = w.tolist()
    return CutPlace(slope=slope, near_w=near, focus_w=focus, far_w=far)


def _vector(values: DoubleArray) -> Vector3:
    x, y, z = values.tolist()
    return x, y, z


def _vector_or_none(values: DoubleArray) -> Vector3 | None:
    return _vector(values) if np.isfinite(values).all() else None
