"""Focus of a lens over time, solved from its camera and focus points. This is the one module that knows the focus modes.

Steps: fade the points in and out · request plane of focus and stop · smooth them · follow them with the hand on the focus ring.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from render.errors import CameraError, SettingsError
from render.focus.expressive import soft_sides
from render.focus.smoothing import points_share, smooth
from render.focus.solve import STATES, FocusSolutions
from render.focus.timeline import drive
from render.focus.tracking import track
from render.model.arrays import DoubleArray
from render.model.focal_surface import FocalPlane
from render.model.lens_law import LensLaw
from render.optics.focus_law import focus_laws
from render.shot.focus.inputs import FocusInputs
from render.shot.focus.request import distances_m, fade_points, request_focus
from render.shot.focus.ring import close_focus_depth_m, focus_ring
from usd_schemas import FocusData


@dataclass(frozen=True, eq=False)
class FocusTrack:
    """Focus of a lens at n times.

    Attributes:
        times: ``(n,)`` USD time codes, rising.
        planes: ``(n, 3)`` w on the axis in 1/m, and its change with the slope to the right and up.
        requested_w: ``(n,)`` w on the axis before the hand follows it.
        slowed_w: ``(n,)`` lag of the hand that is due to the limited speed of the focus ring, 1/m.
        f_stops: ``(n,)``.
        fades: ``(n, k)`` how much of each point counts, 0 to 1.
        points_w: ``(n, k)`` inverse depths of the points for a focal surface, 1/m: their own, except that a hand follows them;
            NaN without a position.
        sides: ``(n, k)`` side of each soft point on which the focal surface passes (`render.focus.expressive.soft_sides`).
        solutions: whose focus it is.
        notes: n sentences on what could not be done as requested, empty where all could.
    """

    times: DoubleArray
    planes: DoubleArray
    requested_w: DoubleArray
    slowed_w: DoubleArray
    f_stops: DoubleArray
    fades: DoubleArray
    points_w: DoubleArray
    sides: DoubleArray
    solutions: FocusSolutions
    notes: tuple[str, ...]

    def plane(self, index: int) -> FocalPlane:
        """The plane of focus at one of the times."""
        w0, right, up = self.planes[index].tolist()
        return FocalPlane(w0, right, up)


def keeps_sides(inputs: FocusInputs) -> bool:
    """True where soft points must keep their side of the focal surface, which takes the whole shot to decide."""
    return inputs.focus[0].mode == "surface" and bool(inputs.targets.is_blurred.any())


def follows_over_time(focus: FocusData) -> bool:
    """True where the focus at one time depends on other times."""
    return max(focus.smoothing_s, focus.lag_s, focus.dead_zone_mm, focus.max_speed_deg_s) > 0


def solve_track(inputs: FocusInputs) -> FocusTrack:
    """Solve the focus of a lens over time.

    Raises:
        CameraError: a number of the camera or of a point has no meaning.
        InputError: the camera's lens has no focal length.
    """
    try:
        return _track_by_hand(inputs) if inputs.focus[0].mode == "manual" else _track_by_points(inputs)
    except SettingsError as error:  # the numbers are the shot's, not the caller's
        path = inputs.cameras[0].path
        raise CameraError(f"camera {path}: {error.detail}", code=error.code, path=path) from error


def _track_by_hand(inputs: FocusInputs) -> FocusTrack:
    """Keep the camera's own distance, its lens tilted as authored."""
    camera_w, (count, points) = inputs.camera_w, inputs.visible.shape
    reason = "the focus mode is manual, so the camera's own focus distance is kept"
    solutions = FocusSolutions(
        focus_distance_m=distances_m(camera_w),
        shares=np.zeros((count, points)),
        state_codes=np.full((count, points), STATES.index("by_hand"), np.int8),
        sources=("camera",) * count,
        reasons=(reason,) * count,
        limits=("",) * count,
    )
    return FocusTrack(
        times=inputs.times,
        planes=np.column_stack([camera_w, inputs.tilt_gradients]),
        requested_w=camera_w,
        slowed_w=np.zeros(count),
        f_stops=inputs.camera_f_stops,
        fades=np.zeros((count, points)),
        points_w=_points_w(inputs),
        sides=np.ones((count, points)),
        solutions=solutions,
        notes=("",) * count,
    )


def _track_by_points(inputs: FocusInputs) -> FocusTrack:
    targets, law = inputs.targets, focus_laws(inputs.cameras)
    request = request_focus(inputs, targets, law)
    fades = fade_points(inputs, targets)
    planes, f_stops = request.planes, request.f_stops
    if inputs.is_smoothed:
        planes, f_stops = _smooth_request(inputs, law, fades)
    stopped = law.at_stops(f_stops if law.frames > 1 else f_stops[:1])
    followed, slowed_w = _follow_planes(inputs, stopped, planes)
    return FocusTrack(
        times=inputs.times,
        planes=followed,
        requested_w=planes[:, 0],
        slowed_w=slowed_w,
        f_stops=f_stops,
        fades=fades,
        points_w=_follow_points(inputs, stopped),
        sides=_soft_point_sides(inputs, law, followed),
        solutions=request.solutions,
        notes=tuple(request.notes),
    )


def _smooth_request(inputs: FocusInputs, law: LensLaw, fades: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    """Planes and f-numbers that cross over between points, and between points and camera, as the points fade."""
    targets, counts, seen = inputs.targets, fades > 0, np.ones(fades.shape)
    faded = replace(targets, weights=targets.weights * fades, enabled=counts, in_frame=counts, visible=seen)
    request = request_focus(inputs, faded, law)
    share = points_share(fades * (targets.weights > 0))
    camera_planes = np.column_stack([inputs.camera_w, inputs.tilt_gradients])
    planes = share[:, None] * request.planes + (1 - share)[:, None] * camera_planes
    return planes, share * request.f_stops + (1 - share) * inputs.camera_f_stops


def _soft_point_sides(inputs: FocusInputs, law: LensLaw, planes: DoubleArray) -> DoubleArray:
    """``(n, k)`` side of each soft point on which the focal surface passes: the same at all times, or its blur would jump."""
    targets = inputs.targets
    growth = law.coc_slope_mm_m(planes[:, 0])[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        w = np.where(targets.depths_m > 0, 1 / targets.depths_m, np.nan) - targets.field_shifts_w * targets.extents
        offset_w = np.where(targets.is_blurred, targets.blurs_mm * targets.extents / growth, 0.0)
        plane_w = planes[:, :1] + (planes[:, None, 1:] * targets.slopes).sum(-1)
    return np.broadcast_to(soft_sides(w, plane_w, offset_w), w.shape)


def _follow_planes(inputs: FocusInputs, law: LensLaw, planes: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    """Follow the requested planes with the hand on the lens.

    Returns:
        ``(n, 3)`` planes, and ``(n,)`` the lag that is due to the speed of the focus ring, 1/m.
    """
    if not any(follows_over_time(focus) for focus in inputs.focus):
        return planes, np.zeros(len(planes))
    seconds, keys = inputs.seconds, inputs.key_seconds
    smoothing, lag, speed = (inputs.setting(name) for name in ("smoothing_s", "lag_s", "max_speed_deg_s"))
    follow = partial(_follow, inputs, law, planes[:, 0], close_focus_m=close_focus_depth_m(inputs.cameras[0]))
    ring = focus_ring(inputs.cameras[0], float(inputs.throws_deg[0]))
    followed = planes.copy()
    followed[:, 0] = follow(ring=ring, max_speed_rad_s=np.radians(speed))
    for column in (1, 2):
        level = smooth(seconds, planes[:, column], smoothing, exact_at_s=keys)
        followed[:, column] = track(seconds, level, lag_s=lag)
    return followed, np.abs(followed[:, 0] - follow())


def _follow_points(inputs: FocusInputs, law: LensLaw) -> DoubleArray:
    """``(n, k)`` inverse depths of the points for a focal surface: a hand without a ring to slow it follows each of them."""
    w = _points_w(inputs)
    if inputs.focus[0].mode != "surface" or not any(follows_over_time(focus) for focus in inputs.focus):
        return w
    for column in w.T:
        is_finite = np.isfinite(column)
        if is_finite.any():
            gapless = np.interp(inputs.times, inputs.times[is_finite], column[is_finite])
            column[is_finite] = _follow(inputs, law, gapless)[is_finite]
    return w


def _points_w(inputs: FocusInputs) -> DoubleArray:
    depths_m = inputs.unshifted_targets.depths_m
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(depths_m > 0, 1 / depths_m, np.nan)


def _follow(inputs: FocusInputs, law: LensLaw, w: DoubleArray, **ring: Any) -> DoubleArray:
    """Follow ``(n,)`` requested inverse depths, 1/m, with the hand on the lens."""
    growth, zone_mm = law.coc_slope_mm_m(w), inputs.setting("dead_zone_mm")
    return drive(
        inputs.seconds,
        w,
        exact_at_s=inputs.key_seconds,
        smoothing_s=inputs.setting("smoothing_s"),
        lag_s=inputs.setting("lag_s"),
        dead_zone_w=np.where(growth > 0, zone_mm / np.where(growth > 0, growth, 1.0), 0.0),
        **ring,
    )
